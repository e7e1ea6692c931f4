// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/servo_thread.hpp"

#include "test_field.h"

namespace {

using namespace std::chrono_literals;

struct record {
    std::uint64_t number;
    std::uint64_t copies[30];
    unsigned char tail[3];
};

TEST(servo_thread, what_is_read_is_one_publication_whole) {
    palpate::latest<record> shared;
    record seen{};
    EXPECT_FALSE(shared.read(seen));
    std::atomic<bool> done{false};
    std::thread writer([&] {
        for (std::uint64_t n = 1; n <= 200000; ++n) {
            record r{};
            r.number = n;
            for (auto& c : r.copies) c = n;
            r.tail[2] = static_cast<unsigned char>(n);
            shared.publish(r);
        }
        done = true;
    });
    std::uint64_t last = 0;
    while (!done) {
        if (!shared.read(seen)) continue;
        for (const auto c : seen.copies) ASSERT_EQ(c, seen.number);
        ASSERT_EQ(seen.tail[2], static_cast<unsigned char>(seen.number));
        ASSERT_GE(seen.number, last);
        last = seen.number;
    }
    writer.join();
    ASSERT_TRUE(shared.read(seen));
    EXPECT_EQ(seen.number, 200000u);
}

TEST(servo_thread, a_session_ticks_in_it_and_another_thread_sees_the_force) {
    const opened_field plane("plane");
    const session_memory memory(plane.field);
    palpate::latest<palpate_tool_response> shared;
    double z = 9e-3;
    double shortest = 1.0;
    {
        palpate::servo_thread loop(1ms, [&](double dt) {
            shortest = dt < shortest ? dt : shortest;
            z = z > 3e-3 ? z - 1e-4 : z;
            shared.publish(memory.tick({-4e-3, 0, z}));
        });
        palpate_tool_response r{};
        const auto start = std::chrono::steady_clock::now();
        while (!(r.depth > 1.9e-3) && std::chrono::steady_clock::now() - start < 20s) {
            std::this_thread::sleep_for(1ms);
            shared.read(r);
        }
        EXPECT_GT(r.force[2], 0.05);
        EXPECT_GE(loop.ticks(), 60u);
    }
    EXPECT_GT(shortest, 0.0);
}

TEST(servo_thread, ticks_that_were_missed_are_counted_and_not_run_after) {
    std::atomic<int> calls{0};
    palpate::servo_thread loop(2ms, [&](double) {
        if (calls++ == 0) std::this_thread::sleep_for(41ms);
    });
    const auto start = std::chrono::steady_clock::now();
    while (calls < 4 && std::chrono::steady_clock::now() - start < 20s) std::this_thread::sleep_for(1ms);
    loop.stop();
    const auto periods = (std::chrono::steady_clock::now() - start) / 2ms;
    EXPECT_GE(loop.missed(), 19u);
    EXPECT_LE(loop.ticks() + loop.missed(), static_cast<std::uint64_t>(periods) + 3u);
}

}  // namespace
