# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Small-strain elasticity, as Warp functions: what a press is without large rotations and stretches.

    eps = sym(F - 1),   psi = mu dev(eps):dev(eps) + kappa/2 tr(eps)^2
    P = 2 mu dev(eps) + kappa tr(eps) 1

Not objective: a rotation by theta strains it by 1 - cos(theta).
"""

from __future__ import annotations

import warp as wp

from palpate.fem_offline.tensor4 import mat9x9

__all__ = ["linear_isochoric", "linear_isochoric_tangent", "linear_volumetric", "linear_volumetric_tangent"]

THIRD = wp.constant(wp.float64(1.0 / 3.0))


@wp.func
def deviatoric_strain(F: wp.mat33d) -> wp.mat33d:
    """dev sym(F - 1)."""
    one = wp.identity(n=3, dtype=wp.float64)
    D = F - one
    return (D + wp.transpose(D)) * wp.float64(0.5) - one * (THIRD * wp.trace(D))


@wp.func
def linear_isochoric(F: wp.mat33d, mu: wp.float64):
    """psi = mu dev(eps):dev(eps) and P = 2 mu dev(eps)."""
    strain = deviatoric_strain(F)
    return mu * wp.ddot(strain, strain), strain * (wp.float64(2.0) * mu)


@wp.func
def linear_isochoric_tangent(mu: wp.float64) -> mat9x9:
    """mu (d_ij d_kl + d_il d_kj - 2/3 d_ik d_jl)."""
    A = mat9x9()
    for i in range(3):
        for k in range(3):
            A[3 * i + k, 3 * i + k] = A[3 * i + k, 3 * i + k] + mu
            A[3 * i + k, 3 * k + i] = A[3 * i + k, 3 * k + i] + mu
            A[4 * i, 4 * k] = A[4 * i, 4 * k] - wp.float64(2.0) * THIRD * mu
    return A


@wp.func
def linear_volumetric(F: wp.mat33d, kappa: wp.float64):
    """psi = kappa/2 tr(eps)^2 and P = kappa tr(eps) 1."""
    one = wp.identity(n=3, dtype=wp.float64)
    trace = wp.trace(F - one)
    return wp.float64(0.5) * kappa * trace * trace, one * (kappa * trace)


@wp.func
def linear_volumetric_tangent(kappa: wp.float64) -> mat9x9:
    """kappa d_ik d_jl."""
    A = mat9x9()
    for i in range(3):
        for j in range(3):
            A[4 * i, 4 * j] = kappa
    return A
