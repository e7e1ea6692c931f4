# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The volume of a whole tetrahedron as one strain, as Warp functions: what keeps quadratic tetrahedra from locking.

    W = V kappa/2 j^2,   j = 1/4 sum_q (J_q - 1),   p = kappa j
    dW/du_a = p sum_q V/4 C_q grad N_a,   C = cof F = dJ/dF
    d2W = V kappa g (x) g + p sum_q V/4 d2J_q,   g_a = 1/4 sum_q C_q grad N_a,   d2J/dF_ik dF_jl = e_ijm e_kln F_mn

(mean dilatation: Nagtegaal, Parks and Rice, Comput. Methods Appl. Mech. Eng. 4:153-177, 1974; Simo, Taylor and Pister,
ibid. 51:177-208, 1985, section 3.)  A linear material has tr(F - 1) for J - 1 and 1 for C.

At small strain this is J at the centre.  Under pressure it is not: moves inside a held body leave its volume, hence
the sum of mean J, alone, but not the sum of J at centres, and the second derivative of that is indefinite.  Held all
around under uniform pressure, a ball in 1,800 tetrahedra lost its stability at p = 2.8 mu with J at the centres
(whatever the share of kappa at the four points: 2.6 at 0.5 mu, 3.3 at 8 mu); with the mean it is stable beyond 256 mu,
as a solid is.
"""

from __future__ import annotations

import warp as wp

from palpate.fem_offline import material_table as t
from palpate.fem_offline.near_one import jacobian_less_one
from palpate.fem_offline.tensor4 import mat9x9

__all__ = ["cofactor", "mean_kappa", "mean_stress", "mean_tangent", "volume_strain"]


@wp.func
def volume_strain(F: wp.mat33d) -> wp.vec2d:
    """(J - 1, tr(F - 1)): the volumetric strain of hyperelastic and of linear materials."""
    return wp.vec2d(jacobian_less_one(F), wp.trace(F - wp.identity(n=3, dtype=wp.float64)))


@wp.func
def mean_kappa(
    table: wp.array2d(dtype=wp.float64), fraction: wp.array2d(dtype=wp.float64), e: int
) -> wp.vec2d:
    """kappa of element e that acts on its mean volume strain: hyperelastic, linear, Pa."""
    kappa = wp.vec2d()
    for m in range(table.shape[0]):
        part = fraction[e, m] * table[m, t.KAPPA_MEAN]
        if int(table[m, t.MODEL]) == t.LINEAR:
            kappa[1] = kappa[1] + part
        else:
            kappa[0] = kappa[0] + part
    return kappa


@wp.func
def cofactor(F: wp.mat33d) -> wp.mat33d:
    """C = J F^-T, whatever J."""
    r0 = wp.vec3d(F[0, 0], F[0, 1], F[0, 2])
    r1 = wp.vec3d(F[1, 0], F[1, 1], F[1, 2])
    r2 = wp.vec3d(F[2, 0], F[2, 1], F[2, 2])
    return wp.matrix_from_rows(wp.cross(r1, r2), wp.cross(r2, r0), wp.cross(r0, r1))


@wp.func
def mean_stress(F: wp.mat33d, p: wp.vec2d) -> wp.mat33d:
    """P = p C: of hyperelastic materials p[0], of linear ones p[1]."""
    return cofactor(F) * p[0] + wp.identity(n=3, dtype=wp.float64) * p[1]


@wp.func
def mean_tangent(F: wp.mat33d, p: wp.vec2d) -> mat9x9:
    """A = p d2J/dF dF; linear materials have none."""
    A = mat9x9()
    for i in range(3):
        for j in range(3):
            if i != j:
                row = p[0]
                if (j - i + 3) % 3 == 2:
                    row = -p[0]
                for k in range(3):
                    for l in range(3):
                        if k != l:
                            sign = row
                            if (l - k + 3) % 3 == 2:
                                sign = -row
                            A[3 * i + k, 3 * j + l] = sign * F[3 - i - j, 3 - k - l]
    return A
