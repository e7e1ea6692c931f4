// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Coulomb friction of one principal contact with normal force N, after Luo and Xiao's equations 3 to 5:
//     static:   F = -K_p s, |F| <= mu N                      (3), (4)
//     kinetic:  F = -mu_D N_j u_j at each equivalent point j  (5, with the kinetic coefficient)
// s is the slip of the touching material since it stuck, not of one tick: a force that grows with the tick's length would not
// hold anything.  In pure rolling the touching materials do not slip, so s stays.  A region also twists: psi about the normal, with the
// stiffness K_p g^2 and the limit mu N g, g the region's mean radius (gyration); slip and twist share one limit,
//     (K_p |s|)^2 + (K_p g psi)^2 <= (mu N)^2.
// Kinetic friction of a region that turns about a point o inside it: sixteen rays from o, exit at l_j.  The pressure of a thin sector is
// in proportion to l_j^2 and acts at 2/3 l_j (Luo and Xiao's sidebar has l_j and 1/2 l_j, a quarter too little for a disc); of a line, l_j and
// 1/2 l_j as they have it.
#ifndef PALPATE_SRC_LAYERS_RIGID_FRICTION_H
#define PALPATE_SRC_LAYERS_RIGID_FRICTION_H

#include "rigid_formation.h"

namespace palpate {

struct rigid_grip {       // friction's state at one principal contact; trivially copyable
    double slip[3];       // m; s, in the contact plane
    double twist;         // rad; psi
    std::uint32_t sliding;
    std::uint32_t reserved;
};

struct rigid_friction_force {
    double force[3];      // N, on the held object at the contact's point
    double torque;        // N m, about the normal
    double energy;        // J; stored in slip and twist
};

// Takes the state through one tick: `moved` is the touching material's step along the contact plane (m), `turned` its turn about the
// normal (rad).  `kinetic_allowed`: 0 where the motion's type says that the contact rests (equation 4 instead of 5).
rigid_friction_force rigid_rub(const rigid_header& law, const rigid_principal& pc, double normal_force, const double moved[3],
                               double turned, double dt, bool kinetic_allowed, rigid_grip& grip) PALPATE_REAL_TIME;

}  // namespace palpate

#endif
