// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "layers/layers.h"

#include "layers/texture.h"
#include "layers/transient.h"
#ifdef PALPATE_LAYER_DEFORMATION
#include "layers/deformation.h"
#endif

namespace palpate {
namespace {

struct known_layer {
    const char* name;
    layer_proof prove;  // null where the library was built without the layer's code
};

constexpr known_layer known_layers[layer_count] = {
#ifdef PALPATE_HAS_TEXTURE
    {"texture", prove_texture},
#else
    {"texture", nullptr},
#endif
#ifdef PALPATE_HAS_TRANSIENT
    {"transient", prove_transient},
#else
    {"transient", nullptr},
#endif
#ifdef PALPATE_LAYER_DEFORMATION
    {"deformation", prove_deformation},
#else
    {"deformation", nullptr},
#endif
    {"rigid", nullptr},
};

}  // namespace

bool open_layers(const unsigned char* data, const rfield_header& h, layer_bytes layers[layer_count], refusal& why) noexcept {
    const std::uint32_t last = section_provenance;
    std::uint64_t end = h.section_offset[last] + h.section_elements[last] * rfield_element_size[last];  // proven before
    for (std::uint32_t i = 0; i < rfield_layer_limit; ++i) {
        const std::uint64_t offset = h.layer_offset[i], size = h.layer_size[i];
        if (i < layer_count) layers[i] = {nullptr, 0};
        if (offset == 0 && size == 0) continue;
        if (size == 0 || offset % rfield_section_alignment != 0 || offset < end || offset > h.file_size || size > h.file_size - offset) {
            return refuse(why, PALPATE_BAD_LAYOUT, "Layer %u (%llu bytes at byte %llu) does not lie behind the sections in the file.",
                          static_cast<unsigned>(i), static_cast<unsigned long long>(size), static_cast<unsigned long long>(offset));
        }
        end = offset + size;
        if (i >= layer_count) {
            return refuse(why, PALPATE_LAYER_MISSING, "The file has layer %u, which this runtime does not know.", static_cast<unsigned>(i));
        }
        if (known_layers[i].prove == nullptr) {
            return refuse(why, PALPATE_LAYER_MISSING, "The file has the effect %s, and this runtime was built without it.",
                          known_layers[i].name);
        }
        layers[i] = {data + offset, size};
        if (!known_layers[i].prove(layers[i], h, why)) return false;
    }
    return true;
}

}  // namespace palpate
