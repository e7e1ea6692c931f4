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

// Four waves at one place: their vectors, their cosines, and the cosines' slopes per cycle.
struct four_waves {
    quad kx, ky, kz, value, slope;
};

PALPATE_INLINE four_waves waves_at(const texture_ground& ground, std::int32_t i, const quad& x, const quad& y, const quad& z) noexcept {
    const auto of = [](double value) { return all(value); };  // no pointer to a function: inlined, and known to return at once
    four_waves w{load(ground.kx + i), load(ground.ky + i), load(ground.kz + i), all(0.0), all(0.0)};
    const quad cycles = ((w.kx * x + w.ky * y) + w.kz * z) + load(ground.phase + i);
    cosine_of_cycles(cycles - nearest(cycles, of), of, w.value, w.slope);
    return w;
}

PALPATE_INLINE void add(const quad& amplitude, const four_waves& w, wave_sums& sums) noexcept {
    const quad rise = amplitude * w.slope;
    sums.h = sums.h + amplitude * w.value;
    sums.x = sums.x + rise * w.kx;
    sums.y = sums.y + rise * w.ky;
    sums.z = sums.z + rise * w.kz;
}

// Masks and their gradients (1/m) at one place.
struct mask_sums {
    quad sole;  // (m, grad m), where there is one alone
    double value[4], dx[4], dy[4], dz[4];  // else, per cell
};

// Apart, or every tick pays for the registers that this one needs.
PALPATE_APART void enter_masks(const texture_ground& ground, const quad& u, mask_cell& kept) noexcept {
    const quad corner = truncated(u, kept.cell);
    store(kept.corner, corner);
    amplitude_taps taps;
    lines_inside(ground.mask, ground.mask_coefficients, kept.cell, taps);
    const bool sole = ground.sole_mask >= 0;
    if (sole) {
        quad c[3][3];  // A, B, C along y, by tap along x
        PALPATE_NO_UNROLL
        for (int a = 0; a < 3; ++a) {
            quad tap[3];
            PALPATE_UNROLL_3
            for (int b = 0; b < 3; ++b) {
                const float* const* line = taps.line + taps.x->across[a] + taps.y->across[b];
                const std::int64_t at = taps.x->column[a] + taps.y->column[b] + ground.sole_mask;
                tap[b] = three(static_cast<double>(line[0][at]), static_cast<double>(line[1][at]), static_cast<double>(line[2][at]));
            }
            const forms f(tap[0], tap[1], tap[2]);
            c[a][0] = f.A;
            c[a][1] = f.B;
            c[a][2] = f.C;
        }
        store_rows(c, kept.channels);
    } else {
        enter(taps, 0, kept.channels);
    }
    quad most = all(0.0);
    for (int row = 0; row < (sole ? 9 : 27); ++row) {  // A, B, C of coefficients that are not negative: 0 where all these are
        const quad c = load(kept.channels[row]);
        most = larger(most, c);
    }
    kept.zero = !any_other(most, all(0.0));
}

// Beyond the box's last whole cell.
PALPATE_APART bool masks_at_the_edge(const texture_ground& ground, double px, double py, double pz, mask_sums& masks) noexcept {
    amplitude_taps taps;
    if (!gather_amplitudes(ground.mask, ground.mask_coefficients, px, py, pz, taps)) return false;
    double four_of[27][4];
    enter(taps, 0, four_of);
    gradients_at(four_of, place(load(taps.t)), masks.value, masks.dx, masks.dy, masks.dz);
    const std::int32_t c = ground.sole_mask;
    const double scale = ground.mask.inverse_spacing;
    if (c >= 0) masks.sole = four(masks.value[c], scale * masks.dx[c], scale * masks.dy[c], scale * masks.dz[c]);
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
    if (PALPATE_EXPECTED(ground.sole_mask >= 0)) {
        masks.sole = load(ground.sole_scale) * one_channel_in(kept.channels, t);
    } else {
        gradients_at(kept.channels, place(t), masks.value, masks.dx, masks.dy, masks.dz);
    }
    return true;
}

// (m, grad m) of mask c.
PALPATE_INLINE quad mask_of(const texture_ground& ground, const mask_sums& masks, std::uint32_t c) noexcept {
    if (PALPATE_EXPECTED(ground.sole_mask >= 0)) return masks.sole;
    const double scale = ground.mask.inverse_spacing;
    return four(masks.value[c], scale * masks.dx[c], scale * masks.dy[c], scale * masks.dz[c]);
}

// (h, grad h) of waves whose sums these are, below mask c of those at this place.
PALPATE_INLINE quad below_mask(const texture_ground& ground, const mask_sums& masks, std::uint32_t c, const wave_sums& sums) noexcept {
    const quad waves = sums_of_four(sums.h, sums.x, sums.y, sums.z);
    if (c == texture_no_mask) return waves;
    const quad mask = mask_of(ground, masks, c);
    return lane<0>(mask) * waves + (four(0.0, 1.0, 1.0, 1.0) * mask) * lane<0>(waves);
}

// Sums of the groups that have a bit in `felt`; the waves of group `known` were found already (-1: none were).
PALPATE_INLINE void sum_groups(const texture_ground& ground, const double* amplitude, std::uint32_t felt, const quad& x, const quad& y, const quad& z,
                               bool some_mask, const mask_sums& masks, std::int32_t known, const four_waves& known_waves,
                               double height_and_gradient[4]) noexcept {
    quad sum = all(0.0);
    wave_sums sums;  // of groups in a row that have one mask
    PALPATE_NO_UNROLL
    for (std::int32_t g = 0; g < ground.group_count; ++g) {
        const std::uint32_t c = ground.mask_channel[g];
        if (c != texture_no_mask && !some_mask) continue;
        if ((felt >> g & 1u) != 0) add(load(amplitude + 4 * g), g == known ? known_waves : waves_at(ground, 4 * g, x, y, z), sums);
        if (g + 1 < ground.group_count && ground.mask_channel[g + 1] == c) continue;
        sum = sum + below_mask(ground, masks, c, sums);
        sums = wave_sums();
    }
    store(height_and_gradient, sum);
}

void texture(const texture_ground& ground, const double* amplitude, double px, double py, double pz, mask_cell& kept,
             double height_and_gradient[4]) PALPATE_REAL_TIME {
    mask_sums masks;
    const bool some = ground.masked && masks_at(ground, px, py, pz, kept, masks);
    sum_groups(ground, amplitude, ~0u, all(px), all(py), all(pz), some, masks, -1, four_waves{}, height_and_gradient);
}

// The group whose turn it is: one wave to each lane, without a branch for each.
bool texture_in_turn(const texture_ground& ground, texture_state& t, const double q[3], const double step[3], double reach,
                     mask_cell& kept, double height_and_gradient[4], double* height_change) PALPATE_REAL_TIME {
    const quad x = all(q[0]), y = all(q[1]), z = all(q[2]), none = all(0.0);
    const auto g = static_cast<std::int32_t>(t.turn);
    const std::int32_t i = 4 * g;
    const std::uint32_t c = ground.mask_channel[g];
    const quad along = (load(ground.kx + i) * all(step[0]) + load(ground.ky + i) * all(step[1])) + load(ground.kz + i) * all(step[2]);
    const quad wanted = where_less(larger(along, none - along), all(reach), load(t.most + i), none);
    const quad gain = load(t.gain + i), room = all(t.walked - t.turned_at[g]) * load(ground.spatial_frequency + i);
    quad after = larger(gain - room, smaller(wanted, gain + room));
    four_waves waves{};
    bool changed = any_other(after, gain);
    mask_sums masks;
    const bool some = (changed || t.felt != 0) && ground.masked && masks_at(ground, q[0], q[1], q[2], kept, masks);
    const bool felt_here = c == texture_no_mask || some;  // else any gain is right for the energy
    if (changed && felt_here) {
        waves = waves_at(ground, i, x, y, z);
        after = where_less(none, (after - gain) * waves.value, gain, after);
        changed = any_other(after, gain);
    }
    if (changed) {
        const quad amplitude = after * load(ground.amplitude + i), before = load(t.amplitude + i);
        store(t.gain + i, after);
        store(t.amplitude + i, amplitude);
        changed = felt_here;
        if (changed) {
            quad rise = (amplitude - before) * waves.value;
            rise = sums_of_four(rise, rise, rise, rise);
            if (c != texture_no_mask) rise = mask_of(ground, masks, c) * rise;
            double height[4];
            store(height, rise);
            *height_change = height[0];
        }
    }
    const quad whole = load(ground.amplitude + i), now = load(t.amplitude + i);
    const std::uint32_t bit = 1u << g;
    const bool limited = any_other(now, whole), restless = limited || any_other(now, wanted * whole);
    t.limited = limited ? t.limited | bit : t.limited & ~bit;
    t.restless = restless ? t.restless | bit : t.restless & ~bit;
    t.felt = any_other(now, none) ? t.felt | bit : t.felt & ~bit;
    t.turned_at[g] = t.walked;
    t.turn = g + 1 < ground.group_count ? t.turn + 1 : 0;
    sum_groups(ground, t.amplitude, t.felt, x, y, z, some, masks, changed ? g : -1, waves, height_and_gradient);
    return changed;
}

}  // namespace PALPATE_ISA
}  // namespace palpate
