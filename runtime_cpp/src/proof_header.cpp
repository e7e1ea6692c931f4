// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// What the header says: identity, numbers, counts, and where the sections lie.
#include <cstring>

#include "crc32.h"
#include "proof.h"

namespace palpate {
namespace {

constexpr std::uint32_t edge_limit = 4096;     // blocks along an axis
constexpr std::uint64_t block_limit = 1u << 24;  // blocks in a box, and stored
constexpr std::uint32_t interval_limit = 65536;
constexpr double way_gap = 1e-6;               // smallest step of cosine between ways; a blend divides by it

bool check_text(const char* text, std::size_t size, const char* name, refusal& why) noexcept {
    if (std::memchr(text, 0, size) == nullptr) return refuse(why, PALPATE_BAD_LAYOUT, "%s does not end.", name);
    return true;
}

bool check_blocks(const std::uint32_t blocks[3], std::uint32_t stored, const char* name, std::uint64_t& count,
                  refusal& why) noexcept {
    count = 1;
    for (int a = 0; a < 3; ++a) {
        if (blocks[a] == 0 || blocks[a] > edge_limit) {
            return refuse(why, PALPATE_BAD_LAYOUT, "%s has %u blocks along an axis: 1 to %u is right.", name,
                          static_cast<unsigned>(blocks[a]), static_cast<unsigned>(edge_limit));
        }
        count *= blocks[a];
    }
    if (count > block_limit || stored == 0 || stored > block_limit) {
        return refuse(why, PALPATE_BAD_LAYOUT, "%s has %llu blocks, %u stored: 1 to %llu is right.", name,
                      static_cast<unsigned long long>(count), static_cast<unsigned>(stored),
                      static_cast<unsigned long long>(block_limit));
    }
    return true;
}

// Ways of touching: cosines fall from 1 at most, offsets are lengths and the largest is the tool's.
bool check_ways(const rfield_header& h, refusal& why) noexcept {
    if (h.way_count == 0 || h.way_count > rfield_way_limit) {
        return refuse(why, PALPATE_BAD_LAYOUT, "%u ways of touching: 1 to %u is right.", static_cast<unsigned>(h.way_count),
                      static_cast<unsigned>(rfield_way_limit));
    }
    double largest = 0.0;
    for (std::uint32_t w = 0; w < h.way_count; ++w) {
        const double c = h.way_cosine[w], above = w == 0 ? 1.0 + 2.0 * way_gap : h.way_cosine[w - 1];
        if (!(c >= 0.0 && c <= 1.0 && above - c >= way_gap)) {
            return refuse(why, PALPATE_NOT_FINITE, "way_cosine %u is %g: 0 to 1, each clearly below the one before is right.",
                          static_cast<unsigned>(w), c);
        }
        if (!(h.way_offset[w] >= 0.0 && h.way_offset[w] <= h.tool_offset)) {
            return refuse(why, PALPATE_NOT_FINITE, "way_offset %u is %g: 0 to %g is right.", static_cast<unsigned>(w),
                          h.way_offset[w], h.tool_offset);
        }
        largest = largest < h.way_offset[w] ? h.way_offset[w] : largest;
    }
    if (!(largest == h.tool_offset)) {
        return refuse(why, PALPATE_NOT_FINITE, "tool_offset is %g: the largest way_offset, %g, is right.", h.tool_offset, largest);
    }
    return true;
}

}  // namespace

bool check_identity(const unsigned char* data, std::size_t size, rfield_header& h, refusal& why) noexcept {
    std::size_t shortest = sizeof h;
    for (const auto& older : rfield_older_versions) {
        if (older.header_size < shortest) shortest = older.header_size;
    }
    if (size < shortest) {
        return refuse(why, PALPATE_TRUNCATED, "%llu bytes are fewer than the header's %llu.", static_cast<unsigned long long>(size),
                      static_cast<unsigned long long>(shortest));
    }
    h = rfield_header{};
    std::memcpy(&h, data, shortest);
    if (std::memcmp(h.magic, rfield_magic, sizeof h.magic) != 0) {
        return refuse(why, PALPATE_NOT_RFIELD, "The first bytes are not PALPRFLD: this is not an .rfield.");
    }
    std::uint64_t layout_hash = rfield_layout_hash;
    std::uint32_t header_size = sizeof h;
    bool known = h.version == rfield_version;
    for (const auto& older : rfield_older_versions) {
        if (h.version != older.version) continue;
        known = true;
        layout_hash = older.layout_hash;
        header_size = older.header_size;
    }
    if (!known || h.layout_hash != layout_hash || h.header_size != header_size || h.section_count != rfield_section_count) {
        return refuse(why, PALPATE_WRONG_VERSION, "The file has layout version %u, this runtime reads versions up to %u: cook it again.",
                      static_cast<unsigned>(h.version), static_cast<unsigned>(rfield_version));
    }
    if (h.file_size != size || size < header_size) {
        return refuse(why, PALPATE_TRUNCATED, "The header says %llu bytes, there are %llu.",
                      static_cast<unsigned long long>(h.file_size), static_cast<unsigned long long>(size));
    }
    std::memcpy(&h, data, header_size);
    rfield_header blank = h;
    blank.checksum = 0;
    std::uint32_t crc = crc32(0, reinterpret_cast<const unsigned char*>(&blank), header_size);
    crc = crc32(crc, data + header_size, size - header_size);
    if (crc != h.checksum) return refuse(why, PALPATE_DAMAGED, "The checksum does not fit: the file is damaged.");
    if (h.version < 2) {
        h.way_count = 1;
        h.way_cosine[0] = 1.0;
        h.way_offset[0] = h.tool_offset;
    }
    return true;
}

bool check_header(const rfield_header& h, std::uint64_t elements[rfield_section_count], refusal& why) noexcept {
    if (!check_text(h.tool_name, sizeof h.tool_name, "tool_name", why) ||
        !check_text(h.tool_shape, sizeof h.tool_shape, "tool_shape", why) ||
        !check_text(h.tool_hash, sizeof h.tool_hash, "tool_hash", why) ||
        !check_text(h.field_hash, sizeof h.field_hash, "field_hash", why)) {
        return false;
    }
    const struct {
        const char* name;
        double value, low, high;
    } numbers[] = {
        {"tool_offset", h.tool_offset, 0.0, 1.0},
        {"depth_max", h.depth_max, 1e-9, 1.0},
        {"stiffness_max", h.stiffness_max, 0.0, curve_limit},
        {"band[0]", h.band[0], -length_limit, h.band[1]},
        {"band[1]", h.band[1], -length_limit, length_limit},
        {"geometry_error_p99", h.geometry_error_p99, 0.0, length_limit},
        {"geometry_flagged_share", h.geometry_flagged_share, 0.0, 1.0},
        {"geometry_origin x", h.geometry_origin[0], -length_limit, length_limit},
        {"geometry_origin y", h.geometry_origin[1], -length_limit, length_limit},
        {"geometry_origin z", h.geometry_origin[2], -length_limit, length_limit},
        {"geometry_spacing", h.geometry_spacing, 1e-6, 1.0},
        {"geometry_scale", h.geometry_scale, 1e-15, 1e-3},
        {"geometry_bias", h.geometry_bias, -length_limit, length_limit},
        {"amplitude_origin x", h.amplitude_origin[0], -length_limit, length_limit},
        {"amplitude_origin y", h.amplitude_origin[1], -length_limit, length_limit},
        {"amplitude_origin z", h.amplitude_origin[2], -length_limit, length_limit},
        {"amplitude_spacing", h.amplitude_spacing, 1e-6, 1.0},
        {"energy_depth_end", h.energy_depth_end, 1e-6, 1.0},
        {"stiffness_depth_end", h.stiffness_depth_end, 1e-6, 1.0},
        {"friction_depth_end", h.friction_depth_end, 1e-6, 1.0},
    };
    for (const auto& n : numbers) {
        if (!(n.value >= n.low && n.value <= n.high)) {
            return refuse(why, PALPATE_NOT_FINITE, "%s is %g: %g to %g is right.", n.name, n.value, n.low, n.high);
        }
    }
    if (!check_ways(h, why)) return false;
    const std::uint32_t curve_counts[3] = {h.energy_curve_count, h.stiffness_curve_count, h.friction_curve_count};
    const std::uint32_t interval_counts[3] = {h.energy_intervals, h.stiffness_intervals, h.friction_intervals};
    std::uint64_t channels = 0;
    for (int k = 0; k < 3; ++k) {
        channels += curve_counts[k];
        if (curve_counts[k] > rfield_channel_limit || interval_counts[k] == 0 || interval_counts[k] > interval_limit) {
            return refuse(why, PALPATE_BAD_LAYOUT, "%u curves on %u intervals: at most %u on 1 to %u is right.",
                          static_cast<unsigned>(curve_counts[k]), static_cast<unsigned>(interval_counts[k]),
                          static_cast<unsigned>(rfield_channel_limit), static_cast<unsigned>(interval_limit));
        }
    }
    if (h.energy_curve_count == 0 || h.channel_stride % 4 != 0 || h.channel_stride == 0 ||
        h.channel_stride > rfield_channel_limit || channels > h.channel_stride) {
        return refuse(why, PALPATE_BAD_LAYOUT, "%u channels for %llu curves: a multiple of 4, enough and at most %u is right.",
                      static_cast<unsigned>(h.channel_stride), static_cast<unsigned long long>(channels),
                      static_cast<unsigned>(rfield_channel_limit));
    }
    if (!check_blocks(h.geometry_blocks, h.geometry_stored, "geometry", elements[section_geometry_index], why) ||
        !check_blocks(h.amplitude_blocks, h.amplitude_stored, "amplitude", elements[section_amplitude_index], why)) {
        return false;
    }
    elements[section_geometry_coefficients] = 64ull * h.geometry_stored;
    elements[section_amplitude_coefficients] = 64ull * h.amplitude_stored * h.way_count * h.channel_stride;
    elements[section_energy_curves] = 4ull * (h.energy_intervals + 1ull) * h.energy_curve_count;
    elements[section_stiffness_curves] = 4ull * (h.stiffness_intervals + 1ull) * h.stiffness_curve_count;
    elements[section_friction_curves] = 4ull * (h.friction_intervals + 1ull) * h.friction_curve_count;
    elements[section_provenance] = h.section_elements[section_provenance];
    return true;
}

bool check_sections(const rfield_header& h, const std::uint64_t elements[rfield_section_count], refusal& why) noexcept {
    std::uint64_t end = h.header_size;
    for (std::uint32_t i = 0; i < rfield_section_count; ++i) {
        const std::uint64_t offset = h.section_offset[i];
        const std::uint64_t count = h.section_elements[i];
        const std::uint64_t element = rfield_element_size[i];
        if (h.section_element_size[i] != element || count != elements[i] || offset % rfield_section_alignment != 0 ||
            offset < end || offset > h.file_size || count > (h.file_size - offset) / element) {
            return refuse(why, PALPATE_BAD_LAYOUT, "Section %u (%llu elements at byte %llu) does not fit its counts or the file.",
                          static_cast<unsigned>(i), static_cast<unsigned long long>(count),
                          static_cast<unsigned long long>(offset));
        }
        end = offset + count * element;
    }
    return true;
}

}  // namespace palpate
