// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Opening an .rfield: every fact that a tick relies on is proven here, once, or the file is refused with one sentence.
// In order: size, magic, version, checksum; counts and offsets; block indices; finite numbers; curves.
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>

#include "crc32.h"
#include "field.h"
#include "palpate/palpate.h"

namespace palpate {
namespace {

static_assert(std::numeric_limits<double>::is_iec559 && std::numeric_limits<float>::is_iec559, "IEEE 754 is relied on");

// Bounds that no physical field comes near; with them every product that a tick forms stays finite.
constexpr double length_limit = 1e3;           // m
constexpr double curve_limit = 1e12;           // J/m^j, N/m^j
constexpr double amplitude_limit = 1e6;        // dimensionless
constexpr std::uint32_t edge_limit = 4096;     // blocks along an axis
constexpr std::uint64_t block_limit = 1u << 24;  // blocks in a box, and stored
constexpr std::uint32_t interval_limit = 65536;
constexpr long file_size_limit = 0x7FFFFFFF;     // bytes; a folder claims more on Linux
// Jump of a curve between intervals, as a fraction of its largest value, slope or (friction) value; rounding of a fit.
constexpr double joint_tolerance = 1e-9;

struct refusal {
    palpate_status status;
    char sentence[200];
};

#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
bool refuse(refusal& why, palpate_status status, const char* format, ...) noexcept {
    why.status = status;
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(why.sentence, sizeof why.sentence, format, arguments);
    va_end(arguments);
    return false;
}

bool bounded(double x, double limit) noexcept { return x >= -limit && x <= limit; }  // false for NaN

bool check_identity(const unsigned char* data, std::size_t size, const rfield_header& h, refusal& why) noexcept {
    if (std::memcmp(h.magic, rfield_magic, sizeof h.magic) != 0) {
        return refuse(why, PALPATE_NOT_RFIELD, "The first bytes are not PALPRFLD: this is not an .rfield.");
    }
    if (h.version != rfield_version || h.layout_hash != rfield_layout_hash || h.header_size != sizeof h ||
        h.section_count != rfield_section_count) {
        return refuse(why, PALPATE_WRONG_VERSION, "The file has layout version %u, this runtime reads version %u: cook it again.",
                      static_cast<unsigned>(h.version), static_cast<unsigned>(rfield_version));
    }
    if (h.file_size != size) {
        return refuse(why, PALPATE_TRUNCATED, "The header says %llu bytes, there are %llu.",
                      static_cast<unsigned long long>(h.file_size), static_cast<unsigned long long>(size));
    }
    rfield_header blank = h;
    blank.checksum = 0;
    std::uint32_t crc = crc32(0, reinterpret_cast<const unsigned char*>(&blank), sizeof blank);
    crc = crc32(crc, data + sizeof blank, size - sizeof blank);
    if (crc != h.checksum) return refuse(why, PALPATE_DAMAGED, "The checksum does not fit: the file is damaged.");
    return true;
}

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
    elements[section_amplitude_coefficients] = 64ull * h.amplitude_stored * h.channel_stride;
    elements[section_energy_curves] = 4ull * (h.energy_intervals + 1ull) * h.energy_curve_count;
    elements[section_stiffness_curves] = 4ull * (h.stiffness_intervals + 1ull) * h.stiffness_curve_count;
    elements[section_friction_curves] = 4ull * (h.friction_intervals + 1ull) * h.friction_curve_count;
    elements[section_provenance] = h.section_elements[section_provenance];
    return true;
}

bool check_sections(const rfield_header& h, const std::uint64_t elements[rfield_section_count], refusal& why) noexcept {
    std::uint64_t end = sizeof h;
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

bool check_index(const std::int32_t* index, std::uint64_t count, std::int32_t least, std::uint32_t stored, const char* name,
                 refusal& why) noexcept {
    for (std::uint64_t i = 0; i < count; ++i) {
        if (index[i] < least || index[i] >= static_cast<std::int64_t>(stored)) {
            return refuse(why, PALPATE_BAD_INDEX, "%s block %llu points at row %d of %u.", name, static_cast<unsigned long long>(i),
                          static_cast<int>(index[i]), static_cast<unsigned>(stored));
        }
    }
    return true;
}

bool check_amplitudes(const float* coefficients, std::uint64_t count, std::uint64_t row_size, refusal& why) noexcept {
    for (std::uint64_t i = 0; i < count; ++i) {
        const double x = static_cast<double>(coefficients[i]);
        if (!bounded(x, amplitude_limit)) {
            return refuse(why, PALPATE_NOT_FINITE, "Amplitude %llu is %g: at most %g is right.", static_cast<unsigned long long>(i),
                          x, amplitude_limit);
        }
        if (i < row_size && !(x == 0.0)) {
            return refuse(why, PALPATE_BAD_LAYOUT, "The zero block of the amplitudes is not zero.");
        }
    }
    return true;
}

// Rows of cubics with `degree` continuous derivatives at every joint, the last row a quadratic; an energy curve
// (degree 1) starts with value and slope zero, so that force starts at zero.
bool check_curves(const double* rows, std::uint32_t intervals, std::uint32_t curves, double depth_end, int degree,
                  const char* name, refusal& why) noexcept {
    const double h = depth_end / static_cast<double>(intervals);
    for (std::uint64_t i = 0; i < 4ull * (intervals + 1ull) * curves; ++i) {
        const bool cubic = i % 4 == 3;
        if (!(bounded(rows[i], cubic ? curve_limit * 1e3 : curve_limit))) {
            return refuse(why, PALPATE_NOT_FINITE, "%s coefficient %llu is %g.", name, static_cast<unsigned long long>(i), rows[i]);
        }
    }
    for (std::uint32_t r = 0; r < curves; ++r) {
        double value_scale = 0.0, slope_scale = 0.0;
        for (int pass = 0; pass < 2; ++pass) {
            for (std::uint32_t m = 0; m < intervals; ++m) {
                const double* c = rows + 4ull * (static_cast<std::uint64_t>(m) * curves + r);
                const double* next = c + 4ull * curves;
                const double value = c[0] + h * (c[1] + h * (c[2] + h * c[3]));
                const double slope = c[1] + h * (2.0 * c[2] + 3.0 * h * c[3]);
                if (pass == 0) {
                    value_scale = std::fmax(value_scale, std::fmax(std::fabs(c[0]), std::fabs(value)));
                    slope_scale = std::fmax(slope_scale, std::fmax(std::fabs(c[1]), std::fabs(slope)));
                } else if (!(std::fabs(next[0] - value) <= joint_tolerance * value_scale) ||
                           (degree > 0 && !(std::fabs(next[1] - slope) <= joint_tolerance * slope_scale))) {
                    return refuse(why, PALPATE_BAD_CURVE, "%s curve %u jumps at knot %u.", name, static_cast<unsigned>(r),
                                  static_cast<unsigned>(m + 1));
                }
            }
        }
        const double* first = rows + 4ull * r;
        if (degree > 0 && !(first[0] == 0.0 && first[1] == 0.0)) {
            return refuse(why, PALPATE_BAD_CURVE, "%s curve %u does not start with value and slope zero.", name,
                          static_cast<unsigned>(r));
        }
        if (!(rows[4ull * (static_cast<std::uint64_t>(intervals) * curves + r) + 3] == 0.0)) {
            return refuse(why, PALPATE_BAD_CURVE, "%s curve %u does not continue as a quadratic.", name, static_cast<unsigned>(r));
        }
    }
    return true;
}

void set_lattice(lattice& L, const double origin[3], double spacing, const std::uint32_t blocks[3],
                 const std::int32_t* index) noexcept {
    for (int a = 0; a < 3; ++a) {
        L.origin[a] = origin[a];
        L.blocks[a] = static_cast<std::int32_t>(blocks[a]);
        L.last[a] = 4.0 * static_cast<double>(blocks[a]) - 2.0;
    }
    L.spacing = spacing;
    L.inverse_spacing = 1.0 / spacing;
    L.index = index;
}

void set_curves(depth_curves& c, double depth_end, std::uint32_t intervals, std::uint32_t curves, const double* rows) noexcept {
    c.depth_end = depth_end;
    c.interval_count = static_cast<double>(intervals);
    c.step = depth_end / c.interval_count;
    c.inverse_step = c.interval_count / depth_end;
    c.last_row = static_cast<std::int32_t>(intervals);
    c.curve_count = static_cast<std::int32_t>(curves);
    c.rows = rows;
}

template <class T>
const T* section(const unsigned char* data, const rfield_header& h, rfield_section i) noexcept {
    return reinterpret_cast<const T*>(data + h.section_offset[i]);
}

// Proves the aligned bytes and points `field` into them.
bool prove(const unsigned char* data, std::size_t size, palpate_field& field, refusal& why) noexcept {
    const rfield_header& h = *reinterpret_cast<const rfield_header*>(data);
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
        !check_amplitudes(amplitudes, elements[section_amplitude_coefficients], 64ull * h.channel_stride, why) ||
        !check_curves(energy, h.energy_intervals, h.energy_curve_count, h.energy_depth_end, 1, "Energy", why) ||
        !check_curves(stiffness, h.stiffness_intervals, h.stiffness_curve_count, h.stiffness_depth_end, 0, "Stiffness", why) ||
        !check_curves(friction, h.friction_intervals, h.friction_curve_count, h.friction_depth_end, 0, "Friction", why)) {
        return false;
    }

    set_lattice(field.geometry, h.geometry_origin, h.geometry_spacing, h.geometry_blocks, geometry_index);
    field.geometry_coefficients = section<std::int16_t>(data, h, section_geometry_coefficients);
    field.geometry_scale = h.geometry_scale;
    field.geometry_bias = h.geometry_bias;
    set_lattice(field.amplitudes, h.amplitude_origin, h.amplitude_spacing, h.amplitude_blocks, amplitude_index);
    field.amplitude_coefficients = amplitudes;
    field.channel_stride = static_cast<std::int32_t>(h.channel_stride);
    const std::uint32_t channels = h.energy_curve_count + h.stiffness_curve_count + h.friction_curve_count;
    field.channels = static_cast<std::int32_t>((channels + 3) / 4 * 4);
    field.gradient_channels = static_cast<std::int32_t>((h.energy_curve_count + 3) / 4 * 4);
    field.contract = &contraction_here();
    set_curves(field.energy, h.energy_depth_end, h.energy_intervals, h.energy_curve_count, energy);
    set_curves(field.stiffness, h.stiffness_depth_end, h.stiffness_intervals, h.stiffness_curve_count, stiffness);
    set_curves(field.friction, h.friction_depth_end, h.friction_intervals, h.friction_curve_count, friction);
    field.tool_offset = h.tool_offset;
    field.depth_max = h.depth_max;
    field.header = &h;
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
    } else if (size < sizeof(rfield_header)) {
        refuse(why, PALPATE_TRUNCATED, "%llu bytes are fewer than the header's %llu.", static_cast<unsigned long long>(size),
               static_cast<unsigned long long>(sizeof(rfield_header)));
    } else {
        new (field) palpate_field{};
        good = prove(data, size, *field, why);
    }
    if (!good) {
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
    std::free(field->owned);
    std::free(field);
}

}  // extern "C"
