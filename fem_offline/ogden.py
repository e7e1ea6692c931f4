# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Ogden's energy of isochoric principal stretches, as Warp functions.

    psi = sum_p 2 mu_p / alpha_p^2 (l1^alpha_p + l2^alpha_p + l3^alpha_p - 3),   initial shear modulus sum_p mu_p

(Ogden, Proc. R. Soc. Lond. A 326:565-584, 1972; this normalisation is Abaqus'.)  With C = V diag(c) V^T,
x_a = ln(c_a)/2 the logarithmic stretches and y_a = x_a - (x_1 + x_2 + x_3)/3 their isochoric part, l_a = exp(y_a):

    tau_a = d psi / d x_a = sum_p 2 mu_p/alpha_p (e_a - sum_b e_b / 3),   e_a = exp(alpha_p y_a)
    psi_ab = d tau_a / d x_b = sum_p 2 mu_p (e_a d_ab - (e_a + e_b)/3 + sum_c e_c / 9)
    S = V diag(tau_a / c_a) V^T,   P = F S
    dS_aa = sum_b (psi_ab - 2 tau_a d_ab) / (c_a c_b) H_bb,   dS_ab = (s_b - s_a)/(c_b - c_a) (H_ab + H_ba)

in the principal frame, H = V^T F^T dF V, s_a = tau_a / c_a (Bonet and Wood, 2008, section 6.6; Holzapfel, 2000,
section 6.6).  The last quotient is 0/0 for equal stretches; it is evaluated as

    (s_b - s_a)/(c_b - c_a) = [ (tau_b - tau_a)/(c_b - c_a) c_a - tau_a ] / (c_a c_b)
    (e_b - e_a)/(c_b - c_a) = exp(alpha (y_a + y_b)/2 - x_a - x_b) sinh(alpha d/2) / sinh(d),   d = x_b - x_a

in which no difference of nearly equal numbers is left.  C - 1 rather than C is diagonalised, so that small strains
keep their digits.
"""

from __future__ import annotations

import warp as wp

from palpate.fem_offline import material_table as t
from palpate.fem_offline.near_one import expm1, log1p
from palpate.fem_offline.principal_frame import principal_frame
from palpate.fem_offline.tensor4 import mat9x9

__all__ = ["ogden_isochoric", "ogden_isochoric_tangent"]

THIRD = wp.constant(wp.float64(1.0 / 3.0))
NINTH = wp.constant(wp.float64(1.0 / 9.0))

EQUAL = wp.constant(wp.float64(1e-9))
"""Difference of logarithmic stretches below which sinh(alpha d/2)/sinh(d) is alpha/2, to d^2."""


@wp.struct
class Stretches:
    """Of one F.  log: x.  isochoric: y.  squared: c = exp(2 x).  axes: V.  pushed: F V."""

    log: wp.vec3d
    isochoric: wp.vec3d
    squared: wp.vec3d
    axes: wp.mat33d
    pushed: wp.mat33d


@wp.func
def stretches(F: wp.mat33d) -> Stretches:
    D = F - wp.identity(n=3, dtype=wp.float64)
    frame = principal_frame(D + wp.transpose(D) + wp.transpose(D) * D)
    out = Stretches()
    x = wp.vec3d()
    c = wp.vec3d()
    for a in range(3):
        x[a] = wp.float64(0.5) * log1p(frame.values[a])
        c[a] = wp.float64(1.0) + frame.values[a]
    mean = (x[0] + x[1] + x[2]) * THIRD
    out.log = x
    out.isochoric = x - wp.vec3d(mean, mean, mean)
    out.squared = c
    out.axes = frame.axes
    out.pushed = F * frame.axes
    return out


@wp.func
def powers_less_one(alpha: wp.float64, y: wp.vec3d) -> wp.vec3d:
    """e_a - 1."""
    return wp.vec3d(expm1(alpha * y[0]), expm1(alpha * y[1]), expm1(alpha * y[2]))


@wp.func
def principal_stress(y: wp.vec3d, table: wp.array2d(dtype=wp.float64), m: int):
    """psi and tau_a, Pa."""
    two = wp.float64(2.0)
    psi = wp.float64(0.0)
    tau = wp.vec3d()
    for p in range(int(table[m, t.TERM_COUNT])):
        alpha = table[m, t.CONSTANTS + 2 * p + 1]
        scale = two * table[m, t.CONSTANTS + 2 * p] / alpha
        e = powers_less_one(alpha, y)
        total = e[0] + e[1] + e[2]
        psi += scale / alpha * total
        tau += (e - wp.vec3d(total, total, total) * THIRD) * scale
    return psi, tau


@wp.func
def ogden_isochoric(F: wp.mat33d, table: wp.array2d(dtype=wp.float64), m: int):
    """psi and P = F V diag(tau_a / c_a) V^T, Pa."""
    s = stretches(F)
    psi, tau = principal_stress(s.isochoric, table, m)
    return psi, s.pushed * wp.diag(wp.cw_div(tau, s.squared)) * wp.transpose(s.axes)


@wp.func
def divided_difference(alpha: wp.float64, s: Stretches, a: int, b: int) -> wp.float64:
    """(e_b - e_a) / (c_b - c_a)."""
    half = wp.float64(0.5)
    d = s.log[b] - s.log[a]
    ratio = half * alpha
    if wp.abs(d) > EQUAL:
        ratio = wp.sinh(half * alpha * d) / wp.sinh(d)
    return ratio * wp.exp(half * alpha * (s.isochoric[a] + s.isochoric[b]) - s.log[a] - s.log[b])


@wp.func
def ogden_isochoric_tangent(F: wp.mat33d, table: wp.array2d(dtype=wp.float64), m: int) -> mat9x9:
    """A[3 i + k, 3 j + l] = d P_ik / d F_jl, Pa."""
    two = wp.float64(2.0)
    s = stretches(F)
    c = s.squared
    _, tau = principal_stress(s.isochoric, table, m)
    normal = wp.mat33d()  # of dS_aa to H_bb
    shear = wp.mat33d()  # of dS_ab to H_ab + H_ba
    for p in range(int(table[m, t.TERM_COUNT])):
        mu = table[m, t.CONSTANTS + 2 * p]
        alpha = table[m, t.CONSTANTS + 2 * p + 1]
        e = powers_less_one(alpha, s.isochoric) + wp.vec3d(wp.float64(1.0), wp.float64(1.0), wp.float64(1.0))
        ninth = (e[0] + e[1] + e[2]) * NINTH
        for a in range(3):
            normal[a, a] = normal[a, a] + two * mu * e[a]
            for b in range(3):
                normal[a, b] = normal[a, b] + two * mu * (ninth - (e[a] + e[b]) * THIRD)
                if b > a:
                    shear[a, b] = shear[a, b] + two * mu / alpha * divided_difference(alpha, s, a, b)
    for a in range(3):
        normal[a, a] = normal[a, a] - two * tau[a]
        for b in range(3):
            normal[a, b] = normal[a, b] / (c[a] * c[b])
            if b > a:
                shear[a, b] = (shear[a, b] * c[a] - tau[a]) / (c[a] * c[b])
    S = s.axes * wp.diag(wp.cw_div(tau, c)) * wp.transpose(s.axes)
    A = mat9x9()
    for j in range(3):
        for l in range(3):  # dF = e_j (x) e_l, H_ab = pushed[j, a] axes[l, b]
            dS = wp.mat33d()
            for a in range(3):
                for b in range(3):
                    dS[a, a] = dS[a, a] + normal[a, b] * s.pushed[j, b] * s.axes[l, b]
                    if b > a:
                        dS[a, b] = shear[a, b] * (
                            s.pushed[j, a] * s.axes[l, b] + s.pushed[j, b] * s.axes[l, a]
                        )
                        dS[b, a] = dS[a, b]
            dP = s.pushed * dS * wp.transpose(s.axes)
            for i in range(3):
                for k in range(3):
                    A[3 * i + k, 3 * j + l] = dP[i, k]
            for k in range(3):
                A[3 * j + k, 3 * j + l] = A[3 * j + k, 3 * j + l] + S[l, k]
    return A
