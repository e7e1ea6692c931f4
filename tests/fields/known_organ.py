# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""An organ whose response is known exactly, for the field tests: an ellipsoid with a Hertz-like law.

    U(q) = A(c(q)) d^2.5 (1 + beta(c) d / D),   d = rho - phi(q)

with A and beta smooth functions of the nearest surface point c(q).  Lateral forces are exact: the gradient of U
is taken by complex-free central differences of this U, independent of everything in palpate.fields.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from palpate.fields.node_fit import LateralLadder, PressArrays


@dataclass(frozen=True)
class KnownOrgan:
    """Semi-axes (3,) m; tool radius m; depth_max m; contrast of the modulus (log amplitude)."""

    semi_axes: np.ndarray
    radius: float = 5e-3
    depth_max: float = 5e-3
    contrast: float = 0.7
    stiffness_ratio: float = 0.7

    def foot(self, q: np.ndarray) -> np.ndarray:
        """Nearest points of the ellipsoid (n, 3), by Newton on sum (a_i q_i / (t + a_i^2))^2 = 1."""
        a2 = self.semi_axes**2
        t = np.max(self.semi_axes * np.abs(q) - a2, axis=1)  # largest pole: a bracket's lower end
        for _ in range(100):
            r = self.semi_axes * q / (t[:, None] + a2)
            value = np.sum(r**2, axis=1) - 1
            slope = -2 * np.sum(r**2 / (t[:, None] + a2), axis=1)
            t = t - value / slope
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
        return -np.stack([(self.energy(q + step * e) - self.energy(q - step * e)) / (2 * step) for e in np.eye(3)], -1)

    def cap_points(self, count: int, rng: np.random.Generator, extent: float = 20e-3) -> np.ndarray:
        """(count, 3) well-spread surface points of the cap: farthest-point picks from 60 times as many."""
        radius = extent * np.sqrt(rng.uniform(0, 1, 60 * count))
        angle = rng.uniform(0, 2 * np.pi, 60 * count)
        a, b, h = self.semi_axes
        x, y = radius * np.cos(angle), radius * np.sin(angle)
        pool = np.stack([x, y, h * np.sqrt(1 - (x / a) ** 2 - (y / b) ** 2)], axis=1)
        chosen = [0]
        distance = np.linalg.norm(pool - pool[0], axis=1)
        for _ in range(count - 1):
            chosen.append(int(distance.argmax()))
            distance = np.minimum(distance, np.linalg.norm(pool - pool[chosen[-1]], axis=1))
        return pool[chosen]

    def press(self, c: np.ndarray, rng: np.random.Generator, noise: float = 0.0, levels: int = 10) -> PressArrays:
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
        second = sum(-(self.force(at + x * n) @ n) * sign for x, sign in ((-step, -1.0), (step, 1.0))) / (2 * step)
        deflection = np.outer(np.linspace(0.1e-3, 0.5e-3, 4), t)
        ladders = []
        for i, state in enumerate((5, 10)):
            k = self.stiffness_ratio * second[i]
            change = -k * deflection + self.force(q[state] + deflection) - self.force(q[state : state + 1])
            ladders.append(LateralLadder(float(depth[state]), deflection, change, np.zeros(4)))
        return PressArrays(c, n, depth, force, energy, ladders, 0.1, f"press-{c[0]:.6f}")
