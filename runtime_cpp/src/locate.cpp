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

#include "stencil.h"

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

    // The rows of the (up to) 8 blocks under the stencil; the same one twice where it does not cross.
    std::int32_t row[2][2][2];
    std::int32_t any = 0;
    const std::int32_t cross[3] = {next_block(x, 2), next_block(y, 2), next_block(z, 2)};
    for (int a = 0; a < 2; ++a) {
        for (int b = 0; b < 2; ++b) {
            const std::int32_t* line =
                L.index + (static_cast<std::int64_t>(x.block + a * cross[0]) * L.blocks[1] + y.block + b * cross[1]) * L.blocks[2] +
                z.block;
            row[a][b][0] = line[0];
            row[a][b][1] = line[cross[2]];
            any |= row[a][b][0] | row[a][b][1];
        }
    }
    if (any < 0) {
        const bool all_outside = row[0][0][0] == absent_outside && row[0][0][1] == absent_outside &&
                                 row[0][1][0] == absent_outside && row[0][1][1] == absent_outside &&
                                 row[1][0][0] == absent_outside && row[1][0][1] == absent_outside &&
                                 row[1][1][0] == absent_outside && row[1][1][1] == absent_outside;
        found.region = all_outside ? PALPATE_REGION_OUTSIDE : unknown_cell(field, u);
        return;
    }

    // phi = sum wx wy wz C and its derivatives, in counts; along z first, then y, then x.
    const std::int32_t z_next[3] = {0, next_block(z, 1), cross[2]};
    const std::int32_t z_place[3] = {z.place, place_of(z, 1), place_of(z, 2)};
    double value = 0.0, gx = 0.0, gy = 0.0, gz = 0.0;
    for (std::int32_t a = 0; a < 3; ++a) {
        double s = 0.0, sy = 0.0, sz = 0.0;
        for (std::int32_t b = 0; b < 3; ++b) {
            const std::int32_t* pair = row[next_block(x, a)][next_block(y, b)];
            const std::int32_t column = place_of(x, a) * 16 + place_of(y, b) * 4;
            const std::int16_t* block[2] = {field.geometry_coefficients + static_cast<std::int64_t>(pair[0]) * 64 + column,
                                            field.geometry_coefficients + static_cast<std::int64_t>(pair[1]) * 64 + column};
            const double c0 = static_cast<double>(block[0][z_place[0]]);
            const double c1 = static_cast<double>(block[z_next[1]][z_place[1]]);
            const double c2 = static_cast<double>(block[z_next[2]][z_place[2]]);
            const double v = z.w[0] * c0 + z.w[1] * c1 + z.w[2] * c2;
            const double dv = z.d[0] * c0 + z.d[1] * c1 + z.d[2] * c2;
            s += y.w[b] * v;
            sy += y.d[b] * v;
            sz += y.w[b] * dv;
        }
        value += x.w[a] * s;
        gx += x.d[a] * s;
        gy += x.w[a] * sy;
        gz += x.w[a] * sz;
    }
    const double per_metre = field.geometry_scale * L.inverse_spacing;
    found.depth = field.tool_offset - (field.geometry_bias + field.geometry_scale * value);
    found.gradient[0] = per_metre * gx;
    found.gradient[1] = per_metre * gy;
    found.gradient[2] = per_metre * gz;
    found.region = found.depth > 0.0 ? PALPATE_REGION_CONTACT : PALPATE_REGION_FREE;
}

void look_along(const palpate_field& field, const double from[3], const double to[3], bool starts_in_contact,
                stroke& seen) noexcept {
    seen = stroke{};
    const double step[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    const double length = std::sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]);
    const double parts = length * field.geometry.inverse_spacing;
    if (!(parts < stroke_sample_limit)) {
        seen.too_long = true;
        return;
    }
    const auto count = static_cast<std::int32_t>(parts) + 1;
    bool touching = starts_in_contact;
    for (std::int32_t i = 1; i < count; ++i) {
        const double t = static_cast<double>(i) / static_cast<double>(count);
        const double q[3] = {from[0] + t * step[0], from[1] + t * step[1], from[2] + t * step[2]};
        location at;
        locate(field, q, at);
        switch (at.region) {
            case PALPATE_REGION_CONTACT:
                if (!touching && !seen.has_normal) {
                    seen.has_normal = true;
                    for (int a = 0; a < 3; ++a) seen.gradient[a] = at.gradient[a];
                }
                seen.touched = touching = true;
                break;
            case PALPATE_REGION_DEEP:
                seen.deep = true;
                break;
            case PALPATE_REGION_UNREACHED:
                seen.unreached = true;
                break;
            default:
                seen.left = seen.left || touching;
                touching = false;
                break;
        }
    }
}

}  // namespace palpate
