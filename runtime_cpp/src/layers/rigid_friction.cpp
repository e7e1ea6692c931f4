// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "rigid_friction.h"

#include <cmath>

#include "../rotation.h"
#include "../vec.h"

namespace palpate {
namespace {

constexpr double half = 0.70710678118654752, c1 = 0.92387953251128676, s1 = 0.38268343236508977;
constexpr double ray[16][2] = {{1, 0}, {c1, s1}, {half, half}, {s1, c1}, {0, 1}, {-s1, c1}, {-half, half}, {-c1, s1},
                               {-1, 0}, {-c1, -s1}, {-half, -half}, {-s1, -c1}, {0, -1}, {s1, -c1}, {half, -half}, {c1, -s1}};

// Distance from o to the hull's rim along d; 0 where o is outside.
double exit_of(const rigid_principal& pc, const double o[2], const double d[2]) noexcept {
    double nearest = 1e9;
    for (std::uint32_t i = 0; i < pc.hull_count; ++i) {
        const double *a = pc.hull[i], *b = pc.hull[(i + 1) % pc.hull_count];
        const double e[2] = {b[0] - a[0], b[1] - a[1]};
        const double inside = e[0] * (o[1] - a[1]) - e[1] * (o[0] - a[0]);  // > 0 inside
        if (inside < 0.0) return 0.0;
        const double falls = e[1] * d[0] - e[0] * d[1];
        if (falls > 1e-15 && inside < nearest * falls) nearest = inside / falls;
    }
    return nearest < 1e8 ? nearest : 0.0;
}

struct plane_force {
    double along[2], torque;
};

// One share of the kinetic force, at p, where the material moves with u + turned x p.
void share(double size, const double p[2], const double u[2], double turned, plane_force& f) noexcept {
    const double v[2] = {u[0] - turned * p[1], u[1] + turned * p[0]};
    const double speed = std::sqrt(v[0] * v[0] + v[1] * v[1]);
    if (!(speed > 1e-15)) return;
    const double x = -size * v[0] / speed, y = -size * v[1] / speed;
    f.along[0] += x;
    f.along[1] += y;
    f.torque += p[0] * y - p[1] * x;
}

// Kinetic friction, in (across, tangent); `size` = mu_D N.
plane_force kinetic(const rigid_principal& pc, double size, const double u[2], double turned) noexcept {
    plane_force f{{0.0, 0.0}, 0.0};
    const double origin[2] = {0.0, 0.0};
    if (pc.hull_count < 2 || turned == 0.0) {
        share(size, origin, u, 0.0, f);
        return f;
    }
    const double o[2] = {-u[1] / turned, u[0] / turned};  // planar rotation axis: the material there rests
    if (pc.region == PALPATE_RIGID_LINE) {
        const double e[2] = {pc.hull[1][0] - pc.hull[0][0], pc.hull[1][1] - pc.hull[0][1]}, square = e[0] * e[0] + e[1] * e[1];
        const double t = ((o[0] - pc.hull[0][0]) * e[0] + (o[1] - pc.hull[0][1]) * e[1]) / square;
        const double off = e[0] * (o[1] - pc.hull[0][1]) - e[1] * (o[0] - pc.hull[0][0]);
        if (t <= 0.0 || t >= 1.0 || off * off > 0.01 * square * square) {
            share(size, origin, u, turned, f);
            return f;
        }
        for (int side = 0; side < 2; ++side) {
            const double part = side == 0 ? t : 1.0 - t, at = side == 0 ? 0.5 * t : 0.5 * (1.0 + t);
            const double p[2] = {pc.hull[0][0] + at * e[0], pc.hull[0][1] + at * e[1]};
            share(size * part, p, u, turned, f);
        }
        return f;
    }
    double length[16], total = 0.0;
    for (int j = 0; j < 16; ++j) {
        length[j] = exit_of(pc, o, ray[j]);
        total += length[j] * length[j];
    }
    if (total > 0.0) {
        for (int j = 0; j < 16; ++j) {
            const double p[2] = {o[0] + 2.0 / 3.0 * length[j] * ray[j][0], o[1] + 2.0 / 3.0 * length[j] * ray[j][1]};
            share(size * length[j] * length[j] / total, p, u, turned, f);
        }
        return f;
    }
    double area = 0.0;
    for (std::uint32_t i = 0; i < pc.hull_count; ++i) {
        const double *a = pc.hull[i], *b = pc.hull[(i + 1) % pc.hull_count];
        area += std::fabs(a[0] * b[1] - a[1] * b[0]);
    }
    for (std::uint32_t i = 0; i < pc.hull_count && area > 0.0; ++i) {
        const double *a = pc.hull[i], *b = pc.hull[(i + 1) % pc.hull_count], p[2] = {(a[0] + b[0]) / 3.0, (a[1] + b[1]) / 3.0};
        share(size * std::fabs(a[0] * b[1] - a[1] * b[0]) / area, p, u, turned, f);
    }
    return f;
}

}  // namespace

rigid_friction_force rigid_rub(const rigid_header& law, const rigid_principal& pc, double normal_force, const double moved[3],
                               double turned, double dt, bool kinetic_allowed, rigid_grip& grip) noexcept {
    const double g = pc.gyration, kp = law.tangential_stiffness;
    double flat[3];
    const double through = dot(moved, pc.normal), sunk = dot(grip.slip, pc.normal);
    for (int k = 0; k < 3; ++k) flat[k] = moved[k] - through * pc.normal[k];
    const double quick = dot(flat, flat) + g * g * turned * turned, slow = law.speed_static * dt;
    const bool at_rest = quick <= slow * slow;
    for (int k = 0; k < 3; ++k) grip.slip[k] += flat[k] - sunk * pc.normal[k];
    grip.twist = g > 0.0 ? grip.twist + turned : 0.0;
    const double stretch = std::sqrt(dot(grip.slip, grip.slip) + g * g * grip.twist * grip.twist);
    const double most = law.static_friction * normal_force;
    const bool over = kp * stretch > most;
    grip.sliding = kinetic_allowed && !at_rest && (over || grip.sliding != 0) ? 1u : 0u;
    if (grip.sliding != 0) {
        const double u[2] = {dot(flat, pc.across), dot(flat, pc.tangent)};
        const plane_force f = kinetic(pc, law.kinetic_friction * normal_force, u, turned);
        for (int k = 0; k < 3; ++k) grip.slip[k] = -(f.along[0] * pc.across[k] + f.along[1] * pc.tangent[k]) / kp;
        grip.twist = g > 0.0 ? -f.torque / (kp * g * g) : 0.0;
    } else if (over) {
        const double keep = most / (kp * stretch);
        for (double& s : grip.slip) s *= keep;
        grip.twist *= keep;
    }
    rigid_friction_force out;
    for (int k = 0; k < 3; ++k) out.force[k] = -kp * grip.slip[k];
    out.torque = -kp * g * g * grip.twist;
    out.energy = 0.5 * kp * (dot(grip.slip, grip.slip) + g * g * grip.twist * grip.twist);
    return out;
}

}  // namespace palpate
