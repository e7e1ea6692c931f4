// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// palpate_counted_ticks FIELD.rfield stick|slide|free|first: runs the bench's trace of that kind once.  The ticks that count go through
// counted_tick, so that callgrind counts the instructions of these alone (instructions.sh).  Prints how many they are.
#include <algorithm>
#include <cstdio>
#include <string>

#include "bench_paths.h"

using namespace palpate_bench_paths;

extern "C" {
// Found by its name in this program, so it must be a function of its own.
__attribute__((noinline)) std::uint32_t counted_tick(palpate_session* session, const palpate_tool_state* state,
                                                     palpate_tool_response* response) {
    return palpate_tick(session, state, response);
}
}

int main(int count, char** arguments) {
    const std::string kind = count == 3 ? arguments[2] : "";
    palpate_field* field = nullptr;
    char why[512] = "usage: palpate_counted_ticks FIELD.rfield stick|slide|free|first";
    if (count != 3 || palpate_field_open_file(arguments[1], &field, why, sizeof why) != PALPATE_OK) {
        std::fprintf(stderr, "%s\n", why);
        return 2;
    }
    const auto at = contacts(field, 100, 1);
    const auto path = kind == "stick"   ? sticking(at)
                      : kind == "slide" ? sliding(field, at)
                      : kind == "free"  ? hovering(field, at)
                                        : tapping(field, at);
    std::vector<std::uint64_t> memory((palpate_session_size() + 7) / 8);
    palpate_session* session = nullptr;
    palpate_config config;
    palpate_config_default(&config);
    config.speed_max = 0.0;
    palpate_session_init(memory.data(), memory.size() * 8, field, &config, &session);
    palpate_tool_state state{};
    state.size = sizeof state;
    state.flags = PALPATE_INPUT_POSITION_ONLY;
    state.dt = 1e-3;
    palpate_tool_response response{};
    response.size = sizeof response;
    unsigned long counted = 0;
    for (const tick& t : path) {
        std::copy(t.q.begin(), t.q.end(), state.position);
        (t.timed ? counted_tick : palpate_tick)(session, &state, &response);
        counted += t.timed;
    }
    palpate_field_close(field);
    std::printf("%lu\n", counted);
    return 0;
}
