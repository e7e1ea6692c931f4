// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Poses from another thread: never torn, never waited for.  Run with -fsanitize=thread too.
#include "organ.h"

#include <atomic>
#include <cmath>
#include <thread>

#include "session.h"
#include "test_field.h"

namespace {

struct organ_memory {
    std::vector<std::uint64_t> bytes = std::vector<std::uint64_t>((palpate_organ_size() + 7) / 8);
    palpate_organ* organ = nullptr;
    organ_memory() { EXPECT_EQ(palpate_organ_init(bytes.data(), bytes.size() * 8, &organ), PALPATE_OK); }
};

TEST(organ, two_sessions_on_their_own_threads_follow_one_that_a_third_moves) {
    const opened_field plane("plane");
    const organ_memory memory;
    std::atomic<bool> stop{false};
    std::thread mover([&] {
        for (std::uint64_t i = 0; !stop.load(std::memory_order_relaxed); ++i) {
            // Position and orientation belong together: a torn pose would not have both of the same i.
            const double a = 0.1 * std::sin(1e-3 * static_cast<double>(i));
            const double position[3] = {1e-2 * a, 0.0, 1e-2 * a}, orientation[4] = {0.0, 0.0, a, std::sqrt(1.0 - a * a)};
            EXPECT_EQ(palpate_organ_move(memory.organ, position, orientation, 0.0), PALPATE_OK);
        }
    });
    const auto follow = [&](double x) {
        const session_memory tool(plane.field, 0.0, 0.2);
        EXPECT_EQ(palpate_session_set_organ(tool.session, memory.organ), PALPATE_OK);
        int felt = 0;
        for (int i = 0; i < 60000; ++i) {
            const palpate_tool_response r = tool.tick({x, 0.0, 4.5e-3 + 1e-3 * std::sin(1e-2 * i)});
            felt += r.force[2] > 0.0;
            const palpate::rigid& now = tool.session->organ.now;
            if (tool.session->organ.posed) {
                EXPECT_NEAR(now.position[0], 1e-2 * now.orientation[2], 1e-15);
            }
            EXPECT_NEAR(r.work_in + r.organ_work + r.hold_leak, r.stored_energy + r.dissipated_friction + r.dissipated_rule, 1e-11);
        }
        EXPECT_GT(felt, 1000);
    };
    std::thread one([&] { follow(-3e-3); });
    std::thread two([&] { follow(3e-3); });
    one.join();
    two.join();
    stop = true;
    mover.join();
}

TEST(organ, wrong_arguments_are_refused) {
    palpate_organ* organ = reinterpret_cast<palpate_organ*>(1);
    std::uint64_t room[4];
    EXPECT_EQ(palpate_organ_init(room, sizeof room, &organ), PALPATE_BAD_ARGUMENT);
    EXPECT_EQ(organ, nullptr);
    EXPECT_EQ(palpate_organ_init(nullptr, 1u << 20, &organ), PALPATE_BAD_ARGUMENT);
    const organ_memory memory;
    const double place[3] = {0, 0, 0}, upright[4] = {0, 0, 0, 1}, none[4] = {0, 0, 0, 0};
    EXPECT_EQ(palpate_organ_move(memory.organ, place, none, 0.0), PALPATE_BAD_ARGUMENT);
    EXPECT_EQ(palpate_organ_move(memory.organ, place, upright, -1.0), PALPATE_BAD_ARGUMENT);
    EXPECT_EQ(palpate_organ_move(memory.organ, nullptr, upright, 0.0), PALPATE_BAD_ARGUMENT);
    EXPECT_EQ(palpate_organ_move(nullptr, place, upright, 0.0), PALPATE_BAD_ARGUMENT);
    EXPECT_EQ(palpate_session_set_organ(nullptr, memory.organ), PALPATE_BAD_ARGUMENT);
}

TEST(organ, a_reset_session_takes_the_latest_pose_at_once) {
    const opened_field plane("plane");
    const organ_memory memory;
    const session_memory tool(plane.field, 0.0, 0.2);
    palpate_session_set_organ(tool.session, memory.organ);
    const double up[3] = {0, 0, 0.5}, upright[4] = {0, 0, 0, 1};
    palpate_organ_move(memory.organ, up, upright, 10.0);
    for (int pass = 0; pass < 2; ++pass) {
        tool.tick({0, 0, 0.5 + 8e-3});
        EXPECT_GT(tool.tick({0, 0, 0.5 + 4e-3}).force[2], 0.0);
        palpate_session_reset(tool.session);
    }
}

}  // namespace
