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
    linear_isochoric,
    linear_isochoric_tangent,
    linear_volumetric,
    linear_volumetric_tangent,
)
from palpate.fem_offline.invariant_models import invariant_isochoric, invariant_isochoric_tangent
from palpate.fem_offline.near_one import jacobian_less_one
from palpate.fem_offline.ogden import ogden_isochoric, ogden_isochoric_tangent
from palpate.fem_offline.tensor4 import inverse_transpose, mat9x9

__all__ = ["isochoric", "isochoric_tangent", "volumetric", "volumetric_tangent"]


@wp.func
def isochoric(F: wp.mat33d, table: wp.array2d(dtype=wp.float64), m: int):
    """psi_iso (float64) and its P (mat33d) of material m, Pa."""
    model = int(table[m, t.MODEL])
    psi = wp.float64(0.0)
    P = wp.mat33d()
    if model == t.LINEAR:
        psi, P = linear_isochoric(F, table[m, t.CONSTANTS])
    elif model == t.OGDEN:
        psi, P = ogden_isochoric(F, table, m)
    else:
        psi, P = invariant_isochoric(F, table, m)
    return psi, P


@wp.func
def isochoric_tangent(F: wp.mat33d, table: wp.array2d(dtype=wp.float64), m: int) -> mat9x9:
    """A[3 i + k, 3 j + l] = d P_ik / d F_jl of psi_iso of material m, Pa."""
    model = int(table[m, t.MODEL])
    if model == t.LINEAR:
        return linear_isochoric_tangent(table[m, t.CONSTANTS])
    if model == t.OGDEN:
        return ogden_isochoric_tangent(F, table, m)
    return invariant_isochoric_tangent(F, table, m)


@wp.func
def volumetric(F: wp.mat33d, table: wp.array2d(dtype=wp.float64), m: int, kappa: wp.float64):
    """psi_vol (float64) and its P (mat33d) of material m, Pa."""
    j = jacobian_less_one(F)
    psi = wp.float64(0.5) * kappa * j * j
    P = inverse_transpose(F) * (kappa * j * (wp.float64(1.0) + j))
    if int(table[m, t.MODEL]) == t.LINEAR:
        psi, P = linear_volumetric(F, kappa)
    return psi, P


@wp.func
def volumetric_tangent(
    F: wp.mat33d, table: wp.array2d(dtype=wp.float64), m: int, kappa: wp.float64
) -> mat9x9:
    """A of psi_vol of material m, Pa."""
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
