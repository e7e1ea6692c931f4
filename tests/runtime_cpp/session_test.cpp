// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include <thread>

#include "test_field.h"

namespace {

TEST(session, refuses_memory_that_is_too_small_or_misaligned_and_null_pointers) {
    const opened_field plane("plane");
    std::vector<std::uint64_t> memory((palpate_session_size() + 15) / 8);
    palpate_session* s = nullptr;
    EXPECT_EQ(palpate_session_init(memory.data(), palpate_session_size() - 1, plane.field, nullptr, &s), PALPATE_BAD_ARGUMENT);
    EXPECT_EQ(palpate_session_init(reinterpret_cast<char*>(memory.data()) + 4, palpate_session_size(), plane.field, nullptr, &s),
              PALPATE_BAD_ARGUMENT);
    EXPECT_EQ(palpate_session_init(nullptr, 4096, plane.field, nullptr, &s), PALPATE_BAD_ARGUMENT);
    EXPECT_EQ(palpate_session_init(memory.data(), palpate_session_size(), nullptr, nullptr, &s), PALPATE_BAD_ARGUMENT);
    EXPECT_EQ(palpate_session_init(memory.data(), palpate_session_size(), plane.field, nullptr, nullptr), PALPATE_BAD_ARGUMENT);
    EXPECT_EQ(s, nullptr);
    EXPECT_EQ(palpate_session_init(memory.data(), palpate_session_size(), plane.field, nullptr, &s), PALPATE_OK);
    EXPECT_EQ(palpate_session_reset(nullptr), PALPATE_BAD_ARGUMENT);
    EXPECT_LT(palpate_session_size(), 5120u);  // the cells of response and masks that are kept between ticks are most of it
}

TEST(session, refuses_structs_smaller_than_its_own_and_leaves_the_tail_of_larger_ones_alone) {
    const opened_field plane("plane");
    const session_memory memory(plane.field);
    palpate_tool_state state{sizeof state, PALPATE_INPUT_POSITION_ONLY, 1e-3, {0, 0, 9e-3}, {0, 0, 0, 1}, {0, 0, 0}, {0, 0, 0, 1}};
    struct larger {
        palpate_tool_response response;
        std::uint64_t tail;
    } out{};
    out.tail = 0x1234;
    out.response.size = sizeof(palpate_tool_response) - 1;
    EXPECT_EQ(palpate_tick(memory.session, &state, &out.response), PALPATE_TICK_BAD_ARGUMENT);
    out.response.size = sizeof out;
    EXPECT_EQ(palpate_tick(memory.session, &state, &out.response), 0u);
    EXPECT_EQ(out.tail, 0x1234u);
    state.size = 8;
    EXPECT_EQ(palpate_tick(memory.session, &state, &out.response), PALPATE_TICK_BAD_ARGUMENT);
    EXPECT_EQ(palpate_tick(nullptr, nullptr, nullptr), PALPATE_TICK_BAD_ARGUMENT);
}

TEST(session, a_copy_of_the_bytes_is_a_snapshot) {
    const opened_field plane("plane");
    const session_memory memory(plane.field);
    for (int i = 0; i < 300; ++i) memory.tick({-4e-3 + 1e-6 * i, 0, 8e-3 - 2e-5 * i});
    session_memory copy(plane.field);
    palpate_session* snapshot = nullptr;
    ASSERT_EQ(palpate_session_snapshot(memory.session, copy.bytes.data(), copy.bytes.size() * 8, &snapshot), PALPATE_OK);
    ASSERT_EQ(snapshot, copy.session);
    for (int i = 0; i < 300; ++i) {
        const point p{-3.7e-3 + 1e-6 * i, 2e-6 * i, 2e-3 + 1e-5 * i};
        const palpate_tool_response a = memory.tick(p), b = copy.tick(p);
        ASSERT_EQ(std::memcmp(&a, &b, sizeof a), 0);
    }
}

TEST(session, threads_share_a_field_and_get_the_same_answers) {
    const opened_field plane("plane");
    const auto run = [&plane](double* sum) {
        const session_memory memory(plane.field);
        for (int i = 0; i < 20000; ++i) *sum += memory.tick({-4e-3 + 5e-7 * i, 0, i < 300 ? 8e-3 - 2e-5 * i : 2e-3}).force[0];
    };
    double sums[4] = {};
    std::vector<std::thread> threads;
    for (double& sum : sums) threads.emplace_back(run, &sum);
    for (auto& t : threads) t.join();
    for (double sum : sums) EXPECT_EQ(sum, sums[0]);
    EXPECT_NE(sums[0], 0.0);
}

}  // namespace
