// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#ifndef PALPATE_SRC_LOCATE_H
#define PALPATE_SRC_LOCATE_H

#include "field.h"
#include "palpate/palpate.h"

namespace palpate {

struct location {
    palpate_region region;
    double depth;        // m; rho - phi(q); only where region is FREE or CONTACT
    double gradient[3];  // grad phi, likewise
};

static_assert(sizeof(location) == 5 * sizeof(double), "depth and gradient in a row");

// In a cell whose coefficients are not all stored.
void locate_unknown(const palpate_field& field, double x, double y, double z, location& found) PALPATE_REAL_TIME;

// Where q = (x, y, z) (m, |q| bounded by 1e6) is; `kept` belongs to this field and gets the cell of q.
inline void locate(const palpate_field& field, double x, double y, double z, distance_cell& kept, location& found) PALPATE_REAL_TIME {
    if (field.contract->distance(field, x, y, z, kept, &found.depth)) {
        found.region = found.depth > 0.0 ? PALPATE_REGION_CONTACT : PALPATE_REGION_FREE;
    } else {
        locate_unknown(field, x, y, z, found);
    }
}
void locate(const palpate_field& field, const double q[3], location& found) PALPATE_REAL_TIME;

// What a straight stroke between two points meets, both ends excluded, looked at once each geometry spacing:
// the lattice cannot hold tissue thinner than that.
struct stroke {
    bool touched;    // contact somewhere
    bool left;       // free somewhere after contact, or after a start in contact
    bool turned;     // in one contact the normal turned over: the middle of a thin lobe was crossed
    bool deep;       // deeper than the band somewhere
    bool unreached;  // unreached somewhere
    bool too_long;   // more than stroke_sample_limit looks needed; not looked at
    double normal[3];  // of the contact that the stroke is in at its end, or starts with (any length); 0 if none
};

constexpr double stroke_sample_limit = 256.0;

// `start_normal`: of the contact that the stroke starts in; null where it starts free.
void look_along(const palpate_field& field, const double from[3], const double to[3], const double* start_normal,
                stroke& seen) PALPATE_REAL_TIME;

}  // namespace palpate

#endif
