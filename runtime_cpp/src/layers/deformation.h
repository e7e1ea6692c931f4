// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// The layer `deformation` of an .rfield, as fields/deformation_layout.py lists it: how the surface moves, for graphics.
#ifndef PALPATE_SRC_LAYERS_DEFORMATION_H
#define PALPATE_SRC_LAYERS_DEFORMATION_H

#include <cstddef>
#include <cstdint>

#include "layers/layers.h"

namespace palpate {

constexpr std::uint32_t deformation_magic = 0x4D464544u;  // DEFM
constexpr std::uint32_t deformation_version = 1;
constexpr std::uint32_t deformation_rank_limit = 8;
constexpr std::uint32_t deformation_knot_limit = 64;  // radial and of depth
constexpr std::uint32_t deformation_node_limit = 4096;
constexpr std::uint32_t deformation_gap_limit = 512;

struct deformation_header {
    std::uint32_t magic;
    std::uint32_t version;
    std::uint32_t rank[3];        // shared tables of harmonics 0, 1, 2
    std::uint32_t node_count;     // N
    std::uint32_t radial_count;   // J
    std::uint32_t depth_count;    // K
    std::uint32_t gap_count[2];   // heights, distances
    double depth_end;             // m
    double scale;                 // m
    double radius;                // m
    double normal_length;         // m
    double length[3];             // m
    double gap_step;              // m
    double error[5];              // p95, max (shares of the depth), p95, max, within (m); -1: not judged
};
static_assert(offsetof(deformation_header, rank) == 8, "deformation layout");
static_assert(offsetof(deformation_header, node_count) == 20, "deformation layout");
static_assert(offsetof(deformation_header, gap_count) == 32, "deformation layout");
static_assert(offsetof(deformation_header, depth_end) == 40, "deformation layout");
static_assert(offsetof(deformation_header, length) == 72, "deformation layout");
static_assert(offsetof(deformation_header, error) == 104, "deformation layout");
static_assert(sizeof(deformation_header) == 144, "deformation layout");

// Where its arrays are.
struct deformation_arrays {
    const double *node, *normal;    // (N, 3)
    const double* mean;             // (rank[0],)
    const double* weight;           // (N, rank[0] + 3 rank[1] + 6 rank[2])
    const float* table[3];          // (rank, K, J, 2 or 3)
    const float* stuck;             // (K, J, 3)
    const float* gap;               // heights x distances
};

inline std::uint64_t deformation_columns(const deformation_header& h) noexcept {
    return h.rank[0] + 3ull * h.rank[1] + 6ull * h.rank[2];
}

// Bytes of the whole layer; `at` of a header whose counts are within their limits.
std::uint64_t deformation_size(const deformation_header& h, const unsigned char* begin, deformation_arrays& at) noexcept;

bool prove_deformation(const layer_bytes& bytes, const rfield_header& h, refusal& why) noexcept;

}  // namespace palpate

#endif
