# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Isochoric energies of the invariants I1bar = J^(-2/3) I1 and I2bar = J^(-4/3) I2, as Warp functions.

With a = I1bar - 3, b = I2bar - 3:

    polynomial         psi = c10 a + c01 b + c20 a^2 + c30 a^3
                       (neo-Hookean c10 = mu/2; Mooney 1940, Rivlin 1948: c10, c01; Yeoh 1993: c10, c20, c30)
    Veronda-Westmann   psi = c1 (exp(c2 a) - 1) - c1 c2 / 2 b
                       (Veronda and Westmann, J. Biomech. 3:111-124, 1970)

All are f(a) + c b: a model gives psi, d1 = f', d2 = c and d11 = f''; stress and tangent are the same code for all.
In the variables (I1, I2, t = ln J), whose gradients are

    g1 = dI1/dF = 2 F,   g2 = dI2/dF = 2 (I1 F - F C),   g3 = dt/dF = F^-T,   C = F^T F

the stress is P = sum_p W_p g_p and the tangent A = d^2 psi / dF^2 = sum_pq W_pq g_p (x) g_q + sum_p W_p dg_p/dF, with
s = J^(-2/3):

    W_1 = d1 s,   W_2 = d2 s^2,   W_t = -2/3 (d1 I1bar + 2 d2 I2bar)
    W_11 = d11 s^2,   W_12 = W_22 = 0,   W_1t = -2/3 s (d1 + d11 I1bar),   W_2t = -4/3 s^2 d2
    W_tt = 4/9 (d1 I1bar + d11 I1bar^2 + 4 d2 I2bar)

(derived here; compare Holzapfel, Nonlinear Solid Mechanics, 2000, sections 6.4 and 6.6.)
"""

from __future__ import annotations

import warp as wp

from palpate.fem_offline import material_table as t
from palpate.fem_offline.near_one import expm1, jacobian_less_one
from palpate.fem_offline.tensor4 import inverse_transpose, mat9x9

__all__ = ["invariant_isochoric", "invariant_isochoric_tangent"]

# A quotient of literals inside a Warp function would be taken in float32.
TWO_THIRDS = wp.constant(wp.float64(2.0 / 3.0))
FOUR_NINTHS = wp.constant(wp.float64(4.0 / 9.0))


@wp.func
def distortion(F: wp.mat33d) -> wp.vec3d:
    """(I1bar - 3, I2bar - 3, J^(-2/3)), the first two without cancellation near rest.

    With G = C - 1 and q = J^(1/3):  I1 - 3 = tr G,  I2 - 3 = 2 tr G + (tr^2 G - G:G)/2,  q - 1 = (J - 1)/(1 + q + q^2).
    """
    one = wp.float64(1.0)
    D = F - wp.identity(n=3, dtype=wp.float64)
    G = D + wp.transpose(D) + wp.transpose(D) * D
    i1 = wp.trace(G)
    i2 = wp.float64(0.5) * (i1 * i1 - wp.ddot(G, G))
    j = jacobian_less_one(F)
    q = wp.cbrt(one + j)
    q2 = q * q
    q2_less_one = j / (one + q + q2) * (q + one)
    a = (i1 - wp.float64(3.0) * q2_less_one) / q2
    b = (wp.float64(2.0) * i1 + i2 - wp.float64(3.0) * q2_less_one * (q2 + one)) / (q2 * q2)
    return wp.vec3d(a, b, one / q2)


@wp.func
def derivatives(table: wp.array2d(dtype=wp.float64), m: int, a: wp.float64, b: wp.float64) -> wp.vec4d:
    """(psi, d1, d2, d11) of material m, Pa."""
    two = wp.float64(2.0)
    three = wp.float64(3.0)
    if int(table[m, t.MODEL]) == t.VERONDA_WESTMANN:
        c1 = table[m, t.CONSTANTS]
        c2 = table[m, t.CONSTANTS + 1]
        slope = c1 * c2 * wp.exp(c2 * a)
        psi = c1 * expm1(c2 * a) - c1 * c2 * b / two
        return wp.vec4d(psi, slope, -c1 * c2 / two, c2 * slope)
    c10 = table[m, t.CONSTANTS]
    c01 = table[m, t.CONSTANTS + 1]
    c20 = table[m, t.CONSTANTS + 2]
    c30 = table[m, t.CONSTANTS + 3]
    psi = (c10 + (c20 + c30 * a) * a) * a + c01 * b
    return wp.vec4d(psi, c10 + (two * c20 + three * c30 * a) * a, c01, two * c20 + two * three * c30 * a)


@wp.func
def invariant_isochoric(F: wp.mat33d, table: wp.array2d(dtype=wp.float64), m: int):
    """psi and P = 2 W_1 F + 2 W_2 (I1 F - F C) + W_t F^-T, Pa."""
    two = wp.float64(2.0)
    three = wp.float64(3.0)
    x = distortion(F)
    d = derivatives(table, m, x[0], x[1])
    s = x[2]
    Wt = -TWO_THIRDS * (d[1] * (x[0] + three) + two * d[2] * (x[1] + three))
    P = F * (two * s * d[1]) + inverse_transpose(F) * Wt
    if d[2] != wp.float64(0.0):
        P += (F * wp.ddot(F, F) - F * wp.transpose(F) * F) * (two * s * s * d[2])
    return d[0], P


@wp.func
def invariant_isochoric_tangent(F: wp.mat33d, table: wp.array2d(dtype=wp.float64), m: int) -> mat9x9:
    """A[3 i + k, 3 j + l] = d P_ik / d F_jl, Pa.

    A = sum_pq W_pq g_p (x) g_q + 2 W_1 d_ij d_kl - W_t F^-T_il F^-T_jk
        + 2 W_2 (2 F_ik F_jl + I1 d_ij d_kl - d_ij C_kl - F_il F_jk - B_ij d_kl),   B = F F^T
    """
    two = wp.float64(2.0)
    three = wp.float64(3.0)
    x = distortion(F)
    d = derivatives(table, m, x[0], x[1])
    s = x[2]
    I1b = x[0] + three
    I2b = x[1] + three
    W1 = d[1] * s
    Wt = -TWO_THIRDS * (d[1] * I1b + two * d[2] * I2b)
    W1t = -TWO_THIRDS * s * (d[1] + d[3] * I1b)
    Wtt = FOUR_NINTHS * ((d[1] + d[3] * I1b) * I1b + two * two * d[2] * I2b)
    g1 = F * two
    g3 = inverse_transpose(F)
    h1 = g1 * (d[3] * s * s) + g3 * W1t
    h3 = g1 * W1t + g3 * Wtt
    A = mat9x9()
    for i in range(3):
        for k in range(3):
            for j in range(3):
                for l in range(3):
                    A[3 * i + k, 3 * j + l] = (
                        g1[i, k] * h1[j, l] + g3[i, k] * h3[j, l] - Wt * g3[i, l] * g3[j, k]
                    )
            A[3 * i + k, 3 * i + k] = A[3 * i + k, 3 * i + k] + two * W1
    if d[2] == wp.float64(0.0):
        return A
    W2 = two * d[2] * s * s
    W2t = -TWO_THIRDS * W2
    I1 = wp.ddot(F, F)
    B = F * wp.transpose(F)
    C = wp.transpose(F) * F
    g2 = (F * I1 - F * C) * two
    for i in range(3):
        for k in range(3):
            for j in range(3):
                for l in range(3):
                    A[3 * i + k, 3 * j + l] = (
                        A[3 * i + k, 3 * j + l]
                        + W2t * (g2[i, k] * g3[j, l] + g3[i, k] * g2[j, l])
                        + W2 * (two * F[i, k] * F[j, l] - F[i, l] * F[j, k])
                    )
            for n in range(3):
                A[3 * i + k, 3 * i + n] = A[3 * i + k, 3 * i + n] - W2 * C[k, n]
                A[3 * i + k, 3 * n + k] = A[3 * i + k, 3 * n + k] - W2 * B[i, n]
            A[3 * i + k, 3 * i + k] = A[3 * i + k, 3 * i + k] + W2 * I1
    return A
