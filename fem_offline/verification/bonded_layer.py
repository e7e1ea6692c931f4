# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A rigid, frictionless punch or sphere on a linear elastic layer bonded to a rigid base, by its integral equation.

Layer of thickness h, endless sides, small strains.  A surface pressure with Hankel transform P(xi) moves the surface by

    w(r) = 2/E* int_0^inf M(xi h) P(xi) J0(xi r) d xi,      E* = E / (1 - nu^2)
    M(x) = ((3 - 4 nu) sinh x cosh x - x) / (x^2 + 4 (1 - nu)^2 + (3 - 4 nu) sinh^2 x)

M = 1 is the half space.  P(xi) = int_0^a phi(t) cos(xi t) dt keeps the pressure inside r < a whatever phi is.
w = d - f(r) there (f: the tool's shape above its lowest point) then turns, by Abel's transform, into Fredholm's
equation of the second kind

    phi(s) - 1/(pi h) int_0^a phi(t) (K((s - t)/h) + K((s + t)/h)) dt = E*/pi g(s),     F = 2 pi int_0^a phi(t) dt
    K(y) = int_0^inf (1 - M(x)) cos(x y) dx,      g(s) = d - s int_0^s f'(r) / sqrt(s^2 - r^2) dr

    flat punch   g = d                      a given
    paraboloid   g = d - s^2 / R            phi(a) = 0 gives a
    sphere       g = d - s artanh(s / R)    phi(a) = 0 gives a (Sneddon's sphere, if M = 1)
    rounded punch: f = 0 up to b, then f' = (r - b) / sqrt(e^2 - (r - b)^2), e the edge's radius, a between b and b + e

(Lebedev and Ufliand, Axisymmetric contact problem for an elastic layer, J. Appl. Math. Mech. 22:442-450, 1958; Hayes,
Keer, Herrmann and Mockros, A mathematical analysis for indentation tests of articular cartilage, J. Biomech.
5:541-551, 1972, whose kappa is F / (2 E* a d).)  What it leaves out is of the order of d/h and d/R: finite strain, and
the layer's thinning under the tool.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import roots_legendre

__all__ = ["BondedLayer", "LayerContact"]

POINTS = 80
"""Gauss-Legendre points over the contact."""
REACH = 30.0
"""Of x.  1 - M falls as 4 x^2 exp(-2 x) / (3 - 4 nu): 5e-23 at 30."""


Shape = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class LayerContact:
    """A tool at rest on the layer.

    Attributes:
        radius: a, m.
        force: F, N.
    """

    radius: float
    force: float


@dataclass(frozen=True)
class BondedLayer:
    """A layer, pressed by rigid tools without friction.

    Attributes:
        youngs_modulus: Pa.
        poissons_ratio: up to 0.5 itself.
        thickness: h, m.
    """

    youngs_modulus: float
    poissons_ratio: float
    thickness: float

    @property
    def effective_modulus(self) -> float:
        """E*, Pa."""
        return self.youngs_modulus / (1.0 - self.poissons_ratio**2)

    def compliance(self, x: np.ndarray) -> np.ndarray:
        """M(x): the layer's compliance to pressure of wave number x / h, over the half space's."""
        return 1.0 - self._stiffening(x)

    def punch(self, contact_radius: float, depth: float) -> LayerContact:
        """A flat punch."""
        _, w, phi = self.solution(contact_radius, lambda s: np.full_like(s, depth))
        return LayerContact(contact_radius, float(2.0 * np.pi * w @ phi))

    def punch_factor(self, contact_radius: float) -> float:
        """Hayes' kappa: F over that on a half space, 2 E* a d."""
        return self.punch(contact_radius, 1.0).force / (2.0 * self.effective_modulus * contact_radius)

    def paraboloid(self, radius: float, depth: float) -> LayerContact:
        """A paraboloid of revolution; radius (m) of curvature at its tip."""
        return self._smooth(lambda s: s**2 / radius, depth, 1.5 * np.sqrt(radius * depth))

    def sphere(self, radius: float, depth: float) -> LayerContact:
        """A true sphere."""
        widest = min(1.5 * np.sqrt(radius * depth), radius * (1.0 - 1e-12))
        return self._smooth(lambda s: s * np.arctanh(s / radius), depth, widest)

    def rounded_punch(self, radius: float, edge_radius: float, depth: float) -> LayerContact:
        """A flat punch whose edge is rounded; radius (m) with the rounding."""
        b, e = radius - edge_radius, edge_radius
        x, w = roots_legendre(40)

        def rise(s: np.ndarray) -> np.ndarray:  # s int f'(s sin v) dv, from sin v = b / s to v = pi / 2
            first = np.arcsin(np.minimum(1.0, b / s))
            half = 0.5 * (0.5 * np.pi - first)
            past = np.clip(s[:, None] * np.sin(first[:, None] + half[:, None] * (x + 1.0)) - b, 0.0, None)
            return s * half * (past / np.sqrt(e**2 - past**2) @ w)

        return self._smooth(rise, depth, radius * (1.0 - 1e-9), b)

    def solution(self, contact_radius: float, g: Shape) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Points t (POINTS,) m, their weights m, and phi(t) Pa m there; g of radii (n,) m -> (n,) m."""
        t, w = self._points(contact_radius)
        system = np.eye(len(t)) - self._coupling(t, t) * w
        return t, w, np.linalg.solve(system, self.effective_modulus / np.pi * g(t))

    def _smooth(self, rise: Shape, depth: float, widest: float, narrowest: float = 0.0) -> LayerContact:
        """A tool with g(s) = depth - rise(s): its contact ends where phi(a) = 0, between the bounds (m) given."""

        def end(a: float, g: Shape) -> tuple[float, float]:  # phi(a), by the equation itself, and F
            t, w, phi = self.solution(a, g)
            edge = np.array([a])
            at_edge = self.effective_modulus / np.pi * g(edge) + self._coupling(edge, t) @ (w * phi)
            return float(at_edge[0]), float(2.0 * np.pi * w @ phi)

        def of_contact(a: float) -> tuple[float, float]:  # the depth at which a contact ends at a; F there
            flat, shaped = end(a, np.ones_like), end(a, rise)
            d = shaped[0] / flat[0]
            return d, d * flat[1] - shaped[1]

        least = narrowest + 1e-3 * (widest - narrowest)
        a = brentq(lambda a: of_contact(a)[0] - depth, least, widest, xtol=1e-14 * widest, rtol=1e-13)
        return LayerContact(a, of_contact(a)[1])

    def _points(self, a: float) -> tuple[np.ndarray, np.ndarray]:
        x, w = roots_legendre(POINTS)
        return 0.5 * a * (x + 1.0), 0.5 * a * w

    def _coupling(self, s: np.ndarray, t: np.ndarray) -> np.ndarray:
        """(K((s - t)/h) + K((s + t)/h)) / (pi h), (len(s), len(t)), by cos(x - y) + cos(x + y) = 2 cos x cos y."""
        h = self.thickness
        x, w = roots_legendre(100 + int(REACH * (s.max() + t.max()) / h))
        x, w = 0.5 * REACH * (x + 1.0), 0.5 * REACH * w
        near, far = np.cos(np.multiply.outer(s / h, x)), np.cos(np.multiply.outer(x, t / h))
        return 2.0 / (np.pi * h) * (near * (w * self._stiffening(x))) @ far

    def _stiffening(self, x: np.ndarray) -> np.ndarray:
        """1 - M(x), with exp(-2 x) taken out of both sides of the fraction."""
        nu, q = self.poissons_ratio, np.exp(-2.0 * np.asarray(x, float))
        c = 3.0 - 4.0 * nu
        above = (x**2 + 4.0 * (1.0 - nu) ** 2 + x) * q - 0.5 * c * q * (1.0 - q)
        return above / ((x**2 + 4.0 * (1.0 - nu) ** 2) * q + 0.25 * c * (1.0 - q) ** 2)
