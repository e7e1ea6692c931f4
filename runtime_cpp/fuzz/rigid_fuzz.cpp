// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Any bytes as cooked rigid objects.  Size and checksum are made to fit; what opens must survive ticks with finite answers.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "crc32.h"
#include "layers/rigid_layout.h"
#include "palpate/rigid.h"

namespace {

void require(bool law) {
    if (!law) std::abort();
}

void exercise(const palpate_rigid* rigid, bool coupled) {
    palpate_rigid_config config;
    palpate_rigid_config_default(&config);
    if (coupled) {
        config.coupling_stiffness = 1000.0;
        config.coupling_damping = 10.0;
        config.coupling_torsional_stiffness = 1.0;
        config.coupling_torsional_damping = 0.01;
    }
    std::vector<std::uint64_t> memory((palpate_rigid_session_size() + 7) / 8);
    palpate_rigid_session* session = nullptr;
    require(palpate_rigid_session_init(memory.data(), memory.size() * 8, rigid, &config, &session) == PALPATE_OK);
    palpate_rigid_state state{sizeof state, 0, 1e-3, {0, 0, 0.08}, {0, 0, 0, 1}};
    palpate_rigid_response response{};
    response.size = sizeof response;
    for (int i = 0; i < 100; ++i) {
        state.position[0] += 1e-4;
        state.position[2] -= 1e-3;
        state.orientation[0] = 0.005 * i;
        state.orientation[3] = std::sqrt(1.0 - state.orientation[0] * state.orientation[0]);
        palpate_rigid_tick(session, &state, &response);
        require(response.contact_count <= PALPATE_RIGID_CONTACT_LIMIT);
        for (int a = 0; a < 3; ++a) require(std::isfinite(response.force[a]) && std::isfinite(response.torque[a]));
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    std::vector<std::uint8_t> bytes(data, data + size);
    if (size >= sizeof(rigid_header)) {
        rigid_header h;
        std::memcpy(&h, bytes.data(), sizeof h);
        h.magic = rigid_magic;
        h.version = rigid_version;
        h.byte_count = size;
        h.checksum = 0;
        std::memcpy(bytes.data(), &h, sizeof h);
        h.checksum = crc32(0, bytes.data(), size);
        std::memcpy(bytes.data(), &h, sizeof h);
    }
    palpate_rigid* rigid = nullptr;
    char message[128];
    const palpate_status status = palpate_rigid_open(bytes.data(), size, &rigid, message, sizeof message);
    require((status == PALPATE_OK) == (rigid != nullptr));
    if (rigid != nullptr) {
        exercise(rigid, false);
        exercise(rigid, true);
    }
    palpate_rigid_close(rigid);
    return 0;
}
