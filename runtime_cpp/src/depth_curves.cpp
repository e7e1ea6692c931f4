// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "depth_curves.h"

namespace palpate {
namespace {

// The intervals of a set that all three kinds share, or 0: the finest kind's where they end at one depth and each knot is one of its.
std::uint32_t shared_intervals(const stored_curves kinds[3]) noexcept {
    std::uint32_t finest = 0;
    for (int k = 0; k < 3; ++k) finest = kinds[k].intervals > finest ? kinds[k].intervals : finest;
    for (int k = 0; k < 3; ++k) {
        if (kinds[k].depth_end != kinds[0].depth_end || finest % kinds[k].intervals != 0) return 0;
    }
    return finest;
}

std::uint64_t padded_channels(const stored_curves kinds[3]) noexcept {
    return (std::uint64_t{kinds[0].count} + kinds[1].count + kinds[2].count + 3) / 4 * 4;
}

void set_intervals(curve_set& set, double depth_end, std::uint32_t intervals, const double* rows) noexcept {
    set.depth_end = depth_end;
    set.interval_count = static_cast<double>(intervals);
    set.step = depth_end / set.interval_count;
    set.inverse_step = set.interval_count / depth_end;
    set.last_row = static_cast<std::int32_t>(intervals);
    set.rows = rows;
}

// Channels from `first` on get the kind's curves, on intervals `finer` to one of its own:
//     c(x + o) = (c0 + c1 o + c2 o^2 + c3 o^3) + (c1 + 2 c2 o + 3 c3 o^2) x + (c2 + 3 c3 o) x^2 + c3 x^3
void put(const stored_curves& kind, std::uint32_t finer, double step, std::uint64_t first, std::uint64_t padded, double* rows) noexcept {
    for (std::uint64_t row = 0; row <= std::uint64_t{kind.intervals} * finer; ++row) {
        const double o = static_cast<double>(row % finer) * step;
        for (std::uint32_t r = 0; r < kind.count; ++r) {
            const double* c = kind.rows + 4 * (row / finer * kind.count + r);
            double* to = rows + row * 4 * padded + first + r;
            to[0] = c[0] + o * (c[1] + o * (c[2] + o * c[3]));
            to[padded] = c[1] + o * (2.0 * c[2] + 3.0 * o * c[3]);
            to[2 * padded] = c[2] + 3.0 * o * c[3];
            to[3 * padded] = c[3];
        }
    }
}

}  // namespace

std::uint64_t curve_numbers(const stored_curves kinds[3]) noexcept {
    std::uint64_t rows = shared_intervals(kinds);
    rows = rows > 0 ? rows + 1 : std::uint64_t{kinds[0].intervals} + kinds[1].intervals + kinds[2].intervals + 3;
    return rows * 4 * padded_channels(kinds);
}

void set_curves(depth_curves& curves, const stored_curves kinds[3], double* rows) noexcept {
    const std::uint64_t padded = padded_channels(kinds), numbers = curve_numbers(kinds);
    for (std::uint64_t i = 0; i < numbers; ++i) rows[i] = 0.0;
    const std::uint32_t shared = shared_intervals(kinds);
    double* const masks[3] = {curves.of_energy, curves.of_stiffness, curves.of_friction};
    curves.padded = static_cast<std::int32_t>(padded);
    curves.set_count = shared > 0 ? 1 : 3;
    if (shared > 0) set_intervals(curves.sets[0], kinds[0].depth_end, shared, rows);
    std::uint64_t first = 0;
    for (int k = 0; k < 3; ++k) {
        const stored_curves& kind = kinds[k];
        for (std::uint32_t i = 0; i < rfield_channel_limit; ++i) masks[k][i] = i >= first && i < first + kind.count ? 1.0 : 0.0;
        if (shared > 0) {
            put(kind, shared / kind.intervals, curves.sets[0].step, first, padded, rows);
        } else {
            set_intervals(curves.sets[k], kind.depth_end, kind.intervals, rows);
            put(kind, 1, curves.sets[k].step, first, padded, rows);
            rows += (std::uint64_t{kind.intervals} + 1) * 4 * padded;
        }
        first += kind.count;
    }
}

}  // namespace palpate
