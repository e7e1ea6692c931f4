# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rigid punches of revolution on a linear elastic half space, without friction.

A true sphere (not a paraboloid):

    d = a/2 ln((R + a) / (R - a)),   F = E*/2 [(a^2 + R^2) ln((R + a) / (R - a)) - 2 a R]

A flat punch and a sharp cone of half-angle alpha:

    F = 2 E* a d;      F = 2/pi E* tan(alpha) d^2,   a = 2/pi tan(alpha) d

Any convex profile z(s), z(0) = 0, with s = a sin(t):

    d = a int_0^(pi/2) z'(a sin t) dt,      F = 2 E* [a d - a^2 int_0^(pi/2) z'(a sin t) cos^2 t dt]

(Sneddon, The relation between load and penetration in the axisymmetric Boussinesq problem for a punch of arbitrary
profile, Int. J. Eng. Sci. 3:47-57, 1965; the second integral after exchanging the order of integration.)
Small strains: for the sphere F / F_Hertz = 1 - d / (10 R) + O(d^2 / R^2).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

__all__ = [
    "cone_force",
    "cone_profile",
    "contact_radius",
    "profile_force",
    "punch_force",
    "punch_profile",
    "sphere_force",
]


def contact_radius(radius: float, depth: float) -> float:
    """a, m, of a sphere at a depth m."""
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


def punch_force(effective: float, radius: float, depth: np.ndarray) -> np.ndarray:
    """F, N, of a flat punch with a sharp edge."""
    return 2.0 * effective * radius * depth


def cone_force(effective: float, half_angle: float, depth: np.ndarray) -> np.ndarray:
    """F, N, of a cone with a sharp tip, half_angle rad between axis and flank; a = 2/pi tan(half_angle) d."""
    return 2.0 / np.pi * effective * np.tan(half_angle) * depth**2


def profile_force(
    effective: float, slope: Callable[[float], float], breaks: tuple[float, ...], widest: float, depth: float
) -> float:
    """F, N, of a punch with the profile slope z'(s), s in m.

    Args:
        breaks: m; where z' has kinks.
        widest: m; the punch's radius, beyond which its side goes straight up.
        depth: m.
    """

    def integral(a: float, weight: Callable[[float], float]) -> float:
        kinks = sorted(np.arcsin(s / a) for s in breaks if 0.0 < s < a)
        return quad(
            lambda t: slope(a * np.sin(t)) * weight(t), 0.0, 0.5 * np.pi, points=kinks or None, limit=400
        )[0]

    def depth_of(a: float) -> float:
        return a * integral(a, lambda t: 1.0)

    almost = widest * (1.0 - 1e-9)
    a = almost if depth_of(almost) <= depth else brentq(lambda a: depth_of(a) - depth, 1e-6 * widest, almost)
    return float(2.0 * effective * (a * depth - a**2 * integral(a, lambda t: np.cos(t) ** 2)))


def punch_profile(
    radius: float, edge_radius: float
) -> tuple[Callable[[float], float], tuple[float, ...], float]:
    """Slope, breaks and widest of a flat punch with a rounded edge, for `profile_force`."""
    flat = radius - edge_radius

    def slope(s: float) -> float:
        w = max(0.0, s - flat)
        return w / np.sqrt(max(edge_radius**2 - w**2, 1e-30))

    return slope, (flat,), radius


def cone_profile(
    half_angle: float, tip_radius: float, widest: float
) -> tuple[Callable[[float], float], tuple[float, ...], float]:
    """Slope, breaks and widest of a cone with a ball for a tip, for `profile_force`."""
    merged = tip_radius * np.cos(half_angle)

    def slope(s: float) -> float:
        return s / np.sqrt(tip_radius**2 - s**2) if s < merged else 1.0 / np.tan(half_angle)

    return slope, (merged,), widest
