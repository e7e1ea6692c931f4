// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Whatever a host sends while the tool is pressed in: zero force, a status that says why, finite answers, books that balance, and
// contact again only from outside.
#include <cmath>
#include <limits>

#include "test_field.h"

namespace {

constexpr double outside[3] = {-4e-3, 0.0, 6e-3}, pressed[3] = {-4e-3, 0.0, 3e-3};

palpate_tool_state state_at(const double place[3], std::uint32_t flags) {
    return {sizeof(palpate_tool_state), flags, 1e-3, {place[0], place[1], place[2]}, {0, 0, 0, 1}, {0, 0, 0}, {0, 0, 0, 1}};
}

palpate_tool_response tick(palpate_session* session, const palpate_tool_state& state) {
    palpate_tool_response r{};
    r.size = sizeof r;
    EXPECT_EQ(palpate_tick(session, &state, &r), r.status);
    return r;
}

// All numbers of an answer, in a row.
void expect_finite(const palpate_tool_response& r) {
    const double* first = r.force;
    const auto count = (sizeof r - offsetof(palpate_tool_response, force)) / sizeof(double);
    for (std::size_t i = 0; i < count; ++i) EXPECT_TRUE(std::isfinite(first[i])) << i;
}

void expect_silence(const palpate_tool_response& r) {
    for (int a = 0; a < 3; ++a) {
        EXPECT_EQ(r.force[a], 0.0);
        EXPECT_EQ(r.torque[a], 0.0);
    }
    EXPECT_EQ(r.stored_energy, 0.0);
    EXPECT_NEAR(r.work_in + r.organ_work + r.hold_leak, r.dissipated_friction + r.dissipated_rule, 1e-15);
    expect_finite(r);
}

// The doubles of a tool state, by number: dt, position, orientation, organ position, organ orientation.
constexpr int number_count = 15;
double& number(palpate_tool_state& s, int i) {
    if (i == 0) return s.dt;
    if (i < 4) return s.position[i - 1];
    if (i < 8) return s.orientation[i - 4];
    return i < 11 ? s.organ_position[i - 8] : s.organ_orientation[i - 11];
}

struct bad_input : testing::Test {
    const opened_field plane{"plane"};
    const session_memory memory{plane.field, 10.0, 0.3};
    palpate_session* session = memory.session;

    void press(std::uint32_t flags) {
        palpate_session_reset(session);
        tick(session, state_at(outside, flags));
        ASSERT_GT(tick(session, state_at(pressed, flags)).force[2], 0.05);
    }
    void expect_refusal(const palpate_tool_state& bad, std::uint32_t bit, std::uint32_t flags) {
        press(flags);
        const palpate_tool_response r = tick(session, bad);
        EXPECT_NE(r.status & bit, 0u);
        expect_silence(r);
        const palpate_tool_response inside = tick(session, state_at(pressed, flags));
        EXPECT_NE(inside.status & (PALPATE_TICK_WAITING | PALPATE_TICK_JUMP), 0u);
        expect_silence(inside);
        auto far = state_at(outside, flags);
        far.dt = 0.09;
        tick(session, far);
        tick(session, far);
        EXPECT_GT(tick(session, state_at(pressed, flags)).force[2], 0.05);
    }
};

TEST_F(bad_input, any_number_that_is_not_one_releases_until_the_tool_was_outside) {
    const double inf = std::numeric_limits<double>::infinity();
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), inf, -inf, 1e300, -1e300}) {
        for (int i = 0; i < number_count; ++i) {
            const std::uint32_t flags = i < 8 ? 0u : PALPATE_INPUT_ORGAN_POSE;
            auto state = state_at(pressed, flags);
            number(state, i) = bad;
            expect_refusal(state, PALPATE_TICK_BAD_INPUT, flags);
        }
    }
}

TEST_F(bad_input, time_that_stands_still_runs_back_or_is_stale) {
    for (const double dt : {0.0, -0.0, -1e-3, -1e9}) {
        auto state = state_at(pressed, PALPATE_INPUT_POSITION_ONLY);
        state.dt = dt;
        expect_refusal(state, PALPATE_TICK_BAD_INPUT, PALPATE_INPUT_POSITION_ONLY);
    }
    for (const double dt : {0.1000001, 1.0, 1e8}) {
        auto state = state_at(pressed, PALPATE_INPUT_POSITION_ONLY);
        state.dt = dt;
        expect_refusal(state, PALPATE_TICK_STALE, PALPATE_INPUT_POSITION_ONLY);
    }
}

TEST_F(bad_input, orientations_that_are_no_rotation) {
    for (const double w : {0.0, 0.9, 1.1, 2.0, -2.0}) {
        for (const bool of_the_organ : {false, true}) {
            const std::uint32_t flags = of_the_organ ? PALPATE_INPUT_ORGAN_POSE : 0u;
            auto state = state_at(pressed, flags);
            (of_the_organ ? state.organ_orientation : state.orientation)[3] = w;
            expect_refusal(state, PALPATE_TICK_BAD_INPUT, flags);
        }
    }
}

TEST_F(bad_input, jumps_of_the_tool_or_of_the_organ_faster_than_the_device_can_move) {
    for (int axis = 0; axis < 3; ++axis) {
        for (const double step : {-0.02, 0.02, 5.0, 999.0}) {
            auto state = state_at(pressed, PALPATE_INPUT_POSITION_ONLY);
            state.position[axis] += step;
            expect_refusal(state, PALPATE_TICK_JUMP, PALPATE_INPUT_POSITION_ONLY);
            state = state_at(pressed, PALPATE_INPUT_ORGAN_POSE);
            state.organ_position[axis] += step;
            expect_refusal(state, PALPATE_TICK_JUMP, PALPATE_INPUT_ORGAN_POSE);
        }
    }
}

TEST_F(bad_input, a_burst_of_it_changes_nothing_more) {
    press(0);
    auto bad = state_at(pressed, 0);
    bad.position[1] = std::numeric_limits<double>::quiet_NaN();
    const palpate_tool_response first = tick(session, bad);
    for (int i = 0; i < 1000; ++i) {
        const palpate_tool_response again = tick(session, bad);
        ASSERT_EQ(std::memcmp(&again, &first, sizeof first), 0);
    }
}

TEST_F(bad_input, what_is_not_read_may_be_anything) {
    press(PALPATE_INPUT_POSITION_ONLY);
    auto state = state_at(pressed, PALPATE_INPUT_POSITION_ONLY);
    for (int i = 4; i < number_count; ++i) number(state, i) = std::numeric_limits<double>::quiet_NaN();
    const palpate_tool_response r = tick(session, state);
    EXPECT_EQ(r.status, 0u);
    EXPECT_GT(r.force[2], 0.05);
    expect_finite(r);
}

TEST_F(bad_input, batches_whose_structs_are_too_small_or_misaligned_are_refused_whole) {
    press(PALPATE_INPUT_POSITION_ONLY);
    palpate_tool_state states[3];
    palpate_tool_response out[3] = {}, untouched[3] = {};
    for (auto& s : states) s = state_at(pressed, PALPATE_INPUT_POSITION_ONLY);
    const auto sizes = [&](std::size_t in, std::size_t answer) {
        states[0].size = static_cast<std::uint32_t>(in);
        out[0].size = untouched[0].size = static_cast<std::uint32_t>(answer);
        return palpate_tick_batch(session, states, out, 3);
    };
    EXPECT_EQ(sizes(sizeof states[0] - 8, sizeof out[0]), PALPATE_TICK_BAD_ARGUMENT);
    EXPECT_EQ(sizes(sizeof states[0] + 4, sizeof out[0]), PALPATE_TICK_BAD_ARGUMENT);
    EXPECT_EQ(sizes(sizeof states[0], 0), PALPATE_TICK_BAD_ARGUMENT);
    EXPECT_EQ(sizes(sizeof states[0], sizeof out[0] + 4), PALPATE_TICK_BAD_ARGUMENT);
    EXPECT_EQ(palpate_tick_batch(session, nullptr, out, 3), PALPATE_TICK_BAD_ARGUMENT);
    EXPECT_EQ(palpate_tick_batch(session, states, nullptr, 3), PALPATE_TICK_BAD_ARGUMENT);
    EXPECT_EQ(palpate_tick_batch(nullptr, states, out, 3), PALPATE_TICK_BAD_ARGUMENT);
    EXPECT_EQ(palpate_tick_batch(session, states, out, 0), 0u);
    EXPECT_EQ(std::memcmp(out, untouched, sizeof out), 0);
    EXPECT_EQ(sizes(sizeof states[0], sizeof out[0]), 0u);
    EXPECT_GT(out[2].force[2], 0.05);
}

}  // namespace
