// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// The C functions of a session: arguments are judged here, tick.cpp does the work.
#include "session.h"

#include <cstring>
#include <new>
#include <type_traits>

#include "field.h"

static_assert(std::is_trivially_copyable<palpate_session>::value, "a snapshot is a copy of the bytes");
static_assert(alignof(palpate_session) <= 8, "the header promises 8");

namespace {

bool usable(const palpate_config& c) noexcept {
    const auto length = [](double x) { return x >= -1e3 && x <= 1e3; };
    const double axis_squared = c.tool_axis[0] * c.tool_axis[0] + c.tool_axis[1] * c.tool_axis[1] + c.tool_axis[2] * c.tool_axis[2];
    return c.size >= sizeof(palpate_config) && length(c.reference_point[0]) && length(c.reference_point[1]) &&
           length(c.reference_point[2]) && c.friction_coefficient <= 1e6 && c.friction_coefficient >= -1e6 &&
           c.speed_max >= 0.0 && c.speed_max <= 1e9 && c.dt_max > 0.0 && c.dt_max <= 1e9 &&
           c.adhesion >= PALPATE_ADHESION_STICK_SLIP && c.adhesion <= PALPATE_ADHESION_DAHL && c.adhesion_start >= 0.0 &&
           c.adhesion_start <= 0.999 && c.force_max >= 0.0 && c.force_max <= 1e9 && c.passivity_control <= 1 &&
           c.response <= PALPATE_RESPONSE_AXIAL_UNGUARDED && axis_squared > 0.98 && axis_squared < 1.02;
}

bool roomy(const void* memory, size_t size) noexcept {
    return memory != nullptr && size >= sizeof(palpate_session) &&
           reinterpret_cast<std::uintptr_t>(memory) % alignof(palpate_session) == 0;
}

}  // namespace

extern "C" {

void palpate_config_default(palpate_config* config) noexcept {
    if (config == nullptr) return;
    *config = palpate_config{};
    config->size = sizeof(palpate_config);
    config->friction_coefficient = -1.0;
    config->speed_max = 10.0;
    config->dt_max = 0.1;
    config->adhesion = PALPATE_ADHESION_STICK_SLIP;
    config->adhesion_start = 0.5;
    config->tool_axis[2] = 1.0;
}

size_t palpate_session_size(void) noexcept { return sizeof(palpate_session); }

palpate_status palpate_session_init(void* memory, size_t size, const palpate_field* field, const palpate_config* config,
                                    palpate_session** session) noexcept {
    if (session != nullptr) *session = nullptr;
    if (session == nullptr || field == nullptr || !roomy(memory, size)) return PALPATE_BAD_ARGUMENT;
    if (config != nullptr && !usable(*config)) return PALPATE_BAD_ARGUMENT;
    auto* s = new (memory) palpate_session{};
    s->field = field;
    if (config != nullptr) {
        s->config = *config;
    } else {
        palpate_config_default(&s->config);
    }
    for (double x : s->config.reference_point) s->has_arm = s->has_arm || x != 0.0;
    palpate::begin(*s);
    *session = s;
    return PALPATE_OK;
}

palpate_status palpate_session_reset(palpate_session* session) PALPATE_REAL_TIME {
    if (session == nullptr) return PALPATE_BAD_ARGUMENT;
    if (session->next_field != nullptr) session->field = session->next_field;
    session->next_field = nullptr;
    palpate::begin(*session);
    return PALPATE_OK;
}

palpate_status palpate_session_snapshot(const palpate_session* session, void* memory, size_t size,
                                        palpate_session** snapshot) PALPATE_REAL_TIME {
    if (snapshot != nullptr) *snapshot = nullptr;
    if (session == nullptr || snapshot == nullptr || !roomy(memory, size)) return PALPATE_BAD_ARGUMENT;
    *snapshot = new (memory) palpate_session(*session);
    return PALPATE_OK;
}

palpate_status palpate_session_transient(const palpate_session* session, double account[3]) PALPATE_REAL_TIME {
    if (session == nullptr || account == nullptr) return PALPATE_BAD_ARGUMENT;
    account[0] = session->transients.given;
    account[1] = session->transients.taken;
    account[2] = static_cast<double>(session->transients.events);
    return PALPATE_OK;
}

palpate_status palpate_session_set_field(palpate_session* session, const palpate_field* field) PALPATE_REAL_TIME {
    if (session == nullptr || field == nullptr) return PALPATE_BAD_ARGUMENT;
    session->next_field = field == session->field ? nullptr : field;
    return PALPATE_OK;
}

uint32_t palpate_tick(palpate_session* session, const palpate_tool_state* state, palpate_tool_response* response) PALPATE_REAL_TIME {
    if (session == nullptr || state == nullptr || response == nullptr || state->size < sizeof(palpate_tool_state) ||
        response->size < sizeof(palpate_tool_response)) {
        return PALPATE_TICK_BAD_ARGUMENT;
    }
    const bool at_rest = !session->organ.used && (state->flags & PALPATE_INPUT_ORGAN_POSE) == 0;
    std::uint32_t status = at_rest ? palpate::tick(*session, *state, *response) : palpate::tick_on_organ(*session, *state, *response);
#ifdef PALPATE_HAS_TRANSIENT
    const palpate::layer_bytes& transient = session->field->layer[palpate::layer_transient];
    if (transient.begin != nullptr) status |= palpate::play_transients(session->transients, transient, *state, *response);
#endif
    return status;
}

uint32_t palpate_tick_batch(palpate_session* session, const palpate_tool_state* states, palpate_tool_response* responses,
                            size_t count) PALPATE_REAL_TIME {
    if (count == 0) return 0;
    if (session == nullptr || states == nullptr || responses == nullptr || states->size < sizeof(palpate_tool_state) ||
        responses->size < sizeof(palpate_tool_response) || states->size % alignof(palpate_tool_state) != 0 ||
        responses->size % alignof(palpate_tool_response) != 0) {
        return PALPATE_TICK_BAD_ARGUMENT;
    }
    const std::uint32_t in_stride = states->size;
    const std::uint32_t out_stride = responses->size;
    const auto* in = reinterpret_cast<const unsigned char*>(states);
    auto* out = reinterpret_cast<unsigned char*>(responses);
    std::uint32_t all = 0;
    for (size_t i = 0; i < count; ++i, in += in_stride, out += out_stride) {
        auto& response = *reinterpret_cast<palpate_tool_response*>(out);
        response.size = out_stride;
        all |= palpate_tick(session, reinterpret_cast<const palpate_tool_state*>(in), &response);
    }
    return all;
}

}  // extern "C"
