// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Friction as a tangential spring that holds while contact sticks and yields when it slips, after V. Hayward and
// B. Armstrong, A new computational model of friction applied to haptic rendering (2000), eq. 3; with a stiffness
// that depends on place and depth, and written so that its energy E = 1/2 k |s|^2 rises by the hand's work alone.
//
// carry    s' = s + P dq, P = I - n n^T.  With f = -k s:  E' - E = k s . dq + 1/2 k |P dq|^2, the hand's work plus the
//          zero-order hold's share.
// turn     s is transported by the smallest rotation that takes n to n':
//              s' = s - (s . n') / (1 + n . n') (n + n'),
//          for which s' . n' = 0 and |s'|^2 = |s|^2 - 2 (s.n')^2 / (1 + c) + 2 (s.n')^2 / (1 + c) = |s|^2, c = n . n'.
//          So E stays.  Projecting s onto the new plane instead would also never raise E, but a tool held still in
//          the tangent plane while the organ curves under it would lose its grip a little with every tick.
// stiffen  k' > k: s' = s k / k', E' = 1/2 k^2 / k' |s|^2 < E (contact that grows carries no shear yet).
//          k' < k: s' = s, E' = 1/2 k' |s|^2 < E.
// yield    s' = s limit / |k s|, E' <= E.
// Each of the three is a contraction of s or of k, so E falls or stays whatever the field's k, mu and curvature are.
#include "friction.h"

#include <cmath>

namespace palpate {
namespace {

double dot(const double a[3], const double b[3]) noexcept { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

}  // namespace

double spring_energy(const friction_spring& spring) noexcept {
    return 0.5 * spring.stiffness * dot(spring.stretch, spring.stretch);
}

void touch_down(friction_spring& spring, const double normal[3]) noexcept {
    spring = friction_spring{};
    for (int a = 0; a < 3; ++a) spring.normal[a] = normal[a];
}

void carry(friction_spring& spring, const double step[3]) noexcept {
    double s[3];
    for (int a = 0; a < 3; ++a) s[a] = spring.stretch[a] + step[a];
    const double out = dot(s, spring.normal);  // of step alone, up to rounding that must not pile up
    for (int a = 0; a < 3; ++a) spring.stretch[a] = s[a] - out * spring.normal[a];
}

void turn(friction_spring& spring, const double normal[3]) noexcept {
    const double c = 1.0 + dot(spring.normal, normal);
    const double share = dot(spring.stretch, normal) / c;
    for (int a = 0; a < 3; ++a) {
        spring.stretch[a] -= share * (spring.normal[a] + normal[a]);
        spring.normal[a] = normal[a];
    }
}

void stiffen(friction_spring& spring, double stiffness) noexcept {
    if (stiffness > spring.stiffness) {
        const double share = spring.stiffness / stiffness;
        for (int a = 0; a < 3; ++a) spring.stretch[a] *= share;
    } else if (!(stiffness > 0.0)) {
        for (int a = 0; a < 3; ++a) spring.stretch[a] = 0.0;  // no spring: nothing to stretch
    }
    spring.stiffness = stiffness;
}

bool yield(friction_spring& spring, double limit) noexcept {
    const double force_squared = spring.stiffness * spring.stiffness * dot(spring.stretch, spring.stretch);
    if (!(force_squared > limit * limit)) return false;
    const double share = limit / std::sqrt(force_squared);
    for (int a = 0; a < 3; ++a) spring.stretch[a] *= share;
    return true;
}

}  // namespace palpate
