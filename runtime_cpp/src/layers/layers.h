// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// The effects beyond response and friction that a file carries: a block of bytes each, with a layout and a proof of its own.
#ifndef PALPATE_SRC_LAYERS_LAYERS_H
#define PALPATE_SRC_LAYERS_LAYERS_H

#include <cstdint>

#include "proof.h"
#include "rfield_layout.h"

namespace palpate {

struct layer_bytes {
    const unsigned char* begin;  // aligned to 64 bytes; null where the file has no such layer
    std::uint64_t size;          // byte
};

// Proves all that the layer's code relies on, or fills `why`.
using layer_proof = bool (*)(const layer_bytes& bytes, const rfield_header& h, refusal& why) noexcept;

// Points `layers` into the file and proves each one: its bytes lie behind the sections, aligned, in order, and this library has its code.
bool open_layers(const unsigned char* data, const rfield_header& h, layer_bytes layers[layer_count], refusal& why) noexcept;

}  // namespace palpate

#endif
