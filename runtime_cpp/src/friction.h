// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#ifndef PALPATE_SRC_FRICTION_H
#define PALPATE_SRC_FRICTION_H

namespace palpate {

// The tangential spring between the tool and the tissue.  Trivially copyable.
struct friction_spring {
    double stretch[3];  // s, m; orthogonal to normal
    double normal[3];   // unit; 0 while nothing is touched
    double stiffness;   // k, N/m, >= 0
};

// 1/2 k |s|^2, J
double spring_energy(const friction_spring& spring) noexcept;

// A spring that was just set down: no stretch, this normal, no stiffness.
void touch_down(friction_spring& spring, const double normal[3]) noexcept;

// The hand moved the tool by `step` (m): s += the part of step orthogonal to the normal; k and normal stay.
void carry(friction_spring& spring, const double step[3]) noexcept;

// The normal becomes `normal` (unit, less than a right angle away): s turns with it.  Energy stays.
void turn(friction_spring& spring, const double normal[3]) noexcept;

// The stiffness becomes `stiffness` >= 0: where it rises k s stays, where it falls s stays.  Energy does not rise.
void stiffen(friction_spring& spring, double stiffness) noexcept;

// Slips until |k s| <= limit (N, >= 0); true when it had to.  Energy does not rise.
bool yield(friction_spring& spring, double limit) noexcept;

}  // namespace palpate

#endif
