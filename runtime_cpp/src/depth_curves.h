// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#ifndef PALPATE_SRC_DEPTH_CURVES_H
#define PALPATE_SRC_DEPTH_CURVES_H

#include <cstdint>

#include "rfield_layout.h"

namespace palpate {

// Uniform intervals of depth, a row of coefficients for each and a last one beyond depth_end.
struct curve_set {
    double depth_end;       // m
    double step;            // m
    double inverse_step;    // 1/m
    double interval_count;  // as a double, for the comparison that bounds the row
    std::int32_t last_row;  // interval_count
    const double* rows;     // (last_row + 1) x 4 x padded
};

// The depth curves of a field (fields/response_field.py, DepthCurves) as a tick reads them: one for each channel of the amplitudes.  A row
// holds c0 of every channel, then c1, c2, c3, padded with zeros to a multiple of 4 channels.  Kinds of curves whose knots fit those of the
// finest kind share a set, so that there is one row to look up; else each kind has a set, in which the other kinds' curves are zero.
struct depth_curves {
    curve_set sets[3];
    std::int32_t set_count;
    std::int32_t padded;  // channels, up to a multiple of 4
    // By channel: 1 for those of the kind, else 0.
    double of_energy[rfield_channel_limit], of_stiffness[rfield_channel_limit], of_friction[rfield_channel_limit];
};

// One kind of curves as the file has it: (intervals + 1) x count x 4.
struct stored_curves {
    double depth_end;  // m
    std::uint32_t intervals, count;
    const double* rows;
};

// How many doubles the rows of all sets take.
std::uint64_t curve_numbers(const stored_curves kinds[3]) noexcept;

// Energy, stiffness, friction: `rows` has room for curve_numbers.
void set_curves(depth_curves& curves, const stored_curves kinds[3], double* rows) noexcept;

}  // namespace palpate

#endif
