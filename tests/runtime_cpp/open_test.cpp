// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include "field.h"
#include "test_field.h"

namespace palpate {
namespace {

using bytes = std::vector<unsigned char>;

palpate_status open_status(const bytes& data, std::string* sentence = nullptr) {
    char why[256] = "untouched";
    palpate_field* field = reinterpret_cast<palpate_field*>(1);
    const palpate_status status = palpate_field_open(data.data(), data.size(), 0, &field, why, sizeof why);
    EXPECT_EQ(status == PALPATE_OK, field != nullptr);
    palpate_field_close(field);
    if (sentence != nullptr) *sentence = why;
    return status;
}

template <class T>
bytes with(bytes data, std::size_t offset, T value) {
    std::memcpy(data.data() + offset, &value, sizeof value);
    reseal(data);
    return data;
}

rfield_header header_of(const bytes& data) {
    rfield_header h;
    std::memcpy(&h, data.data(), sizeof h);
    return h;
}

struct open : testing::Test {
    const bytes data = file_bytes("plane");
    const rfield_header header = header_of(data);
    template <class T>
    palpate_status status_with(std::size_t offset, T value) {
        std::string sentence;
        const palpate_status status = open_status(with(data, offset, value), &sentence);
        if (status != PALPATE_OK) {
            EXPECT_GT(sentence.size(), 20u);
            EXPECT_EQ(sentence.back(), '.') << sentence;
        }
        return status;
    }
    std::size_t section(rfield_section i, std::size_t element = 0) const {
        return header.section_offset[i] + element * rfield_element_size[i];
    }
};

TEST_F(open, accepts_the_file_copied_and_in_place_alike) {
    ASSERT_EQ(open_status(data), PALPATE_OK);
    bytes room(data.size() + 64);
    const auto up = (64 - reinterpret_cast<std::uintptr_t>(room.data()) % 64) % 64;
    std::memcpy(room.data() + up, data.data(), data.size());
    palpate_field* field = nullptr;
    ASSERT_EQ(palpate_field_open(room.data() + up, data.size(), PALPATE_OPEN_IN_PLACE, &field, nullptr, 0), PALPATE_OK);
    EXPECT_GT(sample_at(field, {0, 0, 3e-3}).stored_energy, 0.0);
    palpate_field_close(field);
    EXPECT_EQ(palpate_field_open(room.data() + up + 8, data.size(), PALPATE_OPEN_IN_PLACE, &field, nullptr, 0), PALPATE_BAD_ARGUMENT);
}

// Every length and every bit: of a field of 5 kB, which has all that the large ones have.
TEST_F(open, refuses_every_truncation) {
    const bytes whole = file_bytes("small");
    ASSERT_EQ(open_status(whole), PALPATE_OK);
    for (std::size_t size = 0; size < whole.size(); ++size) {
        EXPECT_EQ(open_status(bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))),
                  size == 0 ? PALPATE_BAD_ARGUMENT : PALPATE_TRUNCATED);
    }
    bytes longer = whole;
    longer.push_back(0);
    EXPECT_EQ(open_status(longer), PALPATE_TRUNCATED);
}

TEST_F(open, refuses_every_truncation_whose_header_was_made_to_fit) {
    const bytes whole = file_bytes("small");
    for (std::size_t size = sizeof(rfield_header); size < whole.size(); ++size) {
        bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
        const std::uint64_t file_size = size;
        std::memcpy(cut.data() + offsetof(rfield_header, file_size), &file_size, sizeof file_size);
        reseal(cut);
        EXPECT_EQ(open_status(cut), PALPATE_BAD_LAYOUT);
    }
}

TEST_F(open, refuses_every_flipped_bit) {
    const bytes whole = file_bytes("small");
    bytes damaged = whole;
    for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
        damaged[bit / 8] = static_cast<unsigned char>(damaged[bit / 8] ^ (1u << (bit % 8)));
        EXPECT_NE(open_status(damaged), PALPATE_OK) << bit;
        damaged[bit / 8] = whole[bit / 8];
    }
}

TEST_F(open, refuses_other_files_and_other_versions) {
    EXPECT_EQ(status_with(0, 'X'), PALPATE_NOT_RFIELD);
    EXPECT_EQ(status_with(offsetof(rfield_header, version), std::uint32_t{99}), PALPATE_WRONG_VERSION);
    EXPECT_EQ(status_with(offsetof(rfield_header, layout_hash), std::uint64_t{2}), PALPATE_WRONG_VERSION);
    EXPECT_EQ(open_status(bytes(5000, 0)), PALPATE_NOT_RFIELD);
}

TEST_F(open, refuses_numbers_that_are_not_finite_or_not_physical) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    for (std::size_t offset :
         {offsetof(rfield_header, tool_offset), offsetof(rfield_header, depth_max), offsetof(rfield_header, stiffness_max),
          offsetof(rfield_header, band), offsetof(rfield_header, geometry_origin), offsetof(rfield_header, geometry_spacing),
          offsetof(rfield_header, geometry_scale), offsetof(rfield_header, geometry_bias), offsetof(rfield_header, amplitude_origin),
          offsetof(rfield_header, amplitude_spacing), offsetof(rfield_header, energy_depth_end),
          offsetof(rfield_header, stiffness_depth_end), offsetof(rfield_header, friction_depth_end)}) {
        for (double bad : {nan, inf, -inf, 1e30}) EXPECT_EQ(status_with(offset, bad), PALPATE_NOT_FINITE) << offset;
    }
    EXPECT_EQ(status_with(offsetof(rfield_header, geometry_spacing), 0.0), PALPATE_NOT_FINITE);
    EXPECT_EQ(status_with(section(section_amplitude_coefficients, 5000), std::numeric_limits<float>::quiet_NaN()), PALPATE_NOT_FINITE);
    EXPECT_EQ(status_with(section(section_energy_curves, 2), nan), PALPATE_NOT_FINITE);
    EXPECT_EQ(status_with(section(section_stiffness_curves, 1), inf), PALPATE_NOT_FINITE);
    EXPECT_EQ(status_with(section(section_friction_curves, 0), nan), PALPATE_NOT_FINITE);
}

TEST_F(open, refuses_counts_that_do_not_fit) {
    for (std::size_t offset :
         {offsetof(rfield_header, geometry_blocks), offsetof(rfield_header, geometry_stored), offsetof(rfield_header, amplitude_blocks),
          offsetof(rfield_header, amplitude_stored), offsetof(rfield_header, channel_stride), offsetof(rfield_header, energy_curve_count),
          offsetof(rfield_header, energy_intervals), offsetof(rfield_header, stiffness_intervals),
          offsetof(rfield_header, section_element_size)}) {
        for (std::uint32_t bad : {0u, 1u, 3u, 77u, 4097u, 0x10000u, 0x7FFFFFFFu, 0xFFFFFFFFu}) {
            std::uint32_t now;
            std::memcpy(&now, data.data() + offset, 4);
            if (bad != now) {
                EXPECT_NE(status_with(offset, bad), PALPATE_OK) << offset << " " << bad;
            }
        }
    }
    for (std::size_t i = 0; i < rfield_section_count; ++i) {
        for (std::uint64_t bad : {std::uint64_t{0}, std::uint64_t{64}, std::uint64_t{header.section_offset[i] + 1}, std::uint64_t{data.size()}, ~std::uint64_t{0}, ~std::uint64_t{63}}) {
            EXPECT_EQ(status_with(offsetof(rfield_header, section_offset) + 8 * i, bad), PALPATE_BAD_LAYOUT) << i << " " << bad;
        }
        EXPECT_EQ(status_with(offsetof(rfield_header, section_elements) + 8 * i, ~std::uint64_t{0}), PALPATE_BAD_LAYOUT) << i;
    }
}

TEST_F(open, refuses_block_indices_that_point_outside) {
    const auto stored = static_cast<std::int32_t>(header.geometry_stored);
    for (std::int32_t bad : {-4, stored, stored + 1, std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()}) {
        EXPECT_EQ(status_with(section(section_geometry_index, 7), bad), PALPATE_BAD_INDEX);
    }
    for (std::int32_t bad : {-1, static_cast<std::int32_t>(header.amplitude_stored)}) {
        EXPECT_EQ(status_with(section(section_amplitude_index, 7), bad), PALPATE_BAD_INDEX);
    }
    EXPECT_EQ(status_with(section(section_amplitude_coefficients, 9), 1.0f), PALPATE_BAD_LAYOUT);  // the zero block
}

TEST_F(open, refuses_curves_that_jump_or_do_not_start_at_zero) {
    const std::size_t row = 4u * header.energy_curve_count;
    EXPECT_EQ(status_with(section(section_energy_curves, 0), 1e-3), PALPATE_BAD_CURVE);
    EXPECT_EQ(status_with(section(section_energy_curves, 1), 1e-3), PALPATE_BAD_CURVE);
    EXPECT_EQ(status_with(section(section_energy_curves, 5 * row), 1.0), PALPATE_BAD_CURVE);
    EXPECT_EQ(status_with(section(section_energy_curves, 5 * row + 2), 1e3), PALPATE_BAD_CURVE);
    EXPECT_EQ(status_with(section(section_energy_curves, header.energy_intervals * row + 3), 1e3), PALPATE_BAD_CURVE);
    EXPECT_EQ(status_with(section(section_stiffness_curves, 4), 1e6), PALPATE_BAD_CURVE);
    EXPECT_EQ(status_with(section(section_friction_curves, 4), 3.0), PALPATE_BAD_CURVE);
}

TEST_F(open, a_field_with_negative_bends_and_negative_amplitudes_still_opens_and_stays_finite) {
    // The last row's c2: a force that falls beyond depth_end.  Physics to be judged elsewhere; nothing may break.
    bytes changed = data;
    const std::size_t row = 4u * header.energy_curve_count;
    const double bend = -1e5;
    std::memcpy(changed.data() + section(section_energy_curves, header.energy_intervals * row + 2), &bend, 8);
    for (std::size_t i = 300; i < 20000; i += 4) {
        const float a = -3.0f;
        std::memcpy(changed.data() + section(section_amplitude_coefficients, i), &a, 4);
    }
    reseal(changed);
    palpate_field* field = nullptr;
    ASSERT_EQ(palpate_field_open(changed.data(), changed.size(), 0, &field, nullptr, 0), PALPATE_OK);
    const session_memory session(field);
    for (int i = 0; i < 1000; ++i) {
        const palpate_tool_response r = session.tick({-4e-3 + 1e-5 * i, 1e-3, 6e-3 - 7e-6 * i});
        const double balance = r.work_in + r.hold_leak - r.stored_energy - r.dissipated_friction - r.dissipated_rule;
        ASSERT_TRUE(std::isfinite(r.force[0] + r.force[1] + r.force[2] + r.torque[0]));
        EXPECT_NEAR(balance, 0.0, 1e-12);
        EXPECT_GE(r.dissipated_friction, -1e-18);
        EXPECT_GE(r.dissipated_rule, 0.0);
    }
    palpate_field_close(field);
}

TEST(open_file, says_what_is_wrong_with_a_path) {
    palpate_field* field = nullptr;
    char why[64];
    EXPECT_EQ(palpate_field_open_file("/nowhere/absent.rfield", &field, why, sizeof why), PALPATE_FILE_UNREADABLE);
    EXPECT_STREQ(why, palpate_status_text(PALPATE_FILE_UNREADABLE));
    EXPECT_EQ(palpate_field_open_file(PALPATE_TEST_FIELDS, &field, why, sizeof why), PALPATE_FILE_UNREADABLE);  // a folder
    EXPECT_EQ(palpate_field_open_file(nullptr, &field, why, sizeof why), PALPATE_BAD_ARGUMENT);
    char tiny[4];
    EXPECT_EQ(palpate_field_open("x", 1, 0, &field, tiny, sizeof tiny), PALPATE_TRUNCATED);
    EXPECT_EQ(std::strlen(tiny), 3u);
}

}  // namespace
}  // namespace palpate
