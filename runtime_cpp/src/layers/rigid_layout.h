// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Cooked rigid objects, byte for byte; the list that fields/rigid_layout.py has in Python (a test compares them).
// Little endian: header, elements (held first), pairs, numbers, indices, merges, formations; each section 64-byte aligned.
#ifndef PALPATE_SRC_LAYERS_RIGID_LAYOUT_H
#define PALPATE_SRC_LAYERS_RIGID_LAYOUT_H

#include <cstdint>

namespace palpate {

constexpr std::uint32_t rigid_magic = 0x44474952;  // "RIGD"
constexpr std::uint32_t rigid_version = 1;
constexpr std::uint32_t rigid_element_limit = 1024, rigid_pair_limit = 1u << 17, rigid_pool_limit = 1u << 20;

struct rigid_header {
    std::uint32_t magic, version;
    std::uint64_t byte_count;
    std::uint32_t checksum, reserved;  // CRC-32 of all bytes with this word at zero
    std::uint32_t held_count, element_count;  // elements of the held object, of all
    std::uint32_t pair_count, number_count, index_count, merge_count, formation_count, formation_index_count;
    std::uint64_t elements, pairs, numbers, indices, merges, formations, formation_indices;  // byte offsets
    double threshold;            // m; eps
    double stiffness;            // N/m; K
    double damping;              // N s/m; D
    double static_friction;      // mu
    double kinetic_friction;     // mu_D
    double tangential_stiffness; // N/m; K_p
    double depth_max;            // m; deeper contact is released
    double speed_static;         // m/s; slower is at rest
    double hysteresis;           // a contact is kept up to (1 + hysteresis) eps
    double gravity[3];           // m/s2
    double mass;                 // kg
    double inertia[6];           // kg m2, about the centre of mass: xx yy zz xy yz xz, entries of the tensor (products negative)
    double held_radius;          // m; of the held object about its centre of mass
};

enum rigid_kind : std::uint32_t {
    rigid_vertex, rigid_segment, rigid_circle, rigid_polygon, rigid_disc, rigid_sphere, rigid_cylinder, rigid_cone, rigid_torus,
    rigid_paraboloid, rigid_kind_count
};

struct rigid_element {
    std::uint32_t kind;
    std::int32_t side;           // 1: solid inside; -1: a cavity (circle: the surface beside the rim faces its axis)
    std::uint32_t beside_first, beside_count;  // indices: faces that meet this face in a convex edge
    std::uint32_t up_first, up_count;          // indices: elements whose closure holds this one, itself included
    std::uint32_t number_first, number_count;  // doubles: polygon, 4 each (both ends of a boundary line, along across and axis x across);
                                               // vertex, 3 each (to the other end of each edge)
    double bound_centre[3], bound_radius;
    double centre[3], axis[3], across[3];      // frame: across, axis x across, axis
    double radius;               // m
    double size;                 // disc: inner radius; circle: axial part of the other surface's normal; cone: tangent of half angle;
                                 // torus: tube radius, m; paraboloid: 1/m, z = size rho^2
    double low, high;            // circle: axial part of the first surface's normal, low; sphere: cosine of the cap, low; 
                                 // cylinder, segment: half length, high; cone: axial range; paraboloid: height, high
    double cosine;               // cone: of its half angle
    double normal[2][3];         // segment: of the two faces beside it
};

struct rigid_pair {
    std::uint16_t held, fixed;
};

struct rigid_merge {  // sorted by key
    std::uint32_t key;     // held << 16 | fixed
    std::uint32_t region;  // 1 line, 2 plane
};

struct rigid_formation {  // sorted by hash
    std::uint64_t hash;
    std::uint32_t first, count;  // of formation_indices: keys, rising
};

static_assert(sizeof(rigid_header) == 272, "fields/rigid_layout.py has other numbers");
static_assert(sizeof(rigid_element) == 224, "fields/rigid_layout.py has other numbers");
static_assert(sizeof(rigid_pair) == 4 && sizeof(rigid_merge) == 8 && sizeof(rigid_formation) == 16, "fields/rigid_layout.py");

}  // namespace palpate

#endif
