// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Any bytes as a trace on the field named by the environment variable PALPATE_FUZZ_FIELD.  Laws: answers are finite,
// the energy accounts balance with the work recomputed outside, dissipation never falls, limits are kept; with every
// adhesion function, device limits, axial responses, changes to a field three times as stiff, tilts (on a field with several ways
// of touching) and a moving organ.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <vector>

#include "crc32.h"
#include "palpate/palpate.h"
#include "rfield_layout.h"

namespace {

void require(bool law) {
    if (!law) std::abort();
}

struct two_fields {
    palpate_field* soft = nullptr;   // the one that was named
    palpate_field* stiff = nullptr;  // three times as stiff
};

const two_fields& fields() {
    static const two_fields opened = [] {
        two_fields f;
        const char* path = std::getenv("PALPATE_FUZZ_FIELD");
        std::ifstream file(path != nullptr ? path : "", std::ios::binary);
        std::vector<char> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
        char why[256] = "";
        if (palpate_field_open(bytes.data(), bytes.size(), 0, &f.soft, why, sizeof why) != PALPATE_OK) {
            std::fprintf(stderr, "set PALPATE_FUZZ_FIELD to an .rfield: %s\n", why);
            std::exit(2);
        }
        palpate::rfield_header head;
        std::memcpy(&head, bytes.data(), sizeof head);
        for (std::uint64_t i = 0; i < head.section_elements[palpate::section_energy_curves]; ++i) {
            char* at = bytes.data() + head.section_offset[palpate::section_energy_curves] + 8 * i;
            double c;
            std::memcpy(&c, at, 8);
            c *= 3.0;
            std::memcpy(at, &c, 8);
        }
        head.checksum = 0;
        std::memcpy(bytes.data(), &head, sizeof head);
        head.checksum = palpate::crc32(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
        std::memcpy(bytes.data(), &head, sizeof head);
        require(palpate_field_open(bytes.data(), bytes.size(), 0, &f.stiff, why, sizeof why) == PALPATE_OK);
        return f;
    }();
    return opened;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const palpate_field* field = fields().soft;
    palpate_field_info info{};
    info.size = sizeof info;
    palpate_field_describe(field, &info);
    std::vector<std::uint64_t> memory((palpate_session_size() + 7) / 8);
    palpate_session* session = nullptr;
    palpate_config config;
    palpate_config_default(&config);
    config.friction_coefficient = size > 0 ? data[0] / 64.0 : 0.0;
    const std::uint8_t choices = size > 1 ? data[1] : 0;
    config.adhesion = 1u + choices % 4u;
    config.force_max = (choices & 4u) != 0 ? 0.05 : 0.0;
    config.passivity_control = choices >> 3 & 1u;
    config.response = (choices & 16u) != 0 ? 1u + (choices >> 5 & 1u) : 0u;
    require(palpate_session_init(memory.data(), memory.size() * 8, field, &config, &session) == PALPATE_OK);

    palpate_tool_state state{sizeof state, PALPATE_INPUT_POSITION_ONLY, 1e-3, {0, 0, 0}, {0, 0, 0, 1}, {0, 0, 0}, {0, 0, 0, 1}};
    for (int a = 0; a < 3; ++a) state.position[a] = 0.5 * (info.box_min[a] + info.box_max[a]);
    palpate_tool_response before{}, now{};
    now.size = sizeof now;
    double work = 0.0, moved = 0.0;
    bool known = false;
    // Each tick takes one byte of kind and then what it needs.
    for (std::size_t i = 2; i + 25 <= size;) {
        const std::uint8_t kind = data[i++];
        const palpate_tool_state last = state;
        state.dt = 1e-3;
        state.flags = PALPATE_INPUT_POSITION_ONLY;
        if (kind < 8) {  // the organ moves by up to 2.5 mm and turns by up to 0.13 rad; with kind < 4 the tool turns
            double* turned = kind < 4 ? state.orientation : state.organ_orientation;
            state.flags = kind < 4 ? 0u : PALPATE_INPUT_POSITION_ONLY | PALPATE_INPUT_ORGAN_POSE;
            for (int a = 0; a < 3; ++a) {
                turned[a] = 1e-3 * static_cast<std::int8_t>(data[i + static_cast<std::size_t>(a)]) * (kind < 4 ? 7.0 : 0.5);
                if (kind >= 4) state.organ_position[a] = 2e-5 * static_cast<std::int8_t>(data[i + 3 + static_cast<std::size_t>(a)]);
            }
            i += 6;
            const double rest = 1.0 - turned[0] * turned[0] - turned[1] * turned[1] - turned[2] * turned[2];
            turned[3] = rest > 0.0 ? std::sqrt(rest) : 0.0;
        } else if (kind < 250) {  // 20 um, 160 um or 2.6 mm a count
            const double scale = kind < 200 ? 2e-5 : kind < 240 ? 1.6e-4 : 2.6e-3;
            for (int a = 0; a < 3; ++a) state.position[a] += scale * static_cast<std::int8_t>(data[i++]);
        } else if (kind < 253) {
            std::memcpy(state.position, data + i, sizeof state.position);
            i += sizeof state.position;
        } else if (kind == 253) {
            std::memcpy(&state.dt, data + i, sizeof state.dt);
            i += sizeof state.dt;
        } else if (kind == 254) {
            state.flags |= PALPATE_INPUT_RELEASE;
        } else {
            palpate_session_set_field(session, (data[i++] & 1u) != 0 ? fields().stiff : fields().soft);
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
        if (config.force_max > 0.0) {
            require(std::sqrt(now.force[0] * now.force[0] + now.force[1] * now.force[1] + now.force[2] * now.force[2]) <=
                    config.force_max * (1.0 + 1e-15));
        }
        if (!usable) {
            for (int a = 0; a < 3; ++a) state.position[a] = 0.5 * (info.box_min[a] + info.box_max[a]);
            state.dt = 1e-3;
        }
        const double rounding = 1e-12 * (1.0 + moved);
        require(std::fabs(now.work_in - work) <= rounding);
        require(std::fabs(now.work_in + now.organ_work + now.injected + now.hold_leak - now.stored_energy - now.dissipated_friction -
                          now.dissipated_rule) <= rounding);
        require(config.response == PALPATE_RESPONSE_AXIAL_UNGUARDED || now.injected == 0.0);
        require(now.dissipated_friction >= before.dissipated_friction - rounding);
        require(now.dissipated_rule >= before.dissipated_rule);
    }
    return 0;
}
