// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Unity: metres, newtons, left-handed, x right, y up, z forward.  Palpate's z (up) is Unity's y, its y Unity's z.
#ifndef PALPATE_ADAPTERS_UNITY_HPP
#define PALPATE_ADAPTERS_UNITY_HPP

#include "axes.hpp"

namespace palpate {

constexpr host_axes unity{{0, 2, 1}, {1.0, 1.0, 1.0}, 1.0, 1.0, 1.0};

}  // namespace palpate

#endif
