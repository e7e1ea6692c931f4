// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#ifndef PALPATE_SRC_DEPTH_CURVES_H
#define PALPATE_SRC_DEPTH_CURVES_H

#include <cstdint>

namespace palpate {

// Depth curves (fields/response_field.py, DepthCurves), a row for each interval and a last one beyond depth_end, each in the order
// that sums read: c0 of every curve, then c1, c2, c3, each padded with zeros to a multiple of 4.  The file has a curve's four coefficients
// together; opening turns them around.
struct depth_curves {
    double depth_end;         // m
    double step;              // m
    double inverse_step;      // 1/m
    double interval_count;    // as a double, for the comparison that bounds the row
    std::int32_t last_row;    // interval_count
    std::int32_t curve_count;
    std::int64_t padded;  // curve_count, up to a multiple of 4
    const double* rows;   // (last_row + 1) x 4 x padded
};

}  // namespace palpate

#endif
