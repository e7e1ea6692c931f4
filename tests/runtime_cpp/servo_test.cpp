// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "../../runtime_cpp/servo/servo.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include "test_field.h"

namespace {

using namespace std::chrono_literals;

const double upright[4] = {0, 0, 0, 1};

TEST(servo, two_threads_lead_and_read_while_it_ticks_and_fields_change) {
    const opened_field plane("plane"), slab("slab");
    const double above[3] = {-4e-3, 0, 9e-3}, deep[3] = {-4e-3, 0, 3e-3};
    palpate_servo* servo = nullptr;
    ASSERT_EQ(palpate_servo_start(plane.field, nullptr, 2000.0, above, upright, &servo), PALPATE_OK);
    std::atomic<bool> done{false};
    std::thread reader([&] {
        std::uint64_t last = 0;
        while (!done) {
            palpate_servo_state state{};
            state.size = sizeof state;
            if (palpate_servo_read(servo, &state) != PALPATE_OK) continue;
            ASSERT_GE(state.ticks, last);
            ASSERT_LE(state.position[2], above[2]);
            ASSERT_GE(state.position[2], deep[2]);
            last = state.ticks;
        }
    });
    for (int k = 0; k < 20; ++k) {
        ASSERT_EQ(palpate_servo_move(servo, k % 2 == 0 ? deep : above, upright, 5e-3, 0), PALPATE_OK);
        ASSERT_EQ(palpate_servo_set_field(servo, k % 4 == 0 ? slab.field : plane.field), PALPATE_OK);
        std::this_thread::sleep_for(6ms);
    }
    done = true;
    reader.join();
    palpate_servo_state state{};
    state.size = sizeof state;
    ASSERT_EQ(palpate_servo_read(servo, &state), PALPATE_OK);
    EXPECT_GT(state.contact_ticks, 0u);
    EXPECT_LE(state.contact_ticks, state.ticks);
    palpate_servo_stop(servo);
}

TEST(servo, what_is_not_usable_is_refused) {
    const opened_field plane("plane");
    const double above[3] = {-4e-3, 0, 9e-3}, nowhere[3] = {0, 0, std::nan("")}, long_one[4] = {0, 0, 0, 2};
    palpate_servo* servo = nullptr;
    EXPECT_EQ(palpate_servo_start(plane.field, nullptr, 1.0, above, upright, &servo), PALPATE_BAD_ARGUMENT);
    EXPECT_EQ(palpate_servo_start(plane.field, nullptr, 1e3, nowhere, upright, &servo), PALPATE_BAD_ARGUMENT);
    EXPECT_EQ(palpate_servo_start(nullptr, nullptr, 1e3, above, upright, &servo), PALPATE_BAD_ARGUMENT);
    EXPECT_EQ(servo, nullptr);
    ASSERT_EQ(palpate_servo_start(plane.field, nullptr, 1e3, above, upright, &servo), PALPATE_OK);
    EXPECT_EQ(palpate_servo_move(servo, above, long_one, 0.0, 0), PALPATE_BAD_ARGUMENT);
    EXPECT_EQ(palpate_servo_move(servo, above, upright, -1.0, 0), PALPATE_BAD_ARGUMENT);
    EXPECT_EQ(palpate_servo_move(servo, above, upright, 0.0, PALPATE_INPUT_ORGAN_POSE), PALPATE_BAD_ARGUMENT);
    EXPECT_EQ(palpate_servo_set_field(servo, nullptr), PALPATE_BAD_ARGUMENT);
    palpate_servo_state small{};
    small.size = 8;
    EXPECT_EQ(palpate_servo_read(servo, &small), PALPATE_BAD_ARGUMENT);
    palpate_servo_stop(servo);
    palpate_servo_stop(nullptr);
}

}  // namespace
