// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Four doubles side by side.  Each lane does the IEEE operations that scalar code would, in the same order and without
// fused operations, so results do not depend on how wide the machine is: with AVX2 one register, else two of two
// lanes (a 32-byte vector without AVX makes gcc 12 go through memory: three times slower), else scalars.
// Included by the files that are compiled once for each instruction set; PALPATE_ISA names their namespace.
#ifndef PALPATE_SRC_LANES_H
#define PALPATE_SRC_LANES_H

#include <cstdint>
#include <cstring>
#include <limits>

#if defined(__AVX2__)
#include <immintrin.h>
#elif defined(__SSE2__)
#include <emmintrin.h>
#endif

// Before a loop of three (eight) turns whose body must not pay for its counter; and before one whose body, unrolled, would not
// fit the registers.
#if defined(__clang__)
#define PALPATE_UNROLL_3 _Pragma("clang loop unroll(full)")
#define PALPATE_UNROLL_8 _Pragma("clang loop unroll(full)")
#define PALPATE_NO_UNROLL _Pragma("clang loop unroll(disable)")
#elif defined(__GNUC__)
#define PALPATE_UNROLL_3 _Pragma("GCC unroll 3")
#define PALPATE_UNROLL_8 _Pragma("GCC unroll 8")
#define PALPATE_NO_UNROLL _Pragma("GCC unroll 1")
#else
#define PALPATE_UNROLL_3
#define PALPATE_UNROLL_8
#define PALPATE_NO_UNROLL
#endif

namespace palpate {
namespace PALPATE_ISA {

// Asks the caches for the line at an address, which may be any: nobody waits and nothing changes.
inline void fetch(const void* at) noexcept {
#if defined(__GNUC__)
    __builtin_prefetch(at);
#if !defined(__clang__)
    __asm__ volatile("" : : "r"(at));  // else gcc takes a function that only fetches for one without effect and drops its calls
#endif
#else
    static_cast<void>(at);
#endif
}

constexpr double lowest = -std::numeric_limits<double>::max();

#if defined(__AVX2__)

struct quad {
    __m256d v;
};
inline quad all(double x) noexcept { return {_mm256_set1_pd(x)}; }
inline quad three(double a, double b, double c) noexcept { return {_mm256_set_pd(0.0, c, b, a)}; }
inline quad four(double a, double b, double c, double d) noexcept { return {_mm256_set_pd(d, c, b, a)}; }
// a > b ? a : b
inline quad larger(quad a, quad b) noexcept { return {_mm256_max_pd(a.v, b.v)}; }
// a < b ? a : b
inline quad smaller(quad a, quad b) noexcept { return {_mm256_min_pd(a.v, b.v)}; }
// a < b ? less : not_less
inline quad where_less(quad a, quad b, quad less, quad not_less) noexcept {
    return {_mm256_blendv_pd(not_less.v, less.v, _mm256_cmp_pd(a.v, b.v, _CMP_LT_OQ))};
}
// a != b in some lane
inline bool any_other(quad a, quad b) noexcept { return _mm256_movemask_pd(_mm256_cmp_pd(a.v, b.v, _CMP_NEQ_UQ)) != 0; }
// (a0, a1, a2, b0)
inline quad with_fourth(quad a, quad b) noexcept { return {_mm256_blend_pd(a.v, _mm256_permute4x64_pd(b.v, 0), 8)}; }
inline quad operator+(quad a, quad b) noexcept { return {_mm256_add_pd(a.v, b.v)}; }
inline quad operator-(quad a, quad b) noexcept { return {_mm256_sub_pd(a.v, b.v)}; }
inline quad operator*(quad a, quad b) noexcept { return {_mm256_mul_pd(a.v, b.v)}; }
// 0 <= a < end in every lane
inline bool all_within(quad a, quad end) noexcept {
    const __m256d low = _mm256_cmp_pd(_mm256_setzero_pd(), a.v, _CMP_LE_OQ), high = _mm256_cmp_pd(a.v, end.v, _CMP_LT_OQ);
    return _mm256_movemask_pd(_mm256_and_pd(low, high)) == 15;
}
// Without their fractions, 0 <= a < 2^31; `whole` as integers.
inline quad truncated(quad a, std::uint32_t whole[4]) noexcept {
    const __m128i i = _mm256_cvttpd_epi32(a.v);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(whole), i);
    return {_mm256_cvtepi32_pd(i)};
}
// The same; `same` tells whether `whole` held these numbers before.
inline quad truncated(quad a, std::uint32_t whole[4], bool& same) noexcept {
    const __m128i i = _mm256_cvttpd_epi32(a.v);
    auto* const at = reinterpret_cast<__m128i*>(whole);
    same = _mm_movemask_epi8(_mm_cmpeq_epi32(i, _mm_loadu_si128(at))) == 0xFFFF;
    _mm_storeu_si128(at, i);
    return {_mm256_cvtepi32_pd(i)};
}
template <int i>
inline quad lane(quad a) noexcept { return {_mm256_permute4x64_pd(a.v, i * 0x55)}; }
inline void store(double* to, quad a) noexcept { _mm256_storeu_pd(to, a.v); }
inline quad load(const double* from) noexcept { return {_mm256_loadu_pd(from)}; }
// Four floats from memory.
inline quad load(const float* from) noexcept { return {_mm256_cvtps_pd(_mm_loadu_ps(from))}; }

// Cuts four int16, beginning with number `place` (0..3), out of two runs of four, and gives each times cut_scale: an int16
// in the upper half of an int32 needs no sign extension.
constexpr double cut_scale = 65536.0;
struct cutter {
    __m128i pattern;
    explicit cutter(std::int64_t place) noexcept {
        const __m128i from_first = _mm_set_epi8(7, 6, -1, -1, 5, 4, -1, -1, 3, 2, -1, -1, 1, 0, -1, -1);
        // -1 (write zero) stays negative
        const __m128i shift = _mm_set1_epi32(static_cast<int>(static_cast<std::uint32_t>(place) * 0x02020000u));
        pattern = _mm_add_epi8(from_first, shift);
    }
    quad operator()(const std::int16_t* own, const std::int16_t* next) const noexcept {
        const __m128 first = _mm_castsi128_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(own)));
        const __m128 both = _mm_loadh_pi(first, reinterpret_cast<const __m64*>(next));
        return {_mm256_cvtepi32_pd(_mm_shuffle_epi8(_mm_castps_si128(both), pattern))};
    }
};

// taps[i] = (a_i, b_i, c_i, anything), i = 0, 1, 2
inline void taps_of(quad a, quad b, quad c, quad taps[3]) noexcept {
    const __m256d even = _mm256_unpacklo_pd(a.v, b.v), odd = _mm256_unpackhi_pd(a.v, b.v);  // a0 b0 a2 b2, a1 b1 a3 b3
    taps[0] = {_mm256_permute2f128_pd(even, c.v, 0x20)};
    taps[1] = {_mm256_permute2f128_pd(odd, _mm256_permute_pd(c.v, 0x5), 0x20)};
    taps[2] = {_mm256_permute2f128_pd(even, c.v, 0x31)};
}

// ((a0 + a1) + (a2 + a3), the same of b, c, d)
inline quad sums_of_four(quad a, quad b, quad c, quad d) noexcept {
    const __m256d ab = _mm256_add_pd(_mm256_unpacklo_pd(a.v, b.v), _mm256_unpackhi_pd(a.v, b.v));  // a0 + a1, b0 + b1, a2 + a3, b2 + b3
    const __m256d cd = _mm256_add_pd(_mm256_unpacklo_pd(c.v, d.v), _mm256_unpackhi_pd(c.v, d.v));
    return {_mm256_add_pd(_mm256_permute2f128_pd(ab, cd, 0x20), _mm256_permute2f128_pd(ab, cd, 0x31))};
}

#else

#if defined(__GNUC__)
typedef double pair __attribute__((vector_size(16)));
#else
struct pair {
    double v[2];
    double operator[](int i) const noexcept { return v[i]; }
};
inline pair operator+(const pair& a, const pair& b) noexcept { return {{a.v[0] + b.v[0], a.v[1] + b.v[1]}}; }
inline pair operator-(const pair& a, const pair& b) noexcept { return {{a.v[0] - b.v[0], a.v[1] - b.v[1]}}; }
inline pair operator*(const pair& a, const pair& b) noexcept { return {{a.v[0] * b.v[0], a.v[1] * b.v[1]}}; }
#endif

struct quad {
    pair low, high;
};
inline quad all(double x) noexcept { return {pair{x, x}, pair{x, x}}; }
inline quad three(double a, double b, double c) noexcept { return {pair{a, b}, pair{c, 0.0}}; }
inline quad four(double a, double b, double c, double d) noexcept { return {pair{a, b}, pair{c, d}}; }
inline quad larger(const quad& a, const quad& b) noexcept {
    const auto of = [](double x, double y) { return x > y ? x : y; };
    return {pair{of(a.low[0], b.low[0]), of(a.low[1], b.low[1])}, pair{of(a.high[0], b.high[0]), of(a.high[1], b.high[1])}};
}
inline quad smaller(const quad& a, const quad& b) noexcept {
    const auto of = [](double x, double y) { return x < y ? x : y; };
    return {pair{of(a.low[0], b.low[0]), of(a.low[1], b.low[1])}, pair{of(a.high[0], b.high[0]), of(a.high[1], b.high[1])}};
}
inline quad where_less(const quad& a, const quad& b, const quad& less, const quad& not_less) noexcept {
    const auto low = [&](int i) { return a.low[i] < b.low[i] ? less.low[i] : not_less.low[i]; };
    const auto high = [&](int i) { return a.high[i] < b.high[i] ? less.high[i] : not_less.high[i]; };
    return {pair{low(0), low(1)}, pair{high(0), high(1)}};
}
inline bool any_other(const quad& a, const quad& b) noexcept {
    return a.low[0] != b.low[0] || a.low[1] != b.low[1] || a.high[0] != b.high[0] || a.high[1] != b.high[1];
}
inline quad with_fourth(const quad& a, const quad& b) noexcept { return {a.low, pair{a.high[0], b.low[0]}}; }
inline quad operator+(const quad& a, const quad& b) noexcept { return {a.low + b.low, a.high + b.high}; }
inline quad operator-(const quad& a, const quad& b) noexcept { return {a.low - b.low, a.high - b.high}; }
inline quad operator*(const quad& a, const quad& b) noexcept { return {a.low * b.low, a.high * b.high}; }
inline void store(double* to, const quad& a) noexcept {
    to[0] = a.low[0];
    to[1] = a.low[1];
    to[2] = a.high[0];
    to[3] = a.high[1];
}
inline quad load(const double* from) noexcept { return {pair{from[0], from[1]}, pair{from[2], from[3]}}; }
inline bool all_within(const quad& a, const quad& end) noexcept {
    const auto within = [](double x, double least_above) { return x >= 0.0 && x < least_above; };
    return within(a.low[0], end.low[0]) && within(a.low[1], end.low[1]) && within(a.high[0], end.high[0]) && within(a.high[1], end.high[1]);
}
inline quad truncated(const quad& a, std::uint32_t whole[4]) noexcept {
    const double from[4] = {a.low[0], a.low[1], a.high[0], a.high[1]};
    for (int i = 0; i < 4; ++i) whole[i] = static_cast<std::uint32_t>(from[i]);
    const auto at = [whole](int i) { return static_cast<double>(whole[i]); };
    return {pair{at(0), at(1)}, pair{at(2), at(3)}};
}
inline quad truncated(const quad& a, std::uint32_t whole[4], bool& same) noexcept {
    std::uint32_t now[4];
    const quad rounded = truncated(a, now);
    same = std::memcmp(now, whole, sizeof now) == 0;
    std::memcpy(whole, now, sizeof now);
    return rounded;
}
template <int i>
inline quad lane(const quad& a) noexcept {
    const pair& from = i < 2 ? a.low : a.high;
    return all(from[i & 1]);
}
inline quad sums_of_four(const quad& a, const quad& b, const quad& c, const quad& d) noexcept {
    return {pair{(a.low[0] + a.low[1]) + (a.high[0] + a.high[1]), (b.low[0] + b.low[1]) + (b.high[0] + b.high[1])},
            pair{(c.low[0] + c.low[1]) + (c.high[0] + c.high[1]), (d.low[0] + d.low[1]) + (d.high[0] + d.high[1])}};
}
inline quad load(const float* from) noexcept {
#if defined(__SSE2__)
    const __m128 four = _mm_loadu_ps(from);
    return {_mm_cvtps_pd(four), _mm_cvtps_pd(_mm_movehl_ps(four, four))};
#else
    const auto at = [from](int i) { return static_cast<double>(from[i]); };
    return {pair{at(0), at(1)}, pair{at(2), at(3)}};
#endif
}

constexpr double cut_scale = 65536.0;
struct cutter {
    std::int64_t place;
    explicit cutter(std::int64_t first) noexcept : place(first) {}
    quad operator()(const std::int16_t* own, const std::int16_t* next) const noexcept {
#if defined(__SSE2__) && defined(__x86_64__)
        std::uint64_t first, second;
        std::memcpy(&first, own, 8);
        std::memcpy(&second, next, 8);
        const auto cut = static_cast<int>(16 * place);
        const __m128i packed = _mm_cvtsi64_si128(static_cast<long long>(first >> cut | second << 1 << (63 - cut)));
        const __m128i wide = _mm_unpacklo_epi16(_mm_setzero_si128(), packed);
        return {_mm_cvtepi32_pd(wide), _mm_cvtepi32_pd(_mm_shuffle_epi32(wide, 0xEE))};
#else
        const auto at = [&](int i) { return cut_scale * static_cast<double>(i + place < 4 ? own[i + place] : next[i + place - 4]); };
        return {pair{at(0), at(1)}, pair{at(2), at(3)}};
#endif
    }
};

inline void taps_of(const quad& a, const quad& b, const quad& c, quad taps[3]) noexcept {
    taps[0] = {pair{a.low[0], b.low[0]}, pair{c.low[0], 0.0}};
    taps[1] = {pair{a.low[1], b.low[1]}, pair{c.low[1], 0.0}};
    taps[2] = {pair{a.high[0], b.high[0]}, pair{c.high[0], 0.0}};
}

#endif

}  // namespace PALPATE_ISA
}  // namespace palpate

#endif
