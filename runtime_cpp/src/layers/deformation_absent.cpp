// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// A library built without the effect `deformation` (PALPATE_LAYER_DEFORMATION=OFF) opens no file that has it.
#include "palpate/palpate.h"

extern "C" {

palpate_status palpate_deformation_describe(const palpate_field*, palpate_deformation_info*) noexcept { return PALPATE_LAYER_MISSING; }

palpate_status palpate_deformation(const palpate_field*, const palpate_deformation_input*, const float*, const uint32_t*, size_t,
                                   float*, palpate_deformation_result*) noexcept {
    return PALPATE_LAYER_MISSING;
}

}  // extern "C"
