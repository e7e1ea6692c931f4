// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Sums are separable; those over curves have a curve to each lane.  Geometry: lanes run along z (a column of a block is four int16); columns are summed along y, then
// x, and the lanes last.  Amplitudes: lanes are channels; sums run along z, then y, then x, and value and derivatives
// share them.
#include "contract.h"
#include "lanes.h"
#include "stencil.inl"

namespace palpate {
namespace PALPATE_ISA {

inline quad sum3(const quad w[3], const quad& c0, const quad& c1, const quad& c2) noexcept {
    return w[0] * c0 + w[1] * c1 + w[2] * c2;
}

static_assert(cut_scale == sums_per_count, "geometry sums");

struct axis_weights {
    quad w[3], d[3];
    axis_weights(const stencil& at, int axis) noexcept
        : w{all(at.w[0][axis]), all(at.w[1][axis]), all(at.w[2][axis])}, d{all(at.d[0][axis]), all(at.d[1][axis]), all(at.d[2][axis])} {}
};

bool gather_geometry(const lattice& L, const std::int16_t* coefficients, double x, double y, double z,
                     geometry_taps& taps) noexcept {
    const quad u = cell_coordinates(L, x, y, z);
    if (!all_within(u, load(L.last))) return false;
    stencil_at(u, taps.at);
    taps.x = &steps_at(L, taps.at, 0);
    taps.y = &steps_at(L, taps.at, 1);
    const corners row(L, taps.at);
    std::int64_t all_rows = 0;
    PALPATE_UNROLL_8
    for (int i = 0; i < 8; ++i) all_rows |= row[i];
    if (all_rows < 0) return false;
    PALPATE_UNROLL_8
    for (int i = 0; i < 8; ++i) taps.block[i] = coefficients + row[i] * 64;
    return true;
}

void geometry(const geometry_taps& taps, double sums[4]) noexcept {
    const stencil& at = taps.at;
    const cutter cut(at.cell[2] & 3);
    const axis_weights wx(at, 0), wy(at, 1);
    quad s[3], sy[3];
    PALPATE_UNROLL_3
    for (int a = 0; a < 3; ++a) {
        const std::int16_t* const* slab = taps.block + taps.x->across[a];
        const std::int64_t in_slab = taps.x->column[a];
        quad c[3];
        PALPATE_UNROLL_3
        for (int b = 0; b < 3; ++b) {
            const std::int16_t* const* along_z = slab + taps.y->across[b];
            const std::int64_t column = in_slab + taps.y->column[b];
            c[b] = cut(along_z[0] + column, along_z[1] + column);
        }
        s[a] = sum3(wy.w, c[0], c[1], c[2]);
        sy[a] = sum3(wy.d, c[0], c[1], c[2]);
    }
    const quad value = sum3(wx.w, s[0], s[1], s[2]);
    const quad dx = sum3(wx.d, s[0], s[1], s[2]);
    const quad dy = sum3(wx.w, sy[0], sy[1], sy[2]);
    const quad zw = three(at.w[0][2], at.w[1][2], at.w[2][2]), zd = three(at.d[0][2], at.d[1][2], at.d[2][2]);
    store(sums, sums_of_three(zw * value, zw * dx, zw * dy, zd * value));
}

// Row of the block (bx, by, bz); the zero block beyond the box.
inline std::int64_t row_of(const lattice& L, std::uint32_t bx, std::uint32_t by, std::uint32_t bz) noexcept {
    const auto count = [&L](int axis) { return static_cast<std::uint32_t>(L.blocks[axis]); };
    const bool inside = bx < count(0) && by < count(1) && bz < count(2);  // -1 is none of them
    return inside ? L.index[bx * L.row_step[0] + by * L.row_step[1] + bz] : 0;
}

bool gather_amplitudes(const lattice& L, const float* coefficients, double x, double y, double z, amplitude_taps& taps) noexcept {
    const quad u = cell_coordinates(L, x, y, z);
    stencil& at = taps.at;
    std::int64_t first[8];
    if (all_within(u, load(L.last))) {
        stencil_at(u, at);
        const corners row(L, at);
        PALPATE_UNROLL_8
        for (int i = 0; i < 8; ++i) first[i] = row[i] * L.block_size;
    } else {
        if (!all_within(u + all(2.0), load(L.last) + all(4.0))) return false;
        stencil_at(u + all(4.0), at);  // shifted by one block so that the cell index truncates towards minus infinity
        for (unsigned i = 0; i < 8; ++i) {
            first[i] = L.block_size * row_of(L, (at.cell[0] >> 2) - 1 + (i >> 2 & crosses(at, 0)), (at.cell[1] >> 2) - 1 + (i >> 1 & crosses(at, 1)),
                                           (at.cell[2] >> 2) - 1 + (i & crosses(at, 2)));
        }
    }
    taps.x = &steps_at(L, at, 0);
    taps.y = &steps_at(L, at, 1);
    const tap_steps& along_z = steps_at(L, at, 2);
    PALPATE_UNROLL_3
    for (int c = 0; c < 3; ++c) {
        const float* const place = coefficients + along_z.column[c];
        const std::int64_t* const block = first + along_z.across[c];
        taps.line[c] = place + block[0];
        taps.line[4 + c] = place + block[2];
        taps.line[8 + c] = place + block[4];
        taps.line[12 + c] = place + block[6];
    }
    return true;
}

// Four channels from `first` on.  Sums along z and y are kept for each slab of taps: running sums of four quads would not stay in
// registers.
template <bool with_gradient>
inline void four_amplitudes(const amplitude_taps& taps, const axis_weights& x, const axis_weights& y, const axis_weights& z,
                            std::int64_t first, double* value, double* dx, double* dy, double* dz) noexcept {
    quad s[3], sy[3], sz[3];
    PALPATE_NO_UNROLL
    for (int a = 0; a < 3; ++a) {
        const float* const* slab = taps.line + taps.x->across[a];
        const std::int64_t in_slab = taps.x->column[a] + first;
        quad v[3], vz[3];
        PALPATE_UNROLL_3
        for (int b = 0; b < 3; ++b) {
            const float* const* line = slab + taps.y->across[b];
            const std::int64_t column = in_slab + taps.y->column[b];
            const quad c0 = load(line[0] + column);
            const quad c1 = load(line[1] + column);
            const quad c2 = load(line[2] + column);
            v[b] = sum3(z.w, c0, c1, c2);
            if (with_gradient) vz[b] = sum3(z.d, c0, c1, c2);
        }
        s[a] = sum3(y.w, v[0], v[1], v[2]);
        if (with_gradient) {
            sy[a] = sum3(y.d, v[0], v[1], v[2]);
            sz[a] = sum3(y.w, vz[0], vz[1], vz[2]);
        }
    }
    store(value, sum3(x.w, s[0], s[1], s[2]));
    if (with_gradient) {
        store(dx, sum3(x.d, s[0], s[1], s[2]));
        store(dy, sum3(x.w, sy[0], sy[1], sy[2]));
        store(dz, sum3(x.w, sz[0], sz[1], sz[2]));
    }
}

void amplitudes(const amplitude_taps& taps, std::int64_t way, std::int32_t gradient_channels, std::int32_t channels,
                amplitude_sums& sums) noexcept {
    const axis_weights x(taps.at, 0), y(taps.at, 1), z(taps.at, 2);
    std::int64_t first = 0;
    for (; first < gradient_channels; first += 4) {
        four_amplitudes<true>(taps, x, y, z, way + first, sums.value + first, sums.dx + first, sums.dy + first, sums.dz + first);
    }
    for (; first < channels; first += 4) {
        four_amplitudes<false>(taps, x, y, z, way + first, sums.value + first, nullptr, nullptr, nullptr);
    }
    store(sums.value + first, all(0.0));
}

// The row of curves at some depth, and the depth from the row's start, m.
struct curve_row {
    const double* c;
    double x;
    std::int64_t padded;
    curve_row(const depth_curves& curves, double depth) noexcept : padded(curves.padded) {
        const double t = depth * curves.inverse_step;
        if (t < curves.interval_count) {
            const auto m = static_cast<std::int32_t>(t);
            c = curves.rows + m * (4 * padded);
            x = depth - static_cast<double>(m) * curves.step;
        } else {
            c = curves.rows + curves.last_row * (4 * padded);
            x = depth - curves.depth_end;
        }
    }
};

// Curves are summed in two halves, (c0 + c1 x) + x^2 (c2 + c3 x): shorter to wait for than Horner's rule.
inline quad value_of(const quad c[4], const quad& x, const quad& x2) noexcept { return (c[0] + c[1] * x) + x2 * (c[2] + c[3] * x); }

inline void load_curves(const curve_row& row, std::int64_t first, quad c[4]) noexcept {
    const double* at = row.c + first;
    c[0] = load(at);
    c[1] = load(at + row.padded);
    c[2] = load(at + 2 * row.padded);
    c[3] = load(at + 3 * row.padded);
}

inline quad weighted(const curve_row& row, const double* amplitude) noexcept {
    const quad x = all(row.x), x2 = all(row.x * row.x);
    quad sum = all(0.0);
    for (std::int64_t first = 0; first < row.padded; first += 4) {
        quad c[4];
        load_curves(row, first, c);
        sum = sum + value_of(c, x, x2) * load(amplitude + first);
    }
    return sum;
}

void curves(const depth_curves& energies, const depth_curves& stiffnesses, const depth_curves& frictions, double depth,
            const amplitude_sums& a, response_sums& sums) noexcept {
    const curve_row energy(energies, depth), stiffness(stiffnesses, depth), friction(frictions, depth);
    const double* const stiffness_amplitude = a.value + energies.curve_count;
    const double* const friction_amplitude = stiffness_amplitude + stiffnesses.curve_count;
    const quad x = all(energy.x), x2 = all(energy.x * energy.x), two = all(2.0), three_x2 = all(3.0 * (energy.x * energy.x)),
               six_x = all(6.0 * energy.x);
    quad value = all(0.0), steep = all(0.0), stiff = all(0.0), gx = all(0.0), gy = all(0.0), gz = all(0.0);
    for (std::int64_t first = 0; first < energy.padded; first += 4) {
        quad c[4];
        load_curves(energy, first, c);
        const quad amplitude = load(a.value + first), twice = two * c[2];
        const quad phi = value_of(c, x, x2);
        value = value + phi * amplitude;
        steep = steep + ((c[1] + twice * x) + three_x2 * c[3]) * amplitude;
        stiff = stiff + (twice + six_x * c[3]) * amplitude;
        gx = gx + phi * load(a.dx + first);
        gy = gy + phi * load(a.dy + first);
        gz = gz + phi * load(a.dz + first);
    }
    static_assert(sizeof(response_sums) == 8 * sizeof(double), "stored as two quads");
    double* out = &sums.energy;
    store(out, sums_of_four(value, steep, stiff, gx));
    store(out + 4, sums_of_four(gy, gz, weighted(stiffness, stiffness_amplitude), weighted(friction, friction_amplitude)));
}

}  // namespace PALPATE_ISA
}  // namespace palpate
