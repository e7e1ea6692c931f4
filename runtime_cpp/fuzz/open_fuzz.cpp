// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Any bytes as an .rfield.  What identifies the file (magic, version, sizes, checksum) is made to fit, so that the
// fuzzer spends its time behind those gates; what opens must then survive samples and ticks with finite answers.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "crc32.h"
#include "palpate/palpate.h"
#include "rfield_layout.h"

namespace {

void require(bool law) {
    if (!law) std::abort();
}

void exercise(const palpate_field* field) {
    palpate_field_info info{};
    info.size = sizeof info;
    require(palpate_field_describe(field, &info) == PALPATE_OK);
    std::vector<std::uint64_t> memory((palpate_session_size() + 7) / 8);
    palpate_session* session = nullptr;
    require(palpate_session_init(memory.data(), memory.size() * 8, field, nullptr, &session) == PALPATE_OK);
    palpate_tool_state state{sizeof state, PALPATE_INPUT_POSITION_ONLY, 1e-3, {0, 0, 0}, {0, 0, 0, 1}, {0, 0, 0}, {0, 0, 0, 1}};
    palpate_tool_response response{};
    response.size = sizeof response;
    std::uint32_t random = 1;
    for (int i = 0; i < 200; ++i) {
        for (int a = 0; a < 3; ++a) {
            random = random * 1664525u + 1013904223u;
            const double t = static_cast<double>(random >> 8) / 16777216.0;
            state.position[a] = info.box_min[a] + (1.2 * t - 0.1) * (info.box_max[a] - info.box_min[a]);
        }
        palpate_sample sample{};
        sample.size = sizeof sample;
        require(palpate_field_sample(field, state.position, 1, &sample) == PALPATE_OK);
        palpate_tick(session, &state, &response);
        require(std::isfinite(sample.stored_energy) && std::isfinite(sample.stiffness) && std::isfinite(sample.depth));
        for (int a = 0; a < 3; ++a) require(std::isfinite(sample.force[a]) && std::isfinite(response.force[a]));
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    std::vector<std::uint8_t> bytes(data, data + size);
    if (size >= sizeof(rfield_header)) {
        rfield_header h;
        std::memcpy(&h, bytes.data(), sizeof h);
        std::memcpy(h.magic, rfield_magic, sizeof h.magic);
        constexpr std::uint32_t older_count = sizeof rfield_older_versions / sizeof *rfield_older_versions;
        const std::uint32_t layout = h.version % (older_count + 1);  // every one, 0 for the newest
        const rfield_older_version newest{rfield_version, rfield_layout_hash, static_cast<std::uint32_t>(sizeof h)};
        const rfield_older_version& one = layout == 0 ? newest : rfield_older_versions[layout - 1];
        h.version = one.version;
        h.header_size = one.header_size;
        h.layout_hash = one.layout_hash;
        h.section_count = rfield_section_count;
        h.file_size = size;
        h.checksum = 0;
        std::memcpy(bytes.data(), &h, sizeof h);
        h.checksum = crc32(0, bytes.data(), bytes.size());
        std::memcpy(bytes.data(), &h, sizeof h);
    }
    palpate_field* field = nullptr;
    char why[256];
    if (palpate_field_open(bytes.data(), bytes.size(), 0, &field, why, sizeof why) == PALPATE_OK) exercise(field);
    palpate_field_close(field);
    return 0;
}
