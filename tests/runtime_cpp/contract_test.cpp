// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "contract.h"

#include <random>
#include <vector>

#include "test_field.h"

namespace palpate {
namespace {

struct random_stencils {
    std::mt19937_64 engine{9};
    std::uniform_real_distribution<double> unit{0.0, 1.0};
    std::vector<std::int16_t> counts = std::vector<std::int16_t>(8 * 64);
    std::vector<float> amplitudes = std::vector<float>(8 * 64 * rfield_channel_limit);
    axis_taps x, y, z;
    void draw() {
        for (auto& c : counts) c = static_cast<std::int16_t>(engine());
        for (auto& a : amplitudes) a = static_cast<float>(unit(engine) - 0.5);
        taps_at(4.0 * unit(engine), x);
        taps_at(4.0 * unit(engine), y);
        taps_at(4.0 * unit(engine), z);
    }
    // Coefficients of an 8 x 8 x 8 box, whatever block they are in.
    static std::size_t at(std::int64_t i, std::int64_t j, std::int64_t k) {
        return static_cast<std::size_t>(((i >> 2) * 4 + (j >> 2) * 2 + (k >> 2)) * 64 + (i & 3) * 16 + (j & 3) * 4 + (k & 3));
    }
    // sum of weight(a, b, c) coefficient(a, b, c), as the definition says it
    template <class Weight, class Coefficient>
    double sum(const Weight& weight, const Coefficient& coefficient) const {
        double total = 0.0;
        for (int a = 0; a < 3; ++a) {
            for (int b = 0; b < 3; ++b) {
                for (int c = 0; c < 3; ++c) total += weight(a, b, c) * coefficient(at(x.place + a, y.place + b, z.place + c));
            }
        }
        return total;
    }
};

TEST(contract, geometry_sums_are_those_of_the_definition) {
    random_stencils r;
    for (int i = 0; i < 2000; ++i) {
        r.draw();
        const std::int16_t* block[8];
        for (int b = 0; b < 8; ++b) block[b] = r.counts.data() + 64 * b;
        double sums[4];
        contraction_here().geometry(block, r.x, r.y, r.z, sums);
        const auto c = [&](std::size_t at) { return 65536.0 * r.counts[at]; };
        const double scale = 1e-15 * 65536.0 * 32768.0 * 8.0;
        EXPECT_NEAR(sums[0], r.sum([&](int a, int b, int k) { return r.x.w[a] * r.y.w[b] * r.z.w[k]; }, c), scale);
        EXPECT_NEAR(sums[1], r.sum([&](int a, int b, int k) { return r.x.d[a] * r.y.w[b] * r.z.w[k]; }, c), scale);
        EXPECT_NEAR(sums[2], r.sum([&](int a, int b, int k) { return r.x.w[a] * r.y.d[b] * r.z.w[k]; }, c), scale);
        EXPECT_NEAR(sums[3], r.sum([&](int a, int b, int k) { return r.x.w[a] * r.y.w[b] * r.z.d[k]; }, c), scale);
    }
}

TEST(contract, amplitude_sums_are_those_of_the_definition) {
    random_stencils r;
    for (int i = 0; i < 200; ++i) {
        r.draw();
        const auto stride = static_cast<std::int64_t>(4 * (1 + i % 4));
        amplitude_taps taps{r.x, r.y, r.z, {}, stride};
        for (int b = 0; b < 8; ++b) taps.block[b] = r.amplitudes.data() + 64 * stride * b;
        amplitude_sums sums;
        contraction_here().amplitudes(taps, 4, static_cast<std::int32_t>(stride), sums);
        for (std::int64_t ch = 0; ch < stride; ++ch) {
            const auto c = [&](std::size_t at) { return static_cast<double>(r.amplitudes[at * static_cast<std::size_t>(stride) + static_cast<std::size_t>(ch)]); };
            EXPECT_NEAR(sums.value[ch], r.sum([&](int a, int b, int k) { return r.x.w[a] * r.y.w[b] * r.z.w[k]; }, c), 1e-15);
            if (ch >= 4) continue;
            EXPECT_NEAR(sums.dx[ch], r.sum([&](int a, int b, int k) { return r.x.d[a] * r.y.w[b] * r.z.w[k]; }, c), 4e-15);
            EXPECT_NEAR(sums.dy[ch], r.sum([&](int a, int b, int k) { return r.x.w[a] * r.y.d[b] * r.z.w[k]; }, c), 4e-15);
            EXPECT_NEAR(sums.dz[ch], r.sum([&](int a, int b, int k) { return r.x.w[a] * r.y.w[b] * r.z.d[k]; }, c), 4e-15);
        }
    }
}

TEST(contract, every_instruction_set_gives_the_same_bits) {
    random_stencils r;
    for (int i = 0; i < 5000; ++i) {
        r.draw();
        const std::int16_t* block[8];
        amplitude_taps taps{r.x, r.y, r.z, {}, 12};
        for (int b = 0; b < 8; ++b) {
            block[b] = r.counts.data() + 64 * b;
            taps.block[b] = r.amplitudes.data() + 64 * 12 * b;
        }
        double here[4], baseline[4];
        contraction_here().geometry(block, r.x, r.y, r.z, here);
        contraction_baseline.geometry(block, r.x, r.y, r.z, baseline);
        ASSERT_EQ(std::memcmp(here, baseline, sizeof here), 0);
        amplitude_sums fast{}, slow{};
        contraction_here().amplitudes(taps, 8, 12, fast);
        contraction_baseline.amplitudes(taps, 8, 12, slow);
        ASSERT_EQ(std::memcmp(&fast, &slow, sizeof fast), 0);
    }
}

}  // namespace
}  // namespace palpate
