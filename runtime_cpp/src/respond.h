// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// The potential and its gradient.  With d = rho - phi(q), grad d = -grad phi,
//     U      = sum_r phi_r(d) a_r(q)
//     grad U = sum_r phi_r(d) grad a_r(q) - (sum_r phi_r'(d) a_r(q)) grad phi(q)
//     k      = max(0, sum_r kappa_r(d) b_r(q)),   mu = max(0, sum_r mu_r(d) m_r(q))
// Curves are cubics on uniform intervals of depth; amplitudes a, b, m are channels of one lattice (contract.inl).  Absent blocks have row 0
// of the coefficients, which is all zero.
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

// Makes `kept`, which belongs to this field, the cell of q = (x, y, z) (m).
inline void go_to(const palpate_field& field, double x, double y, double z, amplitude_cell& kept) noexcept {
    field.contract->go_to(field, x, y, z, kept);
}

// The response at q with depth >= 0 (m) and grad phi as `locate` found them, in the first way of touching; `amplitudes` are
// those at q, `kept` is the cell of q.
inline void respond(const palpate_field& field, const double q[3], double depth, const double distance_gradient[3],
                    const amplitude_cell& kept, response& found, amplitude_sums& amplitudes) noexcept {
    field.contract->respond(field, q[0], q[1], q[2], depth, distance_gradient, kept, found, amplitudes);
}

// The same at another depth, from the amplitudes that were found.
inline void respond_again(const palpate_field& field, const amplitude_sums& amplitudes, double depth, const double distance_gradient[3],
                          response& found) noexcept {
    field.contract->response_from(field, amplitudes, depth, distance_gradient, found);
}

// Its energy alone.
inline double energy_again(const palpate_field& field, const amplitude_sums& amplitudes, double depth) noexcept {
    return field.contract->energy_from(field, amplitudes, depth);
}

// Where the 27 coefficients under q are; false where the whole stencil lies outside the lattice: all amplitudes are zero.
inline bool gather(const palpate_field& field, const double q[3], amplitude_taps& taps) noexcept {
    return field.contract->gather_amplitudes(field.amplitudes, field.amplitude_coefficients, q[0], q[1], q[2], taps);
}

}  // namespace palpate

#endif
