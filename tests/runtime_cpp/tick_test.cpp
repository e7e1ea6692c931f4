// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <cmath>
#include <cstring>
#include <random>

#include "counted_allocations.h"
#include "executed_fetches.h"
#include "session.h"
#include "test_field.h"

std::atomic<long> allocations{0};

#if defined(PALPATE_COUNT_ALLOCATIONS)
extern "C" {
void* __real_malloc(std::size_t size);
void* __real_calloc(std::size_t count, std::size_t size);
void* __real_realloc(void* memory, std::size_t size);
void* __real_aligned_alloc(std::size_t alignment, std::size_t size);
void* __wrap_malloc(std::size_t size) { return ++allocations, __real_malloc(size); }
void* __wrap_calloc(std::size_t count, std::size_t size) { return ++allocations, __real_calloc(count, size); }
void* __wrap_realloc(void* memory, std::size_t size) { return ++allocations, __real_realloc(memory, size); }
void* __wrap_aligned_alloc(std::size_t alignment, std::size_t size) { return ++allocations, __real_aligned_alloc(alignment, size); }
}
void* operator new(std::size_t size) {
    ++allocations;
    void* memory = std::malloc(size);
    if (memory == nullptr) std::abort();
    return memory;
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
#endif

namespace {

// A walk through everything: free, contact, slip, deep, unreached, jumps, bad numbers.
point adventurous(std::mt19937_64& random, point p) {
    std::normal_distribution<double> normal;
    const auto dice = random() % 1000;
    const double scale = dice < 900 ? 5e-5 : dice < 990 ? 1e-3 : 2e-2;
    for (double& x : p) x = std::fmod(x + scale * normal(random), 25e-3);
    if (dice == 999) p[dice % 3] = std::nan("");
    return p;
}

TEST(tick, a_million_ticks_allocate_nothing) {
    const opened_field plane("plane");
    const session_memory memory(plane.field, 10.0);
    std::mt19937_64 random(1);
    point p{0, 0, 8e-3};
    std::uint32_t seen = 0, regions = 0;
#if defined(PALPATE_COUNT_ALLOCATIONS)
    const long at_first = allocations;
    EXPECT_GT(at_first, 0) << "the counter does not count";
#endif
    for (int i = 0; i < 1000000; ++i) {
        p = adventurous(random, std::isfinite(p[0] + p[1] + p[2]) ? p : point{0, 0, 8e-3});
        const palpate_tool_response r = memory.tick(p);
        seen |= r.status;
        regions |= 1u << r.region;
    }
#if defined(PALPATE_COUNT_ALLOCATIONS)
    EXPECT_EQ(allocations, at_first);
#endif
    const std::uint32_t wanted = PALPATE_TICK_EXTRAPOLATED | PALPATE_TICK_SLIPPING | PALPATE_TICK_UNREACHED | PALPATE_TICK_TOO_DEEP |
                                 PALPATE_TICK_PASSED_THROUGH | PALPATE_TICK_WAITING | PALPATE_TICK_JUMP | PALPATE_TICK_BAD_INPUT;
    EXPECT_EQ(seen & wanted, wanted) << "the walk did not meet everything";
    EXPECT_EQ(regions, 0x3Fu);
}

TEST(tick, tilts_organ_motion_changed_fields_limits_and_axial_responses_allocate_nothing) {
    const opened_field tilted("tilted"), plane("plane");
    std::vector<std::uint64_t> organ_memory((palpate_organ_size() + 7) / 8);
    palpate_organ* organ = nullptr;
    ASSERT_EQ(palpate_organ_init(organ_memory.data(), organ_memory.size() * 8, &organ), PALPATE_OK);
    std::mt19937_64 random(4);
    std::normal_distribution<double> normal;
    std::uint32_t seen = 0;
    for (std::uint32_t response : {0u, 1u, 2u}) {
        const session_memory memory(tilted.field);
        palpate_config config;
        palpate_config_default(&config);
        config.response = response;
        config.force_max = 0.05;
        config.passivity_control = 1;
        palpate_session* session = nullptr;
        auto bytes = memory.bytes;
        ASSERT_EQ(palpate_session_init(bytes.data(), bytes.size() * 8, tilted.field, &config, &session), PALPATE_OK);
        palpate_session_set_organ(session, organ);
        const long at_first = allocations;
        point p{0, 0, 8e-3};
        for (int i = 0; i < 100000; ++i) {
            p = adventurous(random, std::isfinite(p[0] + p[1] + p[2]) ? p : point{0, 0, 8e-3});
            for (std::size_t a = 0; a < 3; ++a) p[a] += 0.01 * ((a == 2 ? 3e-3 : 0.0) - p[a]);
            const double t = 0.1 * normal(random), turned[4] = {t, 0, 0, 1.0}, place[3] = {1e-4 * t, 0, 1e-4 * t};
            if (i % 16 == 0) palpate_organ_move(organ, place, turned, 1.0 / 60.0);
            if (i % 100 == 0) palpate_session_set_field(session, i % 200 == 0 ? plane.field : tilted.field);
            palpate_tool_state state{sizeof state, 0, 1e-3, {p[0], p[1], p[2]}, {t, -t, 0, 1.0}, {0, 0, 0}, {0, 0, 0, 1}};
            palpate_tool_response r{};
            r.size = sizeof r;
            seen |= palpate_tick(session, &state, &r);
        }
        EXPECT_EQ(allocations, at_first);
    }
    const std::uint32_t wanted = PALPATE_TICK_RULE_YIELDED | PALPATE_TICK_FORCE_LIMITED | PALPATE_TICK_LEAK_COVERED | PALPATE_TICK_SLIPPING;
    EXPECT_EQ(seen & wanted, wanted);
}

TEST(tick, accounts_balance_and_dissipation_never_falls_on_any_walk) {
    for (const char* name : {"plane", "sphere", "slab"}) {
        const opened_field opened(name);
        for (double friction : {-1.0, 0.0, 0.3, 5.0}) {
            const session_memory memory(opened.field, 0.0, friction);
            std::mt19937_64 random(2);
            point p{0, 0, name[1] == 'p' ? 38e-3 : 9e-3}, before = p;
            palpate_tool_response last{};
            double work = 0.0;
            bool known = false;
            for (int i = 0; i < 50000; ++i) {
                p = adventurous(random, std::isfinite(p[0] + p[1] + p[2]) ? p : point{0, 0, 9e-3});
                const bool usable = std::isfinite(p[0] + p[1] + p[2]);
                const palpate_tool_response r = memory.tick(p);
                if (usable && known) {
                    for (std::size_t a = 0; a < 3; ++a) work -= last.force[a] * (p[a] - before[a]);
                }
                known = usable;
                before = p;
                ASSERT_NEAR(r.work_in, work, 1e-10);
                ASSERT_NEAR(r.work_in + r.hold_leak, r.stored_energy + r.dissipated_friction + r.dissipated_rule, 1e-10);
                ASSERT_GE(r.dissipated_friction, last.dissipated_friction - 1e-16);
                ASSERT_GE(r.dissipated_rule, last.dissipated_rule);
                ASSERT_GE(r.spring_energy, 0.0);
                last = r;
            }
            EXPECT_GT(last.dissipated_rule, 0.0);
        }
    }
}

TEST(tick, looking_ahead_is_done_and_changes_no_answer) {
    const opened_field sphere("sphere");
    const session_memory one(sphere.field), other(sphere.field);
    std::mt19937_64 random(5);
    int looks = 0, felt = 0;
    for (int i = 0; i < 50000; ++i) {
        point p{0, 0, 36e-3};
        if (i % 5000 > 0) {
            const double a = 2e-4 * (i % 5000), b = 1e-3 * (i % 500), r = i % 500 < 20 ? 35.5e-3 : 33e-3 + 1e-6 * static_cast<double>(random() % 100);
            p = {r * std::sin(a) * std::cos(b), r * std::sin(a) * std::sin(b), r * std::cos(a)};
        }
        const palpate::fetched_cells before = one.session->fetched;
        const palpate_tool_response r = one.tick(p);
        looks += std::memcmp(&before, &one.session->fetched, sizeof before) != 0;
        other.session->ticks_since_look = static_cast<std::uint32_t>(random() % 8);
        if (random() % 2 == 0) palpate::forget(other.session->fetched.distance);
        const palpate_tool_response same = other.tick(p);
        ASSERT_EQ(std::memcmp(&r, &same, sizeof r), 0) << i;
        felt += r.normal_force > 0.0;
    }
    EXPECT_GT(looks, 1000);
    EXPECT_GT(felt, 30000);
}

#if defined(PALPATE_COUNTS_FETCHES)
TEST(tick, sliding_and_coming_near_fetch_from_memory) {
    if (!palpate_test::can_step()) GTEST_SKIP() << "nothing here stops after each instruction (an emulator, a debugger)";
    const opened_field sphere("sphere");
    const session_memory memory(sphere.field);
    long in_contact = 0, without_last_place = 0, in_free_space = 0;
    for (int i = 0; i < 16; ++i) {
        const double a = i < 4 ? 0.04 * i : 0.12 + 0.008 * (i - 4), r = i < 4 ? 35.5e-3 : 33e-3;  // 1.4 mm a tick in free space
        const auto one_tick = [&] { (void)memory.tick({r * std::sin(a), 0, r * std::cos(a)}); };
        if (i < 4 || i > 10) {  // an instruction takes microseconds so
            (i == 0 ? without_last_place : i < 4 ? in_free_space : in_contact) += palpate_test::executed_fetches(one_tick);
        } else {
            one_tick();
        }
    }
    EXPECT_GE(in_contact, 18);
    EXPECT_GE(without_last_place, 8);
    EXPECT_GE(in_free_space, 8);
}
#endif

TEST(tick, the_short_way_in_free_space_says_what_the_long_way_says) {
    const opened_field sphere("sphere");
    for (const double tip : {0.0, -0.1}) {
        palpate_config config;
        palpate_config_default(&config);
        config.reference_point[2] = tip;
        const session_memory quick(sphere.field, config), slow(sphere.field, config);
        std::mt19937_64 random(6);
        std::uniform_real_distribution<double> height(34.6e-3, 36e-3);
        palpate_tool_state state{};
        state.size = sizeof state;
        state.dt = 1e-3;
        state.orientation[3] = 1.0;
        palpate_tool_response one, other;
        int free = 0;
        for (int i = 0; i < 20000; ++i) {
            const double a = 1e-4 * i, r = i % 100 < 20 ? 33e-3 : height(random);
            state.position[0] = r * std::sin(a);
            state.position[2] = r * std::cos(a) - tip;
            state.flags = random() % 50 == 0 ? PALPATE_INPUT_RELEASE : 0;
            std::memset(&one, 0xA5, sizeof one);  // nothing may be left as it was
            std::memset(&other, 0x5A, sizeof other);
            one.size = other.size = sizeof one;
            one.reserved = other.reserved = 0;
            palpate_tick(quick.session, &state, &one);
            // Without a last place the long way is taken; in free space no answer depends on that place.
            if (one.region == PALPATE_REGION_FREE && !slow.session->touching) {
                slow.session->has_q = false;
                ++free;
            }
            palpate_tick(slow.session, &state, &other);
            ASSERT_EQ(std::memcmp(&one, &other, sizeof one), 0) << i;
            ASSERT_EQ(std::memcmp(quick.session, slow.session, sizeof *quick.session), 0) << i;
        }
        EXPECT_GT(free, 5000);
        EXPECT_NE(one.work_in, 0.0);
    }
}

TEST(tick, zero_force_bits_mean_zero_force) {
    const opened_field sphere("sphere");
    const session_memory memory(sphere.field, 10.0);
    std::mt19937_64 random(3);
    point p{0, 0, 36e-3};
    const std::uint32_t felt = PALPATE_TICK_EXTRAPOLATED | PALPATE_TICK_SLIPPING;
    for (int i = 0; i < 200000; ++i) {
        p = adventurous(random, std::isfinite(p[0] + p[1] + p[2]) ? p : point{0, 0, 36e-3});
        const palpate_tool_response r = memory.tick(p);
        const bool zero = r.force[0] == 0.0 && r.force[1] == 0.0 && r.force[2] == 0.0 && r.torque[0] == 0.0;
        if ((r.status & ~felt) != 0) {
            EXPECT_TRUE(zero) << r.status;
        }
        EXPECT_STRNE(palpate_tick_text(r.status), palpate_tick_text(1u << 31));
    }
}

TEST(tick, friction_lets_the_tool_turn_around_the_organ_without_losing_its_grip) {
    // A stuck ball carried along a parallel circle by less than the slip limit comes back with the energy of its work.
    const opened_field sphere("sphere");
    const session_memory memory(sphere.field, 0.0, 1e3);  // never slips
    memory.tick({-20e-3, 0, 40e-3});
    const double r = 32e-3;
    palpate_tool_response out{};
    for (int i = 0; i <= 2000; ++i) {
        const double a = 0.1 * std::sin(6.283185307179586 * i / 2000.0);
        out = memory.tick({-r * std::cos(0.8), r * std::sin(a) * std::sin(0.8), r * std::cos(a) * std::sin(0.8)});
    }
    EXPECT_EQ(out.status & PALPATE_TICK_SLIPPING, 0u);
    double s2 = 0.0;
    for (int a = 0; a < 3; ++a) s2 += (out.reference_point[a] - out.anchor[a]) * (out.reference_point[a] - out.anchor[a]);
    EXPECT_LT(std::sqrt(s2), 2e-5);  // out and back on the same arc of 3 mm: the stretch returns to nearly nothing
    EXPECT_GT(out.normal_force, 0.0);
}

}  // namespace
