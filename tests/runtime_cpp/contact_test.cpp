// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Limits, the leak's cover and changed fields: none may create energy.  Beside the accounts' balance, each tick's leak is
// held against 1/2 sigma |dq|^2: a force that is not the gradient of the stored energy would exceed it.
#include <cmath>
#include <random>

#include "session.h"
#include "test_field.h"

namespace {

struct hand {
    std::vector<std::uint64_t> bytes = std::vector<std::uint64_t>((palpate_session_size() + 7) / 8);
    palpate_session* session = nullptr;
    double sigma, depth_max;
    point before{};
    palpate_tool_response last{};
    double work = 0.0;

    hand(const palpate_field* field, const palpate_config& config) {
        palpate_field_info info{};
        info.size = sizeof info;
        palpate_field_describe(field, &info);
        sigma = info.stiffness_max;
        depth_max = info.depth_max;
        EXPECT_EQ(palpate_session_init(bytes.data(), bytes.size() * 8, field, &config, &session), PALPATE_OK);
    }

    palpate_tool_response move(const point& p) {
        palpate_tool_state state{sizeof state, PALPATE_INPUT_POSITION_ONLY, 1e-3, {p[0], p[1], p[2]}, {0, 0, 0, 1}, {0, 0, 0}, {0, 0, 0, 1}};
        palpate_tool_response r{};
        r.size = sizeof r;
        palpate_tick(session, &state, &r);
        if (last.size != 0) {
            double moved = 0.0, done = 0.0;
            for (std::size_t a = 0; a < 3; ++a) {
                moved += (p[a] - before[a]) * (p[a] - before[a]);
                done -= last.force[a] * (p[a] - before[a]);
            }
            work += done;
            EXPECT_NEAR(r.work_in, work, 1e-12);
            if (r.depth <= depth_max && last.depth <= depth_max) {
                EXPECT_LE(r.hold_leak - last.hold_leak, 0.5 * sigma * moved + 1e-14);
            }
        }
        EXPECT_NEAR(r.work_in + r.hold_leak, r.stored_energy + r.dissipated_friction + r.dissipated_rule, 1e-12);
        EXPECT_GE(r.dissipated_rule, last.dissipated_rule);
        EXPECT_GE(r.dissipated_friction, last.dissipated_friction - 1e-16);
        before = p;
        last = r;
        return r;
    }
};

palpate_config config_with(double friction) {
    palpate_config c;
    palpate_config_default(&c);
    c.speed_max = 0.0;
    c.friction_coefficient = friction;
    return c;
}

double length(const double v[3]) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

// Presses, drags over the stiffness step and lifts, `ticks` for each way; the place at tick i of 4 ticks.
point cycle(int i, int ticks) {
    const double t = static_cast<double>(i) / ticks;
    const double down = t < 1.0 ? t : t < 3.0 ? 1.0 : 4.0 - t;
    const double across = t < 1.0 ? 0.0 : t < 3.0 ? 0.5 * (t - 1.0) : 1.0;
    return {-2e-3 + 9e-3 * across, 0.0, 5.2e-3 - 4.2e-3 * down};
}

TEST(contact, the_force_never_exceeds_the_limit_and_the_surface_comes_back) {
    const opened_field plane("plane");
    for (double friction : {0.0, 0.3, 1.0}) {
        palpate_config c = config_with(friction);
        c.force_max = 0.1;
        hand h(plane.field, c);
        bool limited = false;
        double offset = 0.0, step = 0.0, previous[3] = {0, 0, 0};
        for (int i = 0; i <= 8000; ++i) {
            const palpate_tool_response r = h.move(cycle(i, 2000));
            ASSERT_LE(length(r.force), 0.1);
            limited = limited || (r.status & PALPATE_TICK_FORCE_LIMITED) != 0;
            offset = std::fmax(offset, r.surface_offset);
            double jump[3];
            for (int a = 0; a < 3; ++a) {
                jump[a] = r.force[a] - previous[a];
                previous[a] = r.force[a];
            }
            step = std::fmax(step, length(jump));
        }
        EXPECT_TRUE(limited);
        EXPECT_GT(offset, 1e-3);
        EXPECT_LT(step, 0.01);  // 2 um a tick: the limit sets in without a jump
        EXPECT_EQ(h.last.surface_offset, 0.0);
        EXPECT_EQ(h.last.stored_energy, 0.0);
        EXPECT_GT(h.last.dissipated_rule, 1e-5);
    }
}

TEST(contact, a_limit_never_creates_energy_on_any_walk) {
    for (const char* name : {"plane", "sphere"}) {
        const opened_field opened(name);
        for (double friction : {0.0, 0.3}) {
            palpate_config c = config_with(friction);
            c.force_max = 0.05;
            c.passivity_control = friction == 0.0;
            hand h(opened.field, c);
            std::mt19937_64 random(8);
            std::normal_distribution<double> normal;
            const point home{-3e-3, 0.0, name[0] == 'p' ? 6e-3 : 36e-3};
            point p = home;
            for (int i = 0; i < 50000; ++i) {
                for (std::size_t a = 0; a < 3; ++a) p[a] = home[a] + 0.999 * (p[a] - home[a]) + 6e-5 * normal(random) - (a == 2 ? 3e-6 : 0.0);
                ASSERT_LE(length(h.move(p).force), 0.05);
            }
            EXPECT_GT(h.last.dissipated_rule, 0.0);
        }
    }
}

TEST(contact, the_cover_takes_the_leak_back) {
    const opened_field plane("plane");
    double gain[2] = {0, 0};
    for (std::uint32_t control : {0u, 1u}) {
        palpate_config c = config_with(0.0);
        c.passivity_control = control;
        hand h(plane.field, c);
        for (int i = 0; i <= 4000; ++i) h.move({2e-3, 0.0, 3.5e-3 - 2.2e-3 * std::sin(0.21 * i)});
        h.move({2e-3, 0.0, 6e-3});
        gain[control] = -h.last.work_in;
    }
    EXPECT_GT(gain[0], 1e-4);  // held forces feed an oscillating hand
    EXPECT_LT(gain[1], 0.02 * gain[0]);
}

TEST(contact, a_changed_field_never_holds_more_energy) {
    const opened_field plane("plane"), slab("slab");
    auto bytes = file_bytes("plane");
    palpate::rfield_header head;
    std::memcpy(&head, bytes.data(), sizeof head);
    auto* curve = reinterpret_cast<double*>(bytes.data() + head.section_offset[palpate::section_energy_curves]);
    for (std::uint64_t i = 0; i < head.section_elements[palpate::section_energy_curves]; ++i) curve[i] *= 3.0;
    reseal(bytes);
    palpate_field* stiff = nullptr;
    ASSERT_EQ(palpate_field_open(bytes.data(), bytes.size(), 0, &stiff, nullptr, 0), PALPATE_OK);

    hand h(plane.field, config_with(0.2));
    h.sigma *= 3.0;
    for (int i = 0; i <= 1500; ++i) h.move(cycle(i, 1000));
    const palpate_tool_response soft = h.last;
    ASSERT_GT(soft.stored_energy, 1e-5);

    ASSERT_EQ(palpate_session_set_field(h.session, stiff), PALPATE_OK);
    const palpate_tool_response swapped = h.move(h.before);
    EXPECT_GT(swapped.surface_offset, 1e-4);
    EXPECT_LE(swapped.stored_energy, soft.stored_energy);
    EXPECT_NEAR(swapped.stored_energy - swapped.spring_energy, soft.stored_energy - soft.spring_energy, 1e-9 * soft.stored_energy);
    EXPECT_GT(swapped.force[2], soft.force[2]);

    ASSERT_EQ(palpate_session_set_field(h.session, plane.field), PALPATE_OK);
    const palpate_tool_response back = h.move(h.before);
    EXPECT_LE(back.stored_energy, swapped.stored_energy);

    for (int i = 3000; i <= 4000; ++i) h.move({h.before[0], 0.0, cycle(i, 1000)[2]});
    EXPECT_EQ(h.last.surface_offset, 0.0);
    EXPECT_EQ(h.last.stored_energy, 0.0);
    EXPECT_EQ(palpate_session_set_field(nullptr, stiff), PALPATE_BAD_ARGUMENT);
    EXPECT_EQ(palpate_session_set_field(h.session, nullptr), PALPATE_BAD_ARGUMENT);
    palpate_field_close(stiff);
}

TEST(contact, a_field_changed_to_one_without_contact_lets_go_and_is_entered_from_outside_only) {
    const opened_field plane("plane"), slab("slab");
    hand h(plane.field, config_with(0.2));
    for (int i = 0; i <= 1000; ++i) h.move(cycle(i, 1000));
    const double stored = h.last.stored_energy;
    palpate_session_set_field(h.session, slab.field);  // 3 mm of tissue above z = 0: another depth here
    const palpate_tool_response r = h.move(h.before);
    EXPECT_LE(r.stored_energy, stored);

    hand free(slab.field, config_with(0.2));
    free.move({-2e-3, 0.0, 8.5e-3});
    palpate_session_set_field(free.session, plane.field);
    free.move({-2e-3, 0.0, 8.5e-3});
    EXPECT_EQ(free.move({-2e-3, 0.0, 4.5e-3}).status & PALPATE_TICK_WAITING, 0u);
    hand inside(plane.field, config_with(0.2));
    inside.move({-2e-3, 0.0, 5.5e-3});
    palpate_session_set_field(inside.session, slab.field);  // free in the one, in the tissue of the other
    EXPECT_EQ(inside.move({-2e-3, 0.0, 5.5e-3}).status, static_cast<std::uint32_t>(PALPATE_TICK_WAITING));
    EXPECT_EQ(length(inside.move({-2e-3, 0.0, 5.4e-3}).force), 0.0);
}

}  // namespace
