// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Unreal Engine: centimetres, kg cm/s^2 (1 N is 100 of them, 1 N m is 10,000 kg cm^2/s^2), left-handed, x forward, y right, z up.
// Palpate's y points left.
#ifndef PALPATE_ADAPTERS_UNREAL_HPP
#define PALPATE_ADAPTERS_UNREAL_HPP

#include "axes.hpp"

namespace palpate {

constexpr host_axes unreal{{0, 1, 2}, {1.0, -1.0, 1.0}, 1e2, 1e2, 1e4};

}  // namespace palpate

#endif
