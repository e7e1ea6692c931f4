// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// The potential and its gradient.  With d = rho - phi(q), grad d = -grad phi,
//     U      = sum_r phi_r(d) a_r(q)
//     grad U = sum_r phi_r(d) grad a_r(q) - (sum_r phi_r'(d) a_r(q)) grad phi(q)
//     k      = max(0, sum_r kappa_r(d) b_r(q)),   mu = max(0, sum_r mu_r(d) m_r(q))
// Curves are cubics on uniform intervals of depth; amplitudes a, b, m are channels of one lattice
// (contract.inl).  Absent blocks have row 0 of the coefficients, which is all zero.
#include "respond.h"

#include "contract.h"

namespace palpate {
bool gather(const palpate_field& field, const double q[3], amplitude_taps& taps) noexcept {
    return field.contract->gather_amplitudes(field.amplitudes, field.amplitude_coefficients, q[0], q[1], q[2], taps);
}

void go_to(const palpate_field& field, const double q[3], amplitude_cell& kept) noexcept {
    field.contract->go_to(field.amplitudes, field.amplitude_coefficients, q[0], q[1], q[2], field.channels, kept);
}

void respond(const palpate_field& field, const double q[3], double depth, const double distance_gradient[3], const amplitude_cell& kept,
             response& found, amplitude_sums& amplitudes) noexcept {
    if (!field.contract->amplitudes_in_cell(field.amplitudes, field.amplitude_coefficients, q[0], q[1], q[2], field.gradient_channels,
                                            field.channels, kept, amplitudes)) {
        found = response{};
        amplitudes = amplitude_sums{};
        return;
    }
    field.contract->response_from(field, amplitudes, depth, distance_gradient, found);
}

void respond_again(const palpate_field& field, const amplitude_sums& amplitudes, double depth,
                    const double distance_gradient[3], response& found) noexcept {
    field.contract->response_from(field, amplitudes, depth, distance_gradient, found);
}

}  // namespace palpate
