// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>

#include "palpate/adapters/openhaptics.hpp"
#include "palpate/adapters/unity.hpp"
#include "palpate/adapters/unreal.hpp"
#include "rotation.h"
#include "test_field.h"

namespace {

struct random_numbers {
    std::mt19937_64 engine{3};
    std::normal_distribution<double> normal;
    point vector() { return {normal(engine), normal(engine), normal(engine)}; }
    std::array<double, 4> rotation() {
        std::array<double, 4> q{normal(engine), normal(engine), normal(engine), normal(engine)};
        const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        for (double& x : q) x /= length;
        return q;
    }
};

point cross(const point& a, const point& b) { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }

void expect_near(const point& a, const point& b, double within) {
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], within);
}

const palpate::host_axes hosts[] = {palpate::openhaptics, palpate::unity, palpate::unreal};

TEST(adapters, what_goes_out_comes_back_in) {
    random_numbers random;
    for (const auto& host : hosts) {
        const point x = random.vector();
        const auto q = random.rotation();
        double there[4];
        host.position_out(x.data(), there);
        point back;
        host.position_in(there, back.data());
        expect_near(back, x, 1e-15 * 10);
        host.orientation_out(q.data(), there);
        palpate_tool_state state{};
        host.pose_in(x.data(), there, state);
        for (std::size_t a = 0; a < 4; ++a) EXPECT_EQ(state.orientation[a], q[a]);
    }
}

TEST(adapters, a_vector_turned_here_is_the_vector_turned_there) {
    // Rotation matrices need no handedness: R(q_host) M v = M R(q) v, with the same formula for R on both sides.
    random_numbers random;
    for (const auto& host : hosts) {
        for (int i = 0; i < 100; ++i) {
            const point v = random.vector();
            const auto q = random.rotation();
            point turned, expected, there, turned_there;
            palpate::rotate(q.data(), v.data(), turned.data());
            host.direction_out(turned.data(), expected.data());
            double q_host[4];
            host.orientation_out(q.data(), q_host);
            host.direction_out(v.data(), there.data());
            palpate::rotate(q_host, there.data(), turned_there.data());
            expect_near(turned_there, expected, 1e-14);
        }
    }
}

TEST(adapters, torque_is_arm_times_force_in_the_hosts_units_and_work_is_work) {
    random_numbers random;
    for (const auto& host : hosts) {
        const point arm = random.vector(), force = random.vector(), torque = cross(arm, force);
        point arm_host, force_host, torque_host;
        host.position_out(arm.data(), arm_host.data());
        host.force_out(force.data(), force_host.data());
        host.torque_out(torque.data(), torque_host.data());
        expect_near(torque_host, cross(arm_host, force_host), 1e-12 * host.torque);
        double work = 0.0, work_host = 0.0;
        for (std::size_t a = 0; a < 3; ++a) {
            work += force[a] * arm[a];
            work_host += force_host[a] * arm_host[a];
        }
        EXPECT_NEAR(work_host / (host.force * host.length), work, 1e-14);
    }
}

TEST(adapters, up_is_up_and_hosts_are_mirrored_or_not) {
    const point up{0, 0, 1}, ahead{0, 1, 0};
    point there;
    palpate::unity.direction_out(up.data(), there.data());
    expect_near(there, {0, 1, 0}, 0.0);
    palpate::unreal.direction_out(up.data(), there.data());
    expect_near(there, {0, 0, 1}, 0.0);
    palpate::openhaptics.direction_out(up.data(), there.data());
    expect_near(there, {0, 1, 0}, 0.0);
    palpate::openhaptics.direction_out(ahead.data(), there.data());
    expect_near(there, {0, 0, -1}, 0.0);  // away from the user
    EXPECT_EQ(palpate::unity.handedness(), -1.0);
    EXPECT_EQ(palpate::unreal.handedness(), -1.0);
    EXPECT_EQ(palpate::openhaptics.handedness(), 1.0);
}

TEST(adapters, a_press_of_three_millimetres_feels_the_same_from_every_host) {
    const opened_field plane("plane");
    const session_memory alone(plane.field);
    alone.tick({-4e-3, 1e-3, 6e-3});
    const palpate_tool_response r = alone.tick({-4e-3, 1e-3, 2e-3});
    ASSERT_GT(r.force[2], 0.1);
    const double places[3][2][3] = {{{-4, 6, -1}, {-4, 2, -1}},                            // mm, y up, z to the user
                                    {{-4e-3, 6e-3, 1e-3}, {-4e-3, 2e-3, 1e-3}},            // m, y up, z ahead
                                    {{-0.4, -0.1, 0.6}, {-0.4, -0.1, 0.2}}};               // cm, y right
    const int upwards[3] = {1, 1, 2};
    const double units[3] = {1.0, 1.0, 100.0};
    for (std::size_t h = 0; h < 3; ++h) {
        const session_memory tool(plane.field);
        palpate_tool_response felt{};
        for (const auto& place : places[h]) {
            double position[3];
            hosts[h].position_in(place, position);
            felt = tool.tick({position[0], position[1], position[2]});
        }
        double force[3];
        hosts[h].force_out(felt.force, force);
        EXPECT_NEAR(force[upwards[h]], units[h] * r.force[2], 1e-12 * units[h]);
    }
}

TEST(adapters, a_transform_of_openhaptics_gives_place_and_orientation) {
    random_numbers random;
    for (int i = 0; i < 200; ++i) {
        auto q = random.rotation();
        if (i < 4) {  // half turns: each part of the quaternion is the largest once
            q = {0, 0, 0, 0};
            q[static_cast<std::size_t>(i)] = 1.0;
        }
        double m[16] = {};
        for (int column = 0; column < 3; ++column) {
            double e[3] = {0, 0, 0};
            e[column] = 1.0;
            palpate::rotate(q.data(), e, m + 4 * column);
        }
        m[12] = 10.0, m[13] = 20.0, m[14] = 30.0, m[15] = 1.0;
        double found[4];
        palpate::rotation_of_transform(m, found);
        double side = 0.0;
        for (std::size_t a = 0; a < 4; ++a) side += found[a] * q[a];
        EXPECT_NEAR(std::fabs(side), 1.0, 1e-14);
        palpate_tool_state state{};
        palpate::openhaptics_transform(m, state);
        expect_near({state.position[0], state.position[1], state.position[2]}, {10e-3, -30e-3, 20e-3}, 1e-17);
        double turned[3], there[3];
        const double tip[3] = {0, 0, 1}, tip_device[3] = {0, 1, 0};  // the same arm in both axes
        palpate::rotate(state.orientation, tip, turned);
        palpate::openhaptics.direction_out(turned, there);
        double expected[3];
        palpate::rotate(q.data(), tip_device, expected);
        for (int a = 0; a < 3; ++a) EXPECT_NEAR(there[a], expected[a], 1e-14);
    }
}

}  // namespace
