// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// The arithmetic of a tick: weighted sums over the 27 coefficients under a point.  contract.inl is compiled once for
// each instruction set; all of them give the same bits.
#ifndef PALPATE_SRC_CONTRACT_H
#define PALPATE_SRC_CONTRACT_H

#include <cstdint>

#include "rfield_layout.h"
#include "stencil.h"

namespace palpate {

struct amplitude_sums {
    double value[rfield_channel_limit + 4];  // four zeros after the last channel, so that any channel begins a quad
    double dx[rfield_channel_limit];  // per cell; of the gradient channels only
    double dy[rfield_channel_limit];
    double dz[rfield_channel_limit];
};

// The 3 x 3 x 3 coefficients under a point of the amplitude lattice: tap (a, b, c) begins at
//     block[4 next_block(x, a) + 2 next_block(y, b) + next_block(z, c)] + stride (16 place_of(x, a) + 4 place_of(y, b)
//     + place_of(z, c)).
struct amplitude_taps {
    axis_taps x, y, z;
    const float* block[8];
    std::int64_t stride;  // floats from one coefficient to the next
};

constexpr double sums_per_count = 65536.0;

// One row of depth curves in the order that sums read: c0 of every curve, then c1, c2, c3, each padded with zeros to a multiple of 4.
struct curve_row {
    const double* c;
    double x;            // m; depth from the row's start
    std::int64_t padded;  // curves, padding included; a multiple of 4; may be 0
};

// sums over curves r of phi_r a_r and so on; gradients per cell
struct response_sums {
    double energy, steepness, stiffness;   // phi_r a_r, phi_r' a_r, phi_r'' a_r
    double gx, gy, gz;                     // phi_r da_r
    double friction_stiffness, friction_coefficient;  // kappa_r b_r, mu_r m_r
};

struct contraction {
    // phi in 1/65536 counts and its derivatives per cell, sums = (value, dx, dy, dz).  block[8]: the blocks under the stencil as
    // in amplitude_taps, 64 counts each.
    void (*geometry)(const std::int16_t* const block[8], const axis_taps& x, const axis_taps& y, const axis_taps& z,
                     double sums[4]) noexcept;
    // The first `channels` amplitudes, and derivatives of the first `gradient_channels`; both multiples of 4.
    void (*amplitudes)(const amplitude_taps& taps, std::int32_t gradient_channels, std::int32_t channels,
                       amplitude_sums& sums) noexcept;
    // Curves times amplitudes; those of kappa and mu begin at channels `stiffness_from` and `friction_from`.
    void (*curves)(const curve_row& energy, const curve_row& stiffness, const curve_row& friction, const amplitude_sums& a,
                   std::int32_t stiffness_from, std::int32_t friction_from, response_sums& sums) noexcept;
};

extern const contraction contraction_baseline;
#if defined(PALPATE_HAS_AVX2)
extern const contraction contraction_avx2;
#endif

// The fastest that this processor runs.
const contraction& contraction_here() noexcept;

}  // namespace palpate

#endif
