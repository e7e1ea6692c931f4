// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// The opened field: pointers into one buffer whose contents open.cpp has proven, so that a tick checks nothing.
#ifndef PALPATE_SRC_FIELD_H
#define PALPATE_SRC_FIELD_H

#include <cstddef>
#include <cstdint>

#include "contract.h"
#include "depth_curves.h"
#include "lattice.h"
#include "layers/layers.h"
#include "layers/texture.h"
#include "rfield_layout.h"

// The public name palpate_field; everything in it is constant after opening.
struct palpate_field {
    palpate::lattice geometry;
    const std::int16_t* geometry_coefficients;
    double geometry_scale;  // m a count
    double geometry_bias;   // m

    palpate::lattice amplitudes;
    const float* amplitude_coefficients;
    std::int32_t way_stride;      // floats from one way of touching to the next
    std::int32_t way_count;       // their cosines and offsets are in the header
    std::int32_t channels;           // in use, rounded up to a multiple of 4
    std::int32_t gradient_channels;  // the first ones, which hold the energy's and need gradients; likewise
    const palpate::contraction* contract;  // for this processor

    palpate::depth_curves curves;

    // (depth, grad phi) = distance_scale * (sums of the distance) + distance_shift; (U, grad U at fixed depth) = response_scale * (sums)
    double distance_scale[4], distance_shift[4], response_scale[4];

    double tool_offset;  // m; the largest of the ways
    double depth_max;    // m

    palpate::layer_bytes layer[palpate::layer_count];  // by rfield_layer

    palpate::texture_ground texture;

    palpate::rfield_header header;  // as this version would have written it
    const char* provenance;
    std::uint64_t provenance_size;
    void* owned;   // the file's bytes, to free; or null when used in place
    double* curve_rows;  // to free
};

#endif
