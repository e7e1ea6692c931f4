// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Fields and sessions for the C++ tests.
#ifndef PALPATE_TESTS_TEST_FIELD_H
#define PALPATE_TESTS_TEST_FIELD_H

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "crc32.h"
#include "palpate/palpate.h"
#include "rfield_layout.h"

using point = std::array<double, 3>;

inline std::vector<unsigned char> file_bytes(const std::string& name) {
    std::ifstream file(PALPATE_TEST_FIELDS + name + ".rfield", std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

struct opened_field {
    palpate_field* field = nullptr;
    explicit opened_field(const std::string& name) {
        char why[256];
        const auto bytes = file_bytes(name);
        const palpate_status status = palpate_field_open(bytes.data(), bytes.size(), 0, &field, why, sizeof why);
        EXPECT_EQ(status, PALPATE_OK) << why;
    }
    opened_field(const opened_field&) = delete;
    opened_field& operator=(const opened_field&) = delete;
    ~opened_field() { palpate_field_close(field); }
};

struct session_memory {
    std::vector<std::uint64_t> bytes = std::vector<std::uint64_t>((palpate_session_size() + 7) / 8);
    palpate_session* session = nullptr;
    explicit session_memory(const palpate_field* field, double speed_max = 0.0, double friction = -1.0) {
        palpate_config config;
        palpate_config_default(&config);
        config.speed_max = speed_max;
        config.friction_coefficient = friction;
        EXPECT_EQ(palpate_session_init(bytes.data(), bytes.size() * 8, field, &config, &session), PALPATE_OK);
    }
    session_memory(const palpate_field* field, const palpate_config& config) {
        EXPECT_EQ(palpate_session_init(bytes.data(), bytes.size() * 8, field, &config, &session), PALPATE_OK);
    }
    palpate_tool_response tick(const point& p, double dt = 1e-3) const {
        palpate_tool_state state{sizeof state, PALPATE_INPUT_POSITION_ONLY, dt, {p[0], p[1], p[2]}, {0, 0, 0, 1}, {0, 0, 0}, {0, 0, 0, 1}};
        palpate_tool_response response{};
        response.size = sizeof response;
        palpate_tick(session, &state, &response);
        return response;
    }
};

inline palpate_sample sample_at(const palpate_field* field, const point& q) {
    palpate_sample s{};
    s.size = sizeof s;
    EXPECT_EQ(palpate_field_sample(field, q.data(), 1, &s), PALPATE_OK);
    return s;
}

// The file with its checksum made to fit again after a change.
inline void reseal(std::vector<unsigned char>& bytes) {
    auto* checksum = bytes.data() + offsetof(palpate::rfield_header, checksum);
    std::memset(checksum, 0, 4);
    const std::uint32_t crc = palpate::crc32(0, bytes.data(), bytes.size());
    std::memcpy(checksum, &crc, 4);
}

#endif
