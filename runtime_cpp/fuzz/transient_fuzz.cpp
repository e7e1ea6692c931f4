// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Any bytes as limits of a transient layer and a trace on it; the field is the one that PALPATE_FUZZ_FIELD names.  Beside it ticks
// the same field without the layer.  Laws: answers are finite, all but force and torque are the field's own, the force stays within
// what the device gives for a moment, the account is the work recomputed outside, and given <= events energy_max + one tick's work.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <vector>

#include "crc32.h"
#include "layers/transient.h"
#include "palpate/palpate.h"
#include "rfield_layout.h"

namespace {

void require(bool law) {
    if (!law) std::abort();
}

const std::vector<unsigned char>& file_bytes() {
    static const std::vector<unsigned char>& bytes = *[] {  // never freed
        const char* path = std::getenv("PALPATE_FUZZ_FIELD");
        std::ifstream file(path != nullptr ? path : "", std::ios::binary);
        auto* read = new std::vector<unsigned char>{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
        palpate::rfield_header head{};
        if (read->size() >= sizeof head) std::memcpy(&head, read->data(), sizeof head);
        if (head.layer_size[palpate::layer_transient] == 0) {
            std::fprintf(stderr, "set PALPATE_FUZZ_FIELD to an .rfield with a transient layer\n");
            std::exit(2);
        }
        return read;
    }();
    return bytes;
}

palpate_field* opened(std::vector<unsigned char> bytes, palpate::rfield_header head) {
    head.checksum = 0;
    std::memcpy(bytes.data(), &head, sizeof head);
    head.checksum = palpate::crc32(0, bytes.data(), bytes.size());
    std::memcpy(bytes.data(), &head, sizeof head);
    palpate_field* field = nullptr;
    char why[256] = "";
    require(palpate_field_open(bytes.data(), bytes.size(), 0, &field, why, sizeof why) == PALPATE_OK);
    return field;
}

struct pair {
    palpate_field* field = nullptr;
    std::vector<std::uint64_t> memory;
    palpate_session* session = nullptr;
    palpate_tool_response out{};

    explicit pair(palpate_field* f) : field(f), memory((palpate_session_size() + 7) / 8) {
        out.size = sizeof out;
        require(palpate_session_init(memory.data(), memory.size() * 8, field, nullptr, &session) == PALPATE_OK);
    }
    pair(const pair&) = delete;
    pair& operator=(const pair&) = delete;
    ~pair() { palpate_field_close(field); }
};

double length(const double v[3]) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 8) return 0;
    const std::vector<unsigned char>& bytes = file_bytes();
    palpate::rfield_header head;
    std::memcpy(&head, bytes.data(), sizeof head);
    const std::uint64_t at = head.layer_offset[palpate::layer_transient];
    palpate::transient_header limits;
    std::memcpy(&limits, bytes.data() + at, sizeof limits);
    limits.attenuation = data[0] / 255.0;
    limits.force_short = 0.05 * data[1];
    limits.force_steady = 0.01 * data[2];
    limits.energy_max = 1e-6 * data[3];
    limits.rearm_distance = 1e-5 * data[4];
    limits.rearm_time = 1e-3 * data[5];
    limits.velocity_min = 1e-3 * data[6];
    limits.velocity_time = 1e-4 * data[7];
    std::vector<unsigned char> changed = bytes;
    std::memcpy(changed.data() + at, &limits, sizeof limits);
    pair loud(opened(changed, head));
    head.layer_offset[palpate::layer_transient] = head.layer_size[palpate::layer_transient] = 0;
    pair still(opened(bytes, head));

    palpate_field_info info{};
    info.size = sizeof info;
    require(palpate_field_describe(loud.field, &info) == PALPATE_OK);
    palpate_tool_state state{sizeof state, PALPATE_INPUT_POSITION_ONLY, 1e-4, {0, 0, 0}, {0, 0, 0, 1}, {0, 0, 0}, {0, 0, 0, 1}};
    double start[3];
    for (int a = 0; a < 3; ++a) start[a] = state.position[a] = 0.5 * (info.box_min[a] + info.box_max[a]);
    start[2] = state.position[2] = info.tool_offset + 2e-4;  // the organ is the half space z < 0
    double given = 0.0, moved = 0.0, largest = 0.0, last_force[3] = {0, 0, 0}, last_point[3] = {0, 0, 0}, events = 0.0;
    bool known = false;
    for (std::size_t i = 8; i + 4 <= size; i += 4) {
        const std::uint8_t kind = data[i];
        state.flags = PALPATE_INPUT_POSITION_ONLY;
        state.dt = 1e-5 * (1 + data[i + 3]);
        const double scale = kind < 200 ? 1e-5 : kind < 230 ? 1e-4 : 2e-6;
        state.position[2] += scale * static_cast<std::int8_t>(data[i + 1]);
        state.position[0] += scale * static_cast<std::int8_t>(data[i + 2]);
        if (kind == 250) state.flags |= PALPATE_INPUT_RELEASE;
        if (kind == 251) state.position[1] = std::numeric_limits<double>::quiet_NaN();
        if (kind == 252) state.dt = -state.dt;
        if (kind == 253) {
            require(palpate_session_reset(loud.session) == PALPATE_OK && palpate_session_reset(still.session) == PALPATE_OK);
            given = moved = largest = events = 0.0;
            known = false;
        }
        if (kind == 254) state.dt = 0.5;
        palpate_tick(loud.session, &state, &loud.out);
        palpate_tick(still.session, &state, &still.out);
        const palpate_tool_response &l = loud.out, &s = still.out;
        require((l.status & ~(PALPATE_TICK_TRANSIENT | PALPATE_TICK_TRANSIENT_LIMITED)) == s.status);
        require(l.depth == s.depth && l.region == s.region && l.stored_energy == s.stored_energy && l.work_in == s.work_in);
        require(l.dissipated_friction == s.dissipated_friction && l.dissipated_rule == s.dissipated_rule && l.hold_leak == s.hold_leak);
        double f[3];
        for (int a = 0; a < 3; ++a) {
            require(std::isfinite(l.force[a]) && std::isfinite(l.torque[a]) && l.reference_point[a] == s.reference_point[a]);
            f[a] = l.force[a] - s.force[a];
        }
        require((l.status & PALPATE_TICK_TRANSIENT) != 0 || length(f) == 0.0);
        const double most = limits.force_short > length(s.force) ? limits.force_short : length(s.force);
        require(length(l.force) <= most * (1.0 + 1e-9) + 1e-12);
        const bool usable = (l.status & PALPATE_TICK_BAD_INPUT) == 0;
        if (usable && known) {
            double work = 0.0;
            for (int a = 0; a < 3; ++a) {
                work += last_force[a] * (l.reference_point[a] - last_point[a]);
                moved += std::fabs(l.reference_point[a] - last_point[a]);
            }
            given += work > 0.0 ? work : 0.0;
            largest = work > largest ? work : largest;
        }
        double account[3];
        require(palpate_session_transient(loud.session, account) == PALPATE_OK);
        require(std::fabs(account[0] - given) <= 1e-11 * (1.0 + moved));
        require(account[0] <= account[2] * limits.energy_max + largest + 1e-11 * (1.0 + moved));
        require(account[1] >= 0.0 && account[2] >= events);
        events = account[2];
        known = usable;
        for (int a = 0; a < 3; ++a) {
            last_force[a] = usable ? f[a] : 0.0;
            last_point[a] = l.reference_point[a];
            if (!usable) state.position[a] = start[a];
        }
    }
    return 0;
}
