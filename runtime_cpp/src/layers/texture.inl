// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// The waves of a texture, four to a group, a wave to each lane.  Included after contract.inl.
#include "layers/texture.h"

namespace palpate {
namespace PALPATE_ISA {

void texture_groups(const texture_ground& ground, const double* amplitude, double px, double py, double pz,
                    double height_and_gradient[texture_group_limit][4]) PALPATE_REAL_TIME {
    const auto of = [](double value) { return all(value); };  // no pointer to a function: inlined, and known to return at once
    const quad x = all(px), y = all(py), z = all(pz);
    PALPATE_NO_UNROLL
    for (std::int32_t group = 0; group < ground.group_count; ++group) {
        const std::int32_t i = 4 * group;
        const quad kx = load(ground.kx + i), ky = load(ground.ky + i), kz = load(ground.kz + i);
        const quad cycles = ((kx * x + ky * y) + kz * z) + load(ground.phase + i);
        quad value = all(0.0), slope = all(0.0);
        cosine_of_cycles(cycles - nearest(cycles, of), of, value, slope);
        const quad a = load(amplitude + i), rise = a * slope;
        store(height_and_gradient[group], sums_of_four(a * value, rise * kx, rise * ky, rise * kz));
    }
}

}  // namespace PALPATE_ISA
}  // namespace palpate
