// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// An .rfield from memory or a file: proven (proof.h), then pointed into.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>

#include "field.h"
#include "palpate/palpate.h"
#include "proof.h"

namespace palpate {
namespace {

static_assert(std::numeric_limits<double>::is_iec559 && std::numeric_limits<float>::is_iec559, "IEEE 754 is relied on");

constexpr long file_size_limit = 0x7FFFFFFF;     // bytes; a folder claims more on Linux

// Depth and gradient of the distance from its sums; the response's gradient from sums per cell.
void set_scales(palpate_field& field) noexcept {
    field.distance_scale[0] = -field.header.geometry_scale / value_sums_per_count;
    field.distance_shift[0] = field.header.tool_offset - field.header.geometry_bias;
    field.response_scale[0] = 1.0;
    for (int a = 1; a < 4; ++a) {
        field.distance_scale[a] = field.header.geometry_scale / slope_sums_per_count * field.geometry.inverse_spacing;
        field.distance_shift[a] = 0.0;
        field.response_scale[a] = field.amplitudes.inverse_spacing;
    }
}

template <class T>
const T* section(const unsigned char* data, const rfield_header& h, rfield_section i) noexcept {
    return reinterpret_cast<const T*>(data + h.section_offset[i]);
}

// Proves the aligned bytes and points `field` into them.
bool prove(const unsigned char* data, std::size_t size, palpate_field& field, refusal& why) noexcept {
    rfield_header& h = field.header;
    std::uint64_t elements[rfield_section_count];
    if (!check_identity(data, size, h, why) || !check_header(h, elements, why) || !check_sections(h, elements, why)) {
        return false;
    }
    const auto* geometry_index = section<std::int32_t>(data, h, section_geometry_index);
    const auto* amplitude_index = section<std::int32_t>(data, h, section_amplitude_index);
    const auto* amplitudes = section<float>(data, h, section_amplitude_coefficients);
    const auto* energy = section<double>(data, h, section_energy_curves);
    const auto* stiffness = section<double>(data, h, section_stiffness_curves);
    const auto* friction = section<double>(data, h, section_friction_curves);
    if (!check_index(geometry_index, elements[section_geometry_index], -3, h.geometry_stored, "Geometry", why) ||
        !check_index(amplitude_index, elements[section_amplitude_index], 0, h.amplitude_stored, "Amplitude", why) ||
        !check_amplitudes(amplitudes, elements[section_amplitude_coefficients], 64ull * h.way_count * h.channel_stride, why) ||
        !check_curves(energy, h.energy_intervals, h.energy_curve_count, h.energy_depth_end, 1, "Energy", why) ||
        !check_curves(stiffness, h.stiffness_intervals, h.stiffness_curve_count, h.stiffness_depth_end, 0, "Stiffness", why) ||
        !check_curves(friction, h.friction_intervals, h.friction_curve_count, h.friction_depth_end, 0, "Friction", why)) {
        return false;
    }

    set_lattice(field.geometry, h.geometry_origin, h.geometry_spacing, h.geometry_blocks, geometry_index, 1, 2);
    field.geometry_coefficients = section<std::int16_t>(data, h, section_geometry_coefficients);
    field.geometry_scale = h.geometry_scale;
    field.geometry_bias = h.geometry_bias;
    set_lattice(field.amplitudes, h.amplitude_origin, h.amplitude_spacing, h.amplitude_blocks, amplitude_index,
                static_cast<std::int64_t>(h.way_count) * h.channel_stride, 4);
    field.amplitude_coefficients = amplitudes;
    field.way_stride = static_cast<std::int32_t>(h.channel_stride);
    field.way_count = static_cast<std::int32_t>(h.way_count);
    const std::uint32_t channels = h.energy_curve_count + h.stiffness_curve_count + h.friction_curve_count;
    field.channels = static_cast<std::int32_t>((channels + 3) / 4 * 4);
    field.gradient_channels = static_cast<std::int32_t>((h.energy_curve_count + 3) / 4 * 4);
    field.contract = &contraction_here();
    const stored_curves kinds[3] = {{h.energy_depth_end, h.energy_intervals, h.energy_curve_count, energy},
                                    {h.stiffness_depth_end, h.stiffness_intervals, h.stiffness_curve_count, stiffness},
                                    {h.friction_depth_end, h.friction_intervals, h.friction_curve_count, friction}};
    if (!open_layers(data, h, field.layer, why)) return false;
    if (field.layer[layer_texture].begin != nullptr) set_texture(field.texture, field.layer[layer_texture]);
    field.curve_rows = static_cast<double*>(std::malloc(static_cast<std::size_t>(curve_numbers(kinds)) * sizeof(double)));
    if (field.curve_rows == nullptr) return refuse(why, PALPATE_OUT_OF_MEMORY, "There is no memory for the curves.");
    set_curves(field.curves, kinds, field.curve_rows);
    set_scales(field);
    field.tool_offset = h.tool_offset;
    field.depth_max = h.depth_max;
    field.provenance = section<char>(data, h, section_provenance);
    field.provenance_size = h.section_elements[section_provenance];
    return true;
}

void tell(char* message, std::size_t message_size, const char* sentence) noexcept {
    if (message != nullptr && message_size > 0) std::snprintf(message, message_size, "%s", sentence);
}

// A buffer of `size` bytes aligned to the sections' alignment, to be freed through *owned; null without memory.
unsigned char* aligned_buffer(std::size_t size, void** owned) noexcept {
    *owned = size <= SIZE_MAX / 2 ? std::malloc(size + rfield_section_alignment) : nullptr;
    if (*owned == nullptr) return nullptr;
    const auto at = reinterpret_cast<std::uintptr_t>(*owned);
    const auto up = (rfield_section_alignment - at % rfield_section_alignment) % rfield_section_alignment;
    return static_cast<unsigned char*>(*owned) + up;
}

// Takes over `owned` (may be null), the memory behind `data`.
palpate_status open_aligned(const unsigned char* data, std::size_t size, void* owned, palpate_field** out, char* message,
                            std::size_t message_size) noexcept {
    refusal why{};
    auto* field = static_cast<palpate_field*>(std::malloc(sizeof(palpate_field)));
    bool good = false;
    if (field == nullptr) {
        refuse(why, PALPATE_OUT_OF_MEMORY, "There is no memory for the field.");
    } else {
        new (field) palpate_field{};
        good = prove(data, size, *field, why);
    }
    if (!good) {
        if (field != nullptr) std::free(field->curve_rows);
        std::free(field);
        std::free(owned);
        tell(message, message_size, why.sentence);
        return why.status;
    }
    field->owned = owned;
    *out = field;
    tell(message, message_size, "");
    return PALPATE_OK;
}

}  // namespace
}  // namespace palpate

extern "C" {

palpate_status palpate_field_open(const void* data, size_t size, uint32_t flags, palpate_field** field, char* message,
                                  size_t message_size) noexcept {
    using namespace palpate;
    if (field != nullptr) *field = nullptr;
    const bool in_place = (flags & PALPATE_OPEN_IN_PLACE) != 0;
    if (field == nullptr || data == nullptr || (flags & ~PALPATE_OPEN_IN_PLACE) != 0) {
        tell(message, message_size, "Data or field is null, or a flag is unknown.");
        return PALPATE_BAD_ARGUMENT;
    }
    if (in_place && reinterpret_cast<std::uintptr_t>(data) % rfield_section_alignment != 0) {
        tell(message, message_size, "Data used in place must be aligned to 64 bytes.");
        return PALPATE_BAD_ARGUMENT;
    }
    if (in_place) return open_aligned(static_cast<const unsigned char*>(data), size, nullptr, field, message, message_size);
    void* owned = nullptr;
    unsigned char* copy = aligned_buffer(size, &owned);
    if (copy == nullptr) {
        tell(message, message_size, "There is no memory for a copy of the file.");
        return PALPATE_OUT_OF_MEMORY;
    }
    std::memcpy(copy, data, size);
    return open_aligned(copy, size, owned, field, message, message_size);
}

palpate_status palpate_field_open_file(const char* path, palpate_field** field, char* message, size_t message_size) noexcept {
    using namespace palpate;
    if (field != nullptr) *field = nullptr;
    if (field == nullptr || path == nullptr) {
        tell(message, message_size, "Path or field is null.");
        return PALPATE_BAD_ARGUMENT;
    }
    std::FILE* file = std::fopen(path, "rb");
    long size = -1;
    if (file != nullptr && std::fseek(file, 0, SEEK_END) == 0) size = std::ftell(file);
    void* owned = nullptr;
    unsigned char* data = nullptr;
    palpate_status status = PALPATE_FILE_UNREADABLE;
    if (size >= 0 && size <= file_size_limit && std::fseek(file, 0, SEEK_SET) == 0) {
        data = aligned_buffer(static_cast<std::size_t>(size), &owned);
        if (data == nullptr) {
            status = PALPATE_OUT_OF_MEMORY;
        } else if (std::fread(data, 1, static_cast<std::size_t>(size), file) == static_cast<std::size_t>(size)) {
            status = PALPATE_OK;
        }
    }
    if (file != nullptr) std::fclose(file);
    if (status != PALPATE_OK) {
        std::free(owned);
        tell(message, message_size, palpate_status_text(status));
        return status;
    }
    return open_aligned(data, static_cast<std::size_t>(size), owned, field, message, message_size);
}

void palpate_field_close(palpate_field* field) noexcept {
    if (field == nullptr) return;
    std::free(field->curve_rows);
    std::free(field->owned);
    std::free(field);
}

}  // extern "C"
