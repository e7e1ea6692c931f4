// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Contact geometry: depth d = rho - phi(q) from the organ's signed distance phi on a quadratic B-spline lattice.
//
// A cell is known when all blocks under its 27 coefficients are stored.  An unknown cell is
//     deep       when it touches a block that is absent because it lies deeper than the band;
//     outside    when its absent blocks are free space (or beyond the box) and every stored coefficient under it is
//                >= rho: then phi >= rho on each face that it shares with a known cell, since values are convex
//                combinations of the coefficients and a shared face has the coefficients of both;
//     unreached  otherwise.
// So contact is only ever next to free space where U = 0, and coming back from anywhere else is for the tick to judge.
#include "locate.h"

#include <cmath>

#include "contract.h"

namespace palpate {
namespace {

constexpr std::int32_t absent_outside = -1;
constexpr std::int32_t absent_inside = -2;

// floor for |u| < 2^31
std::int32_t floor_of(double u) noexcept {
    const auto i = static_cast<std::int32_t>(u);
    return static_cast<double>(i) > u ? i - 1 : i;
}

palpate_region unknown_cell(const palpate_field& field, const double u[3]) noexcept {
    const lattice& L = field.geometry;
    for (int a = 0; a < 3; ++a) {
        if (!(u[a] >= -2.0 && u[a] < L.last[a] + 2.0)) return PALPATE_REGION_OUTSIDE;
    }
    const std::int32_t i[3] = {floor_of(u[0]), floor_of(u[1]), floor_of(u[2])};
    bool deep = false;
    bool free = true;
    for (std::int32_t tap = 0; tap < 27; ++tap) {
        const std::int32_t j[3] = {i[0] + tap / 9, i[1] + tap / 3 % 3, i[2] + tap % 3};
        bool in_box = true;
        for (int a = 0; a < 3; ++a) in_box = in_box && j[a] >= 0 && j[a] < 4 * L.blocks[a];
        if (!in_box) continue;
        const std::int32_t row =
            L.index[(static_cast<std::int64_t>(j[0] >> 2) * L.blocks[1] + (j[1] >> 2)) * L.blocks[2] + (j[2] >> 2)];
        if (row >= 0) {
            const std::int64_t at = static_cast<std::int64_t>(row) * 64 + (j[0] & 3) * 16 + (j[1] & 3) * 4 + (j[2] & 3);
            const double c = field.geometry_bias + field.geometry_scale * static_cast<double>(field.geometry_coefficients[at]);
            free = free && c >= field.tool_offset;
        } else {
            deep = deep || row == absent_inside;
            free = free && row == absent_outside;
        }
    }
    if (deep) return PALPATE_REGION_DEEP;
    return free ? PALPATE_REGION_OUTSIDE : PALPATE_REGION_UNREACHED;
}

}  // namespace

void locate(const palpate_field& field, const double q[3], location& found) noexcept {
    const lattice& L = field.geometry;
    const double u[3] = {(q[0] - L.origin[0]) * L.inverse_spacing, (q[1] - L.origin[1]) * L.inverse_spacing,
                         (q[2] - L.origin[2]) * L.inverse_spacing};
    found.depth = 0.0;
    found.gradient[0] = found.gradient[1] = found.gradient[2] = 0.0;
    if (!(u[0] >= 0.0 && u[1] >= 0.0 && u[2] >= 0.0 && u[0] < L.last[0] && u[1] < L.last[1] && u[2] < L.last[2])) {
        found.region = unknown_cell(field, u);
        return;
    }
    axis_taps x, y, z;
    taps_at(u[0], x);
    taps_at(u[1], y);
    taps_at(u[2], z);

    // The (up to) 8 blocks under the stencil; the same one twice where it does not cross.
    const std::int64_t cross_x = next_block(x, 2) * static_cast<std::int64_t>(L.blocks[1]) * L.blocks[2];
    const std::int64_t cross_y = next_block(y, 2) * static_cast<std::int64_t>(L.blocks[2]);
    const std::int64_t cross_z = next_block(z, 2);
    const std::int32_t* line =
        L.index + (x.block * L.blocks[1] + y.block) * L.blocks[2] + z.block;
    const std::int32_t row[8] = {line[0],
                                 line[cross_z],
                                 line[cross_y],
                                 line[cross_y + cross_z],
                                 line[cross_x],
                                 line[cross_x + cross_z],
                                 line[cross_x + cross_y],
                                 line[cross_x + cross_y + cross_z]};
    if ((row[0] | row[1] | row[2] | row[3] | row[4] | row[5] | row[6] | row[7]) < 0) {
        bool all_outside = true;
        for (std::int32_t r : row) all_outside = all_outside && r == absent_outside;
        found.region = all_outside ? PALPATE_REGION_OUTSIDE : unknown_cell(field, u);
        return;
    }

    const std::int16_t* block[8];
    for (int i = 0; i < 8; ++i) block[i] = field.geometry_coefficients + static_cast<std::int64_t>(row[i]) * 64;
    double sums[4];
    field.contract->geometry(block, x, y, z, sums);
    const double scale = field.geometry_scale * (1.0 / sums_per_count);
    const double per_metre = scale * L.inverse_spacing;
    found.depth = field.tool_offset - (field.geometry_bias + scale * sums[0]);
    for (int a = 0; a < 3; ++a) found.gradient[a] = per_metre * sums[a + 1];
    found.region = found.depth > 0.0 ? PALPATE_REGION_CONTACT : PALPATE_REGION_FREE;
}

void look_along(const palpate_field& field, const double from[3], const double to[3], const double* start_normal,
                stroke& seen) noexcept {
    seen = stroke{};
    const double step[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    const double length = std::sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]);
    const double parts = length * field.geometry.inverse_spacing;
    if (!(parts < stroke_sample_limit)) {
        seen.too_long = true;
        return;
    }
    bool touching = start_normal != nullptr;
    if (touching) {
        for (int a = 0; a < 3; ++a) seen.normal[a] = start_normal[a];
    }
    const auto count = static_cast<std::int32_t>(parts) + 1;
    for (std::int32_t i = 1; i < count; ++i) {
        const double t = static_cast<double>(i) / static_cast<double>(count);
        const double q[3] = {from[0] + t * step[0], from[1] + t * step[1], from[2] + t * step[2]};
        location at;
        locate(field, q, at);
        const double* g = at.gradient;
        switch (at.region) {
            case PALPATE_REGION_CONTACT:
                seen.touched = true;
                if (!touching) {
                    touching = true;
                    for (int a = 0; a < 3; ++a) seen.normal[a] = g[a];
                }
                seen.turned = seen.turned || g[0] * seen.normal[0] + g[1] * seen.normal[1] + g[2] * seen.normal[2] < 0.0;
                break;
            case PALPATE_REGION_DEEP:
                seen.deep = true;
                break;
            case PALPATE_REGION_UNREACHED:
                seen.unreached = true;
                break;
            default:
                if (touching) {
                    seen.left = true;
                    touching = false;
                    for (double& n : seen.normal) n = 0.0;
                }
                break;
        }
    }
}

}  // namespace palpate
