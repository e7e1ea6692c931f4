// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// What a field says about itself and at a point, without a session.
#include <cmath>

#include "locate.h"
#include "palpate/palpate.h"
#include "respond.h"
#include "rule.h"
#include "ways.h"

extern "C" {

palpate_status palpate_field_describe(const palpate_field* field, palpate_field_info* info) noexcept {
    if (field == nullptr || info == nullptr || info->size < sizeof(palpate_field_info)) return PALPATE_BAD_ARGUMENT;
    const palpate::rfield_header& h = field->header;
    info->channel_count = h.energy_curve_count + h.stiffness_curve_count + h.friction_curve_count;
    info->tool_name = h.tool_name;
    info->tool_shape = h.tool_shape;
    info->tool_hash = h.tool_hash;
    info->field_hash = h.field_hash;
    info->provenance = field->provenance;
    info->provenance_size = field->provenance_size;
    info->bytes = h.file_size;
    info->tool_offset = h.tool_offset;
    info->depth_max = h.depth_max;
    info->stiffness_max = h.stiffness_max;
    for (int a = 0; a < 2; ++a) info->band[a] = h.band[a];
    for (int a = 0; a < 3; ++a) {
        info->box_min[a] = h.geometry_origin[a];
        info->box_max[a] = h.geometry_origin[a] + h.geometry_spacing * field->geometry.last[a];
    }
    info->geometry_spacing = h.geometry_spacing;
    info->amplitude_spacing = h.amplitude_spacing;
    info->geometry_error_p99 = h.geometry_error_p99;
    info->geometry_flagged_share = h.geometry_flagged_share;
    info->geometry_blocks_stored = h.geometry_stored;
    info->amplitude_blocks_stored = h.amplitude_stored;
    info->way_count = h.way_count;
    info->reserved = 0;
    for (int w = 0; w < 4; ++w) {
        info->way_cosine[w] = h.way_cosine[w];
        info->way_offset[w] = h.way_offset[w];
    }
    return PALPATE_OK;
}

palpate_status palpate_field_sample(const palpate_field* field, const double* q, size_t count, palpate_sample* samples) noexcept {
    return palpate_field_sample_tilted(field, q, 1.0, count, samples);
}

palpate_status palpate_field_sample_tilted(const palpate_field* field, const double* q, double cosine, size_t count,
                                           palpate_sample* samples) noexcept {
    if (count == 0) return PALPATE_OK;
    if (field == nullptr || q == nullptr || samples == nullptr || !(cosine >= -1e3 && cosine <= 1e3) ||
        samples->size < sizeof(palpate_sample)) {
        return PALPATE_BAD_ARGUMENT;
    }
    const std::uint32_t stride = samples->size;
    const double way = palpate::clamped_cosine(*field, cosine);
    const double lacking = field->tool_offset - palpate::offset_of_way(*field, way);
    palpate::texture_state limits{};
    palpate::begin_texture(limits, *field);
    palpate::mask_cell under_masks;
    palpate::forget(under_masks);
    if (stride % alignof(palpate_sample) != 0) return PALPATE_BAD_ARGUMENT;
    auto* bytes = reinterpret_cast<unsigned char*>(samples);
    for (size_t i = 0; i < count; ++i, q += 3, bytes += stride) {
        palpate_sample& out = *reinterpret_cast<palpate_sample*>(bytes);
        out = palpate_sample{};
        out.size = stride;
        out.region = PALPATE_REGION_UNKNOWN;
        if (!(std::fabs(q[0]) <= 1e3 && std::fabs(q[1]) <= 1e3 && std::fabs(q[2]) <= 1e3)) continue;
        palpate::location at;
        palpate::locate(*field, q, at);
        if (at.region == PALPATE_REGION_CONTACT || at.region == PALPATE_REGION_FREE) {
            at.depth -= lacking;
            at.region = at.depth > 0.0 ? PALPATE_REGION_CONTACT : PALPATE_REGION_FREE;
        }
        out.region = at.region;
        out.depth = at.depth;
        double length_squared = 0.0;
        for (int a = 0; a < 3; ++a) {
            out.distance_gradient[a] = at.gradient[a];
            length_squared += at.gradient[a] * at.gradient[a];
        }
        if (length_squared > 0.0) {
            const double scale = 1.0 / std::sqrt(length_squared);
            for (int a = 0; a < 3; ++a) out.normal[a] = at.gradient[a] * scale;
        }
        if (at.region != PALPATE_REGION_CONTACT) continue;
        palpate::response r;
        palpate::tissue under;
        under.field = field;
        under.distance_gradient = at.gradient;
        under.depth = at.depth;
        palpate::amplitudes_here here;
        palpate::amplitudes_at(*field, q, here);
        palpate::blend(*field, here, way, under.amplitudes);
        palpate::texture_here texture;
        under.texture = nullptr;
        if (field->texture.group_count > 0) {
            palpate::texture_at(*field, limits.amplitude, q, under_masks, texture);
            under.texture = &texture;
        }
        palpate::respond_at(under, 0.0, r);
        out.stored_energy = r.energy;
        for (int a = 0; a < 3; ++a) {
            out.force[a] = -r.gradient[a];
            out.normal_force += out.force[a] * out.normal[a];
        }
        out.stiffness = r.stiffness;
        out.friction_stiffness = r.friction_stiffness;
        out.friction_coefficient = r.friction_coefficient;
    }
    return PALPATE_OK;
}

}  // extern "C"
