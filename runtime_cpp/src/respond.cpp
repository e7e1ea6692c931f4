// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// The potential and its gradient.  With d = rho - phi(q), grad d = -grad phi,
//     U      = sum_r phi_r(d) a_r(q)
//     grad U = sum_r phi_r(d) grad a_r(q) - (sum_r phi_r'(d) a_r(q)) grad phi(q)
//     k      = max(0, sum_r kappa_r(d) b_r(q)),   mu = max(0, sum_r mu_r(d) m_r(q))
// Curves are cubics on uniform intervals of depth; amplitudes a, b, m are channels of one lattice, read two at a
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
    const std::int64_t cross_x = next_block(c.x, 2) * static_cast<std::int64_t>(L.blocks[1]) * L.blocks[2];
    const std::int64_t cross_y = next_block(c.y, 2) * static_cast<std::int64_t>(L.blocks[2]);
    const std::int64_t cross_z = next_block(c.z, 2);
    const std::int32_t* line =
        L.index + (static_cast<std::int64_t>(c.x.block) * L.blocks[1] + c.y.block) * L.blocks[2] + c.z.block;
    const std::int32_t row[8] = {line[0],
                                 line[cross_z],
                                 line[cross_y],
                                 line[cross_y + cross_z],
                                 line[cross_x],
                                 line[cross_x + cross_z],
                                 line[cross_x + cross_y],
                                 line[cross_x + cross_y + cross_z]};
    const std::int64_t stride = field.channel_stride;
    const float* block[8];
    for (int i = 0; i < 8; ++i) block[i] = field.amplitude_coefficients + row[i] * (64 * stride);
    const std::int64_t next_1 = next_block(c.z, 1);
    const std::int64_t next_2 = next_block(c.z, 2);
    const std::int64_t place_0 = c.z.place * stride;
    const std::int64_t place_1 = place_of(c.z, 1) * stride;
    const std::int64_t place_2 = place_of(c.z, 2) * stride;
    const float** tap = c.tap;
    PALPATE_UNROLL_3
    for (std::int32_t a = 0; a < 3; ++a) {
        PALPATE_UNROLL_3
        for (std::int32_t b = 0; b < 3; ++b, tap += 3) {
            const float* const* pair_along_z = block + 4 * next_block(c.x, a) + 2 * next_block(c.y, b);
            const std::int64_t column = (place_of(c.x, a) * 16 + place_of(c.y, b) * 4) * stride;
            tap[0] = pair_along_z[0] + column + place_0;
            tap[1] = pair_along_z[next_1] + column + place_1;
            tap[2] = pair_along_z[next_2] + column + place_2;
        }
    }
    return true;
}

// The weights twice each, as operands for two channels.
struct weights {
    pair xw[3], xd[3], yw[3], yd[3], zw[3], zd[3];
};

void widen(const corners& c, weights& w) noexcept {
    for (int k = 0; k < 3; ++k) {
        w.xw[k] = both(c.x.w[k]);
        w.xd[k] = both(c.x.d[k]);
        w.yw[k] = both(c.y.w[k]);
        w.yd[k] = both(c.y.d[k]);
        w.zw[k] = both(c.z.w[k]);
        w.zd[k] = both(c.z.d[k]);
    }
}

// w[0] c[0] + w[1] c[1] + w[2] c[2]
inline pair sum3(const pair w[3], const pair& c0, const pair& c1, const pair& c2) noexcept {
    return w[0] * c0 + w[1] * c1 + w[2] * c2;
}

// Two channels: values and derivatives per cell.
void evaluate(const corners& c, const weights& w, std::int64_t first, pair& value, pair& dx, pair& dy, pair& dz) noexcept {
    const float* const* tap = c.tap;
    pair s[3], sy[3], sz[3];
    PALPATE_UNROLL_3
    for (int a = 0; a < 3; ++a) {
        pair v[3], dv[3];
        PALPATE_UNROLL_3
        for (int b = 0; b < 3; ++b, tap += 3) {
            const pair c0 = load_pair(tap[0] + first);
            const pair c1 = load_pair(tap[1] + first);
            const pair c2 = load_pair(tap[2] + first);
            v[b] = sum3(w.zw, c0, c1, c2);
            dv[b] = sum3(w.zd, c0, c1, c2);
        }
        s[a] = sum3(w.yw, v[0], v[1], v[2]);
        sy[a] = sum3(w.yd, v[0], v[1], v[2]);
        sz[a] = sum3(w.yw, dv[0], dv[1], dv[2]);
    }
    value = sum3(w.xw, s[0], s[1], s[2]);
    dx = sum3(w.xd, s[0], s[1], s[2]);
    dy = sum3(w.xw, sy[0], sy[1], sy[2]);
    dz = sum3(w.xw, sz[0], sz[1], sz[2]);
}

void evaluate(const corners& c, const weights& w, std::int64_t first, pair& value) noexcept {
    const float* const* tap = c.tap;
    pair s[3];
    PALPATE_UNROLL_3
    for (int a = 0; a < 3; ++a) {
        pair v[3];
        PALPATE_UNROLL_3
        for (int b = 0; b < 3; ++b, tap += 3) {
            v[b] = sum3(w.zw, load_pair(tap[0] + first), load_pair(tap[1] + first), load_pair(tap[2] + first));
        }
        s[a] = sum3(w.yw, v[0], v[1], v[2]);
    }
    value = sum3(w.xw, s[0], s[1], s[2]);
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
    weights w;
    widen(c, w);

    double value[rfield_channel_limit];
    double dx[rfield_channel_limit], dy[rfield_channel_limit], dz[rfield_channel_limit];
    for (std::int32_t first = 0; first < field.gradient_channels; first += 2) {
        pair v, x, y, z;
        evaluate(c, w, first, v, x, y, z);
        for (int i = 0; i < 2; ++i) {
            value[first + i] = v[i];
            dx[first + i] = x[i];
            dy[first + i] = y[i];
            dz[first + i] = z[i];
        }
    }
    for (std::int32_t first = field.gradient_channels; first < field.channels; first += 2) {
        pair v;
        evaluate(c, w, first, v);
        value[first] = v[0];
        value[first + 1] = v[1];
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
