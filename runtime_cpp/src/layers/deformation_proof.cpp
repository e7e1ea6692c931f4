// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <initializer_list>

#include "layers/deformation.h"

namespace palpate {
namespace {

constexpr double smallest_length = 1e-7;  // m

template <typename number>
const number* take(const unsigned char* begin, std::uint64_t& at, std::uint64_t count) noexcept {
    const auto* found = reinterpret_cast<const number*>(begin + at);  // doubles lie before floats, from an aligned header on
    at += count * sizeof(number);
    return found;
}

template <typename number>
bool all_bounded(const number* values, std::uint64_t count, double limit) noexcept {
    for (std::uint64_t i = 0; i < count; ++i) {
        if (!bounded(static_cast<double>(values[i]), limit)) return false;
    }
    return true;
}

bool length_like(double x) noexcept { return x >= smallest_length && x <= length_limit; }

}  // namespace

std::uint64_t deformation_size(const deformation_header& h, const unsigned char* begin, deformation_arrays& a) noexcept {
    const std::uint64_t table = static_cast<std::uint64_t>(h.depth_count) * h.radial_count;
    std::uint64_t at = sizeof(deformation_header);
    a.node = take<double>(begin, at, 3ull * h.node_count);
    a.normal = take<double>(begin, at, 3ull * h.node_count);
    a.mean = take<double>(begin, at, h.rank[0]);
    a.weight = take<double>(begin, at, h.node_count * deformation_columns(h));
    a.table[0] = take<float>(begin, at, h.rank[0] * table * 2);
    a.table[1] = take<float>(begin, at, h.rank[1] * table * 3);
    a.table[2] = take<float>(begin, at, h.rank[2] * table * 3);
    a.stuck = take<float>(begin, at, table * 3);
    a.gap = take<float>(begin, at, static_cast<std::uint64_t>(h.gap_count[0]) * h.gap_count[1]);
    return (at + 7) / 8 * 8;
}

bool prove_deformation(const layer_bytes& bytes, const rfield_header&, refusal& why) noexcept {
    const auto bad = [&why](const char* what) { return refuse(why, PALPATE_BAD_LAYER, "The effect deformation has %s.", what); };
    deformation_header h;
    if (bytes.size < sizeof h) return bad("too few bytes");
    std::memcpy(&h, bytes.begin, sizeof h);
    if (h.magic != deformation_magic || h.version != deformation_version) return bad("another layout than this runtime's: cook again");
    for (const std::uint32_t rank : h.rank) {
        if (rank > deformation_rank_limit) return bad("too many tables");
    }
    if (h.rank[0] == 0 || h.node_count == 0 || h.node_count > deformation_node_limit) return bad("no tables, or no or too many nodes");
    for (const std::uint32_t count : {h.radial_count, h.depth_count}) {
        if (count < 3 || count > deformation_knot_limit) return bad("too few or too many knots");
    }
    for (const std::uint32_t count : h.gap_count) {
        if (count < 2 || count > deformation_gap_limit) return bad("a tool's distance of a wrong size");
    }
    for (const double x : {h.depth_end, h.scale, h.radius, h.normal_length, h.length[0], h.length[1], h.length[2], h.gap_step}) {
        if (!length_like(x)) return bad("a length that is none");
    }
    deformation_arrays a;
    if (deformation_size(h, bytes.begin, a) != bytes.size) return bad("a size that its counts do not give");
    const std::uint64_t table = static_cast<std::uint64_t>(h.depth_count) * h.radial_count;
    const bool finite = all_bounded(h.error, 5, length_limit) && all_bounded(a.node, 3ull * h.node_count, length_limit) &&
                        all_bounded(a.normal, 3ull * h.node_count, 1.1) && all_bounded(a.mean, h.rank[0], amplitude_limit) &&
                        all_bounded(a.weight, h.node_count * deformation_columns(h), curve_limit) &&
                        all_bounded(a.table[0], h.rank[0] * table * 2, length_limit) &&
                        all_bounded(a.table[1], h.rank[1] * table * 3, length_limit) &&
                        all_bounded(a.table[2], h.rank[2] * table * 3, length_limit) && all_bounded(a.stuck, table * 3, length_limit) &&
                        all_bounded(a.gap, static_cast<std::uint64_t>(h.gap_count[0]) * h.gap_count[1], length_limit);
    return finite || refuse(why, PALPATE_NOT_FINITE, "The effect deformation has a number that is not finite or beyond any physical size.");
}

}  // namespace palpate
