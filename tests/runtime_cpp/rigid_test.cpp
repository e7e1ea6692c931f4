// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Rigid contact's promises that only C++ can check: no allocation in a tick, older hosts' structs, device limits on any path.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "counted_allocations.h"
#include "palpate/rigid.h"

namespace {

struct opened_rigid {
    palpate_rigid* rigid = nullptr;
    explicit opened_rigid(const std::string& name) {
        std::ifstream file(PALPATE_TEST_RIGID + name, std::ios::binary);
        const std::vector<char> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
        char why[256];
        EXPECT_EQ(palpate_rigid_open(bytes.data(), bytes.size(), &rigid, why, sizeof why), PALPATE_OK) << name << ": " << why;
    }
    opened_rigid(const opened_rigid&) = delete;
    opened_rigid& operator=(const opened_rigid&) = delete;
    ~opened_rigid() { palpate_rigid_close(rigid); }
};

palpate_rigid_config limited(bool coupled) {
    palpate_rigid_config config;
    palpate_rigid_config_default(&config);
    config.force_max = 5.0;
    config.torque_max = 0.2;
    if (coupled) {
        config.coupling_stiffness = 1500.0;
        config.coupling_damping = 15.0;
        config.coupling_torsional_stiffness = 0.5;
        config.coupling_torsional_damping = 0.003;
    }
    return config;
}

struct rigid_memory {
    std::vector<std::uint64_t> bytes;
    palpate_rigid_session* session = nullptr;
    rigid_memory(const palpate_rigid* rigid, const palpate_rigid_config& config) : bytes((palpate_rigid_session_size() + 7) / 8) {
        EXPECT_EQ(palpate_rigid_session_init(bytes.data(), bytes.size() * 8, rigid, &config, &session), PALPATE_OK);
    }
};

// A wandering, turning pose with rests, jumps, late ticks and bad numbers.
struct wanderer {
    std::mt19937_64 random{3};
    double position[3]{0, 0, 0.06}, axis[3]{0, 0, 1}, angle = 0.0;
    palpate_rigid_state next() {
        std::normal_distribution<double> normal;
        std::uniform_real_distribution<double> uniform;
        const double what = uniform(random);
        for (int i = 0; i < 3; ++i) position[i] += 4e-4 * normal(random) - 0.002 * (position[i] - (i == 2 ? 0.02 : 0.0));
        angle += 0.01 * normal(random);
        if (what < 5e-4) {
            for (double& x : position) x = 0.15 * (uniform(random) - 0.5);
            for (double& x : axis) x = normal(random);
            const double size = std::sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
            for (double& x : axis) x /= size;
        }
        palpate_rigid_state s{sizeof s, what > 0.9998 ? PALPATE_INPUT_RELEASE : 0u, what > 0.9997 && what < 0.9998 ? 1.0 : 1e-3, {}, {}};
        for (int i = 0; i < 3; ++i) {
            s.position[i] = position[i];
            s.orientation[i] = axis[i] * std::sin(0.5 * angle);
        }
        s.orientation[3] = std::cos(0.5 * angle);
        if (what > 0.9995 && what < 0.9997) s.position[1] = NAN;
        return s;
    }
};

double size_of(const double v[3]) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

TEST(rigid, ticks_allocate_nothing_and_keep_within_the_device_on_any_path) {
    std::uint32_t seen = 0, touched[2] = {0, 0};
    for (const char* name : {"ball", "pen", "torus"}) {
        const opened_rigid scene(name);
        ASSERT_NE(scene.rigid, nullptr);
        for (int coupled = 0; coupled < 2; ++coupled) {
            const rigid_memory memory(scene.rigid, limited(coupled == 1));
            wanderer path;
            palpate_rigid_response out{};
            out.size = sizeof out;
#if defined(PALPATE_COUNT_ALLOCATIONS)
            const long at_first = allocations;
            EXPECT_GT(at_first, 0) << "the counter does not count";
#endif
            double force = 0.0, torque = 0.0;
            for (int i = 0; i < 20000; ++i) {
                const palpate_rigid_state s = path.next();
                seen |= palpate_rigid_tick(memory.session, &s, &out);
                touched[coupled] += out.contact_count;
                const double f = size_of(out.force), t = size_of(out.torque);
                force = f <= force ? force : f;  // also where f is not a number
                torque = t <= torque ? torque : t;
            }
#if defined(PALPATE_COUNT_ALLOCATIONS)
            EXPECT_EQ(allocations, at_first) << name;
#endif
            EXPECT_LE(force, 5.0 * (1 + 1e-12)) << name;
            EXPECT_LE(torque, 0.2 * (1 + 1e-12)) << name;
        }
    }
    EXPECT_GT(touched[0], 400u);
    EXPECT_GT(touched[1], 400u);
    const std::uint32_t wanted = PALPATE_RIGID_TICK_JUMP | PALPATE_RIGID_TICK_STALE | PALPATE_RIGID_TICK_BAD_INPUT |
                                 PALPATE_RIGID_TICK_RELEASED | PALPATE_RIGID_TICK_TOO_DEEP | PALPATE_RIGID_TICK_WAITING |
                                 PALPATE_RIGID_TICK_FORCE_LIMITED | PALPATE_RIGID_TICK_ENERGY_LIMITED;
    EXPECT_EQ(seen & wanted, wanted) << "the walk did not meet everything";
}

TEST(rigid, a_host_that_knows_no_coupling_gets_none) {
    const opened_rigid scene("ball");
    palpate_rigid_config config = limited(true);
    config.size = offsetof(palpate_rigid_config, coupling_stiffness);
    const rigid_memory memory(scene.rigid, config);
    const palpate_rigid_state s{sizeof s, 0, 1e-3, {0.3, 0.2, 0.5}, {0, 0, 0, 1}};
    palpate_rigid_response out{};
    out.size = sizeof out;
    double position[3], orientation[4];
    EXPECT_EQ(palpate_rigid_session_place(memory.session, position, orientation), PALPATE_BAD_ARGUMENT);
    for (int i = 0; i < 100; ++i) palpate_rigid_tick(memory.session, &s, &out);
    ASSERT_EQ(palpate_rigid_session_place(memory.session, position, orientation), PALPATE_OK);
    EXPECT_EQ(position[2], 0.5);  // a coupled one would sag
    config.size = 40;
    palpate_rigid_session* session = nullptr;
    std::vector<std::uint64_t> bytes((palpate_rigid_session_size() + 7) / 8);
    EXPECT_EQ(palpate_rigid_session_init(bytes.data(), bytes.size() * 8, scene.rigid, &config, &session), PALPATE_BAD_ARGUMENT);
}

}  // namespace
