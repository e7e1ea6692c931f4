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

palpate_region unknown_cell(const palpate_field& field, const double q[3]) noexcept {
    const lattice& L = field.geometry;
    std::int32_t i[3];
    for (int a = 0; a < 3; ++a) {
        const double u = (q[a] - L.origin[a]) * L.inverse_spacing;
        if (!(u >= -2.0 && u < L.last[a] + 2.0)) return PALPATE_REGION_OUTSIDE;
        i[a] = floor_of(u);
    }
    const auto row_at = [&L](const std::int32_t j[3]) {  // of the block of coefficient j; beyond the box is outside
        bool in_box = true;
        for (int a = 0; a < 3; ++a) in_box = in_box && j[a] >= 0 && j[a] < 4 * L.blocks[a];
        return in_box ? L.index[(j[0] >> 2) * L.row_step[0] + (j[1] >> 2) * L.row_step[1] + (j[2] >> 2)] : absent_outside;
    };
    bool unreached = false, stored = false;
    for (std::int32_t corner = 0; corner < 8; ++corner) {  // the first and the last taps lie in every block there is
        const std::int32_t j[3] = {i[0] + (corner >> 1 & 2), i[1] + (corner & 2), i[2] + (corner << 1 & 2)};
        const std::int32_t row = row_at(j);
        if (row == absent_inside) return PALPATE_REGION_DEEP;
        unreached = unreached || (row < 0 && row != absent_outside);
        stored = stored || row >= 0;
    }
    if (unreached) return PALPATE_REGION_UNREACHED;
    if (!stored) return PALPATE_REGION_OUTSIDE;
    for (std::int32_t tap = 0; tap < 27; ++tap) {
        const std::int32_t j[3] = {i[0] + tap / 9, i[1] + tap / 3 % 3, i[2] + tap % 3};
        const std::int32_t row = row_at(j);
        if (row < 0) continue;
        const std::int64_t at = static_cast<std::int64_t>(row) * 64 + (j[0] & 3) * 16 + (j[1] & 3) * 4 + (j[2] & 3);
        const double c = field.geometry_bias + field.geometry_scale * static_cast<double>(field.geometry_coefficients[at]);
        if (!(c >= field.tool_offset)) return PALPATE_REGION_UNREACHED;
    }
    return PALPATE_REGION_OUTSIDE;
}

}  // namespace

void locate_unknown(const palpate_field& field, double x, double y, double z, location& found) PALPATE_REAL_TIME {
    const double q[3] = {x, y, z};
    found.region = unknown_cell(field, q);
    found.depth = 0.0;
    found.gradient[0] = found.gradient[1] = found.gradient[2] = 0.0;
}

void locate(const palpate_field& field, const double q[3], location& found) PALPATE_REAL_TIME {
    distance_cell cell;
    forget(cell);
    locate(field, q[0], q[1], q[2], cell, found);
}

void look_along(const palpate_field& field, const double from[3], const double to[3], const double* start_normal,
                stroke& seen) PALPATE_REAL_TIME {
    seen = stroke{};
    const double step[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    const double length = std::sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]);
    const double parts = length * field.geometry.inverse_spacing;
    if (!(parts < stroke_sample_limit)) {
        seen.too_long = true;
        return;
    }
    distance_cell kept;
    forget(kept);
    bool touching = start_normal != nullptr;
    if (touching) {
        for (int a = 0; a < 3; ++a) seen.normal[a] = start_normal[a];
    }
    const auto count = static_cast<std::int32_t>(parts) + 1;
    for (std::int32_t i = 1; i < count; ++i) {
        const double t = static_cast<double>(i) / static_cast<double>(count);
        const double q[3] = {from[0] + t * step[0], from[1] + t * step[1], from[2] + t * step[2]};
        location at;
        locate(field, q[0], q[1], q[2], kept, at);
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
