// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "friction.h"

#include <cmath>
#include <random>

#include "test_field.h"

namespace palpate {
namespace {

double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// The two changes that settle makes at once, each alone.
void stiffen(friction_spring& s, double stiffness) { settle(s, dot(s.stretch, s.stretch), stiffness, 1e100); }
bool yield(friction_spring& s, double limit) { return settle(s, dot(s.stretch, s.stretch), s.stiffness, limit); }

struct random_springs {
    std::mt19937_64 engine{5};
    std::normal_distribution<double> normal;
    point unit() {
        point v{normal(engine), normal(engine), normal(engine)};
        const double length = std::sqrt(dot(v.data(), v.data()));
        for (double& x : v) x /= length;
        return v;
    }
    friction_spring spring() {
        friction_spring s{};
        touch_down(s, unit().data());
        stiffen(s, std::exp(normal(engine)) * 100.0);
        const double step[3] = {1e-3 * normal(engine), 1e-3 * normal(engine), 1e-3 * normal(engine)};
        carry(s, step);
        return s;
    }
};

TEST(friction, a_spring_set_down_has_no_energy) {
    friction_spring s{};
    const double up[3] = {0, 0, 1};
    touch_down(s, up);
    EXPECT_EQ(spring_energy(s), 0.0);
}

TEST(friction, carrying_stretches_only_along_the_surface) {
    random_springs random;
    for (int i = 0; i < 1000; ++i) {
        const friction_spring s = random.spring();
        EXPECT_NEAR(dot(s.stretch, s.normal), 0.0, 1e-17);
    }
}

TEST(friction, carrying_changes_energy_by_the_hands_work_and_the_holds_share) {
    random_springs random;
    for (int i = 0; i < 1000; ++i) {
        friction_spring s = random.spring();
        const double before = spring_energy(s);
        const double step[3] = {1e-4 * random.normal(random.engine), 1e-4 * random.normal(random.engine), 1e-4 * random.normal(random.engine)};
        const double work = s.stiffness * dot(s.stretch, step);
        const double out = dot(step, s.normal);
        const double hold = 0.5 * s.stiffness * (dot(step, step) - out * out);
        carry(s, step);
        EXPECT_NEAR(spring_energy(s) - before, work + hold, 1e-14 * s.stiffness * 1e-2);
    }
}

TEST(friction, turning_keeps_length_and_energy_and_stays_in_the_new_plane) {
    random_springs random;
    for (int i = 0; i < 10000; ++i) {
        friction_spring s = random.spring();
        point n = random.unit();
        if (dot(n.data(), s.normal) < 0.0) {
            for (double& x : n) x = -x;
        }
        const double before = spring_energy(s);
        turn(s, n.data());
        EXPECT_NEAR(spring_energy(s), before, 1e-13 * before);
        EXPECT_NEAR(dot(s.stretch, n.data()), 0.0, 1e-17);
        for (int a = 0; a < 3; ++a) EXPECT_EQ(s.normal[a], n[static_cast<std::size_t>(a)]);
    }
}

TEST(friction, rising_stiffness_keeps_the_force_and_falling_stiffness_the_stretch) {
    friction_spring s{{1e-3, 0, 0}, {0, 0, 1}, 100.0};
    stiffen(s, 400.0);
    EXPECT_DOUBLE_EQ(s.stiffness * s.stretch[0], 0.1);
    EXPECT_DOUBLE_EQ(spring_energy(s), 0.5 * 400.0 * 0.25e-3 * 0.25e-3);
    stiffen(s, 40.0);
    EXPECT_DOUBLE_EQ(s.stretch[0], 0.25e-3);
}

TEST(friction, no_change_of_stiffness_or_limit_raises_energy) {
    random_springs random;
    for (int i = 0; i < 10000; ++i) {
        friction_spring s = random.spring();
        double before = spring_energy(s);
        stiffen(s, i % 10 == 0 ? 0.0 : std::exp(3.0 * random.normal(random.engine)) * 100.0);
        EXPECT_LE(spring_energy(s), before * (1 + 1e-15));
        before = spring_energy(s);
        const double limit = i % 7 == 0 ? 0.0 : std::exp(random.normal(random.engine)) * 0.1;
        const bool slipped = yield(s, limit);
        EXPECT_LE(spring_energy(s), before * (1 + 1e-15));
        EXPECT_LE(s.stiffness * std::sqrt(dot(s.stretch, s.stretch)), limit * (1 + 1e-14));
        if (!slipped) {
            EXPECT_EQ(spring_energy(s), before);
        }
    }
}

TEST(friction, settling_at_once_is_stiffening_and_then_yielding) {
    random_springs random;
    int slips = 0;
    for (int i = 0; i < 10000; ++i) {
        friction_spring one_by_one = random.spring();
        friction_spring at_once = one_by_one;
        const double stiffness = i % 10 == 0 ? 0.0 : std::exp(3.0 * random.normal(random.engine)) * 100.0;
        const double limit = i % 7 == 0 ? 0.0 : std::exp(random.normal(random.engine)) * 0.1;
        stiffen(one_by_one, stiffness);
        const bool slipped = yield(one_by_one, limit);
        EXPECT_EQ(settle(at_once, dot(at_once.stretch, at_once.stretch), stiffness, limit), slipped);
        for (int a = 0; a < 3; ++a) EXPECT_NEAR(at_once.stretch[a], one_by_one.stretch[a], 1e-15 * std::fabs(one_by_one.stretch[a]));
        EXPECT_EQ(at_once.stiffness, one_by_one.stiffness);
        slips += slipped;
    }
    EXPECT_GT(slips, 1000);
    EXPECT_LT(slips, 9000);
}

TEST(friction, without_stiffness_nothing_is_stretched) {
    friction_spring s{{1e-3, 0, 0}, {0, 0, 1}, 100.0};
    stiffen(s, 0.0);
    EXPECT_EQ(s.stretch[0], 0.0);
    stiffen(s, 100.0);
    EXPECT_EQ(spring_energy(s), 0.0);
}

TEST(friction, creeping_never_raises_energy_and_never_turns_the_stretch_around) {
    random_springs random;
    for (int i = 0; i < 10000; ++i) {
        friction_spring s = random.spring();
        const double limit = std::exp(random.normal(random.engine)) * 0.1;
        yield(s, limit);
        const friction_spring before = s;
        const double size = std::exp(3.0 * random.normal(random.engine)) * 1e-4;
        const double step[3] = {size * random.normal(random.engine), size * random.normal(random.engine), 0.0};
        creep(s, 1u + static_cast<std::uint32_t>(i % 4), 0.5, limit, step);
        EXPECT_LE(spring_energy(s), spring_energy(before));
        EXPECT_GE(dot(s.stretch, before.stretch), 0.0);
    }
}

// How far a mass on the spring wanders in `cycles` shakes of 20 % around 50 % of the force that would break it away.
double wander(std::uint32_t model, int cycles) {
    const double k = 1000.0, limit = 0.1, mass = 0.05, damping = 10.0, dt = 1e-4;  // N/m, N, kg, N s/m, s
    friction_spring s{{0, 0, 0}, {0, 0, 1}, k};
    double x = 0.0, v = 0.0, settled = 0.0;
    for (int i = 0; i < cycles * 1000; ++i) {
        const double force = limit * (0.5 + 0.2 * std::sin(6.283185307179586 * i / 1000.0));
        v += dt * (force - k * s.stretch[0] - damping * v) / mass;
        const double step[3] = {dt * v, 0, 0};
        x += step[0];
        carry(s, step);
        yield(s, limit);
        creep(s, model, 0.8, limit, step);
        if (i == 20 * 1000 - 1) settled = x;
    }
    return x - settled;
}

TEST(friction, shaken_below_breakaway_dahls_contact_drifts_and_the_others_hold) {
    for (std::uint32_t model : {1u, 2u, 3u}) EXPECT_NEAR(wander(model, 120), 0.0, 1e-8) << model;
    EXPECT_GT(wander(4, 120), 1e-3);
    EXPECT_NEAR(wander(4, 220) / wander(4, 120), 2.0, 0.05);  // without end, in proportion to the shakes
}

TEST(friction, every_adhesion_function_reaches_the_same_limit) {
    for (std::uint32_t model : {1u, 2u, 3u, 4u}) {
        friction_spring s{{0, 0, 0}, {0, 0, 1}, 1000.0};
        const double step[3] = {1e-7, 0, 0};
        for (int i = 0; i < 20000; ++i) {
            carry(s, step);
            yield(s, 0.1);
            creep(s, model, 0.5, 0.1, step);
        }
        EXPECT_NEAR(1000.0 * s.stretch[0], 0.1, 0.1 * 2e-3) << model;
    }
}

}  // namespace
}  // namespace palpate
