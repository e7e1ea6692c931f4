# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Homogeneous deformation of the neo-Hookean solid of material.py, in closed form and in NumPy alone.

    psi = mu/2 (J^(-2/3) I1 - 3) + kappa/2 (J - 1)^2

Uniaxial, F = diag(l, m, m), J = l m^2, I1 = l^2 + 2 m^2; m from the free sides, then the nominal stress:

    P_side = mu J^(-2/3) (m - I1/(3 m)) + kappa (J - 1) J / m = 0
    P_axis = mu J^(-2/3) (l - I1/(3 l)) + kappa (J - 1) J / l

Simple shear, F = 1 + g e_x (x) e_y, J = 1, I1 = 3 + g^2, F^-T = 1 - g e_y (x) e_x:

    P = mu (F - I1/3 F^-T):   P_xy = mu g,  P_yx = mu g (1 + g^2/3),  P_xx = P_yy = P_zz = -mu g^2/3

(derived here from psi; mu and kappa as in material.py.)
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

__all__ = ["simple_shear", "uniaxial"]


def uniaxial(mu: float, kappa: float, stretch: float) -> tuple[float, float, float]:
    """(side stretch m, axial nominal stress Pa, energy J/m3) at an axial stretch."""

    def side_stress(m: float) -> float:
        J, I1 = stretch * m**2, stretch**2 + 2.0 * m**2
        return mu * J ** (-2.0 / 3.0) * (m - I1 / (3.0 * m)) + kappa * (J - 1.0) * J / m

    m = brentq(side_stress, 0.5 * stretch**-0.5, 2.0 * stretch**-0.5, xtol=1e-16, rtol=1e-15)
    J, I1 = stretch * m**2, stretch**2 + 2.0 * m**2
    axial = mu * J ** (-2.0 / 3.0) * (stretch - I1 / (3.0 * stretch)) + kappa * (J - 1.0) * J / stretch
    return m, axial, 0.5 * mu * (J ** (-2.0 / 3.0) * I1 - 3.0) + 0.5 * kappa * (J - 1.0) ** 2


def simple_shear(mu: float, shear: float) -> tuple[np.ndarray, float]:
    """(first Piola-Kirchhoff stress (3, 3) Pa, energy J/m3) at an amount of shear."""
    stress = -mu * shear**2 / 3.0 * np.eye(3)
    stress[0, 1] = mu * shear
    stress[1, 0] = mu * shear * (1.0 + shear**2 / 3.0)
    return stress, 0.5 * mu * shear**2
