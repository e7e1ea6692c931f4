// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Opening proves, once, every fact that a tick relies on, or refuses the file with one sentence: first the header
// (proof_header.cpp), then what the sections hold (proof_contents.cpp).
#ifndef PALPATE_SRC_PROOF_H
#define PALPATE_SRC_PROOF_H

#include <cstddef>
#include <cstdint>

#include "palpate/palpate.h"
#include "rfield_layout.h"

namespace palpate {

// Bounds that no physical field comes near; with them every product that a tick forms stays finite.
constexpr double length_limit = 1e3;           // m
constexpr double curve_limit = 1e12;           // J/m^j, N/m^j
constexpr double amplitude_limit = 1e6;        // dimensionless

struct refusal {
    palpate_status status;
    char sentence[200];
};

// Fills `why`; false.
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
bool refuse(refusal& why, palpate_status status, const char* format, ...) noexcept;

inline bool bounded(double x, double limit) noexcept { return x >= -limit && x <= limit; }  // false for NaN

// Size, magic, version, checksum; the header of whichever version as this version's in `h`.
bool check_identity(const unsigned char* data, std::size_t size, rfield_header& h, refusal& why) noexcept;
// Numbers and counts; how many elements each section has to have.
bool check_header(const rfield_header& h, std::uint64_t elements[rfield_section_count], refusal& why) noexcept;
// Sections lie in the file, in order and aligned.
bool check_sections(const rfield_header& h, const std::uint64_t elements[rfield_section_count], refusal& why) noexcept;

// Rows from `least` to stored - 1.
bool check_index(const std::int32_t* index, std::uint64_t count, std::int32_t least, std::uint32_t stored, const char* name,
                 refusal& why) noexcept;
// Finite amplitudes, the first `row_size` of them zero.
bool check_amplitudes(const float* coefficients, std::uint64_t count, std::uint64_t row_size, refusal& why) noexcept;
// Rows of cubics with `degree` continuous derivatives at every joint, the last row a quadratic; an energy curve
// (degree 1) starts with value and slope zero, so that force starts at zero.
bool check_curves(const double* rows, std::uint32_t intervals, std::uint32_t curves, double depth_end, int degree,
                  const char* name, refusal& why) noexcept;

}  // namespace palpate

#endif
