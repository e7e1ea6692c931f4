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
namespace {

// Row of `curves` at depth d >= 0.
inline curve_row row_at(const depth_curves& curves, double d) noexcept {
    const double t = d * curves.inverse_step;
    if (t < curves.interval_count) {
        const auto m = static_cast<std::int32_t>(t);
        return {curves.rows + static_cast<std::int64_t>(m) * curves.padded * 4, d - static_cast<double>(m) * curves.step, curves.padded};
    }
    return {curves.rows + static_cast<std::int64_t>(curves.last_row) * curves.padded * 4, d - curves.depth_end, curves.padded};
}

// Row of the block (bx, by, bz); the zero block beyond the box.
std::int64_t row_of(const lattice& L, std::int64_t bx, std::int64_t by, std::int64_t bz) noexcept {
    const bool inside = bx >= 0 && by >= 0 && bz >= 0 && bx < L.blocks[0] && by < L.blocks[1] && bz < L.blocks[2];
    return inside ? L.index[(bx * L.blocks[1] + by) * L.blocks[2] + bz] : 0;
}

struct rows {
    curve_row energy, stiffness, friction;
};

inline rows rows_at(const palpate_field& field, double d) noexcept {
    return {row_at(field.energy, d), row_at(field.stiffness, d), row_at(field.friction, d)};
}

inline void combine(const palpate_field& field, const rows& at, const amplitude_sums& a, const double distance_gradient[3],
                    response& found) noexcept {
    const std::int32_t energies = field.energy.curve_count;
    response_sums sums;
    field.contract->curves(at.energy, at.stiffness, at.friction, a, energies, energies + field.stiffness.curve_count, sums);
    const double per_metre = field.amplitudes.inverse_spacing;
    found.energy = sums.energy;
    found.gradient[0] = sums.gx * per_metre - sums.steepness * distance_gradient[0];
    found.gradient[1] = sums.gy * per_metre - sums.steepness * distance_gradient[1];
    found.gradient[2] = sums.gz * per_metre - sums.steepness * distance_gradient[2];
    found.steepness = sums.steepness;
    found.stiffness = sums.stiffness;
    found.friction_stiffness = sums.friction_stiffness > 0.0 ? sums.friction_stiffness : 0.0;
    found.friction_coefficient = sums.friction_coefficient > 0.0 ? sums.friction_coefficient : 0.0;
}

inline bool find_taps(const palpate_field& field, const double q[3], amplitude_taps& taps) noexcept {
    const lattice& L = field.amplitudes;
    const double u[3] = {(q[0] - L.origin[0]) * L.inverse_spacing, (q[1] - L.origin[1]) * L.inverse_spacing,
                         (q[2] - L.origin[2]) * L.inverse_spacing};
    taps.stride = field.channel_stride;
    const std::int64_t block_size = 64 * taps.stride;
    if (!(u[0] >= 0.0 && u[1] >= 0.0 && u[2] >= 0.0 && u[0] < L.last[0] && u[1] < L.last[1] && u[2] < L.last[2])) {
        for (int a = 0; a < 3; ++a) {
            if (!(u[a] >= -2.0 && u[a] < L.last[a] + 2.0)) return false;
        }
        // Shifted by one block so that the cell index truncates towards minus infinity.
        taps_at(u[0] + 4.0, taps.x);
        taps_at(u[1] + 4.0, taps.y);
        taps_at(u[2] + 4.0, taps.z);
        for (int i = 0; i < 8; ++i) {
            const std::int64_t row = row_of(L, taps.x.block - 1 + (i >> 2 & next_block(taps.x, 2)),
                                            taps.y.block - 1 + (i >> 1 & next_block(taps.y, 2)),
                                            taps.z.block - 1 + (i & next_block(taps.z, 2)));
            taps.block[i] = field.amplitude_coefficients + row * block_size;
        }
        return true;
    }
    taps_at(u[0], taps.x);
    taps_at(u[1], taps.y);
    taps_at(u[2], taps.z);
    const std::int64_t cross_x = next_block(taps.x, 2) * static_cast<std::int64_t>(L.blocks[1]) * L.blocks[2];
    const std::int64_t cross_y = next_block(taps.y, 2) * static_cast<std::int64_t>(L.blocks[2]);
    const std::int64_t cross_z = next_block(taps.z, 2);
    const std::int32_t* line =
        L.index + (taps.x.block * L.blocks[1] + taps.y.block) * L.blocks[2] + taps.z.block;
    const std::int64_t step[8] = {0,       cross_z,           cross_y,           cross_y + cross_z,
                                  cross_x, cross_x + cross_z, cross_x + cross_y, cross_x + cross_y + cross_z};
    for (int i = 0; i < 8; ++i) taps.block[i] = field.amplitude_coefficients + line[step[i]] * block_size;
    return true;
}

}  // namespace

bool gather(const palpate_field& field, const double q[3], amplitude_taps& taps) noexcept { return find_taps(field, q, taps); }

void respond(const palpate_field& field, const double q[3], double depth, const double distance_gradient[3],
             response& found, amplitude_sums& amplitudes) noexcept {
    amplitude_taps taps;
    if (!find_taps(field, q, taps)) {
        found = response{};
        amplitudes = amplitude_sums{};
        return;
    }
    const rows at = rows_at(field, depth);
    field.contract->amplitudes(taps, field.gradient_channels, field.channels, amplitudes);
    combine(field, at, amplitudes, distance_gradient, found);
}

void respond_again(const palpate_field& field, const amplitude_sums& amplitudes, double depth,
                    const double distance_gradient[3], response& found) noexcept {
    combine(field, rows_at(field, depth), amplitudes, distance_gradient, found);
}

}  // namespace palpate
