// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// OpenHaptics (HDAPI): millimetres, newtons, millinewton metres, right-handed, x right, y up, z towards the user.  Palpate's z (up)
// is the device's y, its y points away from the user.  HD_CURRENT_TRANSFORM is a 4x4 matrix, column by column.
//
//     hdGetDoublev(HD_CURRENT_TRANSFORM, m);  palpate::openhaptics_transform(m, state);
//     palpate_tick(session, &state, &response);
//     palpate::openhaptics.force_out(response.force, f);  hdSetDoublev(HD_CURRENT_FORCE, f);
#ifndef PALPATE_ADAPTERS_OPENHAPTICS_HPP
#define PALPATE_ADAPTERS_OPENHAPTICS_HPP

#include <cmath>

#include "axes.hpp"

namespace palpate {

constexpr host_axes openhaptics{{0, 2, 1}, {1.0, 1.0, -1.0}, 1e3, 1.0, 1e3};

// Quaternion (x y z w, w >= 0 or the largest part) of the rotation in a transform stored column by column; by the largest of
// the four parts, so that none is divided by a small number.
inline void rotation_of_transform(const double m[16], double q[4]) noexcept {
    const double xx = m[0], yy = m[5], zz = m[10], trace = xx + yy + zz;
    int largest = 3;  // whose square, (1 + ...) / 4, is largest
    double most = trace;
    for (int a = 0; a < 3; ++a) {
        if (m[5 * a] > most) most = m[5 * a], largest = a;
    }
    if (largest == 3) {
        const double s = 2.0 * std::sqrt(1.0 + trace);
        q[0] = (m[6] - m[9]) / s;
        q[1] = (m[8] - m[2]) / s;
        q[2] = (m[1] - m[4]) / s;
        q[3] = 0.25 * s;
        return;
    }
    const int i = largest, j = (i + 1) % 3, k = (i + 2) % 3;
    const double s = 2.0 * std::sqrt(1.0 + m[5 * i] - m[5 * j] - m[5 * k]);
    q[i] = 0.25 * s;
    q[j] = (m[4 * i + j] + m[4 * j + i]) / s;
    q[k] = (m[4 * i + k] + m[4 * k + i]) / s;
    q[3] = (m[4 * j + k] - m[4 * k + j]) / s;
}

// Position and orientation of `state` from HD_CURRENT_TRANSFORM.
inline void openhaptics_transform(const double m[16], palpate_tool_state& state) noexcept {
    double q[4];
    rotation_of_transform(m, q);
    openhaptics.pose_in(m + 12, q, state);
}

}  // namespace palpate

#endif
