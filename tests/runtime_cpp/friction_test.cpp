// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "friction.h"

#include <cmath>
#include <random>

#include "test_field.h"

namespace palpate {
namespace {

double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

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

TEST(friction, without_stiffness_nothing_is_stretched) {
    friction_spring s{{1e-3, 0, 0}, {0, 0, 1}, 100.0};
    stiffen(s, 0.0);
    EXPECT_EQ(s.stretch[0], 0.0);
    stiffen(s, 100.0);
    EXPECT_EQ(spring_energy(s), 0.0);
}

}  // namespace
}  // namespace palpate
