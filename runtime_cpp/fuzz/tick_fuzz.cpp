// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Any bytes as a trace on one of the fields that the environment variable PALPATE_FUZZ_FIELD names (up to four, with ':'
// between them).  Laws: answers are finite, the energy accounts balance with the work recomputed outside, dissipation never falls,
// limits are kept; with every adhesion function, device limits, axial responses, changes to a field three times as stiff, tilts (on a
// field with several ways of touching), a moving organ, published poses, and whole states of any bytes.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "crc32.h"
#include "palpate/palpate.h"
#include "rfield_layout.h"

namespace {

void require(bool law) {
    if (!law) std::abort();
}

struct subject {
    palpate_field* soft = nullptr;   // the one that was named
    palpate_field* stiff = nullptr;  // three times as stiff
    double start[3] = {0, 0, 0};     // m; free, 0.2 mm above the tissue where there is some below the box's middle
};

// From the top of the box down, until contact is near.
void place_above(subject& s) {
    palpate_field_info info{};
    info.size = sizeof info;
    require(palpate_field_describe(s.soft, &info) == PALPATE_OK);
    for (int a = 0; a < 3; ++a) s.start[a] = 0.5 * (info.box_min[a] + info.box_max[a]);
    for (double z = info.box_max[2]; z > info.box_min[2]; z -= 1e-4) {
        const double q[3] = {s.start[0], s.start[1], z};
        palpate_sample sample{};
        sample.size = sizeof sample;
        require(palpate_field_sample(s.soft, q, 1, &sample) == PALPATE_OK);
        if (sample.region != PALPATE_REGION_FREE || sample.depth < -2e-4) continue;
        s.start[2] = z;
        return;
    }
}

subject opened(const std::string& path) {
    subject s;
    std::ifstream file(path, std::ios::binary);
    std::vector<char> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    char why[256] = "";
    if (palpate_field_open(bytes.data(), bytes.size(), 0, &s.soft, why, sizeof why) != PALPATE_OK) {
        std::fprintf(stderr, "set PALPATE_FUZZ_FIELD to .rfield files, with ':' between them; '%s': %s\n", path.c_str(), why);
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
    require(palpate_field_open(bytes.data(), bytes.size(), 0, &s.stiff, why, sizeof why) == PALPATE_OK);
    place_above(s);
    return s;
}

const std::vector<subject>& subjects() {
    static const std::vector<subject>& all = *[] {  // never closed
        const char* named = std::getenv("PALPATE_FUZZ_FIELD");
        std::stringstream paths(named != nullptr ? named : "");
        auto* found = new std::vector<subject>;
        for (std::string path; std::getline(paths, path, ':') && found->size() < 4;) found->push_back(opened(path));
        if (found->empty()) found->push_back(opened(""));
        return found;
    }();
    return all;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::uint8_t choices = size > 1 ? data[1] : 0;
    const subject& organ = subjects()[(choices >> 6) % subjects().size()];
    std::vector<std::uint64_t> memory((palpate_session_size() + 7) / 8), organ_memory((palpate_organ_size() + 7) / 8);
    palpate_session* session = nullptr;
    palpate_organ* moved_organ = nullptr;
    require(palpate_organ_init(organ_memory.data(), organ_memory.size() * 8, &moved_organ) == PALPATE_OK);
    palpate_config config;
    palpate_config_default(&config);
    config.friction_coefficient = size > 0 ? data[0] / 64.0 : 0.0;
    config.adhesion = 1u + choices % 4u;
    config.force_max = (choices & 4u) != 0 ? 0.05 : 0.0;
    config.passivity_control = choices >> 3 & 1u;
    config.response = (choices & 16u) != 0 ? 1u + (choices >> 5 & 1u) : 0u;
    require(palpate_session_init(memory.data(), memory.size() * 8, organ.soft, &config, &session) == PALPATE_OK);

    palpate_tool_state state{sizeof state, PALPATE_INPUT_POSITION_ONLY, 1e-3, {0, 0, 0}, {0, 0, 0, 1}, {0, 0, 0}, {0, 0, 0, 1}};
    for (int a = 0; a < 3; ++a) state.position[a] = organ.start[a];
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
        } else if (kind == 250) {  // a whole state of any bytes; what is missing stays
            const std::size_t whole = sizeof state - sizeof state.size, left = size - i, taken = left < whole ? left : whole;
            std::memcpy(reinterpret_cast<char*>(&state) + sizeof state.size, data + i, taken);
            i += taken;
        } else if (kind == 251) {  // published: up to 2.5 mm, 0.06 rad, in up to 51 ms
            double place[3], turned[4] = {0, 0, 0, 1};
            for (std::size_t a = 0; a < 3; ++a) place[a] = 2e-5 * static_cast<std::int8_t>(data[i + a]);
            for (std::size_t a = 0; a < 3; ++a) turned[a] = 5e-4 * static_cast<std::int8_t>(data[i + 3 + a]);
            palpate_organ_move(moved_organ, place, turned, 2e-4 * data[i + 6]);
            i += 7;
            require(palpate_session_set_organ(session, moved_organ) == PALPATE_OK);
        } else if (kind == 252) {
            std::memcpy(state.position, data + i, sizeof state.position);
            i += sizeof state.position;
        } else if (kind == 253) {
            std::memcpy(&state.dt, data + i, sizeof state.dt);
            i += sizeof state.dt;
        } else if (kind == 254) {
            state.flags |= PALPATE_INPUT_RELEASE;
        } else {
            palpate_session_set_field(session, (data[i++] & 1u) != 0 ? organ.stiff : organ.soft);
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
            for (int a = 0; a < 3; ++a) {
                state.position[a] = organ.start[a];
                state.orientation[a] = state.organ_position[a] = state.organ_orientation[a] = 0.0;
            }
            state.orientation[3] = state.organ_orientation[3] = 1.0;
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
