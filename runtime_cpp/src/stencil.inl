// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Where a point is in a lattice: three axes at once, an axis to each lane.  Included where lanes.h is.
#include "cell.h"
#include "lanes.h"
#include "lattice.h"

namespace palpate {
namespace PALPATE_ISA {

inline quad cell_coordinates(const lattice& L, double x, double y, double z) noexcept {
    return (three(x, y, z) - load(L.origin)) * all(L.inverse_spacing);
}

// The place of tap 0 in its block, by axis.
inline const tap_steps& steps_at(const lattice& L, const std::uint32_t cell[4], int axis) noexcept { return L.steps[axis][cell[axis] & 3]; }

// 1 where the stencil reaches into the next block along the axis.
inline std::uint32_t crosses(const std::uint32_t cell[4], int axis) noexcept { return cell[axis] >> 1 & 1; }

// Rows of the (up to) 8 blocks under a stencil in the box; the same one twice where it does not cross.
struct corners {
    const std::int32_t* first;
    std::int64_t x, y, z;  // entries of the index to the next block, or 0
    corners(const lattice& L, const std::uint32_t cell[4]) noexcept
        : first(L.index + (cell[0] >> 2) * L.row_step[0] + (cell[1] >> 2) * L.row_step[1] + (cell[2] >> 2)),
          x(crosses(cell, 0) * L.row_step[0]), y(crosses(cell, 1) * L.row_step[1]), z(crosses(cell, 2)) {}
    std::int64_t operator[](int i) const noexcept { return first[(i & 4 ? x : 0) + (i & 2 ? y : 0) + (i & 1 ? z : 0)]; }
};

// A, B, C of three taps (cell.h).
struct forms {
    quad A, B, C;
    forms(const quad& c0, const quad& c1, const quad& c2) noexcept : A(c0 + c1), B(c1 - c0), C((c2 - c1) - B) {}
};

// Twice the value at t, and the derivative.
struct value_slope {
    quad value, slope;
    value_slope(const quad& A, const quad& B, const quad& C, const quad& t) noexcept
        : value(), slope(B + t * C) {
        value = A + t * (B + slope);
    }
};
inline quad twice_value(const quad& A, const quad& B, const quad& C, const quad& t) noexcept { return A + t * (B + (B + t * C)); }

}  // namespace PALPATE_ISA
}  // namespace palpate
