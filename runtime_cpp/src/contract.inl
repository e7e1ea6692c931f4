// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Sums are separable; those over curves have a curve to each lane.  Geometry: lanes run along z (a column of a block is four int16); columns are summed along y, then
// x, and the lanes last.  Amplitudes: lanes are channels; sums run along z, then y, then x, and value and derivatives
// share them.
#include "contract.h"
#include "lanes.h"

namespace palpate {
namespace PALPATE_ISA {

inline quad sum3(const quad w[3], const quad& c0, const quad& c1, const quad& c2) noexcept {
    return w[0] * c0 + w[1] * c1 + w[2] * c2;
}

static_assert(cut_scale == sums_per_count, "geometry sums");

struct axis_weights {
    quad w[3], d[3];
    explicit axis_weights(const axis_taps& a) noexcept
        : w{all(a.w[0]), all(a.w[1]), all(a.w[2])}, d{all(a.d[0]), all(a.d[1]), all(a.d[2])} {}
};

void geometry(const std::int16_t* const block[8], const axis_taps& x, const axis_taps& y, const axis_taps& z,
              double sums[4]) noexcept {
    const cutter cut(z.place);
    const axis_weights wx(x), wy(y);
    quad s[3], sy[3];
    PALPATE_UNROLL_3
    for (std::int64_t a = 0; a < 3; ++a) {
        const std::int16_t* const* slab = block + 4 * next_block(x, a);
        const std::int64_t in_slab = place_of(x, a) * 16;
        quad c[3];
        PALPATE_UNROLL_3
        for (std::int64_t b = 0; b < 3; ++b) {
            const std::int16_t* const* along_z = slab + 2 * next_block(y, b);
            const std::int64_t column = in_slab + place_of(y, b) * 4;
            c[b] = cut(along_z[0] + column, along_z[1] + column);
        }
        s[a] = sum3(wy.w, c[0], c[1], c[2]);
        sy[a] = sum3(wy.d, c[0], c[1], c[2]);
    }
    const quad value = sum3(wx.w, s[0], s[1], s[2]);
    const quad dx = sum3(wx.d, s[0], s[1], s[2]);
    const quad dy = sum3(wx.w, sy[0], sy[1], sy[2]);
    const quad zw = three(z.w), zd = three(z.d);
    store(sums, sums_of_three(zw * value, zw * dx, zw * dy, zd * value));
}

// Where the 27 taps are, in as few steps as possible: finding them costs as much as summing them.  Tap (a, b, c) is
// at line[across_x[a] + across_y[b] + c] + (column_x[a] + column_y[b]), in floats.
struct tap_table {
    const float* line[16];  // by which of the four block columns, and tap along z
    std::int64_t column_x[3], column_y[3];
    std::int64_t across_x[3], across_y[3];
    explicit tap_table(const amplitude_taps& t) noexcept {
        PALPATE_UNROLL_3
        for (std::int64_t c = 0; c < 3; ++c) {
            const float* const* along_z = t.block + next_block(t.z, c);
            const std::int64_t place = place_of(t.z, c) * t.stride;
            line[c] = along_z[0] + place;
            line[4 + c] = along_z[2] + place;
            line[8 + c] = along_z[4] + place;
            line[12 + c] = along_z[6] + place;
            column_x[c] = place_of(t.x, c) * 16 * t.stride;
            column_y[c] = place_of(t.y, c) * 4 * t.stride;
            across_x[c] = 8 * next_block(t.x, c);
            across_y[c] = 4 * next_block(t.y, c);
        }
    }
};

// Four channels from `first` on.
template <bool with_gradient>
inline void four_amplitudes(const tap_table& taps, const axis_taps& x, const axis_weights& y, const axis_weights& z,
                            std::int64_t first, amplitude_sums& sums) noexcept {
    quad value = all(0.0), dx = all(0.0), dy = all(0.0), dz = all(0.0);
    PALPATE_NO_UNROLL
    for (int a = 0; a < 3; ++a) {
        const float* const* slab = taps.line + taps.across_x[a];
        const std::int64_t in_slab = taps.column_x[a] + first;
        quad s = all(0.0), sy = all(0.0), sz = all(0.0);
        PALPATE_UNROLL_3
        for (int b = 0; b < 3; ++b) {
            const float* const* line = slab + taps.across_y[b];
            const std::int64_t column = in_slab + taps.column_y[b];
            const quad c0 = load(line[0] + column);
            const quad c1 = load(line[1] + column);
            const quad c2 = load(line[2] + column);
            const quad v = sum3(z.w, c0, c1, c2);
            s = s + y.w[b] * v;
            if (with_gradient) {
                sy = sy + y.d[b] * v;
                sz = sz + y.w[b] * sum3(z.d, c0, c1, c2);
            }
        }
        const quad w = all(x.w[a]);
        value = value + w * s;
        if (with_gradient) {
            dx = dx + all(x.d[a]) * s;
            dy = dy + w * sy;
            dz = dz + w * sz;
        }
    }
    store(sums.value + first, value);
    if (with_gradient) {
        store(sums.dx + first, dx);
        store(sums.dy + first, dy);
        store(sums.dz + first, dz);
    }
}

void amplitudes(const amplitude_taps& taps, std::int32_t gradient_channels, std::int32_t channels,
                amplitude_sums& sums) noexcept {
    const axis_weights y(taps.y), z(taps.z);
    const tap_table table(taps);
    std::int64_t first = 0;
    for (; first < gradient_channels; first += 4) four_amplitudes<true>(table, taps.x, y, z, first, sums);
    for (; first < channels; first += 4) four_amplitudes<false>(table, taps.x, y, z, first, sums);
    store(sums.value + first, all(0.0));
}

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

void curves(const curve_row& energy, const curve_row& stiffness, const curve_row& friction, const amplitude_sums& a,
            std::int32_t stiffness_from, std::int32_t friction_from, response_sums& sums) noexcept {
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
    store(out + 4, sums_of_four(gy, gz, weighted(stiffness, a.value + stiffness_from), weighted(friction, a.value + friction_from)));
}

}  // namespace PALPATE_ISA
}  // namespace palpate
