// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Poses, turns between them, and a held object's velocities and accelerations, tracked and filtered.
#ifndef PALPATE_SRC_LAYERS_RIGID_MOTION_H
#define PALPATE_SRC_LAYERS_RIGID_MOTION_H

#include <cmath>

#include "../rotation.h"
#include "../vec.h"
#include "rigid_distance.h"

namespace palpate {

struct rigid_place {
    double position[3];     // m; centre of mass
    double orientation[4];  // x y z w, of length 1
};

inline rigid_pose pose_of(const rigid_place& at) noexcept {
    const double *u = at.orientation, x = u[0], y = u[1], z = u[2], w = u[3];
    return {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
             {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
             {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}},
            {at.position[0], at.position[1], at.position[2]}};
}

// Rotation vector from a to b (rad): 2 asin(s) along the axis by its series, s = |sin(angle / 2)|; error below 1e-4 rad up to 1 rad.
inline void turn_between(const double a[4], const double b[4], double turn[3]) noexcept {
    double back[4], r[4];
    conjugate(a, back);
    multiply(b, back, r);
    const double square = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
    const double k = (r[3] < 0.0 ? -2.0 : 2.0) * (1.0 + square * (1.0 / 6.0 + square * (3.0 / 40.0 + square * (15.0 / 336.0))));
    for (int i = 0; i < 3; ++i) turn[i] = k * r[i];
}

// Between two places, t = 0 to 1; orientation by normalised interpolation.
inline rigid_place part_way(const rigid_place& a, const rigid_place& b, double t) noexcept {
    rigid_place c;
    double square = 0.0, sign = 0.0;
    for (int i = 0; i < 4; ++i) sign += a.orientation[i] * b.orientation[i];
    for (int i = 0; i < 3; ++i) c.position[i] = a.position[i] + t * (b.position[i] - a.position[i]);
    for (int i = 0; i < 4; ++i) {
        c.orientation[i] = (1.0 - t) * a.orientation[i] + (sign < 0.0 ? -t : t) * b.orientation[i];
        square += c.orientation[i] * c.orientation[i];
    }
    const double scale = square > 1e-12 ? 1.0 / std::sqrt(square) : 0.0;
    for (double& u : c.orientation) u *= scale;
    return c;
}

struct rigid_velocity {
    double linear[3], angular[3], acceleration[3], angular_acceleration[3];
    std::uint32_t known;  // samples so far: 1 velocity, 2 acceleration
    std::uint32_t reserved;
};

// A step `moved` (m) and `turned` (rad) in dt; first-order filter of time constant `time`.
inline void track(rigid_velocity& v, const double moved[3], const double turned[3], double dt, double time) noexcept {
    const double k = dt / (dt + time);
    for (int i = 0; i < 3; ++i) {
        const double before[2] = {v.linear[i], v.angular[i]}, now[2] = {moved[i] / dt, turned[i] / dt};
        v.linear[i] = v.known == 0 ? now[0] : before[0] + k * (now[0] - before[0]);
        v.angular[i] = v.known == 0 ? now[1] : before[1] + k * (now[1] - before[1]);
        if (v.known == 0) continue;
        v.acceleration[i] += k * ((v.linear[i] - before[0]) / dt - v.acceleration[i]);
        v.angular_acceleration[i] += k * ((v.angular[i] - before[1]) / dt - v.angular_acceleration[i]);
    }
    if (v.known < 2) ++v.known;
}

// I w with the tensor `inertia` (xx yy zz xy yz xz) in the object's axes.
inline void inertia_times(const double inertia[6], const rigid_pose& pose, const double w[3], double out[3]) noexcept {
    double b[3], l[3];
    for (int i = 0; i < 3; ++i) b[i] = pose.rotation[0][i] * w[0] + pose.rotation[1][i] * w[1] + pose.rotation[2][i] * w[2];
    l[0] = inertia[0] * b[0] + inertia[3] * b[1] + inertia[5] * b[2];
    l[1] = inertia[3] * b[0] + inertia[1] * b[1] + inertia[4] * b[2];
    l[2] = inertia[5] * b[0] + inertia[4] * b[1] + inertia[2] * b[2];
    for (int i = 0; i < 3; ++i) out[i] = dot(pose.rotation[i], l);
}

}  // namespace palpate

#endif
