# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Surfaces and responses that are known in closed form, made into fields as an author's are: nodes, kriging, lattices.

A ball of radius R on a surface with signed distance phi,

    U(c, d) = A(c) 8/15 E* sqrt(R) d^2.5,   log A = wave sin(x / l + 0.5) cos(y / l - 0.3)

with c the point of the surface under the ball's centre.  k = 0.7 U'', mu as asked.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from palpate.fields.as_cooked import as_cooked
from palpate.fields.build_field import build_field
from palpate.fields.contact_geometry import contact_geometry
from palpate.fields.node_fit import LateralLadder, PressArrays, fit_nodes, uniform_knots
from palpate.fields.response_field import ContactGeometry, ResponseField, ToolReference

__all__ = ["SURFACES", "KnownField", "made", "surface_field"]

RADIUS, DEPTH, MODULUS = 5e-3, 5e-3, 7e3
LENGTH = 15e-3
"""m; l."""
HALF = 18e-3
"""m; half the side of the square that a tool may touch."""
STIFFNESS_SHARE = 0.7
Distance = Callable[[np.ndarray], np.ndarray]


def plane(q: np.ndarray) -> np.ndarray:
    return q[:, 2]


def ridge(q: np.ndarray) -> np.ndarray:
    """Two planes that fall away from x = 0 by 45 degrees: an edge of 90 degrees, pointing out."""
    down, side = np.abs(q[:, 0]) + q[:, 2], np.abs(q[:, 0]) - q[:, 2]
    edge = np.hypot(q[:, 0], q[:, 2])
    return np.where((side < 0) & (down > 0), edge, down / np.sqrt(2.0))


def crease(q: np.ndarray) -> np.ndarray:
    """Two planes that rise from x = 0 by 20 degrees: a valley."""
    a = np.radians(20.0)
    return q[:, 2] * np.cos(a) - np.abs(q[:, 0]) * np.sin(a)


def cusp(q: np.ndarray) -> np.ndarray:
    """A cone with its point at the origin, half-angle 60 degrees."""
    a = np.radians(60.0)
    r = np.hypot(q[:, 0], q[:, 1])
    flank = r * np.cos(a) + q[:, 2] * np.sin(a)
    beyond = q[:, 2] * np.cos(a) - r * np.sin(a) > 0.0
    return np.where(beyond & (flank > 0), np.hypot(r, q[:, 2]), flank)


def lobe(q: np.ndarray) -> np.ndarray:
    """A sheet 3 mm thick, its upper side at z = 0; its other side is nearer than the deepest press."""
    return np.abs(q[:, 2] + 1.5e-3) - 1.5e-3


SURFACES: dict[str, Distance] = {
    "plane": plane,
    "ridge": ridge,
    "crease": crease,
    "cusp": cusp,
    "thin lobe": lobe,
}


@dataclass(frozen=True)
class KnownField:
    """A surface and the response on it.

    Attributes:
        surface: a name of SURFACES.
        wave: how much the stiffness varies (log).  friction: mu.  scale: times the modulus.
        depth: m; depth_max.
    """

    surface: str = "plane"
    wave: float = 0.3
    friction: float = 0.1
    scale: float = 1.0
    depth: float = DEPTH

    @property
    def distance(self) -> Distance:
        return SURFACES[self.surface]

    def reach(self, q: np.ndarray) -> np.ndarray:
        return np.maximum(np.abs(q[:, 0]), np.abs(q[:, 1])) - HALF

    def normal(self, q: np.ndarray, h: float = 1e-6) -> np.ndarray:
        """(n, 3) grad phi, by central differences."""
        slope = [(self.distance(q + h * e) - self.distance(q - h * e)) / (2 * h) for e in np.eye(3)]
        slope = np.stack(slope, axis=1)
        return slope / np.linalg.norm(slope, axis=1, keepdims=True)

    def amplitude(self, c: np.ndarray) -> np.ndarray:
        return np.exp(self.wave * np.sin(c[:, 0] / LENGTH + 0.5) * np.cos(c[:, 1] / LENGTH - 0.3))

    def law(self, c: np.ndarray, depth: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """U J, its slope N and its second derivative N/m (n, k), at surface points (n, 3) and depths (k,) m."""
        A = self.scale * self.amplitude(c)[:, None] * 8 / 15 * MODULUS * np.sqrt(RADIUS)
        return A * depth**2.5, 2.5 * A * depth**1.5, 3.75 * A * depth**0.5

    def places(self, count: int, seed: int) -> np.ndarray:
        """(count, 3) points of the surface, well spread and off its edges."""
        rng = np.random.default_rng(seed)
        pool = rng.uniform(-HALF, HALF, (max(20 * count, 2000), 2))
        pool = pool[np.hypot(*pool.T) > 2e-3] if self.surface == "cusp" else pool
        pool = pool[np.abs(pool[:, 0]) > 2e-3] if self.surface in ("ridge", "crease") else pool
        chosen, distance = [0], np.linalg.norm(pool - pool[0], axis=1)
        for _ in range(count - 1):
            chosen.append(int(distance.argmax()))
            distance = np.minimum(distance, np.linalg.norm(pool - pool[chosen[-1]], axis=1))
        return self.lifted(pool[chosen])

    def lifted(self, xy: np.ndarray) -> np.ndarray:
        """(n, 3) points of the surface above xy (n, 2)."""
        z = np.zeros(len(xy))
        for _ in range(60):  # phi rises with z at a rate from 0.3 to 1
            z -= self.distance(np.column_stack([xy, z]))
        return np.column_stack([xy, z])

    def press(self, c: np.ndarray, steps: int = 10) -> PressArrays:
        """The record of a press at c (3,) m, lateral ladders included."""
        n = self.normal(c[None] + 1e-4 * self.normal(c[None]))[0]
        depth = self.depth * np.arange(steps + 1) / steps
        energy, force, second = (a[0] for a in self.law(c[None], depth))
        h = 1e-6
        slope = [
            (self.law((c + h * e)[None], depth)[0][0] - self.law((c - h * e)[None], depth)[0][0]) / (2 * h)
            for e in np.eye(3)
        ]
        along = np.stack(slope, axis=1)
        along -= (along @ n)[:, None] * n
        t = np.cross(n, [0.0, 1.0, 0.0])
        move = np.outer(np.linspace(1e-4, 4e-4, 4), t / np.linalg.norm(t))
        ladders = [
            LateralLadder(float(depth[i]), move, -STIFFNESS_SHARE * second[i] * move, np.zeros(4))
            for i in (steps // 2, steps)
        ]
        vector = force[:, None] * n - along
        return PressArrays(c, n, depth, vector, energy, ladders, self.friction, f"{c[0]:.9f} {c[1]:.9f}")


@cache
def geometry_of(known: KnownField) -> ContactGeometry:
    low, high = np.full(3, -HALF - 25e-3), np.full(3, HALF + 25e-3)
    low[2], high[2] = (-30e-3, 20e-3) if known.surface != "plane" else (-12e-3, 14e-3)
    return contact_geometry(
        known.distance, known.reach, np.array([low, high]), (-1.5e-3, 7e-3), spacing=2e-3, check_count=500
    )


@cache
def made(known: KnownField, nodes: int = 40, knots: int = 13, seed: int = 3) -> ResponseField:
    """The field as the runtime will hold it, to the last bit of every coefficient.

    Raises:
        ValueError: nothing can be made of so few or so many.
    """
    presses = [known.press(c) for c in known.places(nodes, seed)]
    fitted = fit_nodes(presses, uniform_knots(known.depth, knots), RADIUS)
    tool = ToolReference("ball_5mm", "sphere", RADIUS, {"radius": RADIUS}, "0" * 64)
    return as_cooked(build_field(fitted, geometry_of(known), tool, known.reach))


def surface_field(surface: str, friction: float = 0.1) -> ResponseField:
    return made(KnownField(surface, friction=friction))
