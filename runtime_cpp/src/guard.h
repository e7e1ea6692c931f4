// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// What keeps a tick honest: which inputs are usable, and where each joule went.
#ifndef PALPATE_SRC_GUARD_H
#define PALPATE_SRC_GUARD_H

#include <cmath>
#include <cstdint>

#include "palpate/palpate.h"
#include "rotation.h"

namespace palpate {

// Energy accounts since init or reset, J.  Trivially copyable.
struct accounts {
    double work_in;
    double dissipated_friction;
    double dissipated_rule;
    double hold_leak;
    double organ_work;
    double injected;
};

// The hand did `work` over a tick in which the stored energy went from `before` to `held`, the value at the new place
// with spring stiffness and anchor unchanged.  The difference is what the zero-order hold gave (or took).
inline void hold(accounts& books, double work, double before, double held) noexcept {
    books.work_in += work;
    books.hold_leak += held - before - work;
}

// Contact is given up: after `work` by the hand, `before` of stored energy is gone.  What is left is dissipated; if the
// hand drew more out of the held force than there was, the hold leaked the difference.
inline void release(accounts& books, double work, double before) noexcept {
    books.work_in += work;
    const double left = before + work;
    if (left >= 0.0) {
        books.dissipated_rule += left;
    } else {
        books.hold_leak -= left;
    }
}

// m; no tool is further from its organ.  Keeps lattice coordinates far inside the range of an integer.
constexpr double position_limit = 1e3;

inline bool within(double x, double limit) noexcept { return std::fabs(x) <= limit; }  // false for NaN

// Why this input cannot be used at all: PALPATE_TICK_BAD_INPUT or 0.
inline std::uint32_t input_fault(const palpate_tool_state& state) noexcept {
    const auto unit = [](const double q[4]) {
        const double length_squared = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
        return length_squared > 0.98 && length_squared < 1.02;
    };
    bool usable = state.dt > 0.0 && state.dt <= 1e9;
    for (double x : state.position) usable = usable && within(x, position_limit);
    if ((state.flags & PALPATE_INPUT_POSITION_ONLY) == 0) usable = usable && unit(state.orientation);
    if ((state.flags & PALPATE_INPUT_ORGAN_POSE) != 0) {
        for (double x : state.organ_position) usable = usable && within(x, position_limit);
        usable = usable && unit(state.organ_orientation);
    }
    return usable ? 0u : PALPATE_TICK_BAD_INPUT;
}

// v in the tool's axes, in those of the position's, for a usable input.
inline void turn_with_tool(const palpate_tool_state& state, const double v[3], double turned[3]) noexcept {
    const double* u = state.orientation;
    if ((state.flags & PALPATE_INPUT_POSITION_ONLY) != 0) {
        for (int a = 0; a < 3; ++a) turned[a] = v[a];
    } else {
        rotate_scaled(u, 2.0 / (u[0] * u[0] + u[1] * u[1] + u[2] * u[2] + u[3] * u[3]), v, turned);
    }
}

// The tool's reference point for a usable input: q = position + R(orientation) reference_point.
inline void reference_point(const palpate_tool_state& state, const double in_grip[3], double q[3]) noexcept {
    for (int a = 0; a < 3; ++a) q[a] = state.position[a];
    if (in_grip[0] == 0.0 && in_grip[1] == 0.0 && in_grip[2] == 0.0) return;
    double arm[3];
    turn_with_tool(state, in_grip, arm);
    for (int a = 0; a < 3; ++a) q[a] += arm[a];
}

}  // namespace palpate

#endif
