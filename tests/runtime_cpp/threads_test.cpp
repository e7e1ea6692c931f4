// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// What threads may do to each other's sessions: move the organ, open a field for it, close the one before.  The laws here are
// those of one thread; that nothing else is shared is for the thread sanitizer to say (PALPATE_SANITIZE_THREAD).
#include <atomic>
#include <cmath>
#include <thread>

#include "test_field.h"

namespace {

struct organ_memory {
    std::vector<std::uint64_t> bytes = std::vector<std::uint64_t>((palpate_organ_size() + 7) / 8);
    palpate_organ* organ = nullptr;
    organ_memory() { EXPECT_EQ(palpate_organ_init(bytes.data(), bytes.size() * 8, &organ), PALPATE_OK); }
};

// Publishes poses of an organ that breathes by 1 mm and rocks by 0.02 rad, until told to stop.
struct breathing {
    const organ_memory memory;
    std::atomic<bool> stop{false};
    std::atomic<long> poses{0};
    std::thread mover;
    explicit breathing(double duration)
        : mover([this, duration] {
              while (!stop.load(std::memory_order_relaxed)) {
                  const double phase = 1e-2 * static_cast<double>(poses.fetch_add(1, std::memory_order_relaxed));
                  const double half = 0.01 * std::sin(phase), position[3] = {1e-3 * std::sin(phase), 0.0, 1e-3 * std::cos(phase)};
                  const double orientation[4] = {half, 0.0, 0.0, std::sqrt(1.0 - half * half)};
                  if (palpate_organ_move(memory.organ, position, orientation, duration) != PALPATE_OK) return;
                  std::this_thread::yield();
              }
          }) {}
    ~breathing() {
        stop = true;
        mover.join();
    }
};

point press(int tick, double x) { return {x, 0.0, 4e-3 + 2e-3 * std::sin(3e-3 * tick)}; }

void expect_balance(const palpate_tool_response& r) {
    const double in = r.work_in + r.organ_work + r.hold_leak;
    EXPECT_NEAR(in, r.stored_energy + r.dissipated_friction + r.dissipated_rule, 1e-11);
    for (const double f : r.force) EXPECT_TRUE(std::isfinite(f));
}

TEST(threads, two_hands_feel_an_organ_that_a_third_thread_moves_smoothly_and_no_joule_is_lost) {
    const opened_field plane("plane");
    const breathing organ(1.0 / 60.0);
    const auto hand = [&](double x) {
        const session_memory tool(plane.field, 0.0, 0.3);
        EXPECT_EQ(palpate_session_set_organ(tool.session, organ.memory.organ), PALPATE_OK);
        int felt = 0;
        palpate_tool_response r{};
        // Where the organ hardly moves at first, since other programs have the processor, the hands go on.
        for (int i = 0; i < 20000 || (i < 2000000 && (felt <= 5000 || organ.poses <= 10)); ++i) {
            if (i >= 20000) std::this_thread::yield();
            r = tool.tick(press(i, x));
            felt += r.normal_force > 0.0;
            expect_balance(r);
        }
        EXPECT_GT(felt, 5000);
        EXPECT_NE(r.organ_work, 0.0);
    };
    std::thread left([&] { hand(-4e-3); });
    hand(7e-3);
    left.join();
    EXPECT_GT(organ.poses, 10);
}

// The way to swap fields under a running servo loop: one thread opens and closes, the loop's own thread changes over.
struct swap_desk {
    std::atomic<const palpate_field*> offered{nullptr};  // for the loop to take
    std::atomic<const palpate_field*> returned{nullptr};  // no tick will read it again
    std::atomic<bool> pressed{false};
    std::atomic<long> ticks{0};

    // Until the tool presses, or for a while: a swap may release the contact.
    void wait_for_contact() const {
        const long from = ticks.load();
        while (!pressed.load() && ticks.load() - from < 5000) std::this_thread::yield();
    }
};

TEST(threads, a_field_opened_on_another_thread_is_taken_while_pressed_and_the_one_before_closed_there) {
    const auto plane = file_bytes("plane"), slab = file_bytes("slab"), tilted = file_bytes("tilted");
    const breathing organ(1.0 / 60.0);
    swap_desk desk;
    constexpr int swaps = 60;
    palpate_field* first = nullptr;
    ASSERT_EQ(palpate_field_open(plane.data(), plane.size(), 0, &first, nullptr, 0), PALPATE_OK);
    std::atomic<bool> done{false};
    std::thread librarian([&] {
        const std::vector<unsigned char>* files[3] = {&tilted, &slab, &plane};
        palpate_field* now = first;
        for (int i = 0; i < swaps; ++i) {
            const auto& bytes = *files[i % 3];
            palpate_field* next = nullptr;
            EXPECT_EQ(palpate_field_open(bytes.data(), bytes.size(), 0, &next, nullptr, 0), PALPATE_OK);
            desk.wait_for_contact();
            desk.offered.store(next, std::memory_order_release);
            while (desk.returned.load(std::memory_order_acquire) != now) std::this_thread::yield();
            palpate_field_close(now);
            now = next;
        }
        done = true;
        while (desk.returned.load(std::memory_order_acquire) != now) std::this_thread::yield();
        palpate_field_close(now);
    });

    const session_memory tool(first, 0.0, 0.3);
    EXPECT_EQ(palpate_session_set_organ(tool.session, organ.memory.organ), PALPATE_OK);
    const palpate_field* using_now = first;
    int taken = 0, pressed = 0;
    palpate_tool_response before{};
    for (int i = 0; !done.load(std::memory_order_acquire) || desk.offered.load(std::memory_order_acquire) != nullptr; ++i) {
        const palpate_field* next = desk.offered.exchange(nullptr, std::memory_order_acq_rel);
        if (next != nullptr) {
            EXPECT_EQ(palpate_session_set_field(tool.session, next), PALPATE_OK);
        }
        const palpate_tool_response r = tool.tick(press(i, 2e-3));
        expect_balance(r);
        EXPECT_GE(r.dissipated_rule, before.dissipated_rule);
        if (next != nullptr) {
            desk.returned.store(using_now, std::memory_order_release);
            using_now = next;
            ++taken;
            pressed += before.stored_energy > 0.0 && r.stored_energy > 0.0;
        }
        before = r;
        desk.pressed = r.stored_energy > 0.0;
        ++desk.ticks;
        if (i % 64 == 0) std::this_thread::yield();
    }
    desk.returned.store(using_now, std::memory_order_release);
    librarian.join();
    EXPECT_EQ(taken, swaps);
    EXPECT_GT(pressed, 0) << "no field was changed while pressed";
}

}  // namespace
