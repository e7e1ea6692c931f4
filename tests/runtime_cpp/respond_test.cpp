// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "respond.h"

#include <cmath>
#include <random>

#include "locate.h"
#include "test_field.h"

namespace palpate {
namespace {

// The response alone.
void respond(const palpate_field& field, const double q[3], double depth, const double gradient[3], response& found) {
    amplitude_sums amplitudes;
    amplitude_cell cell;
    forget(cell);
    go_to(field, q[0], q[1], q[2], cell);
    palpate::respond(field, q, depth, gradient, cell, found, amplitudes);
}

response at_point(const palpate_field* field, const point& q) {
    location at;
    locate(*field, q.data(), at);
    response r{};
    if (at.region == PALPATE_REGION_CONTACT) respond(*field, q.data(), at.depth, at.gradient, r);
    return r;
}

TEST(respond, gradient_is_the_central_difference_of_the_energy) {
    const opened_field plane("plane");
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const double h = 2e-7;
    int close = 0;
    const int count = 2000;
    for (int i = 0; i < count; ++i) {
        const point q{-8e-3 + 20e-3 * unit(random), -8e-3 + 16e-3 * unit(random), 0.5e-3 + 4e-3 * unit(random)};
        const response r = at_point(plane.field, q);
        double miss = 0.0, size = 0.0;
        for (std::size_t a = 0; a < 3; ++a) {
            point up = q, down = q;
            up[a] += h;
            down[a] -= h;
            const double slope = (at_point(plane.field, up).energy - at_point(plane.field, down).energy) / (2 * h);
            miss += (slope - r.gradient[a]) * (slope - r.gradient[a]);
            size += r.gradient[a] * r.gradient[a];
        }
        EXPECT_LT(std::sqrt(miss / size), 2e-5);
        close += miss < 1e-12 * size;
    }
    EXPECT_GT(close, count * 95 / 100);  // a cell border inside the difference costs the rest their last digits
}

TEST(respond, energy_and_gradient_vanish_at_first_contact) {
    const opened_field plane("plane");
    for (double depth : {1e-6, 1e-7, 1e-8}) {
        const response r = at_point(plane.field, {8e-3, 0, 5e-3 - depth});
        EXPECT_GT(r.energy, 0.0);
        EXPECT_LT(r.energy, 1e3 * depth * depth);
        EXPECT_LT(std::fabs(r.gradient[2]), 2e3 * depth);
        EXPECT_LT(std::fabs(r.gradient[0]), 2e5 * depth * depth);
    }
}

TEST(respond, outside_the_amplitudes_there_is_no_response) {
    const opened_field plane("plane");
    const double q[3] = {5.0, 5.0, 5.0}, up[3] = {0, 0, 1};
    response r;
    respond(*plane.field, q, 2e-3, up, r);
    EXPECT_EQ(r.energy, 0.0);
    EXPECT_EQ(r.friction_stiffness, 0.0);
}

TEST(respond, is_continuous_across_the_edge_of_the_amplitude_box) {
    const opened_field plane("plane");
    const double up[3] = {0, 0, 1};
    const rfield_header& h = plane.field->header;
    const double edge = h.amplitude_origin[0];
    double before = -1.0;
    for (double x = edge - 6e-3; x < edge + 6e-3; x += 1e-6) {
        response r;
        const double q[3] = {x, 0.0, 3e-3};
        respond(*plane.field, q, 2e-3, up, r);
        if (before >= 0.0) {
            EXPECT_LT(std::fabs(r.energy - before), 1e-6);
        }
        before = r.energy;
    }
    EXPECT_GT(before, 1e-5);
}

TEST(respond, beyond_the_last_knot_force_goes_on_with_its_last_slope) {
    const opened_field plane("plane");
    const double up[3] = {0, 0, 1}, q[3] = {-5e-3, 0, 1e-3};
    response a, b, c, d;
    const double end = plane.field->curves.sets[0].depth_end;
    respond(*plane.field, q, end * (1 - 1e-12), up, a);
    respond(*plane.field, q, end * (1 + 1e-12), up, b);
    respond(*plane.field, q, end + 1e-3, up, c);
    respond(*plane.field, q, end + 2e-3, up, d);
    EXPECT_NEAR(a.energy, b.energy, 1e-12);
    EXPECT_NEAR(a.gradient[2], b.gradient[2], 1e-9);
    EXPECT_NEAR(c.gradient[2] - b.gradient[2], d.gradient[2] - c.gradient[2], 1e-12);
    EXPECT_DOUBLE_EQ(c.stiffness, d.stiffness);
}

}  // namespace
}  // namespace palpate
