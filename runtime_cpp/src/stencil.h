// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// The 3 x 3 x 3 taps of a quadratic B-spline (fields/lattice.py) under a point, with t = u - floor(u) along each axis:
//     w = ((1 - t)^2 / 2, 1/2 + t (1 - t), t^2 / 2),   dw/dt = (t - 1, 1 - 2 t, t)
#ifndef PALPATE_SRC_STENCIL_H
#define PALPATE_SRC_STENCIL_H

#include <cstdint>

namespace palpate {

struct stencil {
    double w[3][4];        // by tap, then axis; the fourth lane means nothing
    double d[3][4];        // per cell; divide by the spacing
    std::uint32_t cell[4];  // of tap 0: block cell / 4, place cell % 4 in it
};

}  // namespace palpate

#endif
