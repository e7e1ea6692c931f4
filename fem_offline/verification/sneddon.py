# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A rigid true sphere (not a paraboloid) on a linear elastic half space.

    d = a/2 ln((R + a) / (R - a)),   F = E*/2 [(a^2 + R^2) ln((R + a) / (R - a)) - 2 a R]

(Sneddon, The relation between load and penetration in the axisymmetric Boussinesq problem for a punch of arbitrary
profile, Int. J. Eng. Sci. 3:47-57, 1965.)  Small strains: F / F_Hertz = 1 - d / (10 R) + O(d^2 / R^2).
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

__all__ = ["contact_radius", "sphere_force"]


def contact_radius(radius: float, depth: float) -> float:
    """a, m, at a depth m."""
    if depth <= 0.0:
        return 0.0

    def excess(share: float) -> float:  # share = a / R; a / 2 ln((R + a) / (R - a)) = a artanh(a / R)
        return share * np.arctanh(share) - depth / radius

    return radius * brentq(excess, 0.0, np.nextafter(1.0, 0.0), xtol=1e-15)


def sphere_force(effective: float, radius: float, depth: np.ndarray) -> np.ndarray:
    """F, N; effective modulus Pa, radius and depth m."""
    a = np.array([contact_radius(radius, float(d)) for d in np.ravel(depth)]).reshape(np.shape(depth))
    log = 2.0 * np.arctanh(a / radius)
    return 0.5 * effective * ((a**2 + radius**2) * log - 2.0 * a * radius)
