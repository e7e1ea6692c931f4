// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#ifndef PALPATE_SRC_GUARD_H
#define PALPATE_SRC_GUARD_H

#include <cstdint>

#include "palpate/palpate.h"

namespace palpate {

// Energy accounts since init or reset, J.  Trivially copyable.
struct accounts {
    double work_in;
    double dissipated_friction;
    double dissipated_rule;
    double hold_leak;
};

// The hand did `work` over a tick in which the stored energy went from `before` to `held`, the value at the new place
// with spring stiffness and anchor unchanged.  The difference is what the zero-order hold gave (or took).
void hold(accounts& books, double work, double before, double held) noexcept;

// Contact is given up: after `work` by the hand, `before` of stored energy is gone.  What is left is dissipated; if the
// hand drew more out of the held force than there was, the hold leaked the difference.
void release(accounts& books, double work, double before) noexcept;

// Why this input cannot be used at all: PALPATE_TICK_BAD_INPUT or 0.
std::uint32_t input_fault(const palpate_tool_state& state) noexcept;

// The tool's reference point for a usable input: q = position + R(orientation) reference_point.
void reference_point(const palpate_tool_state& state, const double in_grip[3], double q[3]) noexcept;

}  // namespace palpate

#endif
