// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "guard.h"

#include <cmath>
#include <limits>

#include "test_field.h"

namespace palpate {
namespace {

TEST(guard, releasing_dissipates_what_is_left_or_leaks_what_was_overdrawn) {
    accounts books{};
    release(books, 1e-3, 2e-3);
    EXPECT_DOUBLE_EQ(books.dissipated_rule, 3e-3);
    EXPECT_EQ(books.hold_leak, 0.0);
    release(books, -5e-3, 2e-3);
    EXPECT_DOUBLE_EQ(books.dissipated_rule, 3e-3);
    EXPECT_DOUBLE_EQ(books.hold_leak, 3e-3);
    EXPECT_DOUBLE_EQ(books.work_in, -4e-3);
}

TEST(guard, the_hold_is_what_work_does_not_explain) {
    accounts books{};
    hold(books, 1e-3, 2e-3, 3.5e-3);
    EXPECT_DOUBLE_EQ(books.hold_leak, 0.5e-3);
}

TEST(guard, every_number_that_is_not_usable_is_a_fault) {
    const double inf = std::numeric_limits<double>::infinity();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const palpate_tool_state good{sizeof good, 0, 1e-3, {0, 0, 0}, {0, 0, 0, 1}, {0, 0, 0}, {0, 0, 0, 1}};
    EXPECT_EQ(input_fault(good), 0u);
    for (double bad : {inf, -inf, nan, 1e300}) {
        for (int i = 0; i < 8; ++i) {
            palpate_tool_state state = good;
            (i == 0 ? state.dt : i < 4 ? state.position[i - 1] : state.orientation[i - 4]) = bad;
            EXPECT_EQ(input_fault(state), PALPATE_TICK_BAD_INPUT) << i << " " << bad;
        }
    }
    for (double dt : {0.0, -1.0}) {
        palpate_tool_state state = good;
        state.dt = dt;
        EXPECT_EQ(input_fault(state), PALPATE_TICK_BAD_INPUT);
    }
    palpate_tool_state state = good;
    state.orientation[3] = 0.0;
    EXPECT_EQ(input_fault(state), PALPATE_TICK_BAD_INPUT);
    state.flags = PALPATE_INPUT_POSITION_ONLY;
    EXPECT_EQ(input_fault(state), 0u);
}

TEST(guard, the_reference_point_turns_with_the_grip) {
    const double half = std::sqrt(0.5);
    const palpate_tool_state state{sizeof state, 0, 1e-3, {1, 2, 3}, {0, 0, half * 1.001, half * 1.001}, {0, 0, 0}, {0, 0, 0, 1}};  // 90 degrees about z
    const double in_grip[3] = {0.1, 0.2, 0.3};
    double q[3];
    reference_point(state, in_grip, q);
    EXPECT_NEAR(q[0], 1 - 0.2, 1e-15);
    EXPECT_NEAR(q[1], 2 + 0.1, 1e-15);
    EXPECT_NEAR(q[2], 3 + 0.3, 1e-15);
}

}  // namespace
}  // namespace palpate
