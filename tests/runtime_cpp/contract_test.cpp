// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "contract.h"

#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "executed_fetches.h"
#include "field.h"
#include "respond.h"
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
    palpate_field field{};
    point q;

    explicit random_box(std::int64_t channels) : stride(channels), amplitudes(static_cast<std::size_t>(8 * 64 * channels)) {
        const double origin[3] = {};
        const std::uint32_t blocks[3] = {2, 2, 2};
        set_lattice(field.geometry, origin, 1.0, blocks, index.data(), 1, 2);
        set_lattice(field.amplitudes, origin, 1.0, blocks, index.data(), stride, 4);
        field.geometry_coefficients = counts.data();
        field.amplitude_coefficients = amplitudes.data();
        for (double& x : field.distance_scale) x = 1.0;
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
    void geometry_sums(const contraction& c, distance_cell& kept, double sums[4]) const { ASSERT_TRUE(c.distance(field, q[0], q[1], q[2], kept, sums)); }
    void geometry_sums(const contraction& c, double sums[4]) const {
        distance_cell fresh;
        forget(fresh);
        geometry_sums(c, fresh, sums);
    }
    void amplitude_sums_from(const contraction& c, std::int64_t way, std::int32_t gradients, std::int32_t channels, amplitude_sums& sums) const {
        amplitude_taps taps;
        ASSERT_TRUE(c.gather_amplitudes(field.amplitudes, amplitudes.data(), q[0], q[1], q[2], taps));
        c.amplitudes(taps, way, gradients, channels, sums);
    }
};

TEST(contract, geometry_sums_are_those_of_the_definition) {
    random_box r(4);
    for (int i = 0; i < 2000; ++i) {
        r.draw();
        double sums[4];
        r.geometry_sums(contraction_here(), sums);
        const auto c = [&](std::size_t at) { return static_cast<double>(r.counts[at]); };
        const double scale = 1e-15 * 32768.0 * 8.0;
        EXPECT_NEAR(sums[0] / value_sums_per_count, r.sum(3, c), scale);
        for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(sums[1 + axis] / slope_sums_per_count, r.sum(axis, c), scale);
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
        EXPECT_FALSE(contraction_here().gather_amplitudes(r.field.amplitudes, r.amplitudes.data(), 1.0, x, 1.0, taps));
    }
    for (const double x : {-1.5, 7.5}) {  // one of three taps along x is in the box
        r.q = {x < 0 ? 6.5 : 4.5, 1.25, 2.5};  // the same weights
        amplitude_sums sums;
        ASSERT_TRUE(contraction_here().gather_amplitudes(r.field.amplitudes, r.amplitudes.data(), x, r.q[1], r.q[2], taps));
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
    distance_cell kept;
    forget(kept);
    double sums[4];
    const auto known = [&](double x, double y, double z) { return contraction_here().distance(r.field, x, y, z, kept, sums); };
    EXPECT_TRUE(known(0.0, 0.0, 0.0));
    EXPECT_TRUE(known(5.999, 5.999, 5.999));
    for (const double x : {-1e-9, 6.0, -1e6, 1e6, std::nan("")}) {
        EXPECT_FALSE(known(x, 1.0, 1.0) || known(1.0, x, 1.0) || known(1.0, 1.0, x));
    }
    r.index[7] = -1;
    EXPECT_TRUE(known(1.9, 1.9, 1.9));   // its taps end in the first block
    EXPECT_TRUE(known(1.9, 2.1, 2.1));
    EXPECT_FALSE(known(2.1, 2.1, 2.1));
    EXPECT_FALSE(known(2.2, 2.2, 2.2));  // nothing is kept of a cell that could not be entered
}

// A walk in steps of up to a fifth of a cell with jumps, out of the box too; each answer with what was kept from the place before and with nothing kept.
TEST(contract, an_answer_does_not_depend_on_the_cell_that_was_kept) {
    random_box r(8);
    for (auto& c : r.counts) c = static_cast<std::int16_t>(r.engine());
    for (auto& a : r.amplitudes) a = static_cast<float>(r.unit(r.engine) - 0.5);
    r.field.channels = 8;
    r.field.gradient_channels = 4;
    stored_curves kind{1.0, 1, 4, nullptr}, rest{1.0, 1, 2, nullptr};
    std::vector<double> ones(2 * 4 * 4, 1.0);
    kind.rows = rest.rows = ones.data();
    const stored_curves kinds[3] = {kind, rest, rest};
    std::vector<double> rows(curve_numbers(kinds));
    set_curves(r.field.curves, kinds, rows.data());
    for (double& x : r.field.response_scale) x = 1.0;
    const double gradient[3] = {0.1, 0.2, 0.9};
    distance_cell kept_distance;
    amplitude_cell kept;
    forget(kept_distance);
    forget(kept);
    int same = 0, changed = 0, outside = 0;
    r.q = {3.0, 3.0, 3.0};
    for (int i = 0; i < 20000; ++i) {
        for (double& x : r.q) x = i % 50 == 0 ? 10.0 * r.unit(r.engine) - 2.0 : x + 0.4 * (r.unit(r.engine) - 0.5);
        distance_cell no_distance;
        amplitude_cell nothing;
        forget(no_distance);
        forget(nothing);
        double with[4] = {}, without[4] = {};
        const contraction& c = contraction_here();
        const bool known = c.distance(r.field, r.q[0], r.q[1], r.q[2], kept_distance, with);
        ASSERT_EQ(c.distance(r.field, r.q[0], r.q[1], r.q[2], no_distance, without), known);
        ASSERT_EQ(std::memcmp(with, without, sizeof with), 0);
        std::uint32_t before[4];
        std::memcpy(before, kept.cell, sizeof before);
        c.go_to(r.field, r.q[0], r.q[1], r.q[2], kept);
        c.go_to(r.field, r.q[0], r.q[1], r.q[2], nothing);
        (!kept.inside ? outside : std::memcmp(before, kept.cell, sizeof before) == 0 ? same : changed) += 1;
        response from_kept{}, from_nothing{};
        amplitude_sums sums{}, sums_of_nothing{};
        c.respond(r.field, r.q[0], r.q[1], r.q[2], 0.5, gradient, kept, from_kept, sums);
        c.respond(r.field, r.q[0], r.q[1], r.q[2], 0.5, gradient, nothing, from_nothing, sums_of_nothing);
        ASSERT_EQ(std::memcmp(&from_kept, &from_nothing, sizeof from_kept), 0);
        ASSERT_EQ(std::memcmp(&sums, &sums_of_nothing, sizeof sums), 0);
        amplitude_taps taps;
        amplitude_sums gathered{};
        if (!c.gather_amplitudes(r.field.amplitudes, r.amplitudes.data(), r.q[0], r.q[1], r.q[2], taps)) continue;
        c.amplitudes(taps, 0, 4, 8, gathered);
        ASSERT_EQ(std::memcmp(&sums, &gathered, sizeof sums), 0);
    }
    EXPECT_GT(same, 3000);
    EXPECT_GT(changed, 1000);
    EXPECT_GT(outside, 1000);
}

TEST(contract, what_is_fetched_is_the_cell_that_a_tick_there_enters) {
    random_box r(8);
    r.field.channels = 8;
    const contraction& c = contraction_here();
    fetched_cells last;
    forget(last.distance);
    forget(last.amplitudes);
    int inside = 0, outside = 0;
    for (int i = 0; i < 2000; ++i) {
        for (double& x : r.q) x = 10.0 * r.unit(r.engine) - 2.0;
        if (i % 100 == 0) r.q[static_cast<std::size_t>(i / 100 % 3)] = i % 200 == 0 ? std::nan("") : 1e9;
        distance_cell distance;
        amplitude_cell amplitudes;
        forget(distance);
        forget(amplitudes);
        double sums[4];
        const fetched_cells before = last;
        c.fetch_cells(r.field, r.q[0], r.q[1], r.q[2], last);
        if (c.distance(r.field, r.q[0], r.q[1], r.q[2], distance, sums)) {
            c.go_to(r.field, r.q[0], r.q[1], r.q[2], amplitudes);
            ASSERT_EQ(std::memcmp(last.distance, distance.cell, sizeof last.distance), 0);
            ASSERT_EQ(std::memcmp(last.amplitudes, amplitudes.cell, sizeof last.amplitudes), 0);
            ++inside;
        } else {
            ASSERT_EQ(std::memcmp(&last, &before, sizeof last), 0);
            ++outside;
        }
    }
    EXPECT_GT(inside, 200);
    EXPECT_GT(outside, 200);
}

#if defined(PALPATE_COUNTS_FETCHES)
TEST(contract, fetching_is_done_by_the_processor_once_for_each_line_of_a_new_cell) {
    random_box r(8);
    r.field.channels = 8;
    const contraction* of[] = {&contraction_baseline, &contraction_here()};
    for (const contraction* c : of) {
        fetched_cells last;
        forget(last.distance);
        forget(last.amplitudes);
        const auto fetches_at = [&](double x, double y, double z) {
            return palpate_test::executed_fetches([&] { c->fetch_cells(r.field, x, y, z, last); });
        };
        EXPECT_EQ(fetches_at(1.5, 2.5, 3.5), 8 + 18);  // lines of the distance, of the amplitudes
        EXPECT_EQ(fetches_at(1.6, 2.4, 3.6), 0);
        EXPECT_EQ(fetches_at(2.5, 2.5, 3.5), 8 + 18);
        EXPECT_EQ(fetches_at(-9.5, 2.5, 3.5), 0);
    }
}
#endif

// Sums over curves as their definition says, on knots that are shared and on knots that are not; within an interval and beyond the last.
TEST(contract, curves_are_those_of_the_definition_on_any_knots) {
    std::mt19937_64 engine(11);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const std::uint32_t counts[][3] = {{2, 1, 1}, {3, 2, 1}, {4, 1, 4}, {5, 3, 2}};
    const std::uint32_t intervals[][3] = {{16, 4, 1}, {32, 32, 32}, {6, 4, 1}, {1, 2, 8}};
    const double ends[][3] = {{4e-3, 4e-3, 4e-3}, {4e-3, 3e-3, 4e-3}};
    for (int i = 0; i < 400; ++i) {
        const auto *count = counts[i % 4], *interval = intervals[i / 4 % 4];
        const double* end = ends[i / 16 % 2];
        stored_curves kinds[3];
        std::vector<double> stored[3];
        for (std::size_t k = 0; k < 3; ++k) {
            stored[k].resize((interval[k] + 1) * count[k] * 4);
            const double h = end[k] / interval[k];
            for (std::uint32_t row = 0; row <= interval[k]; ++row) {
                for (std::uint32_t r = 0; r < count[k]; ++r) {
                    double* c = stored[k].data() + 4 * (row * count[k] + r);
                    const double* last = c - 4 * count[k];
                    c[0] = row == 0 ? unit(engine) : last[0] + h * (last[1] + h * (last[2] + h * last[3]));
                    c[1] = unit(engine) / h;
                    c[2] = (unit(engine) - 0.5) / h / h;
                    c[3] = row == interval[k] ? 0.0 : (unit(engine) - 0.5) / h / h / h;
                }
            }
            kinds[k] = {end[k], interval[k], count[k], stored[k].data()};
        }
        std::vector<double> rows(curve_numbers(kinds), std::nan(""));
        palpate_field field{};
        set_curves(field.curves, kinds, rows.data());
        const bool fit = i / 16 % 2 == 0 && i / 4 % 4 != 2;
        EXPECT_EQ(field.curves.set_count, fit ? 1 : 3);
        field.channels = field.curves.padded;
        field.gradient_channels = static_cast<std::int32_t>((count[0] + 3) / 4 * 4);
        for (double& x : field.response_scale) x = 1.0;
        amplitude_sums a{};
        for (std::uint32_t r = 0; r < count[0] + count[1] + count[2]; ++r) a.value[r] = unit(engine);
        for (std::uint32_t r = 0; r < static_cast<std::uint32_t>(field.gradient_channels); ++r) a.dx[r] = unit(engine);
        const double depth = 5e-3 * unit(engine), no_gradient[3] = {};
        double wanted[5] = {};  // U, dU/dx at fixed depth, dU/dd, k, mu
        std::uint32_t channel = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double h = end[k] / interval[k];
            const double row = depth < end[k] ? std::floor(depth / h) : interval[k], x = depth - row * h;
            for (std::uint32_t r = 0; r < count[k]; ++r, ++channel) {
                const double* c = stored[k].data() + 4 * (static_cast<std::size_t>(row) * count[k] + r);
                const double value = c[0] + x * (c[1] + x * (c[2] + x * c[3]));
                if (k > 0) wanted[2 + k] += value * a.value[channel];
                if (k > 0) continue;
                wanted[0] += value * a.value[channel];
                wanted[1] += value * a.dx[channel];
                wanted[2] += (c[1] + x * (2.0 * c[2] + 3.0 * x * c[3])) * a.value[channel];
            }
        }
        for (const contraction* c : {&contraction_here(), &contraction_baseline}) {
            response found;
            c->response_from(field, a, depth, no_gradient, found);
            const double got[5] = {found.energy, found.gradient[0], found.steepness, found.friction_stiffness, found.friction_coefficient};
            for (int j = 0; j < 5; ++j) {
                const double right = j >= 3 && wanted[j] < 0.0 ? 0.0 : wanted[j];
                EXPECT_NEAR(got[j], right, (j == 2 ? 1e-9 : 1e-11)) << i << " " << j;
            }
        }
    }
}

TEST(contract, every_instruction_set_gives_the_same_bits) {
    random_box r(12);
    std::vector<double> stored(9 * 7 * 4);
    for (double& x : stored) x = r.unit(r.engine) - 0.5;
    const stored_curves kinds[3] = {{1.0, 8, 7, stored.data()}, {1.0, 4, 3, stored.data()}, {1.0, 8, 2, stored.data()}};
    std::vector<double> rows(curve_numbers(kinds));
    set_curves(r.field.curves, kinds, rows.data());
    r.field.channels = 12;
    r.field.gradient_channels = 8;
    for (double& x : r.field.response_scale) x = 0.7;
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
        response fast_response, slow_response;
        const double gradient[3] = {1e-9 * here[1], 1e-9 * here[2], 1e-9 * here[3]}, depth = 1.2 * r.unit(r.engine);
        contraction_here().response_from(r.field, fast, depth, gradient, fast_response);
        contraction_baseline.response_from(r.field, slow, depth, gradient, slow_response);
        ASSERT_EQ(std::memcmp(&fast_response, &slow_response, sizeof fast_response), 0);
    }
}

}  // namespace
}  // namespace palpate
