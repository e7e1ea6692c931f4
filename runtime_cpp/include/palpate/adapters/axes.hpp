// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// A host's units and axes against palpate's (SI, right-handed; organs with z up).  Host axis i is sign[i] times palpate's axis[i]:
// x_host = length M x with a signed permutation M.  A rotation becomes M R M^T, so its quaternion's vector part, like a torque, is an
// axial vector and takes det M too: mirrored hosts (Unity, Unreal) turn the other way round.
// The constants of each host are in the file of its name.  Header-only; nothing but the standard library.
#ifndef PALPATE_ADAPTERS_AXES_HPP
#define PALPATE_ADAPTERS_AXES_HPP

#include "../palpate.h"

namespace palpate {

struct host_axes {
    int axis[3];     // a permutation of 0 1 2
    double sign[3];  // 1 or -1
    double length;   // host's units in a metre
    double force;    // in a newton
    double torque;   // in a newton metre

    // det M
    constexpr double handedness() const noexcept {
        return ((axis[0] + 1) % 3 == axis[1] ? 1.0 : -1.0) * sign[0] * sign[1] * sign[2];  // an even permutation turns in a ring
    }

    // From the host.
    void position_in(const double host[3], double position[3]) const noexcept { in(host, 1.0 / length, position); }
    void orientation_in(const double host[4], double orientation[4]) const noexcept {  // x y z w
        in(host, handedness(), orientation);
        orientation[3] = host[3];
    }
    void pose_in(const double host_position[3], const double host_orientation[4], palpate_tool_state& state) const noexcept {
        position_in(host_position, state.position);
        orientation_in(host_orientation, state.orientation);
    }

    // To the host.
    void position_out(const double position[3], double host[3]) const noexcept { out(position, length, host); }
    void direction_out(const double direction[3], double host[3]) const noexcept { out(direction, 1.0, host); }
    void force_out(const double newton[3], double host[3]) const noexcept { out(newton, force, host); }
    void torque_out(const double newton_metre[3], double host[3]) const noexcept { out(newton_metre, handedness() * torque, host); }
    void orientation_out(const double orientation[4], double host[4]) const noexcept {
        out(orientation, handedness(), host);
        host[3] = orientation[3];
    }

  private:
    void in(const double host[3], double scale, double v[3]) const noexcept {
        for (int i = 0; i < 3; ++i) v[axis[i]] = scale * sign[i] * host[i];
    }
    void out(const double v[3], double scale, double host[3]) const noexcept {
        for (int i = 0; i < 3; ++i) host[i] = scale * sign[i] * v[axis[i]];
    }
};

}  // namespace palpate

#endif
