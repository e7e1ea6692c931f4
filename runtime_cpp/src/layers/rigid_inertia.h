// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Inertia of an object that is where the device is: in free motion (Luo and Xiao) the hand feels
//     W = -(m a, I alpha + w x I w),  a and alpha filtered twice with the time constant tau.
// Contact renders none of it, so what the hand puts in and gets back needs an account, E: the kinetic energy that the hand has put in
// through W and that is not lost.  Filtered inertia is passive, with
//     S = 1/2 (v - tau a) M (v - tau a) + 1/2 tau^2 a M a  its storage and  2 tau a M a  its loss  (v, a: filtered, six numbers each),
// so E <= S; what is above, the filter's loss, or what the object lost while it touched, is gone (and stays in the account `inertial`).  The hand gets back
//     no more than E / S of what W would give: the share of the object's motion that the hand itself has set going.
// Only the part of W along the momentum gives or takes, and only it is kept back: turning round costs nothing and stays whole.
// W is held for a tick in which the hand may accelerate by acceleration_max more than in the last one, so it can take at most
//     W x + max(|F|, |M| / R) acceleration_max dt^2,  x: the last step;  that is kept within 9/10 of the reserve + E,
//     reserve = 10/9 m acceleration_max dt^2 * 10 m/s2,
// with which hands that accelerate by up to 10 m/s2 from rest are never kept back.  Over ticks of one length E >= -reserve at all times.
#ifndef PALPATE_SRC_LAYERS_RIGID_INERTIA_H
#define PALPATE_SRC_LAYERS_RIGID_INERTIA_H

#include "rigid_session.h"

namespace palpate {

// Takes out of E what a step has lost; after `track`.
void rigid_lose_kinetic(palpate_rigid_session& s, const rigid_pose& pose) PALPATE_REAL_TIME;

// W in inertia_force and inertia_torque, `moved` (m) and `turned` (rad) in the last tick.  After rigid_lose_kinetic.
void rigid_free_inertia(palpate_rigid_session& s, const rigid_pose& pose, const double moved[3], const double turned[3],
                        double dt) PALPATE_REAL_TIME;

}  // namespace palpate

#endif
