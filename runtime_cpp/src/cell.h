// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// What lies under a point in one cell of a lattice, made ready for sums and kept while the point stays in the cell: most ticks stay.
// Values are tensor products of quadratic B-splines (fields/lattice.py).  Along an axis, with t = u - floor(u) and the coefficients
// c0, c1, c2 of the three taps,
//     w = ((1 - t)^2 / 2, 1/2 + t (1 - t), t^2 / 2),   dw/dt = (t - 1, 1 - 2 t, t)
//     A = c0 + c1,   B = c1 - c0,   C = (c2 - c1) - B
//     2 sum w c = A + t (B + sum dw/dt c),   sum dw/dt c = B + t C
// A, B, C of each axis in turn are what is kept: they belong to the cell, so that an answer depends on the point alone, not on
// whether the cell was kept.
#ifndef PALPATE_SRC_CELL_H
#define PALPATE_SRC_CELL_H

#include <cstdint>
#include <limits>

namespace palpate {

constexpr std::uint32_t no_cell = 0xFFFFFFFFu;
constexpr std::int32_t kept_channels = 8;

// No point is in a cell with this number.
inline void forget(std::uint32_t cell[4]) noexcept {
    for (int a = 0; a < 4; ++a) cell[a] = no_cell;
}

// Of the distance: A, B, C along x, then y (9 of them), of the four counts along z that begin with tap 0.
struct distance_cell {
    std::uint32_t cell[4];  // of tap 0
    double corner[4];       // the same numbers: a point at u is in the cell while 0 <= u - corner < 1; infinite while nothing is kept, whence no point is in it
    double along_z[9][4];
    bool entered;           // set when it is made, taken back by who looks ahead
};

// Of the first kept_channels amplitudes, four channels at a time, by tap along x: A, B, C along y, then z.  Along x they would take more
// to make than they save.
struct amplitude_cell {
    std::uint32_t cell[4];
    double corner[4];
    double t[4];   // of the point in the cell, by axis
    bool inside;   // the point's stencil lies in the lattice's box; else the rest is of an earlier point
    bool entered;  // as above
    double channels[kept_channels / 4][27][4];
};

// Of the four masks of a texture, in the same order; of one alone, the first nine as of the distance.  Where all are 0, nothing but the cell.
struct mask_cell {
    std::uint32_t cell[4];
    double corner[4];
    bool zero;
    double channels[27][4];
};

// Nothing is kept.
template <class Cell>
void forget(Cell& kept) noexcept {
    forget(kept.cell);
    for (double& x : kept.corner) x = std::numeric_limits<double>::infinity();  // NaN would raise a flag
}

// The cells that the caches were last asked to get (ahead.h).
struct fetched_cells {
    std::uint32_t distance[4], amplitudes[4];
};

}  // namespace palpate

#endif
