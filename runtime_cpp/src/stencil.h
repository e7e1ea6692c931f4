// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Weights of a quadratic B-spline cell (fields/lattice.py), with t = u - floor(u) along an axis:
//     w = ((1 - t)^2 / 2, 1/2 + t (1 - t), t^2 / 2),   dw/dt = (t - 1, 1 - 2 t, t)
// and the place of its taps: tap k of cell i lies in block (i + k) / 4, which is the cell's own block or the next.
#ifndef PALPATE_SRC_STENCIL_H
#define PALPATE_SRC_STENCIL_H

#include <cstdint>

namespace palpate {

struct axis_taps {
    double w[3];
    double d[3];         // per cell; divide by the spacing
    std::int64_t place;  // of tap 0 in its block, 0..3; tap k lies in the next block where place + k > 3
    std::int64_t block;  // of tap 0
};

// u >= 0.
static inline void taps_at(double u, axis_taps& a) noexcept {
    const auto i = static_cast<std::int64_t>(u);
    const double t = u - static_cast<double>(i);
    const double r = 1.0 - t;
    a.w[0] = 0.5 * r * r;
    a.w[1] = 0.5 + t * r;
    a.w[2] = 0.5 * t * t;
    a.d[0] = t - 1.0;
    a.d[1] = 1.0 - 2.0 * t;
    a.d[2] = t;
    a.place = i & 3;
    a.block = i >> 2;
}

// Where tap k of an axis lies: in its own block or the next (0 or 1), and at which place there.
static inline std::int64_t next_block(const axis_taps& a, std::int64_t k) noexcept { return (a.place + k) >> 2; }
static inline std::int64_t place_of(const axis_taps& a, std::int64_t k) noexcept { return (a.place + k) & 3; }

}  // namespace palpate

#endif
