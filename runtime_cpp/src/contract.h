// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// The arithmetic of a tick: weighted sums over the 27 coefficients under a point.  contract.inl is compiled once for
// each instruction set; all of them give the same bits.
#ifndef PALPATE_SRC_CONTRACT_H
#define PALPATE_SRC_CONTRACT_H

#include <cstdint>

#include "cell.h"
#include "depth_curves.h"
#include "lattice.h"
#include "rfield_layout.h"

namespace palpate {

struct amplitude_sums {
    double value[rfield_channel_limit + 4];  // four zeros after the last channel, so that any channel begins a quad
    double dx[rfield_channel_limit];  // per cell; of the gradient channels only
    double dy[rfield_channel_limit];
    double dz[rfield_channel_limit];
};

// Where the 3 x 3 x 3 amplitudes under a point are: channel 0 of tap (a, b, c) is
//     line[x->across[a] + y->across[b] + c][x->column[a] + y->column[b]].
struct amplitude_taps {
    double t[4];  // of the point in its cell, by axis
    const tap_steps *x, *y;
    const float* line[16];  // by which of the four columns of blocks, and tap along z
};

// What `distance` gives its sums in: phi in 1/8 of 1/65536 counts, its derivatives per cell in 1/4.
constexpr double value_sums_per_count = 8.0 * 65536.0, slope_sums_per_count = 4.0 * 65536.0;

// sums over curves r of phi_r a_r and so on; gradients per cell
struct response_sums {
    double energy, steepness, stiffness;   // phi_r a_r, phi_r' a_r, phi_r'' a_r
    double gx, gy, gz;                     // phi_r da_r
    double friction_stiffness, friction_coefficient;  // kappa_r b_r, mu_r m_r
};

struct contraction {
    // phi and its derivatives at q = (x, y, z) (m), sums = (value, dx, dy, dz); false unless all 27 counts under q are stored.
    bool (*distance)(const lattice& L, const std::int16_t* coefficients, double x, double y, double z, distance_cell& kept,
                     double sums[4]) noexcept;
    // Makes `kept` the cell of q.
    void (*go_to)(const lattice& L, const float* coefficients, double x, double y, double z, std::int32_t channels, amplitude_cell& kept) noexcept;
    // gather_amplitudes and amplitudes of way 0 in one, for a `kept` that was made q's.
    bool (*amplitudes_in_cell)(const lattice& L, const float* coefficients, double x, double y, double z, std::int32_t gradient_channels,
                               std::int32_t channels, const amplitude_cell& kept, amplitude_sums& sums) noexcept;
    // Where the coefficients under q are; absent ones are in row 0, which is all zero.  False where the whole stencil lies outside the
    // box.
    bool (*gather_amplitudes)(const lattice& L, const float* coefficients, double x, double y, double z,
                              amplitude_taps& taps) noexcept;
    // The first `channels` amplitudes (up to rfield_channel_limit), and derivatives of the first `gradient_channels`, both multiples of 4; from channel `way` on.
    void (*amplitudes)(const amplitude_taps& taps, std::int64_t way, std::int32_t gradient_channels, std::int32_t channels,
                       amplitude_sums& sums) noexcept;
    // Curves at `depth` >= 0 (m) times amplitudes; those of kappa and mu have theirs after the energy's, one kind after the other.
    void (*curves)(const depth_curves& energy, const depth_curves& stiffness, const depth_curves& friction, double depth,
                   const amplitude_sums& a, response_sums& sums) noexcept;
};

extern const contraction contraction_baseline;
#if defined(PALPATE_HAS_AVX2)
extern const contraction contraction_avx2;
#endif

// The fastest that this processor runs.
const contraction& contraction_here() noexcept;

}  // namespace palpate

#endif
