// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// The waves of a texture, four to a group, a wave to each lane; and the masks of the groups, a mask to each lane, whose coefficients are
// kept while the point stays in their cell.  Included after contract.inl.
#include "layers/texture.h"

namespace palpate {
namespace PALPATE_ISA {

// Sums of h and grad h, a wave to each lane.
struct wave_sums {
    quad h, x, y, z;
    wave_sums() noexcept : h(all(0.0)), x(all(0.0)), y(all(0.0)), z(all(0.0)) {}
};

PALPATE_INLINE void add_four_waves(const texture_ground& ground, const double* amplitude, std::int32_t i, const quad& x, const quad& y,
                                   const quad& z, wave_sums& sums) noexcept {
    if (!(amplitude[i] + amplitude[i + 1] + amplitude[i + 2] + amplitude[i + 3] > 0.0)) return;  // all faded
    const auto of = [](double value) { return all(value); };  // no pointer to a function: inlined, and known to return at once
    const quad kx = load(ground.kx + i), ky = load(ground.ky + i), kz = load(ground.kz + i);
    const quad cycles = ((kx * x + ky * y) + kz * z) + load(ground.phase + i);
    quad value = all(0.0), slope = all(0.0);
    cosine_of_cycles(cycles - nearest(cycles, of), of, value, slope);
    const quad a = load(amplitude + i), rise = a * slope;
    sums.h = sums.h + a * value;
    sums.x = sums.x + rise * kx;
    sums.y = sums.y + rise * ky;
    sums.z = sums.z + rise * kz;
}

// Four masks, and their slopes per cell.
struct mask_sums {
    double value[4], dx[4], dy[4], dz[4];
};

// Apart, or every tick pays for the registers that this one needs.
PALPATE_APART void enter_masks(const texture_ground& ground, const quad& u, mask_cell& kept) noexcept {
    const quad corner = truncated(u, kept.cell);
    store(kept.corner, corner);
    amplitude_taps taps;
    lines_inside(ground.mask, ground.mask_coefficients, kept.cell, taps);
    enter(taps, 0, kept.channels);
    quad most = all(0.0);
    for (const double(&of_four)[4] : kept.channels) {  // A and B of coefficients that are not negative: 0 where all these are
        const quad c = load(of_four);
        most = larger(most, c);
    }
    double found[4];
    store(found, most);
    kept.zero = !(found[0] > 0.0 || found[1] > 0.0 || found[2] > 0.0 || found[3] > 0.0);
}

// Beyond the box's last whole cell.
PALPATE_APART bool masks_at_the_edge(const texture_ground& ground, double px, double py, double pz, mask_sums& masks) noexcept {
    amplitude_taps taps;
    if (!gather_amplitudes(ground.mask, ground.mask_coefficients, px, py, pz, taps)) return false;
    double four[27][4];
    enter(taps, 0, four);
    gradients_at(four, place(load(taps.t)), masks.value, masks.dx, masks.dy, masks.dz);
    return true;
}

// False where all are 0 around the point.
PALPATE_INLINE bool masks_at(const texture_ground& ground, double px, double py, double pz, mask_cell& kept, mask_sums& masks) noexcept {
    const quad u = cell_coordinates(ground.mask, px, py, pz);
    quad t = u - load(kept.corner);
    if (!all_within(t, all(1.0))) {
        if (!all_within(u, load(ground.mask.last))) return masks_at_the_edge(ground, px, py, pz, masks);
        enter_masks(ground, u, kept);
        t = u - load(kept.corner);
    }
    if (kept.zero) return false;
    gradients_at(kept.channels, place(t), masks.value, masks.dx, masks.dy, masks.dz);
    return true;
}

void texture(const texture_ground& ground, const double* amplitude, double px, double py, double pz, mask_cell& kept,
             double height_and_gradient[4]) PALPATE_REAL_TIME {
    const quad x = all(px), y = all(py), z = all(pz);
    mask_sums masks;
    const bool some = ground.masked && masks_at(ground, px, py, pz, kept, masks);
    quad sum = all(0.0);
    wave_sums sums;  // of groups in a row that have one mask
    PALPATE_NO_UNROLL
    for (std::int32_t g = 0; g < ground.group_count; ++g) {
        const std::uint32_t c = ground.mask_channel[g];
        if (c != texture_no_mask && !some) continue;
        add_four_waves(ground, amplitude, 4 * g, x, y, z, sums);
        if (g + 1 < ground.group_count && ground.mask_channel[g + 1] == c) continue;
        const quad waves = sums_of_four(sums.h, sums.x, sums.y, sums.z);
        sums = wave_sums();
        if (c == texture_no_mask) {
            sum = sum + waves;
        } else {
            const quad slope = all(ground.mask.inverse_spacing) * four(0.0, masks.dx[c], masks.dy[c], masks.dz[c]);
            sum = sum + (all(masks.value[c]) * waves + slope * lane<0>(waves));
        }
    }
    store(height_and_gradient, sum);
}

}  // namespace PALPATE_ISA
}  // namespace palpate
