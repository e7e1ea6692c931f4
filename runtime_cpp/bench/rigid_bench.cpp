// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "rigid_bench.h"

#include <chrono>
#include <vector>

namespace {

using clock_type = std::chrono::steady_clock;

double since(clock_type::time_point begun) { return std::chrono::duration<double, std::nano>(clock_type::now() - begun).count(); }

}  // namespace

extern "C" palpate_status palpate_bench_rigid(const palpate_rigid* rigid, const palpate_rigid_config* config,
                                              const palpate_rigid_state* states, size_t count, double* identify_ns, double* tick_ns) {
    if (rigid == nullptr || states == nullptr || identify_ns == nullptr || tick_ns == nullptr) return PALPATE_BAD_ARGUMENT;
    double clock_cost = 1e9;
    for (int i = 0; i < 1000; ++i) {
        const double cost = since(clock_type::now());
        if (cost < clock_cost) clock_cost = cost;
    }
    std::vector<double> memory((palpate_rigid_session_size() + 7) / 8);
    palpate_rigid_response out{};
    out.size = sizeof out;
    for (int run = 0; run < 5; ++run) {
        palpate_rigid_session* session = nullptr;
        const palpate_status status = palpate_rigid_session_init(memory.data(), memory.size() * 8, rigid, config, &session);
        if (status != PALPATE_OK) return status;
        for (size_t i = 0; i < count; ++i) {
            auto begun = clock_type::now();
            palpate_rigid_tick(session, states + i, &out);
            const double whole = since(begun) - clock_cost;
            palpate_rigid_state at = states[i];
            palpate_rigid_session_place(session, at.position, at.orientation);
            begun = clock_type::now();
            palpate_rigid_identify(rigid, &at, &out, 1);
            const double found = since(begun) - clock_cost;
            if (run == 0 || whole < tick_ns[i]) tick_ns[i] = whole;
            if (run == 0 || found < identify_ns[i]) identify_ns[i] = found;
        }
    }
    return PALPATE_OK;
}
