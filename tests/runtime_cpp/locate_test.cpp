// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "locate.h"

#include <cmath>
#include <random>

#include "test_field.h"

namespace palpate {
namespace {

constexpr double rho = 5e-3;

TEST(locate, depth_and_gradient_on_a_sphere_organ_are_those_of_the_sphere) {
    const opened_field sphere("sphere");
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 5000; ++i) {
        point q{normal(random), normal(random), normal(random)};
        const double r = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
        const double radius = 30e-3 + 7e-3 * std::fabs(std::sin(static_cast<double>(i)));
        for (double& x : q) x *= radius / r;
        location at;
        locate(*sphere.field, q.data(), at);
        ASSERT_TRUE(at.region == PALPATE_REGION_CONTACT || at.region == PALPATE_REGION_FREE);
        EXPECT_NEAR(at.depth, rho - (radius - 30e-3), 3e-6);  // spacing 1.5 mm on a radius of 30 mm
        for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(at.gradient[a], q[a] / radius, 5e-3);
    }
}

TEST(locate, gradient_is_the_central_difference_of_depth) {
    const opened_field sphere("sphere");
    const double h = 1e-7;
    for (double angle = 0.0; angle < 6.28; angle += 0.01) {
        const point q{33e-3 * std::cos(angle), 20e-3 * std::sin(angle), 26e-3 * std::sin(angle)};
        location at;
        locate(*sphere.field, q.data(), at);
        for (std::size_t a = 0; a < 3; ++a) {
            point up = q, down = q;
            up[a] += h;
            down[a] -= h;
            location above, below;
            locate(*sphere.field, up.data(), above);
            locate(*sphere.field, down.data(), below);
            EXPECT_NEAR(at.gradient[a], -(above.depth - below.depth) / (2 * h), 1e-5);
        }
    }
}

TEST(locate, nowhere_next_to_free_space_is_contact) {
    // Contact must never touch OUTSIDE: between them lie FREE (where U is zero) or UNREACHED (which closes the gate).
    for (const char* name : {"plane", "sphere", "slab"}) {
        const opened_field opened(name);
        std::mt19937_64 random(2);
        std::uniform_real_distribution<double> unit(-1.0, 1.0);
        for (int i = 0; i < 200000; ++i) {
            const point q{50e-3 * unit(random), 50e-3 * unit(random), 50e-3 * unit(random)};
            location at, next;
            locate(*opened.field, q.data(), at);
            if (at.region != PALPATE_REGION_OUTSIDE) continue;
            const double s = 2e-4;
            const point near{q[0] + s * unit(random), q[1] + s * unit(random), q[2] + s * unit(random)};
            locate(*opened.field, near.data(), next);
            EXPECT_FALSE(next.region == PALPATE_REGION_CONTACT && next.depth > s * std::sqrt(3.0)) << name << " " << next.depth;
        }
    }
}

TEST(locate, far_points_of_any_size_are_outside) {
    const opened_field plane("plane");
    for (double x : {-1e3, -1.0, 1.0, 999.0, 1e6}) {
        location at;
        const double q[3] = {x, -x, x};
        locate(*plane.field, q, at);
        EXPECT_EQ(at.region, PALPATE_REGION_OUTSIDE);
    }
}

TEST(locate, a_stroke_sees_the_slab_between_its_ends) {
    const opened_field slab("slab");
    const double up[3] = {1e-3, 0, 30e-3}, down[3] = {1e-3, 0, -30e-3}, aside[3] = {1e-3, 5e-3, 30e-3};
    stroke seen;
    look_along(*slab.field, up, down, nullptr, seen);
    EXPECT_TRUE(seen.touched && seen.left && seen.turned);
    look_along(*slab.field, up, aside, nullptr, seen);
    EXPECT_FALSE(seen.touched || seen.left || seen.turned || seen.deep || seen.unreached || seen.too_long);
    const double far[3] = {1e-3, 0, -300.0};
    look_along(*slab.field, up, far, nullptr, seen);
    EXPECT_TRUE(seen.too_long);
}

}  // namespace
}  // namespace palpate
