// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Rigid contact's promises that only C++ can check: no allocation in a tick, older hosts' structs, device limits on any path.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdlib>
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

// Ticks of any numbers: not finite, huge, tiny, jumps, deep starts, any dt and flags, between ordinary ones.
struct hostile_hand {
    std::mt19937_64 random{11};
    wanderer path{};
    bool bad = false;  // whether the last state breaks the contract
    double any() {
        constexpr double of[] = {NAN, INFINITY, -INFINITY, 1e308, -1e308, 1e-308, 5e-324, 0.0, -0.0, 1e3, -1e3, 1.0, 0.02, -0.005, 1e-9};
        return of[random() % (sizeof of / sizeof *of)];
    }
    palpate_rigid_state next() {
        constexpr double dts[] = {0.0, -1e-3, NAN, INFINITY, 1e308, 1e-308, 5e-324, 1e-100, 1e-12, 1e-6, 1e-3, 0.1, 1.0, 1e9};
        palpate_rigid_state s = path.next();
        switch (random() % 80) {
            case 0: s.position[random() % 3] = any(); break;
            case 1: s.orientation[random() % 4] = any(); break;
            case 2: s.dt = dts[random() % (sizeof dts / sizeof *dts)]; break;
            case 3: for (double& x : s.position) x = any(); break;
            case 4: for (double& x : s.position) x = 0.001 * static_cast<double>(random() % 40); break;  // deep, anywhere
            case 5: for (double& x : s.orientation) x = any(); break;
            case 6: s.flags = static_cast<std::uint32_t>(random()); break;
            case 7: for (double& x : s.orientation) x = -x; break;
            default: break;
        }
        double square = 0.0, sum = s.dt;
        for (double x : s.orientation) square += x * x;
        for (double x : s.position) sum += std::fabs(x);
        bad = !std::isfinite(sum) || !(s.dt >= 1e-9) || !(std::fabs(square - 1.0) < 0.1);
        return s;
    }
};

void expect_finite(const palpate_rigid_response& r, double scale) {
    const double* first = r.force;  // force to unaccounted are doubles in a row
    const double* last = &r.unaccounted;
    for (const double* x = first; x <= last; ++x) ASSERT_TRUE(std::isfinite(*x)) << "number " << x - first << ", configuration " << scale;
    for (std::uint32_t i = 0; i < r.contact_count; ++i) {
        const palpate_rigid_contact& c = r.contact[i];
        for (const double* x = c.point; x < c.friction + 3; ++x) ASSERT_TRUE(std::isfinite(*x)) << "of contact " << i;
    }
}

TEST(rigid, hostile_ticks_give_finite_answers_within_the_device_and_a_status) {
    const char* many = std::getenv("PALPATE_HOSTILE_TICKS");
    const long ticks = many != nullptr ? std::atol(many) : 400;
    std::uint32_t touched = 0;
    for (const char* name : {"ball", "pen", "torus"}) {
        const opened_rigid scene(name);
        ASSERT_NE(scene.rigid, nullptr);
        for (unsigned kind = 0; kind < 16; ++kind) {
            palpate_rigid_config config = limited((kind & 1u) != 0);
            if ((kind & 2u) != 0) config.speed_max = 0.0;
            if ((kind & 4u) != 0) config.filter_time = 0.0;
            if ((kind & 8u) != 0) config.force_max = config.torque_max = 0.0;
            config.dt_max = (kind & 2u) != 0 ? 1e6 : 0.1;
            const rigid_memory memory(scene.rigid, config);
            hostile_hand hand;
            hand.random.seed(kind + 100u * static_cast<unsigned>(name[0]));
            palpate_rigid_response out{};
            out.size = sizeof out;
            for (long i = 0; i < ticks; ++i) {
                const palpate_rigid_state s = hand.next();
                const std::uint32_t status = palpate_rigid_tick(memory.session, &s, &out);
                ASSERT_EQ(status, out.status);
                expect_finite(out, kind);
                if (HasFatalFailure()) return;
                touched += out.contact_count;
                if (hand.bad) {
                    ASSERT_TRUE((status & PALPATE_RIGID_TICK_BAD_INPUT) != 0);
                }
                if ((status & PALPATE_RIGID_TICK_BAD_INPUT) != 0) {
                    ASSERT_EQ(size_of(out.force) + size_of(out.torque), 0.0);
                }
                if (config.force_max > 0.0) {
                    ASSERT_LE(size_of(out.force), config.force_max * (1 + 1e-12)) << name << " " << kind;
                    ASSERT_LE(size_of(out.torque), config.torque_max * (1 + 1e-12)) << name << " " << kind;
                }
            }
        }
    }
    EXPECT_GT(touched, 100u);
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
