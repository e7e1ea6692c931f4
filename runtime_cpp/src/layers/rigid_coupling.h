// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Virtual coupling (Adams and Hannaford 1999): a spring and damper in six directions between the device's grip and the held object's.
//     wrench on the object  f = k e + b de/dt,  m = kappa phi + beta dphi/dt,   e, phi from the object's grip to the device's
//     M dv/dt = J^T (f, m) + contact + weight - w x I w
// One linearly implicit Euler step, with the contacts' stiffness and damping (bounds from above) in the matrix:
//     (M + dt B + dt^2 K) v+ = M v + dt (J^T (k e + b v_device, ...) + contact + B_c v + weight - w x I w),   K, B: coupling's and contacts'
// so that stiff contacts and light objects stay stable at any tick.
//
// Energy: what the hand has put in and nothing else holds is the ledger, L = reserve + work_in - kinetic - contacts' - losses - lifted.
// A wrench F sent is held for a tick.  The hand's next step is its last one, dx, and at most a = acceleration_max dt^2 more, so it takes
// at most F dx + |F| a (of turns M dtheta + |M| / R a).  That is kept within share * L and the spring's energy within L: L cannot fall
// below zero, and no path with ticks of one length takes out more than the reserve (and a loan of a hundredth of it) beyond what it put in:
//     reserve = a / share (1/2 k a / share + b v0),   k = max(stiffness, torsional / R^2), b alike,
// with which neither the spring nor the damper below v0 is kept back.  What the coupling loses fills the ledger up to spring + reserve; the
// rest is told as damping.  A hand that accelerates more may leave L below zero: then it is let go, as after a jump.
#ifndef PALPATE_SRC_LAYERS_RIGID_COUPLING_H
#define PALPATE_SRC_LAYERS_RIGID_COUPLING_H

#include "rigid_motion.h"

namespace palpate {

constexpr double rigid_ledger_share = 0.9;
constexpr double rigid_ledger_floor = 1e-5;  // of the reserve; below it no wrench could ever begin again
constexpr double rigid_loan = 0.01;          // of the reserve; what may be lent to stay above the floor, paid back by losses
constexpr double rigid_ordinary_speed = 0.3; // m/s; v0

struct rigid_matrix {  // of v, w at the centre of mass in world axes; symmetric
    double at[6][6];
};

struct rigid_coupling {
    double stiffness, damping;            // N/m, N s/m
    double turn_stiffness, turn_damping;  // N m/rad, N m s/rad
};

// What one step needs to know of the held object.
struct rigid_drive {
    double mass, radius;        // kg; m, of the object about its centre
    double weight[3];           // N
    double gyro[3];             // N m; w x I w
    double arm[3];              // m; from the centre to the grip
    double stretch[3], turn[3]; // e (m), phi (rad)
    double hand[6];             // m/s of the device's grip, rad/s
    double wrench[6];           // N, N m; contacts' on the object about its centre, as last rendered
    double speed[6];            // v before the step
    rigid_matrix inertia;       // M
    rigid_matrix stiffness, damping;  // of the contacts
};

struct rigid_step {
    double speed[6];
    double force[3], torque[3];  // on the hand, at the grip
};

// m += k j j^T, j = (d, arm x d): a spring along d at `arm` from the centre.
void rigid_add_point(rigid_matrix& m, const double d[3], const double arm[3], double k) PALPATE_REAL_TIME;

// The step with all of the coupling times `part` (0 to 1).
void rigid_advance(const rigid_drive& drive, const rigid_coupling& coupling, double part, double dt, rigid_step& step) PALPATE_REAL_TIME;

inline double rigid_spring_energy(const rigid_coupling& c, const double stretch[3], const double turn[3]) noexcept {
    return 0.5 * (c.stiffness * dot(stretch, stretch) + c.turn_stiffness * dot(turn, turn));
}

// J; `radius` R, `surprise` a, in m.
inline double rigid_reserve(const rigid_coupling& c, double radius, double surprise) noexcept {
    const double k_turn = c.turn_stiffness / (radius * radius), b_turn = c.turn_damping / (radius * radius);
    const double k = c.stiffness > k_turn ? c.stiffness : k_turn, b = c.damping > b_turn ? c.damping : b_turn, a = surprise / rigid_ledger_share;
    return a * (0.5 * k * a + b * rigid_ordinary_speed);
}

}  // namespace palpate

#endif
