// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#ifndef PALPATE_SRC_RESPOND_H
#define PALPATE_SRC_RESPOND_H

#include "contract.h"
#include "field.h"

namespace palpate {

struct response {
    double energy;                // U, J
    double gradient[3];           // grad U, N
    double steepness;             // dU/dd at fixed amplitudes, N
    double stiffness;             // d2U/dd2 at fixed amplitudes, N/m
    double friction_stiffness;    // k >= 0, N/m
    double friction_coefficient;  // mu >= 0
};

// Makes `kept`, which belongs to this field, the cell of q.
void go_to(const palpate_field& field, const double q[3], amplitude_cell& kept) noexcept;

// The response at q with depth >= 0 (m) and grad phi as `locate` found them, in the first way of touching; `amplitudes` are
// those at q, `kept` is the cell of q.
void respond(const palpate_field& field, const double q[3], double depth, const double distance_gradient[3], const amplitude_cell& kept,
             response& found, amplitude_sums& amplitudes) noexcept;

// Where the 27 coefficients under q are; false where the whole stencil lies outside the lattice: all amplitudes are zero.
bool gather(const palpate_field& field, const double q[3], amplitude_taps& taps) noexcept;

// The same at another depth, from the amplitudes that were found.
void respond_again(const palpate_field& field, const amplitude_sums& amplitudes, double depth,
                    const double distance_gradient[3], response& found) noexcept;

}  // namespace palpate

#endif
