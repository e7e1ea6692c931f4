// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Unit quaternions u = (x, y, z, w):  R v = v + 2 (w (u x v) + u x (u x v)).
#ifndef PALPATE_SRC_ROTATION_H
#define PALPATE_SRC_ROTATION_H

namespace palpate {

inline void cross(const double a[3], const double b[3], double c[3]) noexcept {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

// R v with 2 / |u|^2 given, so that u need not be normalised.
inline void rotate_scaled(const double u[4], double twice, const double v[3], double rotated[3]) noexcept {
    double c[3], cc[3];
    cross(u, v, c);
    cross(u, c, cc);
    for (int a = 0; a < 3; ++a) rotated[a] = v[a] + twice * (u[3] * c[a] + cc[a]);
}

inline void rotate(const double u[4], const double v[3], double rotated[3]) noexcept { rotate_scaled(u, 2.0, v, rotated); }

inline void conjugate(const double u[4], double back[4]) noexcept {
    for (int a = 0; a < 3; ++a) back[a] = -u[a];
    back[3] = u[3];
}

// First b, then a.
inline void multiply(const double a[4], const double b[4], double ab[4]) noexcept {
    double c[3];
    cross(a, b, c);
    for (int i = 0; i < 3; ++i) ab[i] = a[3] * b[i] + b[3] * a[i] + c[i];
    ab[3] = a[3] * b[3] - (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
}

}  // namespace palpate

#endif
