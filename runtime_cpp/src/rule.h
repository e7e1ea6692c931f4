// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// The energy rule: what changes at one place - the way of touching, the field, axial's contact point - may not raise stored
// energy.  The surface yields by the smallest offset o >= 0 for which U(d - o) after the change is not above U before it.
// So a tool that is tilted to and fro between a soft and a stiff way of touching comes back to the soft way's energy each
// time and loses nothing more; a plain refusal of what raises U would stay at the softest way that was met.
#ifndef PALPATE_SRC_RULE_H
#define PALPATE_SRC_RULE_H

#include "contract.h"
#include "field.h"
#include "respond.h"
#include "vec.h"

namespace palpate {

// The tissue under the tool at one place, before friction: everything that does not change when the offset does.
struct tissue {
    const palpate_field* field;
    const double* distance_gradient;  // grad phi
    double depth;                     // m, of the surface that has not yielded; >= 0
    double normal[3];
    amplitude_sums amplitudes;
    const texture_here* texture;      // null where the field has none
};

// A response at the felt depth, told along the real one.
inline void along_depth(const felt_depth& felt, response& found) noexcept {
    found.stiffness = found.stiffness * (felt.slope * felt.slope) + found.steepness * felt.bend;
    found.steepness *= felt.slope;
}

// At the surface that has yielded by `offset` <= depth.
inline void respond_at(const tissue& under, double offset, response& found) noexcept {
    const double depth = under.depth - offset;
    if (PALPATE_EXPECTED(under.texture == nullptr)) {
        respond_again(*under.field, under.amplitudes, depth, under.distance_gradient, found);
        return;
    }
    const felt_depth felt(*under.texture, depth, under.distance_gradient);
    respond_again(*under.field, under.amplitudes, felt.depth, felt.gradient, found);
    along_depth(felt, found);
}

// The smallest offset for which `under` holds at most `energy` >= 0 (J), to 1e-12 of it; `found` is the response there.  `guess`: a
// likely one.
double offset_for(const tissue& under, double energy, double guess, response& found) PALPATE_REAL_TIME;

}  // namespace palpate

#endif
