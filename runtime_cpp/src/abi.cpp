// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// What a caller can ask about the library itself: version, sentences, where the fields of its structs lie.
#include "palpate/palpate.h"

#define PALPATE_ROW(type, field) {#type, #field, offsetof(type, field), sizeof(type::field)}
#define PALPATE_SIZE(type) {#type, "", 0, sizeof(type)}

namespace {

constexpr palpate_abi_row table[] = {
    PALPATE_SIZE(palpate_field_info),
    PALPATE_ROW(palpate_field_info, size),
    PALPATE_ROW(palpate_field_info, channel_count),
    PALPATE_ROW(palpate_field_info, tool_name),
    PALPATE_ROW(palpate_field_info, tool_shape),
    PALPATE_ROW(palpate_field_info, tool_hash),
    PALPATE_ROW(palpate_field_info, field_hash),
    PALPATE_ROW(palpate_field_info, provenance),
    PALPATE_ROW(palpate_field_info, provenance_size),
    PALPATE_ROW(palpate_field_info, bytes),
    PALPATE_ROW(palpate_field_info, tool_offset),
    PALPATE_ROW(palpate_field_info, depth_max),
    PALPATE_ROW(palpate_field_info, stiffness_max),
    PALPATE_ROW(palpate_field_info, band),
    PALPATE_ROW(palpate_field_info, box_min),
    PALPATE_ROW(palpate_field_info, box_max),
    PALPATE_ROW(palpate_field_info, geometry_spacing),
    PALPATE_ROW(palpate_field_info, amplitude_spacing),
    PALPATE_ROW(palpate_field_info, geometry_error_p99),
    PALPATE_ROW(palpate_field_info, geometry_flagged_share),
    PALPATE_ROW(palpate_field_info, geometry_blocks_stored),
    PALPATE_ROW(palpate_field_info, amplitude_blocks_stored),
    PALPATE_ROW(palpate_field_info, way_count),
    PALPATE_ROW(palpate_field_info, reserved),
    PALPATE_ROW(palpate_field_info, way_cosine),
    PALPATE_ROW(palpate_field_info, way_offset),
    PALPATE_SIZE(palpate_sample),
    PALPATE_ROW(palpate_sample, size),
    PALPATE_ROW(palpate_sample, region),
    PALPATE_ROW(palpate_sample, depth),
    PALPATE_ROW(palpate_sample, normal),
    PALPATE_ROW(palpate_sample, distance_gradient),
    PALPATE_ROW(palpate_sample, stored_energy),
    PALPATE_ROW(palpate_sample, force),
    PALPATE_ROW(palpate_sample, normal_force),
    PALPATE_ROW(palpate_sample, stiffness),
    PALPATE_ROW(palpate_sample, friction_stiffness),
    PALPATE_ROW(palpate_sample, friction_coefficient),
    PALPATE_SIZE(palpate_config),
    PALPATE_ROW(palpate_config, size),
    PALPATE_ROW(palpate_config, adhesion),
    PALPATE_ROW(palpate_config, reference_point),
    PALPATE_ROW(palpate_config, friction_coefficient),
    PALPATE_ROW(palpate_config, speed_max),
    PALPATE_ROW(palpate_config, dt_max),
    PALPATE_ROW(palpate_config, adhesion_start),
    PALPATE_ROW(palpate_config, force_max),
    PALPATE_ROW(palpate_config, passivity_control),
    PALPATE_ROW(palpate_config, response),
    PALPATE_ROW(palpate_config, tool_axis),
    PALPATE_SIZE(palpate_tool_state),
    PALPATE_ROW(palpate_tool_state, size),
    PALPATE_ROW(palpate_tool_state, flags),
    PALPATE_ROW(palpate_tool_state, dt),
    PALPATE_ROW(palpate_tool_state, position),
    PALPATE_ROW(palpate_tool_state, orientation),
    PALPATE_ROW(palpate_tool_state, organ_position),
    PALPATE_ROW(palpate_tool_state, organ_orientation),
    PALPATE_SIZE(palpate_tool_response),
    PALPATE_ROW(palpate_tool_response, size),
    PALPATE_ROW(palpate_tool_response, status),
    PALPATE_ROW(palpate_tool_response, region),
    PALPATE_ROW(palpate_tool_response, reserved),
    PALPATE_ROW(palpate_tool_response, force),
    PALPATE_ROW(palpate_tool_response, torque),
    PALPATE_ROW(palpate_tool_response, reference_point),
    PALPATE_ROW(palpate_tool_response, anchor),
    PALPATE_ROW(palpate_tool_response, normal),
    PALPATE_ROW(palpate_tool_response, depth),
    PALPATE_ROW(palpate_tool_response, normal_force),
    PALPATE_ROW(palpate_tool_response, stiffness),
    PALPATE_ROW(palpate_tool_response, friction_stiffness),
    PALPATE_ROW(palpate_tool_response, friction_coefficient),
    PALPATE_ROW(palpate_tool_response, stored_energy),
    PALPATE_ROW(palpate_tool_response, spring_energy),
    PALPATE_ROW(palpate_tool_response, surface_offset),
    PALPATE_ROW(palpate_tool_response, work_in),
    PALPATE_ROW(palpate_tool_response, dissipated_friction),
    PALPATE_ROW(palpate_tool_response, dissipated_rule),
    PALPATE_ROW(palpate_tool_response, hold_leak),
    PALPATE_ROW(palpate_tool_response, organ_work),
    PALPATE_ROW(palpate_tool_response, injected),
    PALPATE_ROW(palpate_tool_response, way_cosine),
    PALPATE_SIZE(palpate_deformation_info),
    PALPATE_ROW(palpate_deformation_info, size),
    PALPATE_ROW(palpate_deformation_info, node_count),
    PALPATE_ROW(palpate_deformation_info, bytes),
    PALPATE_ROW(palpate_deformation_info, radius),
    PALPATE_ROW(palpate_deformation_info, depth_end),
    PALPATE_ROW(palpate_deformation_info, error_p95),
    PALPATE_ROW(palpate_deformation_info, error_max),
    PALPATE_ROW(palpate_deformation_info, error_p95_length),
    PALPATE_ROW(palpate_deformation_info, error_max_length),
    PALPATE_ROW(palpate_deformation_info, error_within),
    PALPATE_SIZE(palpate_deformation_input),
    PALPATE_ROW(palpate_deformation_input, size),
    PALPATE_ROW(palpate_deformation_input, flags),
    PALPATE_ROW(palpate_deformation_input, reference_point),
    PALPATE_ROW(palpate_deformation_input, anchor),
    PALPATE_ROW(palpate_deformation_input, surface_offset),
    PALPATE_ROW(palpate_deformation_input, organ_position),
    PALPATE_ROW(palpate_deformation_input, organ_orientation),
    PALPATE_SIZE(palpate_deformation_result),
    PALPATE_ROW(palpate_deformation_result, size),
    PALPATE_ROW(palpate_deformation_result, reserved),
    PALPATE_ROW(palpate_deformation_result, contact_point),
    PALPATE_ROW(palpate_deformation_result, normal),
    PALPATE_ROW(palpate_deformation_result, depth),
    PALPATE_ROW(palpate_deformation_result, radius),
    PALPATE_ROW(palpate_deformation_result, moved_count),
    PALPATE_SIZE(palpate_texture_info),
    PALPATE_ROW(palpate_texture_info, size),
    PALPATE_ROW(palpate_texture_info, wave_count),
    PALPATE_ROW(palpate_texture_info, bytes),
    PALPATE_ROW(palpate_texture_info, height_max),
    PALPATE_ROW(palpate_texture_info, fade_depth),
    PALPATE_ROW(palpate_texture_info, spatial_frequency_max),
    PALPATE_ROW(palpate_texture_info, stiffness),
    PALPATE_ROW(palpate_texture_info, time_factor),
    PALPATE_ROW(palpate_texture_info, space_factor),
    PALPATE_ROW(palpate_texture_info, force_factor),
    PALPATE_ROW(palpate_texture_info, resolution),
    PALPATE_ROW(palpate_texture_info, force_resolution),
    PALPATE_ROW(palpate_texture_info, stiffness_max),
    PALPATE_ROW(palpate_texture_info, structural_frequency),
    PALPATE_ROW(palpate_texture_info, normal_force),
    PALPATE_SIZE(palpate_texture_limits),
    PALPATE_ROW(palpate_texture_limits, size),
    PALPATE_ROW(palpate_texture_limits, reserved),
    PALPATE_ROW(palpate_texture_limits, time_factor),
    PALPATE_ROW(palpate_texture_limits, space_factor),
    PALPATE_ROW(palpate_texture_limits, force_factor),
    PALPATE_ROW(palpate_texture_limits, resolution),
    PALPATE_ROW(palpate_texture_limits, force_resolution),
    PALPATE_ROW(palpate_texture_limits, stiffness_max),
    PALPATE_ROW(palpate_texture_limits, structural_frequency),
};

}  // namespace

extern "C" {

uint32_t palpate_abi_version(void) noexcept { return PALPATE_ABI_VERSION; }

const char* palpate_version(void) noexcept { return PALPATE_VERSION_TEXT; }

const char* palpate_status_text(palpate_status status) noexcept {
    switch (status) {
        case PALPATE_OK: return "It went well.";
        case PALPATE_BAD_ARGUMENT: return "A pointer is null, a struct has the wrong size, or memory is too small or misaligned.";
        case PALPATE_FILE_UNREADABLE: return "The file is not there or cannot be read.";
        case PALPATE_OUT_OF_MEMORY: return "There is not enough memory.";
        case PALPATE_TRUNCATED: return "The file has fewer or more bytes than its header says: copy it again.";
        case PALPATE_NOT_RFIELD: return "The bytes are not an .rfield.";
        case PALPATE_WRONG_VERSION: return "The file was cooked with another layout: cook it again.";
        case PALPATE_DAMAGED: return "The checksum does not fit: the file is damaged.";
        case PALPATE_BAD_LAYOUT: return "Sizes, counts or offsets in the file contradict each other.";
        case PALPATE_BAD_INDEX: return "A block index in the file points outside the stored blocks.";
        case PALPATE_NOT_FINITE: return "A number in the file is not finite or beyond any physical size.";
        case PALPATE_BAD_CURVE: return "A depth curve in the file does not start at zero or is not continuous.";
        case PALPATE_LAYER_MISSING: return "The file has an effect that this library was built without.";
        case PALPATE_BAD_LAYER: return "An effect in the file contradicts itself.";
    }
    return "This status is unknown to this version.";
}

const char* palpate_tick_text(uint32_t tick_status) noexcept {
    switch (tick_status & (~tick_status + 1u)) {
        case 0: return "An ordinary tick.";
        case PALPATE_TICK_EXTRAPOLATED: return "The tool is deeper than any press went; the curves continue with their last slope.";
        case PALPATE_TICK_SLIPPING: return "The friction spring yielded: the tool slips.";
        case PALPATE_TICK_UNREACHED: return "The tool is near a surface that the scene declares out of reach: no force there.";
        case PALPATE_TICK_TOO_DEEP: return "The tool is deeper than the stored band: released, contact comes back from outside.";
        case PALPATE_TICK_PASSED_THROUGH: return "The stroke went through tissue: released, contact comes back from outside.";
        case PALPATE_TICK_WAITING: return "The tool is in the tissue without having entered it from outside: no force.";
        case PALPATE_TICK_JUMP: return "The tool moved faster than speed_max: released, contact comes back from outside.";
        case PALPATE_TICK_STALE: return "More than dt_max went by since the last tick: released, contact comes back from outside.";
        case PALPATE_TICK_BAD_INPUT: return "Position, orientation or dt is not usable: released, contact comes back from outside.";
        case PALPATE_TICK_RELEASED: return "The host asked to let go: contact comes back from outside.";
        case PALPATE_TICK_FORCE_LIMITED: return "The surface yielded: the device gives no more force.";
        case PALPATE_TICK_LEAK_COVERED: return "The surface yielded by what holding the force had given.";
        case PALPATE_TICK_RULE_YIELDED: return "The surface yields: the way of touching changed to one that would hold more energy.";
        case PALPATE_TICK_TRANSIENT: return "A transient plays on top of the response.";
        case PALPATE_TICK_TRANSIENT_LIMITED: return "The transient was limited: by the device, its energy, its library or four at once.";
        case PALPATE_TICK_TEXTURE_LIMITED: return "A texture is fainter than it should be: the device or the loop cannot render all of it.";
        case PALPATE_TICK_BAD_ARGUMENT: return "A pointer is null or a struct is too small.";
        default: return "This status bit is unknown to this version.";
    }
}

const palpate_abi_row* palpate_abi_table(size_t* count) noexcept {
    if (count == nullptr) return nullptr;
    *count = sizeof table / sizeof table[0];
    return table;
}

}  // extern "C"
