// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#ifndef PALPATE_SRC_VEC_H
#define PALPATE_SRC_VEC_H

// For what a tick must not call, because its numbers would go through memory.
#if defined(__GNUC__)
#define PALPATE_INLINE inline __attribute__((always_inline))
#define PALPATE_APART __attribute__((noinline))
#define PALPATE_EXPECTED(condition) __builtin_expect(condition, 1)
#else
#define PALPATE_INLINE inline
#define PALPATE_APART
#define PALPATE_EXPECTED(condition) (condition)
#endif

namespace palpate {

inline double dot(const double a[3], const double b[3]) noexcept { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

}  // namespace palpate

#endif
