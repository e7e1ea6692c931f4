// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// What is recorded can be replayed; test_find_package.py sends a recording through `palpate replay`.
#include "palpate/trace_recorder.hpp"

#include <cmath>
#include <cstdlib>
#include <sstream>
#include <thread>

#include "test_field.h"

namespace {

std::vector<std::vector<std::string>> table_of(const std::string& path) {
    std::vector<std::vector<std::string>> rows;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        std::stringstream cells(line);
        rows.emplace_back();
        for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
    }
    return rows;
}

palpate_tool_state state_of(int i, std::uint32_t flags) {
    const double t = std::sin(0.1 * i);
    return {sizeof(palpate_tool_state), flags, 1e-3 + 1e-6 * t, {t, 1.0 / 3.0, -t}, {0, 0.6, 0, 0.8}, {t, 2, 3}, {0.6, 0, 0, 0.8}};
}

TEST(trace_recorder, every_number_comes_back_with_all_its_digits) {
    palpate::trace_recorder recorder(100);
    for (int i = 0; i < 50; ++i) recorder.record(state_of(i, i == 7 ? PALPATE_INPUT_RELEASE : 0u));
    const std::string path = testing::TempDir() + "palpate_trace.csv";
    ASSERT_TRUE(recorder.write_csv(path.c_str()));
    const auto rows = table_of(path);
    ASSERT_EQ(rows.size(), 51u);
    const std::vector<std::string> names{"dt", "x", "y", "z", "qx", "qy", "qz", "qw", "release"};
    EXPECT_EQ(rows[0], names);
    for (int i = 0; i < 50; ++i) {
        const auto s = state_of(i, 0);
        const double numbers[] = {s.dt, s.position[0], s.position[1], s.position[2], 0, 0.6, 0, 0.8, i == 7 ? 1.0 : 0.0};
        for (std::size_t c = 0; c < 9; ++c) EXPECT_EQ(std::strtod(rows[static_cast<std::size_t>(i) + 1][c].c_str(), nullptr), numbers[c]);
    }
    std::remove(path.c_str());
}

TEST(trace_recorder, an_organs_pose_holds_until_the_next_one_and_no_orientation_is_the_worlds) {
    palpate::trace_recorder recorder(3);
    recorder.record(state_of(0, PALPATE_INPUT_POSITION_ONLY));
    recorder.record(state_of(1, PALPATE_INPUT_ORGAN_POSE));
    recorder.record(state_of(2, 0));
    const std::string path = testing::TempDir() + "palpate_posed_trace.csv";
    ASSERT_TRUE(recorder.write_csv(path.c_str()));
    const auto rows = table_of(path);
    ASSERT_EQ(rows[0].size(), 16u);
    EXPECT_EQ(rows[1][7], "1");
    EXPECT_EQ(rows[1][15], "1");
    EXPECT_EQ(rows[2][10], "2");
    EXPECT_TRUE(std::equal(rows[2].begin() + 9, rows[2].end(), rows[3].begin() + 9));
    std::remove(path.c_str());
}

TEST(trace_recorder, a_full_room_drops_and_counts) {
    palpate::trace_recorder recorder(10);
    for (int i = 0; i < 25; ++i) recorder.record(state_of(i, 0));
    EXPECT_EQ(recorder.recorded(), 10u);
    EXPECT_EQ(recorder.dropped(), 15u);
    EXPECT_FALSE(recorder.write_csv("/nowhere/trace.csv"));
}

TEST(trace_recorder, another_thread_may_write_while_ticks_are_recorded) {
    palpate::trace_recorder recorder(200000);
    std::thread loop([&] {
        for (int i = 0; i < 200000; ++i) recorder.record(state_of(i, 0));
    });
    const std::string path = testing::TempDir() + "palpate_running_trace.csv";
    while (recorder.recorded() == 0) std::this_thread::yield();
    ASSERT_TRUE(recorder.write_csv(path.c_str()));
    loop.join();
    const auto rows = table_of(path);
    ASSERT_GT(rows.size(), 1u);
    EXPECT_EQ(std::strtod(rows.back()[1].c_str(), nullptr), state_of(static_cast<int>(rows.size()) - 2, 0).position[0]);
    std::remove(path.c_str());
}

}  // namespace
