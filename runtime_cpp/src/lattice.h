// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#ifndef PALPATE_SRC_LATTICE_H
#define PALPATE_SRC_LATTICE_H

#include <cstdint>

namespace palpate {

// The three taps along an axis, when tap 0 has a given place in its block: tap k lies in the block of tap 0 or in the next.
struct tap_steps {
    std::int64_t across[3];  // entries of the table of blocks (contract.h) to the tap's block
    std::int64_t column[3];  // coefficients from the block's begin to the tap's place
};

// A sparse lattice of 4 x 4 x 4 blocks (fields/lattice.py).  Cells 0 .. cells - 3 along each axis have whole stencils.
// Origin and end have a fourth lane (0 and 1) for arithmetic on three axes at once.
struct lattice {
    double origin[4];        // m
    double last[4];          // 4 blocks - 2: cell coordinates below it have their stencil in the box
    double spacing;          // m
    double inverse_spacing;  // 1/m
    std::int32_t blocks[3];
    std::int64_t row_step[2];   // entries of the index from one block to the next along x and y
    const std::int32_t* index;  // (blocks) row of the coefficients
    std::int64_t block_size;    // numbers to a block
    tap_steps steps[3][4];      // by axis and place of tap 0
};

// `stride`: numbers to a coefficient; `across`: entries of the table of blocks from one to the next along y (tap_steps).
inline void set_lattice(lattice& L, const double origin[3], double spacing, const std::uint32_t blocks[3],
                 const std::int32_t* index, std::int64_t stride, std::int64_t across) noexcept {
    for (int a = 0; a < 3; ++a) {
        L.origin[a] = origin[a];
        L.blocks[a] = static_cast<std::int32_t>(blocks[a]);
        L.last[a] = 4.0 * static_cast<double>(blocks[a]) - 2.0;
    }
    L.origin[3] = 0.0;
    L.last[3] = 1.0;
    L.row_step[0] = static_cast<std::int64_t>(L.blocks[1]) * L.blocks[2];
    L.row_step[1] = L.blocks[2];
    L.spacing = spacing;
    L.inverse_spacing = 1.0 / spacing;
    L.index = index;
    L.block_size = 64 * stride;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t next = axis == 0 ? 2 * across : axis == 1 ? across : 1, column = axis == 0 ? 16 : axis == 1 ? 4 : 1;
        for (int place = 0; place < 4; ++place) {
            for (int k = 0; k < 3; ++k) {
                L.steps[axis][place].across[k] = (place + k) / 4 * next;
                L.steps[axis][place].column[k] = (place + k) % 4 * column * stride;
            }
        }
    }
}

}  // namespace palpate

#endif
