// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Where a point is in a lattice: three axes at once, an axis to each lane.  Included where lanes.h is.
#include "lanes.h"
#include "lattice.h"
#include "stencil.h"

namespace palpate {
namespace PALPATE_ISA {

inline quad cell_coordinates(const lattice& L, double x, double y, double z) noexcept {
    return (three(x, y, z) - load(L.origin)) * all(L.inverse_spacing);
}

// u >= 0
inline void stencil_at(const quad& u, stencil& at) noexcept {
    const quad t = u - truncated(u, at.cell), one = all(1.0), half = all(0.5), r = one - t;
    store(at.w[0], half * r * r);
    store(at.w[1], half + t * r);
    store(at.w[2], half * t * t);
    store(at.d[0], t - one);
    store(at.d[1], one - all(2.0) * t);
    store(at.d[2], t);
}

inline const tap_steps& steps_at(const lattice& L, const stencil& at, int axis) noexcept { return L.steps[axis][at.cell[axis] & 3]; }

// 1 where the stencil reaches into the next block along the axis.
inline std::uint32_t crosses(const stencil& at, int axis) noexcept { return at.cell[axis] >> 1 & 1; }

// Rows of the (up to) 8 blocks under a stencil in the box; the same one twice where it does not cross.
struct corners {
    const std::int32_t* first;
    std::int64_t x, y, z;  // entries of the index to the next block, or 0
    corners(const lattice& L, const stencil& at) noexcept
        : first(L.index + (at.cell[0] >> 2) * L.row_step[0] + (at.cell[1] >> 2) * L.row_step[1] + (at.cell[2] >> 2)),
          x(crosses(at, 0) * L.row_step[0]), y(crosses(at, 1) * L.row_step[1]), z(crosses(at, 2)) {}
    std::int64_t operator[](int i) const noexcept { return first[(i & 4 ? x : 0) + (i & 2 ? y : 0) + (i & 1 ? z : 0)]; }
};

}  // namespace PALPATE_ISA
}  // namespace palpate
