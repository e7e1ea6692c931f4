// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// The arithmetic of a tick: weighted sums over the 27 coefficients under a point.  contract.inl is compiled once for
// each instruction set; all of them give the same bits.
#ifndef PALPATE_SRC_CONTRACT_H
#define PALPATE_SRC_CONTRACT_H

#include <cstdint>

#include "depth_curves.h"
#include "lattice.h"
#include "rfield_layout.h"
#include "stencil.h"

namespace palpate {

struct amplitude_sums {
    double value[rfield_channel_limit + 4];  // four zeros after the last channel, so that any channel begins a quad
    double dx[rfield_channel_limit];  // per cell; of the gradient channels only
    double dy[rfield_channel_limit];
    double dz[rfield_channel_limit];
};

// The 3 x 3 x 3 counts under a point of the geometry lattice: with n = x->across[a] + y->across[b], m = x->column[a] + y->column[b], tap
// (a, b, c) is number place + c of the eight that begin with the four at block[n] + m and end with those at block[n + 1] + m.
struct geometry_taps {
    stencil at;
    const tap_steps *x, *y;
    const std::int16_t* block[8];
};

// The same in the amplitude lattice, prepared further because each tap is read for itself: channel 0 of tap (a, b, c) is
//     line[x->across[a] + y->across[b] + c][x->column[a] + y->column[b]].
struct amplitude_taps {
    stencil at;
    const tap_steps *x, *y;
    const float* line[16];  // by which of the four columns of blocks, and tap along z
};

constexpr double sums_per_count = 65536.0;

// sums over curves r of phi_r a_r and so on; gradients per cell
struct response_sums {
    double energy, steepness, stiffness;   // phi_r a_r, phi_r' a_r, phi_r'' a_r
    double gx, gy, gz;                     // phi_r da_r
    double friction_stiffness, friction_coefficient;  // kappa_r b_r, mu_r m_r
};

struct contraction {
    // Where the counts under q = (x, y, z) (m) are; false unless all 27 are stored.
    bool (*gather_geometry)(const lattice& L, const std::int16_t* coefficients, double x, double y, double z,
                            geometry_taps& taps) noexcept;
    // phi in 1/65536 counts and its derivatives per cell, sums = (value, dx, dy, dz).
    void (*geometry)(const geometry_taps& taps, double sums[4]) noexcept;
    // Where the coefficients under q are; absent ones are in row 0, which is all zero.  False where the whole stencil lies outside the
    // box.
    bool (*gather_amplitudes)(const lattice& L, const float* coefficients, double x, double y, double z,
                              amplitude_taps& taps) noexcept;
    // The first `channels` amplitudes, and derivatives of the first `gradient_channels`, both multiples of 4; from channel `way` on.
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
