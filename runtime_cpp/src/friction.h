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
// creep    for the adhesion functions of their figure 2 (eq. 4): s' = s (1 - zeta(|s|) |P dq|), where zeta >= 0 says how much
//          of a motion is slip; a share in [0, 1] of s is left, E' <= E.
// Each of the four is a contraction of s or of k, so E falls or stays whatever the field's k, mu and curvature are.
// Everything is inline: a tick waits for these few operations, not for their calls.
#ifndef PALPATE_SRC_FRICTION_H
#define PALPATE_SRC_FRICTION_H

#include <cmath>
#include <cstdint>

#include "vec.h"

namespace palpate {

// The tangential spring between the tool and the tissue.  Trivially copyable.
struct friction_spring {
    double stretch[3];  // s, m; orthogonal to normal
    double normal[3];   // unit; 0 while nothing is touched
    double stiffness;   // k, N/m, >= 0
};

// Number by number: a copy of the struct would read as pairs what was written one by one, and wait for it.
inline void copy(const friction_spring& from, friction_spring& to) noexcept {
    for (int a = 0; a < 3; ++a) to.stretch[a] = from.stretch[a];
    for (int a = 0; a < 3; ++a) to.normal[a] = from.normal[a];
    to.stiffness = from.stiffness;
}

// 1/2 k |s|^2, J
inline double spring_energy(const friction_spring& spring) noexcept {
    return 0.5 * spring.stiffness * dot(spring.stretch, spring.stretch);
}

// A spring that was just set down: no stretch, this normal, no stiffness.
inline void touch_down(friction_spring& spring, const double normal[3]) noexcept {
    for (int a = 0; a < 3; ++a) spring.stretch[a] = 0.0;
    for (int a = 0; a < 3; ++a) spring.normal[a] = normal[a];
    spring.stiffness = 0.0;
}

// The hand moved the tool by `step` (m): s += the part of step orthogonal to the normal; k and normal stay.
inline void carry(friction_spring& spring, const double step[3]) noexcept {
    double s[3];
    for (int a = 0; a < 3; ++a) s[a] = spring.stretch[a] + step[a];
    const double out = dot(s, spring.normal);  // of step alone, up to rounding that must not pile up
    for (int a = 0; a < 3; ++a) spring.stretch[a] = s[a] - out * spring.normal[a];
}

// The normal becomes `normal` (unit, less than a right angle away): s turns with it.  Energy stays.
inline void turn(friction_spring& spring, const double normal[3]) noexcept {
    const double c = 1.0 + dot(spring.normal, normal);
    const double share = dot(spring.stretch, normal) / c;
    for (int a = 0; a < 3; ++a) {
        spring.stretch[a] -= share * (spring.normal[a] + normal[a]);
        spring.normal[a] = normal[a];
    }
}

// The stiffness becomes `stiffness` >= 0 (stiffen), then slips until |k s| <= limit (N, >= 0; yield); true when it had to.  Energy does not
// rise.  Both at once, because s k / k' limit / |k s| = s limit / (k' |s|): neither waits for the other's division.  `length_squared` is
// |s|^2, or was before the normal turned.
inline bool settle(friction_spring& spring, double length_squared, double stiffness, double limit) noexcept {
    const double before = spring.stiffness, least = stiffness < before ? stiffness : before;
    const bool slips = least * least * length_squared > limit * limit;
    double share = 1.0;
    if (slips) {
        share = limit / (stiffness * std::sqrt(length_squared));
    } else if (stiffness > before) {
        share = before / stiffness;
    } else if (!(stiffness > 0.0)) {
        share = 0.0;  // no spring: nothing to stretch
    }
    for (int a = 0; a < 3; ++a) spring.stretch[a] *= share;
    spring.stiffness = stiffness;
    return slips;
}

// zeta(z) in units of 1/limit, for the stretch z as a fraction of the stretch at which everything slips (z <= 1): how much
// of a motion is slip.  1: none, up to the limit.  2: none up to `start`, then a smooth rise (Dupont and others' sine,
// here its cubic), for control.  3: none up to `start`, then in proportion.  4: Dahl, eq. 1: everywhere; there is no
// sticking, and a contact that is shaken drifts: the example not to follow.
inline double adhesion(std::uint32_t model, double start, double z) noexcept {
    if (model == 4) return 1.0;
    if (model == 1 || !(z > start)) return 0.0;
    const double t = (z - start) / (1.0 - start);
    return model == 2 ? t * t * (3.0 - 2.0 * t) : t;
}

// Slips by the adhesion function's share of the motion `step` (m), of which the part along the surface counts; `limit` as in
// settle, which must have been called.  Energy does not rise.
inline void creep(friction_spring& spring, std::uint32_t model, double start, double limit, const double step[3]) noexcept {
    const double force = spring.stiffness * std::sqrt(dot(spring.stretch, spring.stretch));
    if (!(force > 0.0) || !(limit > 0.0)) return;
    const double out = dot(step, spring.normal);
    const double along = std::sqrt(std::fmax(0.0, dot(step, step) - out * out));
    const double zeta = adhesion(model, start, force < limit ? force / limit : 1.0) * spring.stiffness / limit;  // 1/m
    const double share = 1.0 - zeta * along;
    for (int a = 0; a < 3; ++a) spring.stretch[a] *= share > 0.0 ? share : 0.0;
}

}  // namespace palpate

#endif
