// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "contract.h"

#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "test_field.h"

namespace palpate {
namespace {

// A point in a box of 2 x 2 x 2 blocks, in cells, and what the sums should be as their definition says it.
struct random_box {
    std::mt19937_64 engine{9};
    std::uniform_real_distribution<double> unit{0.0, 1.0};
    std::int64_t stride;
    std::vector<std::int32_t> index{0, 1, 2, 3, 4, 5, 6, 7};
    std::vector<std::int16_t> counts = std::vector<std::int16_t>(8 * 64);
    std::vector<float> amplitudes;
    lattice geometry, amplitude;
    point q;

    explicit random_box(std::int64_t channels) : stride(channels), amplitudes(static_cast<std::size_t>(8 * 64 * channels)) {
        const double origin[3] = {};
        const std::uint32_t blocks[3] = {2, 2, 2};
        set_lattice(geometry, origin, 1.0, blocks, index.data(), 1, 2);
        set_lattice(amplitude, origin, 1.0, blocks, index.data(), stride, 4);
    }
    void draw() {
        for (auto& c : counts) c = static_cast<std::int16_t>(engine());
        for (auto& a : amplitudes) a = static_cast<float>(unit(engine) - 0.5);
        for (double& x : q) x = 6.0 * unit(engine);
    }
    // Weight of tap k along an axis, or its derivative.
    double weight(std::size_t axis, int k, bool derivative) const {
        const double t = q[axis] - std::floor(q[axis]);
        const double w[3] = {0.5 * (1 - t) * (1 - t), 0.5 + t * (1 - t), 0.5 * t * t}, d[3] = {t - 1, 1 - 2 * t, t};
        return derivative ? d[k] : w[k];
    }
    // The sum over the taps, differentiated along `axis` (3: not at all).
    template <class Coefficient>
    double sum(std::size_t axis, const Coefficient& coefficient) const {
        double total = 0.0;
        for (int tap = 0; tap < 27; ++tap) {
            const int k[3] = {tap / 9, tap / 3 % 3, tap % 3};
            std::size_t block = 0, place = 0;
            double w = 1.0;
            for (std::size_t a = 0; a < 3; ++a) {
                const auto i = static_cast<std::size_t>(static_cast<int>(q[a]) + k[a]);
                block = 2 * block + i / 4;
                place = 4 * place + i % 4;
                w *= weight(a, k[a], a == axis);
            }
            total += w * coefficient(64 * block + place);
        }
        return total;
    }
    void geometry_sums(const contraction& c, double sums[4]) const {
        geometry_taps taps;
        ASSERT_TRUE(c.gather_geometry(geometry, counts.data(), q[0], q[1], q[2], taps));
        c.geometry(taps, sums);
    }
    void amplitude_sums_from(const contraction& c, std::int64_t way, std::int32_t gradients, std::int32_t channels, amplitude_sums& sums) const {
        amplitude_taps taps;
        ASSERT_TRUE(c.gather_amplitudes(amplitude, amplitudes.data(), q[0], q[1], q[2], taps));
        c.amplitudes(taps, way, gradients, channels, sums);
    }
};

TEST(contract, geometry_sums_are_those_of_the_definition) {
    random_box r(4);
    for (int i = 0; i < 2000; ++i) {
        r.draw();
        double sums[4];
        r.geometry_sums(contraction_here(), sums);
        const auto c = [&](std::size_t at) { return 65536.0 * r.counts[at]; };
        const double scale = 1e-15 * 65536.0 * 32768.0 * 8.0;
        EXPECT_NEAR(sums[0], r.sum(3, c), scale);
        for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(sums[1 + axis], r.sum(axis, c), scale);
    }
}

TEST(contract, amplitude_sums_are_those_of_the_definition) {
    for (const std::int64_t stride : {4, 8, 12, 16}) {
        random_box r(stride);
        for (int i = 0; i < 50; ++i) {
            r.draw();
            const std::int64_t way = i % 2 == 0 ? 0 : stride - 4;  // the last four channels as if they were a way of their own
            const auto channels = static_cast<std::int32_t>(stride - way);
            amplitude_sums sums;
            r.amplitude_sums_from(contraction_here(), way, 4, channels, sums);
            for (std::int64_t ch = 0; ch < channels; ++ch) {
                const auto c = [&](std::size_t at) { return static_cast<double>(r.amplitudes[at * static_cast<std::size_t>(stride) + static_cast<std::size_t>(way + ch)]); };
                EXPECT_NEAR(sums.value[ch], r.sum(3, c), 1e-15);
                if (ch >= 4) continue;
                EXPECT_NEAR(sums.dx[ch], r.sum(0, c), 4e-15);
                EXPECT_NEAR(sums.dy[ch], r.sum(1, c), 4e-15);
                EXPECT_NEAR(sums.dz[ch], r.sum(2, c), 4e-15);
            }
        }
    }
}

TEST(contract, amplitudes_beyond_the_box_are_zero) {
    random_box r(4);
    r.index[0] = 1;  // row 0 stands for what is absent
    r.draw();
    for (std::size_t i = 0; i < 64 * 4; ++i) r.amplitudes[i] = 0.0f;
    amplitude_taps taps;
    for (const double x : {-2.1, 8.1, -1e6, 1e6}) {
        EXPECT_FALSE(contraction_here().gather_amplitudes(r.amplitude, r.amplitudes.data(), 1.0, x, 1.0, taps));
    }
    for (const double x : {-1.5, 7.5}) {  // one of three taps along x is in the box
        r.q = {x < 0 ? 6.5 : 4.5, 1.25, 2.5};  // the same weights
        amplitude_sums sums;
        ASSERT_TRUE(contraction_here().gather_amplitudes(r.amplitude, r.amplitudes.data(), x, r.q[1], r.q[2], taps));
        contraction_here().amplitudes(taps, 0, 4, 4, sums);
        double wanted = 0.0;
        for (int tap = 0; tap < 9; ++tap) {
            const int j = 1 + tap / 3, k = 2 + tap % 3, i = x < 0 ? 0 : 7;
            const std::size_t row = static_cast<std::size_t>(r.index[static_cast<std::size_t>(i / 4 * 4 + j / 4 * 2 + k / 4)]);
            const std::size_t at = 64 * row + static_cast<std::size_t>(i % 4 * 16 + j % 4 * 4 + k % 4);
            wanted += r.weight(0, x < 0 ? 2 : 0, false) * r.weight(1, tap / 3, false) * r.weight(2, tap % 3, false) * static_cast<double>(r.amplitudes[4 * at]);
        }
        EXPECT_NEAR(sums.value[0], wanted, 1e-15);
    }
}

TEST(contract, geometry_is_known_only_where_every_coefficient_is_stored) {
    random_box r(4);
    geometry_taps taps;
    const auto known = [&](double x, double y, double z) { return contraction_here().gather_geometry(r.geometry, r.counts.data(), x, y, z, taps); };
    EXPECT_TRUE(known(0.0, 0.0, 0.0));
    EXPECT_TRUE(known(5.999, 5.999, 5.999));
    for (const double x : {-1e-9, 6.0, -1e6, 1e6, std::nan("")}) {
        EXPECT_FALSE(known(x, 1.0, 1.0) || known(1.0, x, 1.0) || known(1.0, 1.0, x));
    }
    r.index[7] = -1;
    EXPECT_TRUE(known(1.9, 1.9, 1.9));   // its taps end in the first block
    EXPECT_TRUE(known(1.9, 2.1, 2.1));
    EXPECT_FALSE(known(2.1, 2.1, 2.1));
}

TEST(contract, every_instruction_set_gives_the_same_bits) {
    random_box r(12);
    for (int i = 0; i < 5000; ++i) {
        r.draw();
        double here[4], baseline[4];
        r.geometry_sums(contraction_here(), here);
        r.geometry_sums(contraction_baseline, baseline);
        ASSERT_EQ(std::memcmp(here, baseline, sizeof here), 0);
        amplitude_sums fast{}, slow{};
        r.amplitude_sums_from(contraction_here(), 0, 8, 12, fast);
        r.amplitude_sums_from(contraction_baseline, 0, 8, 12, slow);
        ASSERT_EQ(std::memcmp(&fast, &slow, sizeof fast), 0);
    }
}

}  // namespace
}  // namespace palpate
