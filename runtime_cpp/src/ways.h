// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Ways of touching.  A tool that is not a ball presses differently when it is tilted.  With c the cosine of the angle between
// its axis and the outward normal, and c_0 > c_1 > ... those that were pressed, between neighbours
//     a_r(q; c) = (1 - t) a_r,w(q) + t a_r,w+1(q),   rho(c) likewise,   t = (c_w - c) / (c_w - c_w+1),
// on the same curves and the same geometry: U(q; c) = sum_r phi_r(rho(c) - phi(q)) a_r(q; c).  c is a parameter of the potential, not
// a coordinate: it changes at a place, by the energy rule (rule.h).
#ifndef PALPATE_SRC_WAYS_H
#define PALPATE_SRC_WAYS_H

#include "contract.h"
#include "field.h"

namespace palpate {

// The amplitudes at one place, each way's summed when it is first asked for.
struct amplitudes_here {
    amplitude_taps taps;
    bool stored;  // false: all are zero
    bool known[rfield_way_limit];
    amplitude_sums way[rfield_way_limit];
};

// `cosine` within the field's ways.
double clamped_cosine(const palpate_field& field, double cosine) PALPATE_REAL_TIME;
// rho(c), m.
double offset_of_way(const palpate_field& field, double cosine) PALPATE_REAL_TIME;

void amplitudes_at(const palpate_field& field, const double q[3], amplitudes_here& here) PALPATE_REAL_TIME;
void blend(const palpate_field& field, amplitudes_here& here, double cosine, amplitude_sums& sums) PALPATE_REAL_TIME;

}  // namespace palpate

#endif
