# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Homogeneous deformation of every model, in closed form and in NumPy alone.

    tau = sum_a (tau_a + kappa (J - 1) J) n_a (x) n_a,   P = tau F^-T

tau_a from the principal stretches (principal_energy.py), n_a the principal axes of B = F F^T.

Uniaxial, F = diag(l, m, m), m from P_side = 0; plane stress, F = diag(l1, l2, m), m from P_thickness = 0.
Stretch and shear, F = (1 + g e_x (x) e_y) diag(l1, l2, l3): the block of B in the x-y plane has

    p = (Bxx + Byy)/2,   q = (Bxx - Byy)/2,   r = hypot(q, Bxy)
    l^2 = p + r and det/(p + r),   tan 2 theta = Bxy / q

For l = 1 this is simple shear, with stretches sqrt(1 + g^2/4) +- g/2.  Linear materials have Hooke's law instead.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from palpate.fem_offline.material import Linear, Material
from palpate.fem_offline.principal_energy import principal_energy

__all__ = ["HomogeneousState", "equibiaxial", "plane_stress", "stretch_and_shear", "uniaxial"]


@dataclass(frozen=True)
class HomogeneousState:
    """F (3, 3); first Piola-Kirchhoff stress P (3, 3), Pa; energy density psi, J/m3."""

    F: np.ndarray
    P: np.ndarray
    psi: float


def uniaxial(material: Material, stretch: float) -> HomogeneousState:
    """Stretched along x, free on its sides."""

    def at(side: float) -> HomogeneousState:
        return stretch_and_shear(material, (stretch, side, side), 0.0)

    guess = 1.0 - material.poissons_ratio * (stretch - 1.0) if isinstance(material, Linear) else stretch**-0.5
    return at(_free(lambda side: at(side).P[2, 2], guess))


def equibiaxial(material: Material, stretch: float) -> HomogeneousState:
    """Stretched along x and y alike, free along z."""
    return plane_stress(material, (stretch, stretch))


def plane_stress(material: Material, stretch: tuple[float, float]) -> HomogeneousState:
    """Stretched along x and y, free along z."""

    def at(thickness: float) -> HomogeneousState:
        return stretch_and_shear(material, (*stretch, thickness), 0.0)

    nu = material.poissons_ratio
    linear = 1.0 - nu / (1.0 - nu) * (stretch[0] + stretch[1] - 2.0)
    guess = linear if isinstance(material, Linear) else 1.0 / (stretch[0] * stretch[1])
    return at(_free(lambda thickness: at(thickness).P[2, 2], guess))


def stretch_and_shear(
    material: Material, stretch: tuple[float, float, float], shear: float
) -> HomogeneousState:
    """Stretched along the axes, then sheared along x across y."""
    F = np.diag(np.array(stretch, float))
    F[0, 1] = shear * stretch[1]
    kappa = material.bulk_modulus
    if isinstance(material, Linear):
        strain = 0.5 * (F + F.T) - np.eye(3)
        mean = np.trace(strain) / 3.0
        deviator = strain - mean * np.eye(3)
        stress = 2.0 * material.shear_modulus * deviator + 3.0 * kappa * mean * np.eye(3)
        return HomogeneousState(F, stress, 0.5 * float(np.sum(stress * strain)))
    B = F @ F.T
    p, q = 0.5 * (B[0, 0] + B[1, 1]), 0.5 * (B[0, 0] - B[1, 1])
    r = np.hypot(q, B[0, 1])
    squares = np.array([p + r, (F[0, 0] * F[1, 1]) ** 2 / (p + r), F[2, 2] ** 2])
    J = float(F[0, 0] * F[1, 1] * F[2, 2])
    psi, tau, _ = principal_energy(material, 0.5 * np.log(squares)[None])
    t = tau[0] + kappa * (J - 1.0) * J
    cos, sin = (q / r, B[0, 1] / r) if r > 0.0 else (1.0, 0.0)
    kirchhoff = np.diag([0.5 * (t[0] + t[1]), 0.5 * (t[0] + t[1]), t[2]])
    kirchhoff[:2, :2] += 0.5 * (t[0] - t[1]) * np.array([[cos, sin], [sin, -cos]])
    return HomogeneousState(F, kirchhoff @ np.linalg.inv(F).T, float(psi[0]) + 0.5 * kappa * (J - 1.0) ** 2)


def _free(stress, guess: float) -> float:
    """Stretch near `guess` at which `stress` vanishes."""
    return brentq(stress, 0.4 * guess, 2.5 * guess, xtol=1e-16, rtol=1e-15)
