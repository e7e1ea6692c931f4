// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Traces that meet everything, on fields built here from exact numbers, and the hash of all answers.  Compilers,
// optimisation levels and instruction sets have to agree on it, bit by bit.  After a change of the tick's arithmetic that
// is meant, run the test and take the new hash from its message.
#include <cmath>
#include <vector>

#include "crc32.h"
#include "test_field.h"

namespace {

constexpr std::uint64_t golden = 0xfd6703d5c427dffdu;
constexpr std::uint64_t golden_in_motion = 0xbb19f23330996ff2u;

// Numbers from integer arithmetic alone: no library's sin, no library's distributions.
struct steps {
    std::uint64_t state = 1;
    double next() {  // in [-1, 1), exact
        state = state * 6364136223846793005u + 1442695040888963407u;
        return static_cast<double>(state >> 11) * 0x1p-52 - 1.0;
    }
};

// A slab of tissue, phi = z (exactly representable steps), three energy curves, one of stiffness, one of friction; `ways` of
// touching, each with amplitudes and an offset of its own; energies times `stiffness`.
std::vector<unsigned char> exact_field(std::uint32_t ways, double stiffness_of) {
    using namespace palpate;
    rfield_header h{};
    std::memcpy(h.magic, rfield_magic, sizeof h.magic);
    h.version = rfield_version;
    h.header_size = sizeof h;
    h.layout_hash = rfield_layout_hash;
    h.section_count = rfield_section_count;
    h.tool_offset = 0.005;
    h.depth_max = 0.004;
    h.stiffness_max = 2000.0 * stiffness_of;
    h.band[0] = -0.008;
    h.band[1] = 0.008;
    h.geometry_spacing = 0x1p-9;  // 1.95 mm
    h.geometry_scale = 0x1p-21;
    for (int a = 0; a < 3; ++a) h.geometry_origin[a] = h.amplitude_origin[a] = -0.015625;
    h.amplitude_spacing = 0x1p-8;
    for (int a = 0; a < 3; ++a) {
        h.geometry_blocks[a] = 4;
        h.amplitude_blocks[a] = 3;
    }
    h.geometry_stored = 64;
    h.amplitude_stored = 28;
    h.channel_stride = 8;
    h.way_count = ways;
    for (std::uint32_t w = 0; w < ways; ++w) {
        h.way_cosine[w] = 1.0 - 0.25 * w;
        h.way_offset[w] = h.tool_offset - 0x1p-13 * w;
    }
    h.energy_curve_count = 3;
    h.stiffness_curve_count = h.friction_curve_count = 1;
    h.energy_intervals = h.stiffness_intervals = h.friction_intervals = 4;
    h.energy_depth_end = h.stiffness_depth_end = h.friction_depth_end = 0x1p-8;
    const std::uint64_t count[rfield_section_count] = {64, 64 * 64, 27, ways * 28 * 64 * 8, 5 * 3 * 4, 5 * 4, 5 * 4, 0};
    std::uint64_t at = sizeof h;
    for (std::uint32_t i = 0; i < rfield_section_count; ++i) {
        at = (at + rfield_section_alignment - 1) / rfield_section_alignment * rfield_section_alignment;
        h.section_offset[i] = at;
        h.section_elements[i] = count[i];
        h.section_element_size[i] = rfield_element_size[i];
        at += count[i] * rfield_element_size[i];
    }
    h.file_size = at;
    std::vector<unsigned char> bytes(at);
    std::memcpy(bytes.data(), &h, sizeof h);
    const auto put = [&bytes, &h](rfield_section s, std::uint64_t i, auto value) {
        std::memcpy(bytes.data() + h.section_offset[s] + i * sizeof value, &value, sizeof value);
    };
    steps random;
    for (int i = 0; i < 64; ++i) put(section_geometry_index, static_cast<std::uint64_t>(i), static_cast<std::int32_t>(i));
    for (int i = 0; i < 64; ++i) {
        for (int c = 0; c < 64; ++c) {
            const int z = i % 4 * 4 + c % 4 - 8;  // coefficient of the linear function z, and bumps of 0.1 mm
            const auto value = static_cast<std::int16_t>(z * 4096 + 2048 + static_cast<int>(200.0 * random.next()));
            put(section_geometry_coefficients, static_cast<std::uint64_t>(i * 64 + c), value);
        }
    }
    for (int i = 0; i < 27; ++i) put(section_amplitude_index, static_cast<std::uint64_t>(i), static_cast<std::int32_t>(i == 13 ? 0 : i + 1));
    for (std::uint32_t i = ways * 64 * 8; i < ways * 28 * 64 * 8; ++i) {  // coefficient by coefficient, its ways in a row
        const float a = i % 8 < 5 ? static_cast<float>(1.0 + 0.5 * random.next()) : 0.0f;
        put(section_amplitude_coefficients, i, a);
    }
    const double step = 0x1p-10;
    for (std::uint64_t curve = 0; curve < 3; ++curve) {  // c2 d^2, carried exactly from knot to knot
        const double c2 = stiffness_of * 40.0 * static_cast<double>(curve + 1);
        for (int m = 0; m < 5; ++m) {
            const double d = step * m;
            const double row[4] = {c2 * d * d, 2.0 * c2 * d, c2, 0.0};
            for (int k = 0; k < 4; ++k) put(section_energy_curves, (static_cast<std::uint64_t>(m) * 3 + curve) * 4 + static_cast<std::uint64_t>(k), row[k]);
        }
    }
    for (int m = 0; m < 5; ++m) {
        const double stiffness[4] = {65536.0 * step * m, 65536.0, 0.0, 0.0}, friction[4] = {0.25, 0.0, 0.0, 0.0};
        for (int k = 0; k < 4; ++k) {
            put(section_stiffness_curves, static_cast<std::uint64_t>(m * 4 + k), stiffness[k]);
            put(section_friction_curves, static_cast<std::uint64_t>(m * 4 + k), friction[k]);
        }
    }
    reseal(bytes);
    return bytes;
}

std::uint64_t mix(std::uint64_t hash, const void* data, std::size_t size) {  // FNV-1a
    const auto* byte = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) hash = (hash ^ byte[i]) * 1099511628211u;
    return hash;
}

TEST(golden, all_compilers_and_levels_give_the_same_bits) {
    const auto bytes = exact_field(1, 1.0);
    palpate_field* field = nullptr;
    char why[256];
    ASSERT_EQ(palpate_field_open(bytes.data(), bytes.size(), 0, &field, why, sizeof why), PALPATE_OK) << why;
    std::uint64_t hash = 14695981039346656037u;
    std::uint32_t seen = 0;
    int felt = 0;
    for (std::uint32_t variant = 0; variant < 8; ++variant) {
        palpate_config config;
        palpate_config_default(&config);
        config.adhesion = 1 + variant % 4;
        config.force_max = variant >= 4 ? 0.5 : 0.0;
        config.passivity_control = variant >= 6;
        config.reference_point[2] = -0.125;
        std::vector<std::uint64_t> memory((palpate_session_size() + 7) / 8);
        palpate_session* session = nullptr;
        ASSERT_EQ(palpate_session_init(memory.data(), memory.size() * 8, field, &config, &session), PALPATE_OK);
        steps random;
        random.state += variant;
        palpate_tool_state state{sizeof state, 0, 1e-3, {0, 0, 0.135}, {0.0, 0.0, 0.6, 0.8}, {0, 0, 0}, {0, 0, 0, 1}};
        palpate_tool_response r;
        for (int i = 0; i < 20000; ++i) {
            const double size = i % 1000 == 999 ? 8e-3 : i % 100 == 99 ? 6e-4 : 6e-5;
            const double home[3] = {0.0, 0.0, 0.1285};
            for (int a = 0; a < 3; ++a) state.position[a] += size * random.next() - 0.002 * (state.position[a] - home[a]);
            state.orientation[0] = 0x1p-12 * random.next();
            std::memset(&r, 0, sizeof r);
            r.size = sizeof r;
            seen |= palpate_tick(session, &state, &r);
            felt += r.stored_energy > 0.0;
            hash = mix(hash, &r, sizeof r);
        }
    }
    palpate_field_close(field);
    EXPECT_GT(felt, 20000);
    const std::uint32_t wanted = PALPATE_TICK_SLIPPING | PALPATE_TICK_EXTRAPOLATED | PALPATE_TICK_FORCE_LIMITED |
                                 PALPATE_TICK_LEAK_COVERED | PALPATE_TICK_JUMP | PALPATE_TICK_WAITING;
    EXPECT_EQ(seen & wanted, wanted);
    EXPECT_EQ(hash, golden) << "0x" << std::hex << hash << "u";
}

// The quaternion of a turn about x (axis 0) or y by 2 atan(t): rational, so that no library's sine is asked.
void turn_about(int axis, double t, double q[4]) {
    const double scale = 1.0 / (1.0 + t * t);
    q[0] = q[1] = q[2] = 0.0;
    q[axis] = t * scale * 2.0;
    q[3] = (1.0 - t * t) * scale;
}

TEST(golden, tilts_a_moving_organ_changed_fields_and_axial_responses_give_the_same_bits) {
    palpate_field* fields[2] = {nullptr, nullptr};
    for (int stiff = 0; stiff < 2; ++stiff) {
        const auto bytes = exact_field(3, stiff == 0 ? 1.0 : 4.0);
        char why[256];
        ASSERT_EQ(palpate_field_open(bytes.data(), bytes.size(), 0, &fields[stiff], why, sizeof why), PALPATE_OK) << why;
    }
    std::vector<std::uint64_t> organ_memory((palpate_organ_size() + 7) / 8);
    palpate_organ* organ = nullptr;
    ASSERT_EQ(palpate_organ_init(organ_memory.data(), organ_memory.size() * 8, &organ), PALPATE_OK);
    std::uint64_t hash = 14695981039346656037u;
    std::uint32_t seen = 0;
    int felt = 0;
    for (std::uint32_t variant = 0; variant < 6; ++variant) {
        palpate_config config;
        palpate_config_default(&config);
        config.response = variant % 3;
        std::vector<std::uint64_t> memory((palpate_session_size() + 7) / 8);
        palpate_session* session = nullptr;
        ASSERT_EQ(palpate_session_init(memory.data(), memory.size() * 8, fields[0], &config, &session), PALPATE_OK);
        if (variant >= 3) palpate_session_set_organ(session, organ);
        steps random;
        random.state += 100 + variant;
        palpate_tool_state state{sizeof state, 0, 1e-3, {0, 0, 0.008}, {0, 0, 0, 1}, {0, 0, 0}, {0, 0, 0, 1}};
        palpate_tool_response r;
        double tilt = 0.0;
        for (int i = 0; i < 10000; ++i) {
            const double size = i % 5000 == 4999 ? 16e-3 : i % 500 == 499 ? 4e-3 : 6e-5;
            const double home[3] = {0.0, 0.0, 0.0038};
            for (int a = 0; a < 3; ++a) state.position[a] += size * random.next() - 0.002 * (state.position[a] - home[a]);
            tilt += 0.02 * random.next() - 0.002 * tilt;
            turn_about(0, tilt, state.orientation);
            if (variant >= 3 && i % 16 == 0) {  // 60 Hz
                const double place[3] = {2e-4 * random.next(), 2e-4 * random.next(), 2e-4 * random.next()};
                double turned[4];
                turn_about(1, 0.01 * random.next(), turned);
                ASSERT_EQ(palpate_organ_move(organ, place, turned, 0x1p-6), PALPATE_OK);
            }
            if (i % 250 == 249) palpate_session_set_field(session, fields[i / 250 % 2]);
            std::memset(&r, 0, sizeof r);
            r.size = sizeof r;
            seen |= palpate_tick(session, &state, &r);
            felt += r.stored_energy > 0.0;
            hash = mix(hash, &r, sizeof r);
        }
        EXPECT_TRUE((r.organ_work != 0.0) == (variant >= 3)) << variant;
    }
    for (palpate_field* field : fields) palpate_field_close(field);
    EXPECT_GT(felt, 10000);
    const std::uint32_t wanted = PALPATE_TICK_SLIPPING | PALPATE_TICK_RULE_YIELDED | PALPATE_TICK_WAITING;
    EXPECT_EQ(seen & wanted, wanted);
    EXPECT_EQ(hash, golden_in_motion) << "0x" << std::hex << hash << "u";
}

}  // namespace
