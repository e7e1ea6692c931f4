# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A sphere pressed onto an elastic half space with load P and moved sideways: partial slip, then sliding.

With contact radius a, friction mu and tangential force Q the contact sticks within a radius c and slides around it,

    c / a = (1 - Q / (mu P))^(1/3)
    delta = 3 mu P (2 - nu) / (16 G a) [1 - (1 - Q / (mu P))^(2/3)]

(Cattaneo 1938; Mindlin, Compliance of elastic bodies in contact, J. Appl. Mech. 16:259-268, 1949; rigid sphere,
pressed without friction, tangential load afterwards; friction's small component across the motion and the coupling
of shear with pressure are left out.)

Pressed with so much friction that nothing slides, a rigid sphere meets more resistance at the same depth.  Every
increment of load is that of a bonded disc,

    dP = 2 E* C a d(delta),   C = (1 - nu) ln(3 - 4 nu) / (1 - 2 nu)

(Mossakovskii 1954; Spence, Proc. R. Soc. A 305:55-80, 1968), whose surface outside, with beta = ln(3 - 4 nu) / (2 pi),
stands at

    W(rho) = 2/pi cosh(pi beta) int_0^1 cos(2 beta artanh s) / sqrt(rho^2 - s^2) ds,    W(1) = 1,    W ~ 2 C / (pi rho)

per depth of the disc.  A point at radius r of the profile r^2 / (2 R) is met when the discs before have left that much
gap, r^2 / (2 R) = int_0^delta(r) (1 - W(r / a)) d(delta'), hence delta = k a^2 with
1 / (2 R) = 2 k int_0^1 (1 - W(1/t)) t dt, and P / P_Hertz = C / sqrt(k R):  1.0529 at nu = 0, 1.0162 at 0.3, 1 at 0.5.
(W was put together here from the disc's known force and unit edge, both of which it meets; without coupling k R = 1
and C = 1.)
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import quad

__all__ = ["gross_slip_way", "no_slip_factor", "stick_radius", "tangential_force"]


def gross_slip_way(
    shear_modulus: float, poissons_ratio: float, radius: float, friction_force: float
) -> float:
    """delta at Q = mu P, m; contact radius m, friction force mu P, N."""
    return 3.0 * friction_force * (2.0 - poissons_ratio) / (16.0 * shear_modulus * radius)


def tangential_force(way: np.ndarray) -> np.ndarray:
    """Q / (mu P) of delta over its value at gross slip."""
    return 1.0 - (1.0 - np.minimum(way, 1.0)) ** 1.5


def stick_radius(force: np.ndarray) -> np.ndarray:
    """c / a of Q / (mu P)."""
    return np.cbrt(1.0 - np.minimum(force, 1.0))


def no_slip_factor(poissons_ratio: float) -> float:
    """P / P_Hertz of a rigid sphere at the same depth where nothing slides."""
    nu = poissons_ratio
    beta = np.log(3.0 - 4.0 * nu) / (2.0 * np.pi)
    C = (1.0 - nu) * np.log(3.0 - 4.0 * nu) / (1.0 - 2.0 * nu)
    # t = sin(phi) / s inside: int_0^1 t^2 / sqrt(1 - t^2 s^2) dt = (asin s - s sqrt(1 - s^2)) / (2 s^3);  s = tanh x

    def integrand(x: float) -> float:
        s, c = np.tanh(x), 1.0 / np.cosh(x)
        inner = (np.arcsin(s) - s * c) / (2.0 * s**3) if s > 1e-3 else 1.0 / 3.0
        return np.cos(2.0 * beta * x) * c**2 * inner

    left = 0.5 - 2.0 / np.pi * np.cosh(np.pi * beta) * quad(integrand, 0.0, 18.0)[0]
    return float(C / np.sqrt(0.25 / left))
