# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A rigid disc of radius a bonded to an elastic half space, moved along and across its normal.

    k_n = 2 E* a,   k_t = 8 G a / (2 - nu),   k_t / k_n = 2 (1 - nu) / (2 - nu)

(Mindlin, Compliance of elastic bodies in contact, J. Appl. Mech. 16:259-268, 1949.)
Both leave the coupling of normal and tangential motion out, which vanishes with 1 - 2 nu: a bonded disc has
k_n = 4 G a ln(3 - 4 nu) / (1 - 2 nu), 0.05 % more at nu = 0.48 and 2.9 % at 0.3 (Mossakovskii 1954, Spence 1968).
"""

from __future__ import annotations

__all__ = ["normal_stiffness", "tangential_stiffness"]


def normal_stiffness(youngs_modulus: float, poissons_ratio: float, contact_radius: float) -> float:
    """k_n, N/m."""
    return 2.0 * youngs_modulus / (1.0 - poissons_ratio**2) * contact_radius


def tangential_stiffness(youngs_modulus: float, poissons_ratio: float, contact_radius: float) -> float:
    """k_t, N/m."""
    shear_modulus = 0.5 * youngs_modulus / (1.0 + poissons_ratio)
    return 8.0 * shear_modulus * contact_radius / (2.0 - poissons_ratio)
