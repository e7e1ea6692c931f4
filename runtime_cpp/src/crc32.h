// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// CRC-32 as in zlib (polynomial 0xEDB88320), eight bytes at a time (M. Kounavis and F. Berry, Novel table
// lookup-based algorithms for high-performance CRC generation, 2008).
#ifndef PALPATE_SRC_CRC32_H
#define PALPATE_SRC_CRC32_H

#include <cstddef>
#include <cstdint>

namespace palpate {

struct crc32_tables {
    std::uint32_t at[8][256];
    constexpr crc32_tables() : at{} {
        for (std::uint32_t i = 0; i < 256; ++i) {
            std::uint32_t c = i;
            for (int bit = 0; bit < 8; ++bit) c = (c & 1u) != 0 ? 0xEDB88320u ^ (c >> 1) : c >> 1;
            at[0][i] = c;
        }
        for (std::uint32_t i = 0; i < 256; ++i) {
            for (int k = 1; k < 8; ++k) at[k][i] = at[0][at[k - 1][i] & 255u] ^ (at[k - 1][i] >> 8);
        }
    }
};

inline constexpr crc32_tables crc32_table{};

// Continues from `crc`, the result so far (0 at the start).
inline std::uint32_t crc32(std::uint32_t crc, const unsigned char* data, std::size_t size) noexcept {
    const auto& t = crc32_table.at;
    std::uint32_t c = ~crc;
    for (; size >= 8; size -= 8, data += 8) {
        c ^= static_cast<std::uint32_t>(data[0]) | static_cast<std::uint32_t>(data[1]) << 8 |
             static_cast<std::uint32_t>(data[2]) << 16 | static_cast<std::uint32_t>(data[3]) << 24;
        c = t[7][c & 255u] ^ t[6][c >> 8 & 255u] ^ t[5][c >> 16 & 255u] ^ t[4][c >> 24] ^ t[3][data[4]] ^ t[2][data[5]] ^
            t[1][data[6]] ^ t[0][data[7]];
    }
    for (; size > 0; --size, ++data) c = t[0][(c ^ *data) & 255u] ^ (c >> 8);
    return ~c;
}

}  // namespace palpate

#endif
