// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// What keeps a tick honest: which inputs are usable, and where each joule went.
#include "guard.h"

namespace palpate {
namespace {

// m; no tool is further from its organ.  Keeps lattice coordinates far inside the range of an integer.
constexpr double position_limit = 1e3;

bool bounded(double x, double limit) noexcept { return x >= -limit && x <= limit; }  // false for NaN

}  // namespace

void hold(accounts& books, double work, double before, double held) noexcept {
    books.work_in += work;
    books.hold_leak += held - before - work;
}

void release(accounts& books, double work, double before) noexcept {
    books.work_in += work;
    const double left = before + work;
    if (left >= 0.0) {
        books.dissipated_rule += left;
    } else {
        books.hold_leak -= left;
    }
}

std::uint32_t input_fault(const palpate_tool_state& state) noexcept {
    bool usable = state.dt > 0.0 && bounded(state.dt, 1e9);
    for (double x : state.position) usable = usable && bounded(x, position_limit);
    if ((state.flags & PALPATE_INPUT_POSITION_ONLY) == 0) {
        double length_squared = 0.0;
        for (double x : state.orientation) length_squared += x * x;
        usable = usable && length_squared > 0.98 && length_squared < 1.02;
    }
    return usable ? 0u : PALPATE_TICK_BAD_INPUT;
}

void reference_point(const palpate_tool_state& state, const double in_grip[3], double q[3]) noexcept {
    for (int a = 0; a < 3; ++a) q[a] = state.position[a] + in_grip[a];
    const double* u = state.orientation;
    if ((state.flags & PALPATE_INPUT_POSITION_ONLY) != 0 || (in_grip[0] == 0.0 && in_grip[1] == 0.0 && in_grip[2] == 0.0)) {
        return;
    }
    // R v = v + 2 (w (u x v) + u x (u x v)) / |quaternion|^2
    const double twice = 2.0 / (u[0] * u[0] + u[1] * u[1] + u[2] * u[2] + u[3] * u[3]);
    const double c[3] = {u[1] * in_grip[2] - u[2] * in_grip[1], u[2] * in_grip[0] - u[0] * in_grip[2],
                         u[0] * in_grip[1] - u[1] * in_grip[0]};
    const double cc[3] = {u[1] * c[2] - u[2] * c[1], u[2] * c[0] - u[0] * c[2], u[0] * c[1] - u[1] * c[0]};
    for (int a = 0; a < 3; ++a) q[a] += twice * (u[3] * c[a] + cc[a]);
}

}  // namespace palpate
