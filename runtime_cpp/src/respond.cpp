// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// The potential and its gradient.  With d = rho - phi(q), grad d = -grad phi,
//     U      = sum_r phi_r(d) a_r(q)
//     grad U = sum_r phi_r(d) grad a_r(q) - (sum_r phi_r'(d) a_r(q)) grad phi(q)
//     k      = max(0, sum_r kappa_r(d) b_r(q)),   mu = max(0, sum_r mu_r(d) m_r(q))
// Curves are cubics on uniform intervals of depth; amplitudes a, b, m are channels of one lattice, read four at a
// time.  Absent blocks have row 0 of the coefficients, which is all zero.
#include "respond.h"

#include "lanes.h"
#include "stencil.h"

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

struct corners {
    axis_taps x, y, z;
    const float* tap[27];  // first channel of each coefficient
};

const float* tap_in_box(const palpate_field& field, std::int32_t i, std::int32_t j, std::int32_t k) noexcept {
    const lattice& L = field.amplitudes;
    const bool inside = i >= 0 && j >= 0 && k >= 0 && i < 4 * L.blocks[0] && j < 4 * L.blocks[1] && k < 4 * L.blocks[2];
    const std::int64_t row =
        inside ? L.index[(static_cast<std::int64_t>(i >> 2) * L.blocks[1] + (j >> 2)) * L.blocks[2] + (k >> 2)] : 0;
    return field.amplitude_coefficients + (row * 64 + (i & 3) * 16 + (j & 3) * 4 + (k & 3)) * field.channel_stride;
}

// False where the whole stencil lies outside the lattice: all amplitudes are zero.
bool gather(const palpate_field& field, const double q[3], corners& c) noexcept {
    const lattice& L = field.amplitudes;
    const double u[3] = {(q[0] - L.origin[0]) * L.inverse_spacing, (q[1] - L.origin[1]) * L.inverse_spacing,
                         (q[2] - L.origin[2]) * L.inverse_spacing};
    if (!(u[0] >= 0.0 && u[1] >= 0.0 && u[2] >= 0.0 && u[0] < L.last[0] && u[1] < L.last[1] && u[2] < L.last[2])) {
        for (int a = 0; a < 3; ++a) {
            if (!(u[a] >= -2.0 && u[a] < L.last[a] + 2.0)) return false;
        }
        // Shifted by one block so that the cell index truncates towards minus infinity.
        taps_at(u[0] + 4.0, c.x);
        taps_at(u[1] + 4.0, c.y);
        taps_at(u[2] + 4.0, c.z);
        const std::int32_t i = 4 * c.x.block + c.x.place - 4;
        const std::int32_t j = 4 * c.y.block + c.y.place - 4;
        const std::int32_t k = 4 * c.z.block + c.z.place - 4;
        for (std::int32_t n = 0; n < 27; ++n) c.tap[n] = tap_in_box(field, i + n / 9, j + n / 3 % 3, k + n % 3);
        return true;
    }
    taps_at(u[0], c.x);
    taps_at(u[1], c.y);
    taps_at(u[2], c.z);
    const std::int32_t cross = next_block(c.z, 2);
    const std::int32_t z_next[3] = {0, next_block(c.z, 1), cross};
    const std::int64_t stride = field.channel_stride;
    const std::int64_t z_place[3] = {c.z.place * stride, place_of(c.z, 1) * stride, place_of(c.z, 2) * stride};
    const float* block[2][2][2];
    for (int a = 0; a < 2; ++a) {
        for (int b = 0; b < 2; ++b) {
            const std::int32_t* line = L.index +
                                       (static_cast<std::int64_t>(c.x.block + a * next_block(c.x, 2)) * L.blocks[1] +
                                        c.y.block + b * next_block(c.y, 2)) *
                                           L.blocks[2] +
                                       c.z.block;
            block[a][b][0] = field.amplitude_coefficients + static_cast<std::int64_t>(line[0]) * 64 * stride;
            block[a][b][1] = field.amplitude_coefficients + static_cast<std::int64_t>(line[cross]) * 64 * stride;
        }
    }
    const float** tap = c.tap;
    for (std::int32_t a = 0; a < 3; ++a) {
        for (std::int32_t b = 0; b < 3; ++b) {
            const float* const* pair = block[next_block(c.x, a)][next_block(c.y, b)];
            const std::int64_t column = (place_of(c.x, a) * 16 + place_of(c.y, b) * 4) * stride;
            *tap++ = pair[0] + column + z_place[0];
            *tap++ = pair[z_next[1]] + column + z_place[1];
            *tap++ = pair[z_next[2]] + column + z_place[2];
        }
    }
    return true;
}

// Four channels: values and derivatives per cell.
inline void evaluate(const corners& c, std::int64_t first, lanes& value, lanes& dx, lanes& dy, lanes& dz) noexcept {
    value = dx = dy = dz = lanes{};
    const float* const* tap = c.tap;
    for (int a = 0; a < 3; ++a) {
        lanes s{}, sy{}, sz{};
        for (int b = 0; b < 3; ++b, tap += 3) {
            lanes c0, c1, c2;
            load(c0, tap[0] + first);
            load(c1, tap[1] + first);
            load(c2, tap[2] + first);
            const lanes v = c.z.w[0] * c0 + c.z.w[1] * c1 + c.z.w[2] * c2;
            const lanes dv = c.z.d[0] * c0 + c.z.d[1] * c1 + c.z.d[2] * c2;
            s += c.y.w[b] * v;
            sy += c.y.d[b] * v;
            sz += c.y.w[b] * dv;
        }
        value += c.x.w[a] * s;
        dx += c.x.d[a] * s;
        dy += c.x.w[a] * sy;
        dz += c.x.w[a] * sz;
    }
}

inline void evaluate(const corners& c, std::int64_t first, lanes& value) noexcept {
    value = lanes{};
    const float* const* tap = c.tap;
    for (int a = 0; a < 3; ++a) {
        lanes s{};
        for (int b = 0; b < 3; ++b, tap += 3) {
            lanes c0, c1, c2;
            load(c0, tap[0] + first);
            load(c1, tap[1] + first);
            load(c2, tap[2] + first);
            s += c.y.w[b] * (c.z.w[0] * c0 + c.z.w[1] * c1 + c.z.w[2] * c2);
        }
        value += c.x.w[a] * s;
    }
}

// sum_r g_r(d) channel_r, not below zero
double weighted(const depth_curves& curves, double d, const double* channel) noexcept {
    double x = 0.0;
    const double* row = row_at(curves, d, x);
    double sum = 0.0;
    for (std::int32_t r = 0; r < curves.curve_count; ++r, row += 4) {
        sum += (row[0] + x * (row[1] + x * (row[2] + x * row[3]))) * channel[r];
    }
    return sum > 0.0 ? sum : 0.0;
}

}  // namespace

void respond(const palpate_field& field, const double q[3], double depth, const double distance_gradient[3],
             response& found) noexcept {
    found = response{};
    corners c;
    if (!gather(field, q, c)) return;

    double value[rfield_channel_limit];
    double dx[rfield_channel_limit], dy[rfield_channel_limit], dz[rfield_channel_limit];
    for (std::int32_t lane = 0; lane < field.energy_lane_count; ++lane) {
        lanes v, x, y, z;
        evaluate(c, 4 * lane, v, x, y, z);
        std::memcpy(value + 4 * lane, &v, sizeof v);
        std::memcpy(dx + 4 * lane, &x, sizeof x);
        std::memcpy(dy + 4 * lane, &y, sizeof y);
        std::memcpy(dz + 4 * lane, &z, sizeof z);
    }
    for (std::int32_t lane = field.energy_lane_count; lane < field.lane_count; ++lane) {
        lanes v;
        evaluate(c, 4 * lane, v);
        std::memcpy(value + 4 * lane, &v, sizeof v);
    }

    double x = 0.0;
    const double* row = row_at(field.energy, depth, x);
    double slope = 0.0;  // sum phi_r' a_r
    double gx = 0.0, gy = 0.0, gz = 0.0;
    for (std::int32_t r = 0; r < field.energy.curve_count; ++r, row += 4) {
        const double phi = row[0] + x * (row[1] + x * (row[2] + x * row[3]));
        found.energy += phi * value[r];
        slope += (row[1] + x * (2.0 * row[2] + x * (3.0 * row[3]))) * value[r];
        found.stiffness += (2.0 * row[2] + x * (6.0 * row[3])) * value[r];
        gx += phi * dx[r];
        gy += phi * dy[r];
        gz += phi * dz[r];
    }
    const double per_metre = field.amplitudes.inverse_spacing;
    found.gradient[0] = gx * per_metre - slope * distance_gradient[0];
    found.gradient[1] = gy * per_metre - slope * distance_gradient[1];
    found.gradient[2] = gz * per_metre - slope * distance_gradient[2];
    const double* channel = value + field.energy.curve_count;
    found.friction_stiffness = weighted(field.stiffness, depth, channel);
    found.friction_coefficient = weighted(field.friction, depth, channel + field.stiffness.curve_count);
}

}  // namespace palpate
