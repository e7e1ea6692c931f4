// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Four doubles side by side.  Each lane does the same IEEE operations that scalar code would, so results do not
// depend on how the compiler maps it to the machine.
#ifndef PALPATE_SRC_LANES_H
#define PALPATE_SRC_LANES_H

#include <cstring>

namespace palpate {

#if defined(__GNUC__)

typedef double lanes __attribute__((vector_size(32)));
typedef float float_lanes __attribute__((vector_size(16)));

inline __attribute__((always_inline)) void load(lanes& x, const float* from) noexcept {
    float_lanes f;
    std::memcpy(&f, from, sizeof f);
    x = __builtin_convertvector(f, lanes);
}

#else

struct lanes {
    double v[4];
    double operator[](int i) const noexcept { return v[i]; }
};
inline lanes operator+(const lanes& a, const lanes& b) noexcept {
    return {{a.v[0] + b.v[0], a.v[1] + b.v[1], a.v[2] + b.v[2], a.v[3] + b.v[3]}};
}
inline lanes operator*(double a, const lanes& b) noexcept { return {{a * b.v[0], a * b.v[1], a * b.v[2], a * b.v[3]}}; }
inline lanes& operator+=(lanes& a, const lanes& b) noexcept { return a = a + b; }
inline void load(lanes& x, const float* from) noexcept {
    for (int i = 0; i < 4; ++i) x.v[i] = static_cast<double>(from[i]);
}

#endif

}  // namespace palpate

#endif
