# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""An organ whose response is known exactly, for the tests of fields: an ellipsoid with a Hertz-like law.

    U(q) = A(c(q)) d^2.5 (1 + beta(c) d / D),   d = rho - phi(q)

with A and beta smooth functions of the nearest surface point c(q).  Lateral forces are exact: the gradient of U
is taken by central differences of this U, independent of everything in palpate.fields.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from palpate.fields.build_field import build_field
from palpate.fields.contact_geometry import contact_geometry
from palpate.fields.node_fit import LateralLadder, PressArrays, fit_nodes, uniform_knots
from palpate.fields.response_field import ContactGeometry, ResponseField, ResponseNodes, ToolReference

FLAT = (0.06, 0.05, 0.03)
"""m, semi-axes of the usual test organ: radii of curvature of 120 and 83 mm at the pole."""
CURVED = (0.05, 0.03, 0.03)
"""m, semi-axes of an organ whose curvature matters: 83 and 30 mm at the pole."""
BALL = (0.08, 0.08, 0.08)
"""m."""
RADIUS = 5e-3
DEPTH = 5e-3


@dataclass(frozen=True)
class KnownOrgan:
    """Semi-axes m; tool radius m; depth_max m; contrast of the modulus (log amplitude); k / Phi''; friction."""

    axes: tuple[float, float, float] = FLAT
    radius: float = RADIUS
    depth_max: float = DEPTH
    contrast: float = 0.7
    stiffness_ratio: float = 0.7
    friction: float = 0.1

    @property
    def semi_axes(self) -> np.ndarray:
        return np.array(self.axes)

    def foot(self, q: np.ndarray) -> np.ndarray:
        """Nearest points of the ellipsoid (n, 3), by Newton on sum (a_i q_i / (t + a_i^2))^2 = 1."""
        a2 = self.semi_axes**2
        t = np.max(self.semi_axes * np.abs(q) - a2, axis=1)  # largest pole: a bracket's lower end
        for _ in range(100):
            r = self.semi_axes * q / (t[:, None] + a2)
            value = np.sum(r**2, axis=1) - 1
            slope = -2 * np.sum(r**2 / (t[:, None] + a2), axis=1)
            t = t - value / slope
            if np.all(np.abs(value) < 1e-14):
                break
        return a2 * q / (t[:, None] + a2)

    def normal(self, c: np.ndarray) -> np.ndarray:
        n = c / self.semi_axes**2
        return n / np.linalg.norm(n, axis=1, keepdims=True)

    def signed_distance(self, q: np.ndarray) -> np.ndarray:
        q = np.atleast_2d(q)
        c = self.foot(q)
        return np.sum((q - c) * self.normal(c), axis=1)

    def reach(self, q: np.ndarray) -> np.ndarray:
        """A 4 cm wide cap about the +z pole, by distance along x and y."""
        return np.linalg.norm(np.atleast_2d(q)[:, :2], axis=1) - 20e-3

    def modulus(self, c: np.ndarray) -> np.ndarray:
        x, y = c[:, 0], c[:, 1]
        return 7e3 * np.exp(self.contrast * np.sin(x / 9e-3 + 0.5) * np.cos(y / 11e-3 - 0.3))

    def energy(self, q: np.ndarray) -> np.ndarray:
        c = self.foot(q)
        d = np.maximum(self.radius - np.sum((q - c) * self.normal(c), axis=1), 0.0)
        scale = 8 / 15 * self.modulus(c) * np.sqrt(self.radius)
        beta = 0.2 + 0.15 * np.sin(c[:, 0] / 15e-3 + c[:, 1] / 20e-3)
        return scale * d**2.5 * (1 + beta * d / self.depth_max)

    def force(self, q: np.ndarray, step: float = 1e-6) -> np.ndarray:
        """-grad U (n, 3), by central differences."""
        return -np.stack(
            [(self.energy(q + step * e) - self.energy(q - step * e)) / (2 * step) for e in np.eye(3)], -1
        )

    def random_cap(self, count: int, rng: np.random.Generator, extent: float = 20e-3) -> np.ndarray:
        """(count, 3) random surface points of the cap."""
        radius = extent * np.sqrt(rng.uniform(0, 1, count))
        angle = rng.uniform(0, 2 * np.pi, count)
        a, b, h = self.semi_axes
        x, y = radius * np.cos(angle), radius * np.sin(angle)
        return np.stack([x, y, h * np.sqrt(1 - (x / a) ** 2 - (y / b) ** 2)], axis=1)

    def cap_points(self, count: int, rng: np.random.Generator, extent: float = 20e-3) -> np.ndarray:
        """(count, 3) well-spread surface points of the cap: farthest-point picks from 60 times as many."""
        pool = self.random_cap(60 * count, rng, extent)
        chosen = [0]
        distance = np.linalg.norm(pool - pool[0], axis=1)
        for _ in range(count - 1):
            chosen.append(int(distance.argmax()))
            distance = np.minimum(distance, np.linalg.norm(pool - pool[chosen[-1]], axis=1))
        return pool[chosen]

    def press(
        self, c: np.ndarray, rng: np.random.Generator, noise: float = 0.0, levels: int = 10
    ) -> PressArrays:
        """One press at surface point `c` (3,), every force and energy scaled by 1 + noise times a normal number."""
        n = self.normal(c[None])[0]
        depth = np.linspace(0, self.depth_max, levels + 1)
        q = c + (self.radius - depth)[:, None] * n
        force, energy = self.force(q), self.energy(q)
        size = np.linalg.norm(force, axis=1, keepdims=True)
        force = force + noise * size * rng.normal(size=force.shape)
        energy = energy * (1 + noise * rng.normal(size=len(energy)))
        t = np.cross(n, [0.0, 1.0, 0.0])
        t /= np.linalg.norm(t)
        at = np.array([q[5], q[10]])
        step = 1e-5
        second = (self.force(at - step * n) - self.force(at + step * n)) @ n / (2 * step)
        deflection = np.outer(np.linspace(0.1e-3, 0.5e-3, 4), t)
        ladders = []
        for i, state in enumerate((5, 10)):
            k = self.stiffness_ratio * second[i]
            change = -k * deflection + self.force(q[state] + deflection) - self.force(q[state : state + 1])
            ladders.append(LateralLadder(float(depth[state]), deflection, change, np.zeros(4)))
        return PressArrays(c, n, depth, force, energy, ladders, self.friction, f"press-{c[0]:.6f}")


@lru_cache
def geometry_of(organ: KnownOrgan, spacing: float = 2e-3) -> ContactGeometry:
    top = organ.axes[2]
    bounds = np.array([[-0.045, -0.045, top - 0.03], [0.045, 0.045, top + 0.015]])
    return contact_geometry(organ.signed_distance, organ.reach, bounds, (-0.5e-3, 6e-3), spacing=spacing)


@lru_cache
def nodes_of(organ: KnownOrgan, count: int, noise: float, seed: int) -> ResponseNodes:
    rng = np.random.default_rng(seed)
    presses = [organ.press(c, rng, noise) for c in organ.cap_points(count, rng)]
    return fit_nodes(presses, uniform_knots(organ.depth_max), organ.radius, geometry_of(organ))


@lru_cache
def field_of(
    organ: KnownOrgan, count: int, noise: float = 0.0, seed: int = 2, with_gradients: bool = True
) -> ResponseField:
    tool = ToolReference("ball", "sphere", organ.radius, {"radius": organ.radius}, "")
    nodes = nodes_of(organ, count, noise, seed)
    return build_field(nodes, geometry_of(organ), tool, organ.reach, with_gradients=with_gradients)


def held_out(organ: KnownOrgan, count: int = 60, seed: int = 5) -> tuple[np.ndarray, np.ndarray]:
    """Tool positions (5 count, 3) m at five depths from 20 % on above fresh cap points, and normals there."""
    c = organ.cap_points(count, np.random.default_rng(seed), 19e-3)
    n = organ.normal(c)
    s = organ.radius - organ.depth_max * np.linspace(0.2, 1.0, 5)
    return (c[None] + s[:, None, None] * n).reshape(-1, 3), np.tile(n, (5, 1))
