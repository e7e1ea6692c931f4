// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// One held object in a hand: what it remembers from tick to tick, and the steps that ticks with and without a coupling share.
#ifndef PALPATE_SRC_LAYERS_RIGID_SESSION_H
#define PALPATE_SRC_LAYERS_RIGID_SESSION_H

#include "rigid_coupling.h"
#include "rigid_friction.h"
#include "rigid_motion.h"

namespace palpate {

constexpr std::uint32_t rigid_zero_wrench = PALPATE_RIGID_TICK_JUMP | PALPATE_RIGID_TICK_STALE | PALPATE_RIGID_TICK_BAD_INPUT |
                                            PALPATE_RIGID_TICK_RELEASED | PALPATE_RIGID_TICK_TOO_DEEP | PALPATE_RIGID_TICK_WAITING;

constexpr double rigid_acceleration_max = 300.0;  // m/s2; of a hand, where a config says nothing else

struct rigid_held_contact {
    std::uint32_t key, reserved;
    rigid_grip grip;
    double point[3], normal[3];
    double friction[3], torque, energy;  // sent in the last tick
    double damped;                       // N; the damping part of the normal force
    double gyration;
};

struct rigid_books {
    double work, friction, damping, inertial, gravity;
};

struct rigid_coupled {  // all that only a coupled object has
    double speed[6];    // m/s, rad/s, of the centre of mass
    double wrench[6];   // N, N m, of the contacts about the centre of mass
    rigid_matrix stiffness, damping;  // of the contacts
    double given;       // J; the reserve
    double moving, spring;  // J; kinetic; in the coupling's spring
};

}  // namespace palpate

struct palpate_rigid_session {
    const palpate_rigid* scene;
    palpate_rigid_config config;
    palpate::rigid_place device;   // where the hand holds it
    palpate::rigid_place at;       // where it is: there too, without a coupling
    std::uint32_t known, waiting;  // whether these are places; not come from free space
    palpate::rigid_velocity velocity;
    std::uint32_t count, reserved;
    palpate::rigid_held_contact contact[palpate::rigid_contact_limit];
    double force[3], torque[3];             // sent: on the hand; torque about the device's centre of mass
    double inertia_force[3], inertia_torque[3];
    double stored, gravity_on;              // J, of the contacts; 1 while gravity is rendered
    double lent;                            // J; E in rigid_inertia.h: what the hand may have back of its work on the rendered inertia
    palpate::rigid_books account;
    palpate::rigid_coupled coupled;
};

namespace palpate {

inline bool rigid_has_coupling(const palpate_rigid_session& s) noexcept { return s.config.coupling_stiffness > 0.0; }

void rigid_release(palpate_rigid_session& s) PALPATE_REAL_TIME;

// Whether a look between the last place and `to` met something that neither end shows; or the way is too long to look along.
bool rigid_passed_something(const palpate_rigid_session& s, const rigid_place& to, double step, rigid_touches& touches) PALPATE_REAL_TIME;

// What the object touches at a place, and the status that this gives; `step`: m, of its farthest point since the last tick.
std::uint32_t rigid_meet(palpate_rigid_session& s, const rigid_pose& pose, double step, std::uint32_t status, rigid_touches& touches,
                         rigid_contacts& now) PALPATE_REAL_TIME;

// Motion type, forces and friction of the formation; fills contact_force, contact_torque and the session's contacts.
void rigid_render(palpate_rigid_session& s, const rigid_contacts& now, const rigid_place& to, const rigid_pose& pose, const double moved[3],
                  const double turned[3], double dt, palpate_rigid_response& out) PALPATE_REAL_TIME;

void rigid_tell_contact(const rigid_principal& pc, const rigid_held_contact& c, double normal_force, palpate_rigid_contact& out) PALPATE_REAL_TIME;

// Motion and accounts.
void rigid_tell(const palpate_rigid_session& s, palpate_rigid_response& out) PALPATE_REAL_TIME;

// Scales force and torque (about a point at -arm) to the device's limits, by the factor that it returns.
double rigid_limit(const palpate_rigid_session& s, double force[3], double torque[3], const double arm[3], std::uint32_t& status) PALPATE_REAL_TIME;

// The tick of a coupled object: the device is at `device`, it `moved` and `turned` since the last tick; `status`: what that gave.
std::uint32_t rigid_coupled_tick(palpate_rigid_session& s, const palpate_rigid_state& state, const rigid_place& device,
                                 const double moved[3], const double turned[3], std::uint32_t status,
                                 palpate_rigid_response& out) PALPATE_REAL_TIME;

}  // namespace palpate

#endif
