// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Limits (Hayward's table 1) of a wave of spatial frequency k and force amplitude A = height * max(stiffness, 2 pi k F_n): what it gives along
// the normal, or along the surface where the normal force F_n is the largest (fields/texture.py, force_amplitude):
//     beta k delta < 1,  alpha k delta < 1     positions are too coarse for it        else its gain is 0 for ever
//     gamma b < A                              its force is lost in the device's      likewise
//     A k < A_0                                the device cannot hold its slope       its gain is A_0 / (A k) at most
//     alpha k v T < 1,  v k < F_0              too fast for the loop, the structure   its gain goes to 0 while that lasts
// v k T = |k . step| is what one tick moved along the wave, in wavelengths.  A gain is part of the potential, not of the tool's place, so
// it changes by the energy rule: only where that lowers h and with it U, and only while the tool moves.  Each tick looks at one group of
// four waves (texture.inl), which may go as far as the tool moved since the group's last turn.
#include "layers/texture.h"

#include <cmath>
#include <cstddef>
#include <cstring>
#include <initializer_list>

#include "contract.h"
#include "field.h"
#include "proof.h"
#include "session.h"

namespace palpate {
namespace {

constexpr double spatial_frequency_limit = 1e6;  // 1/m
constexpr double phase_limit = 1e6;              // cycles
constexpr double limit_limit = 1e12;             // of a device's numbers
constexpr double two_pi = 6.283185307179586;

std::uint64_t blocks_of(const texture_header& h) noexcept {
    return static_cast<std::uint64_t>(h.mask_blocks[0]) * h.mask_blocks[1] * h.mask_blocks[2];
}

std::uint64_t header_bytes(const texture_header& h) noexcept {
    return h.version == 1 ? offsetof(texture_header, normal_force) : sizeof h;
}

// The header of a layer that is long enough for one of version 1.
void copy_header(const layer_bytes& bytes, texture_header& h) noexcept {
    h = texture_header{};
    std::memcpy(&h, bytes.begin, bytes.size < sizeof h ? offsetof(texture_header, normal_force) : sizeof h);
    if (h.version == 1) h.normal_force = 0.0;
}

std::uint64_t wave_bytes(const texture_header& h) noexcept { return 5ull * 4 * h.group_count * sizeof(double); }

// Padded, so that what follows is aligned.
std::uint64_t index_bytes(const texture_header& h) noexcept { return (blocks_of(h) * 4 + 63) / 64 * 64; }

double norm(double x, double y, double z) noexcept { return std::sqrt(x * x + y * y + z * z); }

}  // namespace

bool prove_texture(const layer_bytes& bytes, const rfield_header&, refusal& why) noexcept {
    const auto bad = [&why](const char* what) { return refuse(why, PALPATE_BAD_LAYER, "The effect texture %s.", what); };
    texture_header h;
    if (bytes.size < offsetof(texture_header, normal_force)) return bad("is shorter than its header");
    copy_header(bytes, h);
    if (h.magic != texture_magic || h.version < 1 || h.version > texture_version) return bad("is of another layout: cook again");
    if (h.group_count < 1 || h.group_count > texture_group_limit) return bad("has no waves, or too many");
    if (!(h.fade_depth >= 1e-9 && h.fade_depth <= length_limit)) return bad("has an impossible fade depth");
    if (!(h.stiffness >= 0.0 && h.stiffness <= curve_limit)) return bad("has an impossible stiffness");
    if (!(h.normal_force >= 0.0 && h.normal_force <= curve_limit)) return bad("has an impossible normal force");
    double limits[7];
    static_assert(sizeof limits == sizeof h.limits, "a row of numbers");
    std::memcpy(limits, &h.limits, sizeof limits);
    for (const double x : limits) {
        if (!(x >= 0.0 && x <= limit_limit)) return bad("has a device's number out of range");
    }
    const bool masked = h.mask_stored > 0;
    for (std::uint32_t g = 0; g < texture_group_limit; ++g) {
        if (h.mask_channel[g] != texture_no_mask && !(masked && h.mask_channel[g] < texture_mask_limit)) return bad("has a mask that is not there");
    }
    std::uint64_t size = header_bytes(h) + wave_bytes(h);
    if (masked) {
        for (const std::uint32_t count : h.mask_blocks) {
            if (count < 1 || count > 4096) return bad("has masks of an impossible size");
        }
        if (h.mask_stored > 1u << 22 || blocks_of(h) > 1u << 26) return bad("has masks of an impossible size");
        if (!(h.mask_spacing >= 1e-7 && h.mask_spacing <= length_limit)) return bad("has masks of an impossible spacing");
        for (const double x : h.mask_origin) {
            if (!bounded(x, length_limit)) return bad("has masks at an impossible place");
        }
        size = (size + 63) / 64 * 64 + index_bytes(h) + 64ull * texture_mask_limit * sizeof(float) * h.mask_stored;
    }
    if (bytes.size != size) return bad("has not the size of what it holds");
    texture_ground ground;
    set_texture(ground, bytes);
    double height = 0.0;
    for (std::uint32_t i = 0; i < 4 * h.group_count; ++i) {
        if (!bounded(ground.kx[i], spatial_frequency_limit) || !bounded(ground.ky[i], spatial_frequency_limit) ||
            !bounded(ground.kz[i], spatial_frequency_limit) || !bounded(ground.phase[i], phase_limit) ||
            !(ground.amplitude[i] >= 0.0 && ground.amplitude[i] <= length_limit)) {
            return bad("has a wave that is not finite or out of range");
        }
        height += ground.amplitude[i];
    }
    if (!(height <= texture_height_share * h.fade_depth * (1.0 + 1e-9))) return bad("is higher than a quarter of its fade depth");
    if (!masked) return true;
    if (!check_index(ground.mask.index, blocks_of(h), 0, h.mask_stored, "Texture mask", why)) return false;
    const std::uint64_t block = 64ull * texture_mask_limit;
    for (std::uint64_t i = 0; i < block * h.mask_stored; ++i) {
        const float x = ground.mask_coefficients[i];
        if (!(x >= 0.0f && x <= 1.0f)) return bad("has a mask that is not between 0 and 1");
        if (i < block && x != 0.0f) return bad("has masks whose zero block is not zero");
    }
    return true;
}

void set_texture(texture_ground& ground, const layer_bytes& bytes) noexcept {
    texture_header h;
    copy_header(bytes, h);
    const std::uint32_t count = 4 * h.group_count;
    const auto* waves = reinterpret_cast<const double*>(bytes.begin + header_bytes(h));
    ground.group_count = static_cast<std::int32_t>(h.group_count);
    ground.kx = waves;
    ground.ky = waves + count;
    ground.kz = waves + 2 * count;
    ground.phase = waves + 3 * count;
    ground.amplitude = waves + 4 * count;
    ground.fade_depth = h.fade_depth;
    ground.inverse_fade_depth = 1.0 / h.fade_depth;
    ground.stiffness = h.stiffness;
    ground.normal_force = h.normal_force;
    ground.limits = h.limits;
    ground.k_squared = 0.0;
    for (std::uint32_t i = 0; i < texture_wave_limit; ++i) {
        const double k = ground.spatial_frequency[i] = i < count ? norm(ground.kx[i], ground.ky[i], ground.kz[i]) : 0.0;
        if (i >= count) continue;
        if (ground.amplitude[i] > 0.0 && k * k > ground.k_squared) ground.k_squared = k * k;
    }
    for (std::uint32_t g = 0; g < texture_group_limit; ++g) ground.mask_channel[g] = h.mask_channel[g];
    ground.masked = h.mask_stored > 0;
    ground.sole_mask = -1;
    if (!ground.masked) return;
    bool several = false;
    for (std::uint32_t g = 0; g < h.group_count; ++g) {
        const auto channel = static_cast<std::int32_t>(h.mask_channel[g]);
        if (h.mask_channel[g] == texture_no_mask || channel == ground.sole_mask) continue;
        several = several || ground.sole_mask >= 0;
        ground.sole_mask = channel;
    }
    if (several) ground.sole_mask = -1;
    ground.sole_scale[0] = 0.125;
    for (int a = 1; a < 4; ++a) ground.sole_scale[a] = 0.25 / h.mask_spacing;
    const unsigned char* at = bytes.begin + (header_bytes(h) + wave_bytes(h) + 63) / 64 * 64;
    set_lattice(ground.mask, h.mask_origin, h.mask_spacing, h.mask_blocks, reinterpret_cast<const std::int32_t*>(at),
                texture_mask_limit, 4);
    ground.mask_coefficients = reinterpret_cast<const float*>(at + index_bytes(h));
}

void texture_at(const palpate_field& field, const double* amplitude, const double q[3], mask_cell& kept,
                texture_here& here) PALPATE_REAL_TIME {
    double sums[4];
    field.contract->texture(field.texture, amplitude, q[0], q[1], q[2], kept, sums);
    set_here(field.texture, sums, here);
}

void limit_texture(texture_state& t, const palpate_field& field) PALPATE_REAL_TIME {
    const texture_ground& ground = field.texture;
    if (!t.own_limits) t.limits = ground.limits;
    const texture_limits& l = t.limits;
    t.cycles = l.time_factor > 0.0 ? 1.0 / l.time_factor : 0.0;
    t.restless = (1u << ground.group_count) - 1;  // until a tick has looked
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(texture_wave_limit); ++i) {
        t.most[i] = 1.0;
        if (i >= 4 * ground.group_count || !(ground.amplitude[i] > 0.0)) continue;
        const double k = ground.spatial_frequency[i], across = two_pi * k * ground.normal_force;
        const double force = ground.amplitude[i] * (across > ground.stiffness ? across : ground.stiffness);
        const double factor = l.time_factor > l.space_factor ? l.time_factor : l.space_factor;
        const bool coarse = factor * k * l.resolution >= 1.0, weak = force > 0.0 && l.force_factor * l.force_resolution >= force;
        if (coarse || weak) {
            t.most[i] = 0.0;
        } else if (l.stiffness_max > 0.0 && force * k > l.stiffness_max) {
            t.most[i] = l.stiffness_max / (force * k);
        }
    }
}

void begin_texture(texture_state& t, const palpate_field& field) PALPATE_REAL_TIME {
    limit_texture(t, field);
    const double still[3] = {0.0, 0.0, 0.0};
    touch_texture(t, field, still, 1.0);
    t.walked = 0.0;
    for (double& at : t.turned_at) at = 0.0;
    t.turn = 0;
}

void touch_texture(texture_state& t, const palpate_field& field, const double step[3], double dt) PALPATE_REAL_TIME {
    const texture_ground& ground = field.texture;
    const double reach = longest_step(t, dt);
    t.limited = t.felt = 0;
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(texture_wave_limit); ++i) {
        const bool there = i < 4 * ground.group_count;
        const double along = there ? std::fabs(ground.kx[i] * step[0] + ground.ky[i] * step[1] + ground.kz[i] * step[2]) : 0.0;
        t.gain[i] = along >= reach ? 0.0 : t.most[i];
        t.amplitude[i] = there ? t.gain[i] * ground.amplitude[i] : 0.0;
        if (there && t.amplitude[i] != ground.amplitude[i]) t.limited |= 1u << (i / 4);
        if (t.amplitude[i] > 0.0) t.felt |= 1u << (i / 4);
    }
    t.restless = t.limited;
}

void take_back_turn(texture_state& t, const palpate_field& field, const double gain[4]) PALPATE_REAL_TIME {
    const texture_ground& ground = field.texture;
    const std::uint32_t g = (t.turn > 0 ? t.turn : static_cast<std::uint32_t>(ground.group_count)) - 1;
    t.limited &= ~(1u << g);
    for (std::uint32_t j = 0, i = 4 * g; j < 4; ++j, ++i) {
        t.gain[i] = gain[j];
        t.amplitude[i] = gain[j] * ground.amplitude[i];
        if (t.amplitude[i] != ground.amplitude[i]) t.limited |= 1u << g;
    }
    t.restless |= 1u << g;
    t.felt |= 1u << g;
}

}  // namespace palpate

extern "C" {

palpate_status palpate_texture_describe(const palpate_field* field, palpate_texture_info* info) noexcept {
    if (field == nullptr || info == nullptr || info->size < offsetof(palpate_texture_info, normal_force)) return PALPATE_BAD_ARGUMENT;
    const palpate::texture_ground& ground = field->texture;
    if (ground.group_count == 0) return PALPATE_LAYER_MISSING;
    info->wave_count = 0;
    info->bytes = field->layer[palpate::layer_texture].size;
    info->height_max = 0.0;
    for (std::int32_t i = 0; i < 4 * ground.group_count; ++i) {
        info->wave_count += ground.amplitude[i] > 0.0 ? 1u : 0u;
        info->height_max += ground.amplitude[i];
    }
    info->fade_depth = ground.fade_depth;
    info->spatial_frequency_max = std::sqrt(ground.k_squared);
    info->stiffness = ground.stiffness;
    info->time_factor = ground.limits.time_factor;
    info->space_factor = ground.limits.space_factor;
    info->force_factor = ground.limits.force_factor;
    info->resolution = ground.limits.resolution;
    info->force_resolution = ground.limits.force_resolution;
    info->stiffness_max = ground.limits.stiffness_max;
    info->structural_frequency = ground.limits.structural_frequency;
    if (info->size >= sizeof(palpate_texture_info)) info->normal_force = ground.normal_force;
    return PALPATE_OK;
}

palpate_status palpate_session_set_texture_limits(palpate_session* session, const palpate_texture_limits* limits) PALPATE_REAL_TIME {
    if (session == nullptr) return PALPATE_BAD_ARGUMENT;
    palpate::texture_limits given{};
    if (limits != nullptr) {
        if (limits->size < sizeof(palpate_texture_limits)) return PALPATE_BAD_ARGUMENT;
        given = {limits->time_factor, limits->space_factor, limits->force_factor, limits->resolution,
                 limits->force_resolution, limits->stiffness_max, limits->structural_frequency};
        for (const double x : {given.time_factor, given.space_factor, given.force_factor, given.resolution, given.force_resolution,
                               given.stiffness_max, given.structural_frequency}) {
            if (!(x >= 0.0 && x <= palpate::limit_limit)) return PALPATE_BAD_ARGUMENT;
        }
    }
    palpate::texture_state& t = session->texture;
    t.own_limits = limits != nullptr;
    t.limits = given;
    palpate::limit_texture(t, *session->field);
    if (!session->touching) palpate::begin_texture(t, *session->field);
    return PALPATE_OK;
}

palpate_status palpate_session_texture(const palpate_session* session, double gain[16]) PALPATE_REAL_TIME {
    if (session == nullptr || gain == nullptr) return PALPATE_BAD_ARGUMENT;
    for (std::uint32_t i = 0; i < palpate::texture_wave_limit; ++i) gain[i] = session->texture.gain[i];
    return PALPATE_OK;
}

}  // extern "C"
