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

// Row of `curves` at depth d > 0, and d measured from the row's start.
const double* row_at(const depth_curves& curves, double d, double& x) noexcept {
    const double t = d * curves.inverse_step;
    if (t < curves.interval_count) {
        const auto m = static_cast<std::int32_t>(t);
        x = d - static_cast<double>(m) * curves.step;
        return curves.rows + static_cast<std::int64_t>(m) * curves.curve_count * 4;
    }
    x = d - curves.depth_end;
    return curves.rows + static_cast<std::int64_t>(curves.last_row) * curves.curve_count * 4;
}

// Row of the block (bx, by, bz); the zero block beyond the box.
std::int64_t row_of(const lattice& L, std::int64_t bx, std::int64_t by, std::int64_t bz) noexcept {
    const bool inside = bx >= 0 && by >= 0 && bz >= 0 && bx < L.blocks[0] && by < L.blocks[1] && bz < L.blocks[2];
    return inside ? L.index[(bx * L.blocks[1] + by) * L.blocks[2] + bz] : 0;
}

// The curves at one depth.  Summed in two halves, (c0 + c1 x) + x^2 (c2 + c3 x): shorter to wait for than Horner's rule.
struct curve_values {
    double phi[rfield_channel_limit], slope[rfield_channel_limit], bend[rfield_channel_limit];  // phi_r, phi_r', phi_r''
    double friction[rfield_channel_limit];  // kappa_r, then mu_r
};

void values_at(const depth_curves& curves, double d, double* value) noexcept {
    double x = 0.0;
    const double* row = row_at(curves, d, x);
    const double x2 = x * x;
    for (std::int32_t r = 0; r < curves.curve_count; ++r, row += 4) value[r] = (row[0] + row[1] * x) + x2 * (row[2] + row[3] * x);
}

inline void curves_at(const palpate_field& field, double d, curve_values& c) noexcept {
    double x = 0.0;
    const double* row = row_at(field.energy, d, x);
    const double x2 = x * x;
    for (std::int32_t r = 0; r < field.energy.curve_count; ++r, row += 4) {
        c.phi[r] = (row[0] + row[1] * x) + x2 * (row[2] + row[3] * x);
        c.slope[r] = (row[1] + (2.0 * row[2]) * x) + x2 * (3.0 * row[3]);
        c.bend[r] = 2.0 * row[2] + (6.0 * row[3]) * x;
    }
    values_at(field.stiffness, d, c.friction);
    values_at(field.friction, d, c.friction + field.stiffness.curve_count);
}

// sum_r g_r c_r, not below zero
double weighted(std::int32_t count, const double* curve, const double* channel) noexcept {
    double sum = 0.0;
    for (std::int32_t r = 0; r < count; ++r) sum += curve[r] * channel[r];
    return sum > 0.0 ? sum : 0.0;
}

inline void combine(const palpate_field& field, const curve_values& c, const amplitude_sums& a,
                    const double distance_gradient[3], response& found) noexcept {
    const std::int32_t energies = field.energy.curve_count;
    const std::int32_t stiffnesses = field.stiffness.curve_count;
    double energy = 0.0, steepness = 0.0, stiffness = 0.0;  // sums of phi_r a_r, phi_r' a_r, phi_r'' a_r
    double gx = 0.0, gy = 0.0, gz = 0.0;
    for (std::int32_t r = 0; r < energies; ++r) {
        energy += c.phi[r] * a.value[r];
        steepness += c.slope[r] * a.value[r];
        stiffness += c.bend[r] * a.value[r];
        gx += c.phi[r] * a.dx[r];
        gy += c.phi[r] * a.dy[r];
        gz += c.phi[r] * a.dz[r];
    }
    const double per_metre = field.amplitudes.inverse_spacing;
    found.energy = energy;
    found.gradient[0] = gx * per_metre - steepness * distance_gradient[0];
    found.gradient[1] = gy * per_metre - steepness * distance_gradient[1];
    found.gradient[2] = gz * per_metre - steepness * distance_gradient[2];
    found.steepness = steepness;
    found.stiffness = stiffness;
    found.friction_stiffness = weighted(stiffnesses, c.friction, a.value + energies);
    found.friction_coefficient = weighted(field.friction.curve_count, c.friction + stiffnesses, a.value + energies + stiffnesses);
}

}  // namespace

bool gather(const palpate_field& field, const double q[3], amplitude_taps& taps) noexcept {
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

void respond(const palpate_field& field, const double q[3], double depth, const double distance_gradient[3],
             response& found, amplitude_sums& amplitudes) noexcept {
    amplitude_taps taps;
    if (!gather(field, q, taps)) {
        found = response{};
        amplitudes = amplitude_sums{};
        return;
    }
    curve_values curves;  // first: they wait for the depth, while the sums over amplitudes keep the processor busy
    curves_at(field, depth, curves);
    field.contract->amplitudes(taps, field.gradient_channels, field.channels, amplitudes);
    combine(field, curves, amplitudes, distance_gradient, found);
}

void respond_again(const palpate_field& field, const amplitude_sums& amplitudes, double depth,
                    const double distance_gradient[3], response& found) noexcept {
    curve_values curves;
    curves_at(field, depth, curves);
    combine(field, curves, amplitudes, distance_gradient, found);
}

}  // namespace palpate
