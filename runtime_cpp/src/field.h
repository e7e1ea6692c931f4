// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// The opened field: pointers into one buffer whose contents open.cpp has proven, so that a tick checks nothing.
#ifndef PALPATE_SRC_FIELD_H
#define PALPATE_SRC_FIELD_H

#include <cstddef>
#include <cstdint>

#include "contract.h"
#include "rfield_layout.h"

namespace palpate {

// A sparse lattice of 4 x 4 x 4 blocks (fields/lattice.py).  Cells 0 .. cells - 3 along each axis have whole stencils.
struct lattice {
    double origin[3];        // m
    double spacing;          // m
    double inverse_spacing;  // 1/m
    double last[3];          // 4 blocks - 2: cell coordinates below it have their stencil in the box
    std::int32_t blocks[3];
    const std::int32_t* index;  // (blocks) row of the coefficients
};

// Depth curves (fields/response_field.py, DepthCurves), a row for each interval and a last one beyond depth_end, each in the order
// of curve_row.  The file has a curve's four coefficients together; opening turns them around.
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

// The public name palpate_field; everything in it is constant after opening.
struct palpate_field {
    palpate::lattice geometry;
    const std::int16_t* geometry_coefficients;
    double geometry_scale;  // m a count
    double geometry_bias;   // m

    palpate::lattice amplitudes;
    const float* amplitude_coefficients;
    std::int32_t channel_stride;  // floats from one coefficient to the next
    std::int32_t way_stride;      // floats from one way of touching to the next
    std::int32_t way_count;       // their cosines and offsets are in the header
    std::int32_t channels;           // in use, rounded up to a multiple of 4
    std::int32_t gradient_channels;  // the first ones, which hold the energy's and need gradients; likewise
    const palpate::contraction* contract;  // for this processor

    palpate::depth_curves energy;
    palpate::depth_curves stiffness;
    palpate::depth_curves friction;

    double tool_offset;  // m; the largest of the ways
    double depth_max;    // m

    palpate::rfield_header header;  // as this version would have written it
    const char* provenance;
    std::uint64_t provenance_size;
    void* owned;   // the file's bytes, to free; or null when used in place
    double* curves;  // the rows of the three kinds of curves, to free
};

#endif
