// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// contract.inl compiled with -mavx2 (and without fused operations); run only where the processor has it.
#define PALPATE_ISA avx2
#include "contract.inl"
#include "layers/texture.inl"

namespace palpate {

const contraction contraction_avx2 = {
    avx2::distance, avx2::go_to, avx2::respond, avx2::gather_amplitudes, avx2::amplitudes,
    avx2::response_from, avx2::texture, avx2::texture_in_turn,
    avx2::energy_from, avx2::fetch_cells};

}  // namespace palpate
