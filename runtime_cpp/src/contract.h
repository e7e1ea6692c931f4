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
#include "palpate/palpate.h"
#include "rfield_layout.h"

struct palpate_field;

namespace palpate {

struct response;
struct texture_ground;
struct texture_state;

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

struct contraction {
    // Depth (m) and grad phi at q = (x, y, z) (m), any numbers; false unless all 27 counts under q are stored.
    bool (*distance)(const palpate_field& field, double x, double y, double z, distance_cell& kept,
                     double depth_and_gradient[4]) PALPATE_REAL_TIME;
    // Makes `kept` the cell of q.
    void (*go_to)(const palpate_field& field, double x, double y, double z, amplitude_cell& kept) PALPATE_REAL_TIME;
    // The response at q, depth (m, >= 0) and grad phi, in way 0, and the amplitudes there, for a `kept` that was made q's.
    void (*respond)(const palpate_field& field, double x, double y, double z, double depth, const double distance_gradient[3],
                    const amplitude_cell& kept, response& found, amplitude_sums& amplitudes) PALPATE_REAL_TIME;
    // Where the coefficients under q are; absent ones are in row 0, which is all zero.  False where the whole stencil lies outside the
    // box.
    bool (*gather_amplitudes)(const lattice& L, const float* coefficients, double x, double y, double z,
                              amplitude_taps& taps) PALPATE_REAL_TIME;
    // The first `channels` amplitudes (up to rfield_channel_limit), and derivatives of the first `gradient_channels`, both multiples of 4;
    // from channel `way` on.
    void (*amplitudes)(const amplitude_taps& taps, std::int64_t way, std::int32_t gradient_channels, std::int32_t channels,
                       amplitude_sums& sums) PALPATE_REAL_TIME;
    // The same from amplitudes.
    void (*response_from)(const palpate_field& field, const amplitude_sums& amplitudes, double depth, const double distance_gradient[3],
                          response& found) PALPATE_REAL_TIME;
    // Of waves with these amplitudes (m): height (m) and its gradient at (x, y, z); layers/texture.h.
    void (*texture)(const texture_ground& ground, const double* amplitude, double x, double y, double z, mask_cell& kept,
                    double height_and_gradient[4]) PALPATE_REAL_TIME;
    // The same of a session's waves at q as the tool moved there by `step` (m), after the gains of the group whose turn it is went towards
    // what the limits leave of them: by no more than the wavelengths that were walked since its last turn, 0 where a step of `reach`
    // wavelengths is reached, and only where that lowers the height.  True where that changed something at q: the height by *height_change.
    bool (*texture_in_turn)(const texture_ground& ground, texture_state& t, const double q[3], const double step[3], double reach,
                            mask_cell& kept, double height_and_gradient[4], double* height_change) PALPATE_REAL_TIME;
    // The energy (J) of a response, from amplitudes at another depth; the same bits.
    double (*energy_from)(const palpate_field& field, const amplitude_sums& amplitudes, double depth) PALPATE_REAL_TIME;
    // Has the caches get what lies under q in both lattices, in the box and where that is another cell than `last` time; nobody waits.
    void (*fetch_cells)(const palpate_field& field, double x, double y, double z, fetched_cells& last) PALPATE_REAL_TIME;
};

extern const contraction contraction_baseline;
#if defined(PALPATE_HAS_AVX2)
extern const contraction contraction_avx2;
#endif

// The fastest that this processor runs.
const contraction& contraction_here() noexcept;

}  // namespace palpate

#endif
