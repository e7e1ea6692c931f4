// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "rigid_inertia.h"

namespace palpate {
namespace {

constexpr double share = 0.9;                  // of reserve + E
constexpr double ordinary_acceleration = 10.0; // m/s2; what the reserve is for
constexpr double floor_share = 1e-9;           // of the reserve; below it no inertia could ever begin again

// 1/2 v M v, J.
double kinetic(const rigid_header& h, const rigid_pose& pose, const double v[3], const double w[3]) noexcept {
    double spin[3];
    inertia_times(h.inertia, pose, w, spin);
    return 0.5 * (h.mass * dot(v, v) + dot(spin, w));
}

// S, J.
double storage(const palpate_rigid_session& s, const rigid_pose& pose) noexcept {
    const rigid_velocity& v = s.velocity;
    const double tau = s.config.filter_time;
    double lag[3], spin_lag[3];
    for (int i = 0; i < 3; ++i) {
        lag[i] = v.linear[i] - tau * v.acceleration[i];
        spin_lag[i] = v.angular[i] - tau * v.angular_acceleration[i];
    }
    const double along = kinetic(s.scene->head, pose, lag, spin_lag);
    return tau > 0.0 ? along + tau * tau * kinetic(s.scene->head, pose, v.acceleration, v.angular_acceleration) : along;
}

}  // namespace

void rigid_lose_kinetic(palpate_rigid_session& s, const rigid_pose& pose) noexcept {
    if (!(s.lent > 0.0)) return;
    const double most = storage(s, pose);
    if (s.lent > most) s.lent = most;
}

void rigid_free_inertia(palpate_rigid_session& s, const rigid_pose& pose, const double moved[3], const double turned[3],
                        double dt) noexcept {
    const rigid_header& h = s.scene->head;
    const rigid_velocity& v = s.velocity;
    if (v.known < 2) return;
    double *force = s.inertia_force, *torque = s.inertia_torque, rate[3], spin[3], gyro[3];
    inertia_times(h.inertia, pose, v.angular_acceleration, rate);
    inertia_times(h.inertia, pose, v.angular, spin);
    cross(v.angular, spin, gyro);  // Euler's equations; Luo and Xiao leave this out
    for (int i = 0; i < 3; ++i) {
        force[i] = -h.mass * v.acceleration[i];
        torque[i] = -(rate[i] + gyro[i]);
    }
    const double energy = s.lent;
    double gives = dot(force, moved) + dot(torque, turned);
    if (gives > 0.0) {
        double keep = 0.0;
        if (energy > 0.0) {
            const double whole = storage(s, pose), most = gives > whole ? gives : whole;
            keep = energy < most ? energy / most : 1.0;
        }
        if (keep < 1.0) {
            inertia_times(h.inertia, pose, turned, spin);
            const double square = h.mass * dot(moved, moved) + dot(spin, turned);
            const double b = square > 1e-30 ? (1.0 - keep) * gives / square : 0.0;  // steps below 1e-15 m are digital error
            for (int i = 0; i < 3; ++i) {
                force[i] = b > 0.0 ? force[i] - b * h.mass * moved[i] : keep * force[i];
                torque[i] = b > 0.0 ? torque[i] - b * spin[i] : keep * torque[i];
            }
            // What turns the motion does no work, unless the next step goes another way: it may not ask more of E than there is.
            const double astray = std::sqrt(dot(force, force) * dot(moved, moved)) + std::sqrt(dot(torque, torque) * dot(turned, turned));
            const double part = astray > energy ? (energy > 0.0 ? energy / astray : 0.0) : 1.0;
            for (int i = 0; i < 3; ++i) {
                force[i] *= part;
                torque[i] *= part;
            }
            gives *= keep * part;
        }
    }
    const double surprise = (s.config.acceleration_max > 0.0 ? s.config.acceleration_max : rigid_acceleration_max) * dt * dt;
    const double reserve = h.mass * surprise * ordinary_acceleration / share, turning = std::sqrt(dot(torque, torque)) / h.held_radius;
    const double straight = std::sqrt(dot(force, force)), taken = gives + (straight > turning ? straight : turning) * surprise;
    const double left = reserve + energy, most = share * (left > floor_share * reserve ? left : floor_share * reserve);
    if (taken > most) {
        const double keep = most / taken;
        for (int i = 0; i < 3; ++i) {
            force[i] *= keep;
            torque[i] *= keep;
        }
    }
}

}  // namespace palpate
