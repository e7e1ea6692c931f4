// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// How much stack a tick needs, measured: a thread on painted memory, and where the paint is gone afterwards.
#include <random>

#include "test_field.h"

#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__)
#include <pthread.h>

namespace {

constexpr std::size_t stack_size = 1u << 20u;
constexpr unsigned char paint = 0xA5;

struct work {
    palpate_session* session;
    bool ticks;
    const palpate_field* fields[2];  // changed to in turn
    palpate_organ* organ;            // moved beside the ticks
};

void* run(void* argument) {
    const auto& w = *static_cast<work*>(argument);
    std::uint64_t random = 1;
    point p{0, 0, 8e-3};
    palpate_tool_state state{sizeof state, 0, 1e-3, {0, 0, 0}, {0, 0, 0, 1}, {0, 0, 0}, {0, 0, 0, 1}};
    palpate_tool_response r{};
    r.size = sizeof r;
    for (int i = 0; w.ticks && i < 200000; ++i) {
        for (std::size_t a = 0; a < 3; ++a) {
            random = random * 6364136223846793005u + 1442695040888963407u;
            const double step = static_cast<double>(random >> 33u) * 0x1p-30 - 1.0;
            p[a] += (i % 50 == 0 ? 8e-3 : 1e-4) * step - 1e-2 * (p[a] - (a == 2 ? 4e-3 : 0.0));
            state.position[a] = p[a];
        }
        const double t = 2e2 * (p[0] - p[1]), place[3] = {0.01 * p[0], 0, 0.01 * p[1]};
        state.orientation[0] = t < -0.1 ? -0.1 : t > 0.1 ? 0.1 : t;
        if (i % 16 == 0) palpate_organ_move(w.organ, place, state.orientation, 1.0 / 60.0);
        if (i % 100 == 0) palpate_session_set_field(w.session, w.fields[i / 100 % 2]);
        palpate_tick(w.session, &state, &r);
    }
    return nullptr;
}

std::size_t stack_used(work w) {
    std::vector<std::uint64_t> stack(stack_size / 8 + 512);
    auto at = reinterpret_cast<std::uintptr_t>(stack.data());
    at += (4096 - at % 4096) % 4096;
    auto* low = reinterpret_cast<unsigned char*>(at);
    std::memset(low, paint, stack_size);
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    EXPECT_EQ(pthread_attr_setstack(&attributes, low, stack_size), 0);
    pthread_t thread;
    EXPECT_EQ(pthread_create(&thread, &attributes, run, &w), 0);
    pthread_join(thread, nullptr);
    pthread_attr_destroy(&attributes);
    std::size_t untouched = 0;
    while (untouched < stack_size && low[untouched] == paint) ++untouched;
    return stack_size - untouched;
}

TEST(stack, a_tick_needs_less_than_eight_kilobytes_tilted_on_a_moving_organ_changing_fields) {
    const opened_field plane("plane"), tilted("tilted");
    session_memory memory(plane.field);
    std::vector<std::uint64_t> organ_memory((palpate_organ_size() + 7) / 8);
    palpate_organ* organ = nullptr;
    ASSERT_EQ(palpate_organ_init(organ_memory.data(), organ_memory.size() * 8, &organ), PALPATE_OK);
    palpate_config config;
    palpate_config_default(&config);
    config.force_max = 0.1;
    config.passivity_control = 1;
    ASSERT_EQ(palpate_session_init(memory.bytes.data(), memory.bytes.size() * 8, plane.field, &config, &memory.session), PALPATE_OK);
    ASSERT_EQ(palpate_session_set_organ(memory.session, organ), PALPATE_OK);
    const std::size_t thread_alone = stack_used({memory.session, false, {tilted.field, plane.field}, organ});
    const std::size_t with_ticks = stack_used({memory.session, true, {tilted.field, plane.field}, organ});
    ASSERT_GT(with_ticks, thread_alone);
    RecordProperty("bytes", static_cast<int>(with_ticks - thread_alone));
    std::printf("stack: %zu bytes\n", with_ticks - thread_alone);
    EXPECT_LT(with_ticks - thread_alone, 8192u);
}

}  // namespace
#endif
