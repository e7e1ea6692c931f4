// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Generated from fields/rfield_layout.py: python -m palpate.fields.rfield_layout > this file. Do not edit.
#ifndef PALPATE_SRC_RFIELD_LAYOUT_H
#define PALPATE_SRC_RFIELD_LAYOUT_H

#include <cstddef>
#include <cstdint>

namespace palpate {

constexpr char rfield_magic[9] = "PALPRFLD";
constexpr std::uint32_t rfield_version = 3;
constexpr std::uint64_t rfield_layout_hash = 0x92ca1d89caa684feu;
constexpr std::uint32_t rfield_way_limit = 4;
constexpr std::uint64_t rfield_section_alignment = 64;
constexpr std::uint32_t rfield_channel_limit = 16;
constexpr std::uint32_t rfield_section_count = 8;
constexpr std::uint32_t rfield_layer_limit = 8;

// Older versions that are read: their header is the beginning of this one.
struct rfield_older_version {
    std::uint32_t version;
    std::uint64_t layout_hash;
    std::uint32_t header_size;
};
constexpr rfield_older_version rfield_older_versions[] = {
    {1, 0xc7f09ab8c07d2981u, 680},
    {2, 0x7f38e7c7022e4f4au, 752},
};

enum rfield_section : std::uint32_t {
    section_geometry_index = 0,  // (geometry_blocks) i32: block row; -1 free, -2 deeper than the band, -3 unreached
    section_geometry_coefficients = 1,  // (geometry_stored, 4, 4, 4) i16: phi coefficient = geometry_bias + geometry_scale * value
    section_amplitude_index = 2,  // (amplitude_blocks) i32: block row; 0 (the zero block) where nothing is stored
    section_amplitude_coefficients = 3,  // (amplitude_stored, 4, 4, 4, way_count, channel_stride) f32: row 0 is all zero; channels a_r, b_r, m_r, then zero padding
    section_energy_curves = 4,  // (energy_intervals + 1, energy_curve_count, 4) f64: c0..c3 by interval [J/m^j]; the last row continues beyond depth_end with c3 = 0
    section_stiffness_curves = 5,  // (stiffness_intervals + 1, stiffness_curve_count, 4) f64: the same, N/m
    section_friction_curves = 6,  // (friction_intervals + 1, friction_curve_count, 4) f64: the same, dimensionless
    section_provenance = 7,  // (bytes) char: JSON text, UTF-8, keys sorted
};

enum rfield_layer : std::uint32_t {
    layer_texture = 0,
    layer_transient = 1,
    layer_deformation = 2,
    layer_rigid = 3,
    layer_count = 4
};

constexpr std::uint32_t rfield_element_size[rfield_section_count] = {
    4, 2, 4, 4, 8, 8, 8, 1};

struct rfield_header {
    char magic[8];  // PALPRFLD
    std::uint32_t version;  // of the layout
    std::uint32_t header_size;  // (byte) section table included
    std::uint64_t layout_hash;  // of this list; a file written by another list is refused
    std::uint64_t file_size;  // (byte)
    std::uint32_t checksum;  // CRC-32 of the file with this field zero
    std::uint32_t section_count;
    char tool_name[64];  // NUL-terminated UTF-8
    char tool_shape[32];  // NUL-terminated UTF-8
    char tool_hash[80];  // NUL-terminated hex digest
    char field_hash[80];  // NUL-terminated sha256 of every section before provenance
    double tool_offset;  // (m) rho: depth = rho - phi(q); the largest of the ways'
    double depth_max;  // (m) deepest press; beyond it the curves continue and the status says so
    double stiffness_max;  // (N/m) sigma: largest stiffness of energy and friction spring up to depth_max
    double band[2];  // (m) smallest and largest phi meant to be read
    double geometry_error_p99;  // (m) 99th percentile of |lattice - mesh distance|
    double geometry_flagged_share;  // (fraction) share of the band where |grad phi| < 0.9
    double geometry_origin[3];  // (m) organ axes
    double geometry_spacing;  // (m)
    double geometry_scale;  // (m) one count of the int16 coefficients
    double geometry_bias;  // (m) phi coefficient of count zero
    std::uint32_t geometry_blocks[3];  // blocks along x, y, z
    std::uint32_t geometry_stored;  // stored blocks
    double amplitude_origin[3];  // (m) organ axes
    double amplitude_spacing;  // (m)
    std::uint32_t amplitude_blocks[3];  // blocks along x, y, z
    std::uint32_t amplitude_stored;  // stored blocks, the zero block included
    std::uint32_t channel_stride;  // floats from one way to the next; a multiple of 4
    std::uint32_t energy_curve_count;
    std::uint32_t stiffness_curve_count;
    std::uint32_t friction_curve_count;
    std::uint32_t energy_intervals;
    std::uint32_t stiffness_intervals;
    std::uint32_t friction_intervals;
    std::uint32_t reserved;  // zero
    double energy_depth_end;  // (m)
    double stiffness_depth_end;  // (m)
    double friction_depth_end;  // (m)
    std::uint64_t section_offset[8];  // (byte) from the start of the file
    std::uint64_t section_elements[8];  // elements in the section
    std::uint32_t section_element_size[8];  // (byte)
    std::uint32_t way_count;  // ways of touching, 1 to WAY_LIMIT; since version 2, as all below
    std::uint32_t reserved_2;  // zero
    double way_cosine[4];  // of tool axis and outward normal, falling from way to way; then zeros
    double way_offset[4];  // (m) rho of each way; then zeros
    std::uint64_t layer_offset[8];  // (byte) 0 where there is none; since version 3, as all below
    std::uint64_t layer_size[8];  // (byte) 0 where there is none
};

static_assert(offsetof(rfield_header, magic) == 0, "rfield layout");
static_assert(offsetof(rfield_header, version) == 8, "rfield layout");
static_assert(offsetof(rfield_header, header_size) == 12, "rfield layout");
static_assert(offsetof(rfield_header, layout_hash) == 16, "rfield layout");
static_assert(offsetof(rfield_header, file_size) == 24, "rfield layout");
static_assert(offsetof(rfield_header, checksum) == 32, "rfield layout");
static_assert(offsetof(rfield_header, section_count) == 36, "rfield layout");
static_assert(offsetof(rfield_header, tool_name) == 40, "rfield layout");
static_assert(offsetof(rfield_header, tool_shape) == 104, "rfield layout");
static_assert(offsetof(rfield_header, tool_hash) == 136, "rfield layout");
static_assert(offsetof(rfield_header, field_hash) == 216, "rfield layout");
static_assert(offsetof(rfield_header, tool_offset) == 296, "rfield layout");
static_assert(offsetof(rfield_header, depth_max) == 304, "rfield layout");
static_assert(offsetof(rfield_header, stiffness_max) == 312, "rfield layout");
static_assert(offsetof(rfield_header, band) == 320, "rfield layout");
static_assert(offsetof(rfield_header, geometry_error_p99) == 336, "rfield layout");
static_assert(offsetof(rfield_header, geometry_flagged_share) == 344, "rfield layout");
static_assert(offsetof(rfield_header, geometry_origin) == 352, "rfield layout");
static_assert(offsetof(rfield_header, geometry_spacing) == 376, "rfield layout");
static_assert(offsetof(rfield_header, geometry_scale) == 384, "rfield layout");
static_assert(offsetof(rfield_header, geometry_bias) == 392, "rfield layout");
static_assert(offsetof(rfield_header, geometry_blocks) == 400, "rfield layout");
static_assert(offsetof(rfield_header, geometry_stored) == 412, "rfield layout");
static_assert(offsetof(rfield_header, amplitude_origin) == 416, "rfield layout");
static_assert(offsetof(rfield_header, amplitude_spacing) == 440, "rfield layout");
static_assert(offsetof(rfield_header, amplitude_blocks) == 448, "rfield layout");
static_assert(offsetof(rfield_header, amplitude_stored) == 460, "rfield layout");
static_assert(offsetof(rfield_header, channel_stride) == 464, "rfield layout");
static_assert(offsetof(rfield_header, energy_curve_count) == 468, "rfield layout");
static_assert(offsetof(rfield_header, stiffness_curve_count) == 472, "rfield layout");
static_assert(offsetof(rfield_header, friction_curve_count) == 476, "rfield layout");
static_assert(offsetof(rfield_header, energy_intervals) == 480, "rfield layout");
static_assert(offsetof(rfield_header, stiffness_intervals) == 484, "rfield layout");
static_assert(offsetof(rfield_header, friction_intervals) == 488, "rfield layout");
static_assert(offsetof(rfield_header, reserved) == 492, "rfield layout");
static_assert(offsetof(rfield_header, energy_depth_end) == 496, "rfield layout");
static_assert(offsetof(rfield_header, stiffness_depth_end) == 504, "rfield layout");
static_assert(offsetof(rfield_header, friction_depth_end) == 512, "rfield layout");
static_assert(offsetof(rfield_header, section_offset) == 520, "rfield layout");
static_assert(offsetof(rfield_header, section_elements) == 584, "rfield layout");
static_assert(offsetof(rfield_header, section_element_size) == 648, "rfield layout");
static_assert(offsetof(rfield_header, way_count) == 680, "rfield layout");
static_assert(offsetof(rfield_header, reserved_2) == 684, "rfield layout");
static_assert(offsetof(rfield_header, way_cosine) == 688, "rfield layout");
static_assert(offsetof(rfield_header, way_offset) == 720, "rfield layout");
static_assert(offsetof(rfield_header, layer_offset) == 752, "rfield layout");
static_assert(offsetof(rfield_header, layer_size) == 816, "rfield layout");
static_assert(sizeof(rfield_header) == 880, "rfield layout");

}  // namespace palpate

#endif
