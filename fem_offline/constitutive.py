# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""One material at one deformation gradient: energy, stress and tangent as Warp functions, whatever the model.

    psi(F) = psi_iso(F) + psi_vol(J),   P = d psi / dF,   A = d P / dF
    psi_vol = kappa/2 (J - 1)^2,   P_vol = kappa (J - 1) J F^-T
    A_vol = kappa (J (2 J - 1) F^-T (x) F^-T - J (J - 1) F^-T_il F^-T_jk)

(Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, 2008, eq. 6.50, 6.59.)  A material is row m
of a table (material_table.py).  The volumetric functions take kappa apart, because elements integrate its shares at
different points.  Linear materials have kappa/2 tr(eps)^2 instead (hooke.py).
"""

from __future__ import annotations

import warp as wp

from palpate.fem_offline import material_table as t
from palpate.fem_offline.hooke import (
    linear_isochoric_energy,
    linear_isochoric_stress,
    linear_isochoric_tangent,
    linear_volumetric_energy,
    linear_volumetric_stress,
    linear_volumetric_tangent,
)
from palpate.fem_offline.invariant_models import invariant_energy, invariant_stress, invariant_tangent
from palpate.fem_offline.near_one import jacobian_less_one
from palpate.fem_offline.tensor4 import inverse_transpose, mat9x9

__all__ = [
    "isochoric_energy",
    "isochoric_stress",
    "isochoric_tangent",
    "volumetric_energy",
    "volumetric_stress",
    "volumetric_tangent",
]


@wp.func
def isochoric_energy(F: wp.mat33d, table: wp.array2d(dtype=wp.float64), m: int) -> wp.float64:
    """psi_iso of material m, Pa."""
    if int(table[m, t.MODEL]) == t.LINEAR:
        return linear_isochoric_energy(F, table[m, t.CONSTANTS])
    return invariant_energy(F, table, m)


@wp.func
def isochoric_stress(F: wp.mat33d, table: wp.array2d(dtype=wp.float64), m: int) -> wp.mat33d:
    """P of psi_iso of material m, Pa."""
    if int(table[m, t.MODEL]) == t.LINEAR:
        return linear_isochoric_stress(F, table[m, t.CONSTANTS])
    return invariant_stress(F, table, m)


@wp.func
def isochoric_tangent(F: wp.mat33d, table: wp.array2d(dtype=wp.float64), m: int) -> mat9x9:
    """A[3 i + k, 3 j + l] = d P_ik / d F_jl of psi_iso of material m, Pa."""
    if int(table[m, t.MODEL]) == t.LINEAR:
        return linear_isochoric_tangent(table[m, t.CONSTANTS])
    return invariant_tangent(F, table, m)


@wp.func
def volumetric_energy(
    F: wp.mat33d, table: wp.array2d(dtype=wp.float64), m: int, kappa: wp.float64
) -> wp.float64:
    """kappa/2 (J - 1)^2, Pa."""
    if int(table[m, t.MODEL]) == t.LINEAR:
        return linear_volumetric_energy(F, kappa)
    j = jacobian_less_one(F)
    return wp.float64(0.5) * kappa * j * j


@wp.func
def volumetric_stress(
    F: wp.mat33d, table: wp.array2d(dtype=wp.float64), m: int, kappa: wp.float64
) -> wp.mat33d:
    """kappa (J - 1) J F^-T, Pa."""
    if int(table[m, t.MODEL]) == t.LINEAR:
        return linear_volumetric_stress(F, kappa)
    j = jacobian_less_one(F)
    return inverse_transpose(F) * (kappa * j * (wp.float64(1.0) + j))


@wp.func
def volumetric_tangent(
    F: wp.mat33d, table: wp.array2d(dtype=wp.float64), m: int, kappa: wp.float64
) -> mat9x9:
    """kappa (J (2 J - 1) F^-T_ik F^-T_jl - J (J - 1) F^-T_il F^-T_jk), Pa."""
    if int(table[m, t.MODEL]) == t.LINEAR:
        return linear_volumetric_tangent(kappa)
    j = jacobian_less_one(F)
    J = wp.float64(1.0) + j
    Fit = inverse_transpose(F)
    along = kappa * J * (J + j)
    across = kappa * J * j
    A = mat9x9()
    for i in range(3):
        for k in range(3):
            for p in range(3):
                for l in range(3):
                    A[3 * i + k, 3 * p + l] = along * Fit[i, k] * Fit[p, l] - across * Fit[i, l] * Fit[p, k]
    return A
