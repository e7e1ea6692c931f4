# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A rigid sphere on an elastic half space, as Hertz has it, and how a soft solid departs from it.

    E* = E / (1 - nu^2),   F = 4/3 E* sqrt(R) d^(3/2),   a = sqrt(R d)

(Johnson, Contact Mechanics, 1985, eq. 4.22-4.24; paraboloid, small strains, no friction.)

For an incompressible neo-Hookean half space and a true sphere the force falls below it,

    F / F_Hertz = 1 - 0.15 d/R,   d/R <= 1

(fit to finite elements by Zhang, Cao, Li and Feng, Spherical indentation method for determining the constitutive
parameters of hyperelastic soft materials, Biomech. Model. Mechanobiol. 13:1-11, 2014).
"""

from __future__ import annotations

import numpy as np

__all__ = ["contact_radius", "effective_modulus", "large_indentation_factor", "sphere_force"]


def effective_modulus(youngs_modulus: float, poissons_ratio: float) -> float:
    """E*, Pa, against a rigid tool."""
    return youngs_modulus / (1.0 - poissons_ratio**2)


def contact_radius(radius: float, depth: np.ndarray) -> np.ndarray:
    """a, m."""
    return np.sqrt(radius * depth)


def sphere_force(effective: float, radius: float, depth: np.ndarray) -> np.ndarray:
    """F, N; effective modulus Pa, radius and depth m."""
    return 4.0 / 3.0 * effective * np.sqrt(radius) * depth**1.5


def large_indentation_factor(radius: float, depth: np.ndarray) -> np.ndarray:
    """F / F_Hertz of an incompressible neo-Hookean half space."""
    return 1.0 - 0.15 * depth / radius
