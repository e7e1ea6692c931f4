// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// contract.inl for every processor of the architecture; and the choice, made once when a field is opened.
#define PALPATE_ISA baseline
#include "contract.inl"
#include "layers/texture.inl"

namespace palpate {

const contraction contraction_baseline = {
    baseline::distance, baseline::go_to, baseline::respond, baseline::gather_amplitudes, baseline::amplitudes,
    baseline::response_from, baseline::texture, baseline::texture_in_turn,
    baseline::energy_from, baseline::fetch_cells};

const contraction& contraction_here() noexcept {
#if defined(PALPATE_HAS_AVX2)
    if (__builtin_cpu_supports("avx2")) return contraction_avx2;
#endif
    return contraction_baseline;
}

}  // namespace palpate
