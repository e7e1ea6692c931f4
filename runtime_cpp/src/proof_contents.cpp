// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// What the sections hold: indices into stored blocks, finite numbers, curves that start at zero and are continuous.
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "proof.h"

namespace palpate {
namespace {

// Jump of a curve between intervals, as a fraction of its largest value, slope or (friction) value; rounding of a fit.
constexpr double joint_tolerance = 1e-9;

}  // namespace

bool refuse(refusal& why, palpate_status status, const char* format, ...) noexcept {
    why.status = status;
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(why.sentence, sizeof why.sentence, format, arguments);
    va_end(arguments);
    return false;
}

bool check_index(const std::int32_t* index, std::uint64_t count, std::int32_t least, std::uint32_t stored, const char* name,
                 refusal& why) noexcept {
    for (std::uint64_t i = 0; i < count; ++i) {
        if (index[i] < least || index[i] >= static_cast<std::int64_t>(stored)) {
            return refuse(why, PALPATE_BAD_INDEX, "%s block %llu points at row %d of %u.", name, static_cast<unsigned long long>(i),
                          static_cast<int>(index[i]), static_cast<unsigned>(stored));
        }
    }
    return true;
}

bool check_amplitudes(const float* coefficients, std::uint64_t count, std::uint64_t row_size, refusal& why) noexcept {
    for (std::uint64_t i = 0; i < count; ++i) {
        const double x = static_cast<double>(coefficients[i]);
        if (!bounded(x, amplitude_limit)) {
            return refuse(why, PALPATE_NOT_FINITE, "Amplitude %llu is %g: at most %g is right.", static_cast<unsigned long long>(i),
                          x, amplitude_limit);
        }
        if (i < row_size && !(x == 0.0)) {
            return refuse(why, PALPATE_BAD_LAYOUT, "The zero block of the amplitudes is not zero.");
        }
    }
    return true;
}

bool check_curves(const double* rows, std::uint32_t intervals, std::uint32_t curves, double depth_end, int degree,
                  const char* name, refusal& why) noexcept {
    const double h = depth_end / static_cast<double>(intervals);
    for (std::uint64_t i = 0; i < 4ull * (intervals + 1ull) * curves; ++i) {
        const bool cubic = i % 4 == 3;
        if (!(bounded(rows[i], cubic ? curve_limit * 1e3 : curve_limit))) {
            return refuse(why, PALPATE_NOT_FINITE, "%s coefficient %llu is %g.", name, static_cast<unsigned long long>(i), rows[i]);
        }
    }
    for (std::uint32_t r = 0; r < curves; ++r) {
        double value_scale = 0.0, slope_scale = 0.0;
        for (int pass = 0; pass < 2; ++pass) {
            for (std::uint32_t m = 0; m < intervals; ++m) {
                const double* c = rows + 4ull * (static_cast<std::uint64_t>(m) * curves + r);
                const double* next = c + 4ull * curves;
                const double value = c[0] + h * (c[1] + h * (c[2] + h * c[3]));
                const double slope = c[1] + h * (2.0 * c[2] + 3.0 * h * c[3]);
                if (pass == 0) {
                    value_scale = std::fmax(value_scale, std::fmax(std::fabs(c[0]), std::fabs(value)));
                    slope_scale = std::fmax(slope_scale, std::fmax(std::fabs(c[1]), std::fabs(slope)));
                } else if (!(std::fabs(next[0] - value) <= joint_tolerance * value_scale) ||
                           (degree > 0 && !(std::fabs(next[1] - slope) <= joint_tolerance * slope_scale))) {
                    return refuse(why, PALPATE_BAD_CURVE, "%s curve %u jumps at knot %u.", name, static_cast<unsigned>(r),
                                  static_cast<unsigned>(m + 1));
                }
            }
        }
        const double* first = rows + 4ull * r;
        if (degree > 0 && !(first[0] == 0.0 && first[1] == 0.0)) {
            return refuse(why, PALPATE_BAD_CURVE, "%s curve %u does not start with value and slope zero.", name,
                          static_cast<unsigned>(r));
        }
        if (!(rows[4ull * (static_cast<std::uint64_t>(intervals) * curves + r) + 3] == 0.0)) {
            return refuse(why, PALPATE_BAD_CURVE, "%s curve %u does not continue as a quadratic.", name, static_cast<unsigned>(r));
        }
    }
    return true;
}

}  // namespace palpate
