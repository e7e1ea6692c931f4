// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Any bytes as a trace on the field named by the environment variable PALPATE_FUZZ_FIELD.  Laws: answers are finite,
// the energy accounts balance with the work recomputed outside, dissipation never falls.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "palpate/palpate.h"

namespace {

void require(bool law) {
    if (!law) std::abort();
}

const palpate_field* shared_field() {
    static palpate_field* field = nullptr;
    if (field == nullptr) {
        char why[256] = "set PALPATE_FUZZ_FIELD to an .rfield";
        const char* path = std::getenv("PALPATE_FUZZ_FIELD");
        if (path == nullptr || palpate_field_open_file(path, &field, why, sizeof why) != PALPATE_OK) {
            std::fprintf(stderr, "%s\n", why);
            std::exit(2);
        }
    }
    return field;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const palpate_field* field = shared_field();
    palpate_field_info info{};
    info.size = sizeof info;
    palpate_field_describe(field, &info);
    std::vector<std::uint64_t> memory((palpate_session_size() + 7) / 8);
    palpate_session* session = nullptr;
    palpate_config config;
    palpate_config_default(&config);
    config.friction_coefficient = size > 0 ? data[0] / 64.0 : 0.0;
    require(palpate_session_init(memory.data(), memory.size() * 8, field, &config, &session) == PALPATE_OK);

    palpate_tool_state state{sizeof state, PALPATE_INPUT_POSITION_ONLY, 1e-3, {0, 0, 0}, {0, 0, 0, 1}};
    for (int a = 0; a < 3; ++a) state.position[a] = 0.5 * (info.box_min[a] + info.box_max[a]);
    palpate_tool_response before{}, now{};
    now.size = sizeof now;
    double work = 0.0, moved = 0.0;
    bool known = false;
    // Each tick takes one byte of kind and then what it needs.
    for (std::size_t i = 1; i + 25 <= size;) {
        const std::uint8_t kind = data[i++];
        const palpate_tool_state last = state;
        state.dt = 1e-3;
        state.flags = PALPATE_INPUT_POSITION_ONLY;
        if (kind < 250) {  // 20 um, 160 um or 2.6 mm a count
            const double scale = kind < 200 ? 2e-5 : kind < 240 ? 1.6e-4 : 2.6e-3;
            for (int a = 0; a < 3; ++a) state.position[a] += scale * static_cast<std::int8_t>(data[i++]);
        } else if (kind < 253) {
            std::memcpy(state.position, data + i, sizeof state.position);
            i += sizeof state.position;
        } else if (kind == 253) {
            std::memcpy(&state.dt, data + i, sizeof state.dt);
            i += sizeof state.dt;
        } else {
            state.flags |= PALPATE_INPUT_RELEASE;
        }
        before = now;
        const std::uint32_t status = palpate_tick(session, &state, &now);
        const bool usable = (status & PALPATE_TICK_BAD_INPUT) == 0;
        for (int a = 0; a < 3; ++a) {
            require(std::isfinite(now.force[a]) && std::isfinite(now.anchor[a]));
            if (usable && known) {
                work -= before.force[a] * (state.position[a] - last.position[a]);
                moved += std::fabs(before.force[a] * (state.position[a] - last.position[a]));
            }
        }
        known = usable;
        if (!usable) {
            for (int a = 0; a < 3; ++a) state.position[a] = 0.5 * (info.box_min[a] + info.box_max[a]);
            state.dt = 1e-3;
        }
        const double rounding = 1e-12 * (1.0 + moved);
        require(std::fabs(now.work_in - work) <= rounding);
        require(std::fabs(now.work_in + now.hold_leak - now.stored_energy - now.dissipated_friction - now.dissipated_rule) <= rounding);
        require(now.dissipated_friction >= before.dissipated_friction - rounding);
        require(now.dissipated_rule >= before.dissipated_rule);
    }
    return 0;
}
