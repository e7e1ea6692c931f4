// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Two doubles side by side, which every 64-bit machine has.  Each lane does the IEEE operations that scalar code
// would, so results do not depend on how the compiler maps it.  (Four doubles as one 32-byte vector made gcc 12 go through
// memory without AVX: three times slower.)
#ifndef PALPATE_SRC_LANES_H
#define PALPATE_SRC_LANES_H

#include <cstdint>
#include <cstring>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

// Before a loop of three turns whose body must not pay for its counter.
#if defined(__clang__)
#define PALPATE_UNROLL_3 _Pragma("clang loop unroll(full)")
#elif defined(__GNUC__)
#define PALPATE_UNROLL_3 _Pragma("GCC unroll 3")
#else
#define PALPATE_UNROLL_3
#endif

namespace palpate {

#if defined(__GNUC__)
typedef double pair __attribute__((vector_size(16)));
inline pair both(double x) noexcept { return pair{x, x}; }
#else
struct pair {
    double v[2];
    double operator[](int i) const noexcept { return v[i]; }
};
inline pair both(double x) noexcept { return {{x, x}}; }
inline pair operator+(const pair& a, const pair& b) noexcept { return {{a.v[0] + b.v[0], a.v[1] + b.v[1]}}; }
inline pair operator*(const pair& a, const pair& b) noexcept { return {{a.v[0] * b.v[0], a.v[1] * b.v[1]}}; }
inline pair& operator+=(pair& a, const pair& b) noexcept { return a = a + b; }
#endif

// Two floats from memory, as doubles.
inline pair load_pair(const float* from) noexcept {
#if defined(__SSE2__)
    __m128i bits = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(from));
    return _mm_cvtps_pd(_mm_castsi128_ps(bits));
#else
    return pair{static_cast<double>(from[0]), static_cast<double>(from[1])};
#endif
}

// Four int16, the lowest bits first, as doubles.
inline void unpack_counts(std::uint64_t bits, pair& low, pair& high) noexcept {
#if defined(__SSE2__) && defined(__x86_64__)
    const __m128i packed = _mm_cvtsi64_si128(static_cast<long long>(bits));
    const __m128i wide = _mm_srai_epi32(_mm_unpacklo_epi16(packed, packed), 16);
    low = _mm_cvtepi32_pd(wide);
    high = _mm_cvtepi32_pd(_mm_shuffle_epi32(wide, 0xEE));
#else
    const auto at = [bits](int i) { return static_cast<double>(static_cast<std::int16_t>(bits >> (16 * i) & 0xFFFFu)); };
    low = pair{at(0), at(1)};
    high = pair{at(2), at(3)};
#endif
}

}  // namespace palpate

#endif
