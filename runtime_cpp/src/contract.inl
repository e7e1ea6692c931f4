// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Sums are separable (cell.h); those over curves have a curve to each lane.  Distance: lanes run along z (a column of a block is four
// int16).  Amplitudes: lanes are channels; sums run along z, then y, then x, and value and derivatives share them.
#include "contract.h"
#include "field.h"
#include "lanes.h"
#include "respond.h"
#include "vec.h"
#include "stencil.inl"

namespace palpate {
namespace PALPATE_ISA {

// A, B, C along x of rows that are A, B, C along y: the rows of a cell of one channel.
PALPATE_INLINE void store_rows(const quad (&c)[3][3], double rows[9][4]) noexcept {
    PALPATE_UNROLL_3
    for (int j = 0; j < 3; ++j) {
        const forms f(c[0][j], c[1][j], c[2][j]);
        store(rows[j], f.A);
        store(rows[3 + j], f.B);
        store(rows[6 + j], f.C);
    }
}

// ...into a cell: the distance's counts, times cut_scale.  False, and no cell, unless all 27 are stored.
bool enter(const lattice& L, const std::int16_t* coefficients, distance_cell& kept) noexcept {
    const corners row(L, kept.cell);
    std::int64_t rows[8], all_rows = 0;
    PALPATE_UNROLL_8
    for (int i = 0; i < 8; ++i) all_rows |= rows[i] = row[i];
    if (all_rows < 0) return false;
    kept.entered = true;
    const std::int16_t* block[8];
    PALPATE_UNROLL_8
    for (int i = 0; i < 8; ++i) block[i] = coefficients + rows[i] * 64;
    const tap_steps &x = steps_at(L, kept.cell, 0), &y = steps_at(L, kept.cell, 1);
    const cutter cut(kept.cell[2] & 3);
    quad c[3][3];  // A, B, C along y, by tap along x
    PALPATE_UNROLL_3
    for (int a = 0; a < 3; ++a) {
        quad tap[3];
        PALPATE_UNROLL_3
        for (int b = 0; b < 3; ++b) {
            const std::int16_t* const* along_z = block + x.across[a] + y.across[b];
            const std::int64_t column = x.column[a] + y.column[b];
            tap[b] = cut(along_z[0] + column, along_z[1] + column);
        }
        const forms f(tap[0], tap[1], tap[2]);
        c[a][0] = f.A;
        c[a][1] = f.B;
        c[a][2] = f.C;
    }
    store_rows(c, kept.along_z);
    return true;
}

// (8 value, 4 dx, 4 dy, 4 dz) at t in a cell of one channel, whose lanes run along z (distance_cell::along_z); derivatives per cell.
PALPATE_INLINE quad one_channel_in(const double rows[9][4], const quad& t) noexcept {
    const quad x = lane<0>(t), y = lane<1>(t);
    quad s[3], sy[3];
    PALPATE_UNROLL_3
    for (int i = 0; i < 3; ++i) {
        const double(*c)[4] = rows + 3 * i;
        const value_slope along_y(load(c[0]), load(c[1]), load(c[2]), y);
        s[i] = along_y.value;
        sy[i] = along_y.slope;
    }
    const value_slope along_x(s[0], s[1], s[2], x);
    // (value, dx, dy, 0) of each tap along z; values are 4 times, derivatives twice what they should be.
    quad tap[3];
    taps_of(along_x.value, along_x.slope, twice_value(sy[0], sy[1], sy[2], x), tap);
    const forms f(tap[0], tap[1], tap[2]);
    const value_slope along_z(f.A, f.B, f.C, lane<2>(t));
    return with_fourth(along_z.value, along_z.slope);
}

// At t in the kept cell.
PALPATE_INLINE void distance_in(const palpate_field& field, const distance_cell& kept, const quad& t, double depth_and_gradient[4]) noexcept {
    store(depth_and_gradient, load(field.distance_scale) * one_channel_in(kept.along_z, t) + load(field.distance_shift));
}

// Apart, or every tick pays for the registers that this one needs.
PALPATE_APART bool distance_in_another_cell(const palpate_field& field, double px, double py, double pz, distance_cell& kept,
                                            double depth_and_gradient[4]) noexcept {
    const lattice& L = field.geometry;
    const quad u = cell_coordinates(L, px, py, pz);
    if (!all_within(u, load(L.last))) return false;
    const quad corner = truncated(u, kept.cell);
    store(kept.corner, corner);
    if (!enter(L, field.geometry_coefficients, kept)) {
        forget(kept);
        return false;
    }
    distance_in(field, kept, u - corner, depth_and_gradient);
    return true;
}

bool distance(const palpate_field& field, double px, double py, double pz, distance_cell& kept,
              double depth_and_gradient[4]) PALPATE_REAL_TIME {
    // Exact in the cell, so nobody waits to learn which cell it is.
    const quad t = cell_coordinates(field.geometry, px, py, pz) - load(kept.corner);
    if (!all_within(t, all(1.0))) return distance_in_another_cell(field, px, py, pz, kept, depth_and_gradient);
    distance_in(field, kept, t, depth_and_gradient);
    return true;
}

// Row of the block (bx, by, bz); the zero block beyond the box.
inline std::int64_t row_of(const lattice& L, std::uint32_t bx, std::uint32_t by, std::uint32_t bz) noexcept {
    const auto count = [&L](int axis) { return static_cast<std::uint32_t>(L.blocks[axis]); };
    const bool inside = bx < count(0) && by < count(1) && bz < count(2);  // -1 is none of them
    return inside ? L.index[bx * L.row_step[0] + by * L.row_step[1] + bz] : 0;
}

// Where the coefficients under the cell are, whose blocks begin at `first`.
inline void lines_at(const lattice& L, const float* coefficients, const std::uint32_t cell[4], const std::int64_t first[8],
                     amplitude_taps& taps) noexcept {
    taps.x = &steps_at(L, cell, 0);
    taps.y = &steps_at(L, cell, 1);
    const tap_steps& along_z = steps_at(L, cell, 2);
    PALPATE_UNROLL_3
    for (int c = 0; c < 3; ++c) {
        const float* const place = coefficients + along_z.column[c];
        const std::int64_t* const block = first + along_z.across[c];
        taps.line[c] = place + block[0];
        taps.line[4 + c] = place + block[2];
        taps.line[8 + c] = place + block[4];
        taps.line[12 + c] = place + block[6];
    }
}

inline void lines_inside(const lattice& L, const float* coefficients, const std::uint32_t cell[4], amplitude_taps& taps) noexcept {
    std::int64_t first[8];
    const corners row(L, cell);
    PALPATE_UNROLL_8
    for (int i = 0; i < 8; ++i) first[i] = row[i] * L.block_size;
    lines_at(L, coefficients, cell, first, taps);
}

bool gather_amplitudes(const lattice& L, const float* coefficients, double x, double y, double z, amplitude_taps& taps) PALPATE_REAL_TIME {
    const quad u = cell_coordinates(L, x, y, z);
    std::uint32_t cell[4];
    if (all_within(u, load(L.last))) {
        store(taps.t, u - truncated(u, cell));
        lines_inside(L, coefficients, cell, taps);
        return true;
    }
    if (!all_within(u + all(2.0), load(L.last) + all(4.0))) return false;
    const quad shifted = u + all(4.0);  // by one block, so that the cell index truncates towards minus infinity
    store(taps.t, shifted - truncated(shifted, cell));
    std::int64_t first[8];
    for (unsigned i = 0; i < 8; ++i) {
        first[i] = L.block_size * row_of(L, (cell[0] >> 2) - 1 + (i >> 2 & crosses(cell, 0)),
                                         (cell[1] >> 2) - 1 + (i >> 1 & crosses(cell, 1)), (cell[2] >> 2) - 1 + (i & crosses(cell, 2)));
    }
    lines_at(L, coefficients, cell, first, taps);
    return true;
}

// A, B, C of four channels from `first` on.
inline void enter(const amplitude_taps& taps, std::int64_t first, double kept[27][4]) noexcept {
    PALPATE_NO_UNROLL
    for (int a = 0; a < 3; ++a) {
        const float* const* slab = taps.line + taps.x->across[a];
        const std::int64_t in_slab = taps.x->column[a] + first;
        double(*to)[4] = kept + 9 * a;
        quad c[3][3];  // A, B, C along z, by tap along y
        PALPATE_UNROLL_3
        for (int b = 0; b < 3; ++b) {
            const float* const* line = slab + taps.y->across[b];
            const std::int64_t column = in_slab + taps.y->column[b];
            const forms f(load(line[0] + column), load(line[1] + column), load(line[2] + column));
            c[b][0] = f.A;
            c[b][1] = f.B;
            c[b][2] = f.C;
        }
        PALPATE_UNROLL_3
        for (int k = 0; k < 3; ++k) {
            const forms f(c[0][k], c[1][k], c[2][k]);
            store(to[k], f.A);
            store(to[3 + k], f.B);
            store(to[6 + k], f.C);
        }
    }
}

// Where in its cell a point is.
struct place {
    quad x, y, z;
    explicit place(const quad& t) noexcept : x(lane<0>(t)), y(lane<1>(t)), z(lane<2>(t)) {}
};

PALPATE_INLINE void values_at(const double kept[27][4], const place& t, double* value) noexcept {
    quad s[3];
    PALPATE_UNROLL_3
    for (int i = 0; i < 3; ++i) {
        quad v[3];
        PALPATE_UNROLL_3
        for (int j = 0; j < 3; ++j) {
            const double(*c)[4] = kept + 9 * i + 3 * j;
            v[j] = twice_value(load(c[0]), load(c[1]), load(c[2]), t.z);
        }
        s[i] = twice_value(v[0], v[1], v[2], t.y);
    }
    const forms f(s[0], s[1], s[2]);
    store(value, all(0.125) * twice_value(f.A, f.B, f.C, t.x));
}

PALPATE_INLINE void gradients_at(const double kept[27][4], const place& t, double* value, double* dx, double* dy, double* dz) noexcept {
    quad s[3], sy[3], sz[3];
    PALPATE_UNROLL_3
    for (int i = 0; i < 3; ++i) {
        quad v[3], vz[3];
        PALPATE_UNROLL_3
        for (int j = 0; j < 3; ++j) {
            const double(*c)[4] = kept + 9 * i + 3 * j;
            const value_slope along_z(load(c[0]), load(c[1]), load(c[2]), t.z);
            v[j] = along_z.value;
            vz[j] = along_z.slope;
        }
        const value_slope along_y(v[0], v[1], v[2], t.y);
        s[i] = along_y.value;
        sy[i] = along_y.slope;
        sz[i] = twice_value(vz[0], vz[1], vz[2], t.y);
    }
    const forms f(s[0], s[1], s[2]), fy(sy[0], sy[1], sy[2]), fz(sz[0], sz[1], sz[2]);
    const value_slope along_x(f.A, f.B, f.C, t.x);
    store(value, all(0.125) * along_x.value);
    store(dx, all(0.25) * along_x.slope);
    store(dy, all(0.25) * twice_value(fy.A, fy.B, fy.C, t.x));
    store(dz, all(0.25) * twice_value(fz.A, fz.B, fz.C, t.x));
}

PALPATE_INLINE void four_amplitudes(const double kept[27][4], const place& t, bool with_gradient, std::int32_t first,
                                    amplitude_sums& sums) noexcept {
    if (with_gradient) {
        gradients_at(kept, t, sums.value + first, sums.dx + first, sums.dy + first, sums.dz + first);
    } else {
        values_at(kept, t, sums.value + first);
    }
}

void amplitudes(const amplitude_taps& taps, std::int64_t way, std::int32_t gradient_channels, std::int32_t channels,
                amplitude_sums& sums) PALPATE_REAL_TIME {
    const place t(load(taps.t));
    for (std::int32_t first = 0; first < channels; first += 4) {
        double four[27][4];
        enter(taps, way + first, four);
        four_amplitudes(four, t, first < gradient_channels, first, sums);
    }
    store(sums.value + channels, all(0.0));
}

void go_to(const palpate_field& field, double px, double py, double pz, amplitude_cell& kept) PALPATE_REAL_TIME {
    const lattice& L = field.amplitudes;
    const quad u = cell_coordinates(L, px, py, pz);
    const quad t = u - load(kept.corner);
    if (all_within(t, all(1.0))) {
        kept.inside = true;
        store(kept.t, t);
        return;
    }
    kept.inside = field.channels <= kept_channels && all_within(u, load(L.last));
    if (!kept.inside) return;
    const quad corner = truncated(u, kept.cell);
    store(kept.corner, corner);
    store(kept.t, u - corner);
    kept.entered = true;
    amplitude_taps taps;
    lines_inside(L, field.amplitude_coefficients, kept.cell, taps);
    for (std::int32_t first = 0; first < field.channels; first += 4) enter(taps, first, kept.channels[first / 4]);
}

// True where `cell` became another one: that of q, in the lattice's box.
inline bool moves_to(const lattice& L, double x, double y, double z, std::uint32_t cell[4]) noexcept {
    const quad u = cell_coordinates(L, x, y, z);
    if (!all_within(u, load(L.last))) return false;
    bool same;
    truncated(u, cell, same);
    return !same;
}

// Inline, or gcc forgets to clear the upper halves of the registers on the way out, and the tick's other code pays 140 ns for it.
// A line of 64 bytes holds two layers along x of a block: the first and the last taps lie in every line that there is.
PALPATE_INLINE void fetch_cell(const lattice& L, const std::int16_t* coefficients, const std::uint32_t cell[4]) noexcept {
    const corners row(L, cell);
    const std::int64_t *const x = steps_at(L, cell, 0).column, *const y = steps_at(L, cell, 1).column;
    const std::int64_t column[4] = {x[0] + y[0], x[0] + y[2], x[2] + y[0], x[2] + y[2]};
    PALPATE_UNROLL_8
    for (int i = 0; i < 8; ++i) {
        if (row[i] >= 0) fetch(coefficients + row[i] * 64 + column[i / 2]);
    }
}

// The same along z, for up to 8 channels; of more channels, the first ones.
PALPATE_INLINE void fetch_cell(const lattice& L, const float* coefficients, const std::uint32_t cell[4]) noexcept {
    amplitude_taps taps;
    lines_inside(L, coefficients, cell, taps);
    PALPATE_NO_UNROLL
    for (int a = 0; a < 3; ++a) {
        PALPATE_UNROLL_3
        for (int b = 0; b < 3; ++b) {
            const float* const* line = taps.line + taps.x->across[a] + taps.y->across[b];
            const std::int64_t column = taps.x->column[a] + taps.y->column[b];
            fetch(line[0] + column);
            fetch(line[2] + column);
        }
    }
}

void fetch_cells(const palpate_field& field, double x, double y, double z, fetched_cells& last) PALPATE_REAL_TIME {
    const lattice &D = field.geometry, &A = field.amplitudes;
    if (moves_to(D, x, y, z, last.distance)) fetch_cell(D, field.geometry_coefficients, last.distance);
    if (moves_to(A, x, y, z, last.amplitudes)) fetch_cell(A, field.amplitude_coefficients, last.amplitudes);
}

// The row of curves at some depth, and the depth from the row's start, m.
struct curve_row {
    const double* c;
    double x;
    curve_row(const curve_set& set, std::int64_t padded, double depth) noexcept {
        const double t = depth * set.inverse_step;
        if (t < set.interval_count) {
            const auto m = static_cast<std::int32_t>(t);
            c = set.rows + m * (4 * padded);
            x = depth - static_cast<double>(m) * set.step;
        } else {
            c = set.rows + set.last_row * (4 * padded);
            x = depth - set.depth_end;
        }
    }
};

// Sums over curves r in four lanes each: phi_r a_r and so on, kappa_r b_r, mu_r m_r.
struct curve_sums {
    quad energy, gx, gy, gz, steepness, stiffness, friction_stiffness, friction_coefficient;
};

// Four channels.  Curves are summed in two halves, (c0 + c1 x) + x^2 (c2 + c3 x): shorter to wait for than Horner's rule.
PALPATE_INLINE curve_sums four_curves(const depth_curves& curves, const double* c, double depth, const amplitude_sums& a,
                                      std::int64_t first, bool with_gradient) noexcept {
    const std::int64_t padded = curves.padded;
    const quad x = all(depth), x2 = all(depth * depth);
    const quad c0 = load(c), c1 = load(c + padded), c2 = load(c + 2 * padded), c3 = load(c + 3 * padded);
    const quad phi = (c0 + c1 * x) + x2 * (c2 + c3 * x);
    const quad amplitude = load(a.value + first), felt = phi * amplitude;
    curve_sums sums;
    sums.friction_stiffness = felt * load(curves.of_stiffness + first);
    sums.friction_coefficient = felt * load(curves.of_friction + first);
    if (with_gradient) {
        const quad of_energy = load(curves.of_energy + first), energy_amplitude = amplitude * of_energy, energy_phi = phi * of_energy;
        const quad twice = c2 + c2, three_c3_x = all(3.0 * depth) * c3;
        sums.energy = felt * of_energy;
        sums.steepness = ((c1 + twice * x) + x * three_c3_x) * energy_amplitude;
        sums.stiffness = (twice + (three_c3_x + three_c3_x)) * energy_amplitude;
        sums.gx = energy_phi * load(a.dx + first);
        sums.gy = energy_phi * load(a.dy + first);
        sums.gz = energy_phi * load(a.dz + first);
    }
    return sums;
}

PALPATE_INLINE void combine(const palpate_field& field, const amplitude_sums& a, double depth, const double distance_gradient[3],
                            response& found) noexcept {
    const depth_curves& curves = field.curves;
    const curve_row row(curves.sets[0], curves.padded, depth);
    curve_sums s = four_curves(curves, row.c, row.x, a, 0, true);
    const auto add = [&](const double* c, double x, std::int64_t first) {
        const bool with_gradient = first < field.gradient_channels;
        const curve_sums more = four_curves(curves, c, x, a, first, with_gradient);
        s.friction_stiffness = s.friction_stiffness + more.friction_stiffness;
        s.friction_coefficient = s.friction_coefficient + more.friction_coefficient;
        if (!with_gradient) return;
        s.energy = s.energy + more.energy;
        s.steepness = s.steepness + more.steepness;
        s.stiffness = s.stiffness + more.stiffness;
        s.gx = s.gx + more.gx;
        s.gy = s.gy + more.gy;
        s.gz = s.gz + more.gz;
    };
    for (std::int64_t first = 4; first < curves.padded; first += 4) add(row.c + first, row.x, first);
    for (std::int32_t i = 1; i < curves.set_count; ++i) {
        const curve_row other(curves.sets[i], curves.padded, depth);
        for (std::int64_t first = 0; first < curves.padded; first += 4) add(other.c + first, other.x, first);
    }
    // grad U = sums per cell, in metres, - dU/dd grad phi;  k and mu are never negative.
    const quad rest = sums_of_four(s.steepness, s.stiffness, s.friction_stiffness, s.friction_coefficient);
    const quad along_depth = lane<0>(rest) * four(0.0, distance_gradient[0], distance_gradient[1], distance_gradient[2]);
    static_assert(sizeof(response) == 8 * sizeof(double), "stored as two quads");
    double* const out = &found.energy;
    store(out, load(field.response_scale) * sums_of_four(s.energy, s.gx, s.gy, s.gz) - along_depth);
    store(out + 4, larger(rest, four(lowest, lowest, 0.0, 0.0)));
}

void respond(const palpate_field& field, double px, double py, double pz, double depth, const double distance_gradient[3],
             const amplitude_cell& kept, response& found, amplitude_sums& sums) PALPATE_REAL_TIME {
    if (kept.inside) {
        const place t(load(kept.t));
        for (std::int32_t first = 0; first < field.channels; first += 4) {
            four_amplitudes(kept.channels[first / 4], t, first < field.gradient_channels, first, sums);
        }
        store(sums.value + field.channels, all(0.0));
    } else {
        amplitude_taps taps;
        if (!gather_amplitudes(field.amplitudes, field.amplitude_coefficients, px, py, pz, taps)) {
            sums = amplitude_sums{};
            found = response{};
            return;
        }
        amplitudes(taps, 0, field.gradient_channels, field.channels, sums);
    }
    combine(field, sums, depth, distance_gradient, found);
}

void response_from(const palpate_field& field, const amplitude_sums& sums, double depth, const double distance_gradient[3],
                   response& found) PALPATE_REAL_TIME {
    combine(field, sums, depth, distance_gradient, found);
}

double energy_from(const palpate_field& field, const amplitude_sums& a, double depth) PALPATE_REAL_TIME {
    const depth_curves& curves = field.curves;
    quad energy = all(0.0);
    for (std::int32_t i = 0; i < curves.set_count; ++i) {
        const curve_row row(curves.sets[i], curves.padded, depth);
        const quad x = all(row.x), x2 = all(row.x * row.x);
        for (std::int64_t first = 0; first < curves.padded && first < field.gradient_channels; first += 4) {
            const double* const c = row.c + first;
            const std::int64_t padded = curves.padded;
            const quad phi = (load(c) + load(c + padded) * x) + x2 * (load(c + 2 * padded) + load(c + 3 * padded) * x);
            energy = energy + (phi * load(a.value + first)) * load(curves.of_energy + first);
        }
    }
    double sum[4];
    store(sum, sums_of_four(energy, energy, energy, energy));
    return sum[0];
}

}  // namespace PALPATE_ISA
}  // namespace palpate
