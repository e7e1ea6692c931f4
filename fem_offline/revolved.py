# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Signed distance of a convex solid of revolution with rounded edges: punch, cylinder, cone, capsule, ball.

The solid is a core, revolved about z, and everything within the rounding radius r of it.  With cylinder coordinates
(s, z), s = sqrt(x^2 + y^2), and the closest point c of the core's half-section to (s, z),

    g = |(s, z) - c| - r,   m = ((s, z) - c) / |(s, z) - c| = (m_s, m_z)
    grad g = m_s e_s + m_z e_z
    Hess g = k t t^T + (m_s / s) e_phi e_phi^T,   t = (-m_z, m_s),   k = 1 / |(s, z) - c| at a corner, 0 along an edge

The hoop term m_s / s is s / |(s, z) - c| / s on the axis when c lies there: 1 / |(s, z) - c|, finite.  Where c lies off
the axis, m_s = 0 before s is (the section is convex).  Inside the core, g is the largest signed distance to its edges'
lines: continuous, so that an iterate that strays there finds its way out, with kinks where two edges are as near.
(Hart, Sphere tracing, The Visual Computer 12, 1996, has such distances; the Hessian is elementary.)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from palpate.fem_offline.pose import ToolDistance

__all__ = ["Revolved"]


@dataclass(frozen=True)
class Revolved:
    """A rounded convex solid of revolution about z.

    Attributes:
        profile: (V, 2) m as nested tuples; corners (s, z), s >= 0, of the core's half-section, from the lower end of
            the axis round the outside to the upper one.  One corner is a ball, two on the axis are a capsule.
        rounding: r, m, positive.

    Raises:
        ValueError: the profile is not convex, does not begin and end on the axis, or r is not positive.
    """

    profile: tuple[tuple[float, float], ...]
    rounding: float

    def __post_init__(self) -> None:
        corners = self.corners
        if corners.ndim != 2 or corners.shape[1] != 2 or not np.isfinite(corners).all():
            raise ValueError("a profile is a list of corners (s, z), finite numbers in m")
        if not self.rounding > 0.0:
            raise ValueError(f"the rounding radius is {self.rounding} m; it must be positive")
        if (corners[:, 0] < 0.0).any() or corners[0, 0] != 0.0 or corners[-1, 0] != 0.0:
            raise ValueError("a profile begins and ends on the axis (s = 0) and stays at s >= 0")
        edge = self._edges
        turn = edge[:-1, 0] * edge[1:, 1] - edge[:-1, 1] * edge[1:, 0]
        if (np.linalg.norm(edge, axis=1) == 0.0).any() or (turn <= 0.0).any():
            raise ValueError(
                "a profile is convex: going round from the lower end it only turns towards the axis"
            )
        if len(corners) > 1 and not corners[-1, 1] > corners[0, 1]:
            raise ValueError("a profile ends higher on the axis than it begins")

    @cached_property
    def corners(self) -> np.ndarray:
        return np.array(self.profile, float)

    @property
    def _edges(self) -> np.ndarray:
        return np.diff(self.corners, axis=0)

    @property
    def centre(self) -> np.ndarray:
        """(3,) m; the middle of the axis."""
        return np.array([0.0, 0.0, 0.5 * (self.corners[0, 1] + self.corners[-1, 1])])

    def support(self, direction: np.ndarray) -> float:
        """m; largest direction . x over the solid, direction (3,) of unit length."""
        across = float(np.hypot(direction[0], direction[1]))
        return float(np.max(self.corners @ np.array([across, direction[2]]))) + self.rounding

    def distance(self, points: np.ndarray) -> ToolDistance:
        """Gap of points (n, 3) m with its gradient and Hessian."""
        s = np.hypot(points[:, 0], points[:, 1])
        safe = np.maximum(s, 1e-300)
        outward = np.where(s[:, None] > 0.0, points[:, :2] / safe[:, None], [1.0, 0.0])
        closest, corner = self._closest(s, points[:, 2])
        away = np.stack([s, points[:, 2]], axis=1) - closest
        length = np.linalg.norm(away, axis=1)
        floor = 1e-9 * self.rounding
        m = away / np.maximum(length, floor)[:, None]
        bend = np.where(corner, 1.0 / np.maximum(length, floor), 0.0)
        gap = length - self.rounding
        if len(self.corners) > 2:
            depth, line = self._inside(s, points[:, 2])
            within = depth <= 0.0
            gap = np.where(within, depth - self.rounding, gap)
            m = np.where(within[:, None], line, m)
            bend = np.where(within, 0.0, bend)
        on_axis = closest[:, 0] == 0.0
        hoop = np.where(on_axis & corner, bend, m[:, 0] / np.maximum(s, floor))
        return ToolDistance(gap, *_in_space(outward, m, bend, hoop))

    def _closest(self, s: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(n, 2) m closest points of the core's outline, (n,) bool whether they are corners of it."""
        point = np.stack([s, z], axis=1)
        closest, corner = np.broadcast_to(self.corners[0], point.shape).copy(), np.ones(len(s), bool)
        best = np.linalg.norm(point - closest, axis=1) if len(self.corners) == 1 else np.full(len(s), np.inf)
        last = len(self.corners) - 2
        for k, (start, edge) in enumerate(zip(self.corners, self._edges, strict=False)):
            along = np.clip((point - start) @ edge / (edge @ edge), 0.0, 1.0)
            foot = start + along[:, None] * edge
            length = np.linalg.norm(point - foot, axis=1)
            # the middle of a flat end is no corner of the solid
            level = edge[1] == 0.0
            at_corner = ((along == 0.0) & (not (level and k == 0))) | (
                (along == 1.0) & (not (level and k == last))
            )
            nearer = length < best
            best = np.where(nearer, length, best)
            closest[nearer] = foot[nearer]
            corner[nearer] = at_corner[nearer]
        return closest, corner

    def _inside(self, s: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(n,) m largest signed distance to the edges' lines, positive outside; (n, 2) that edge's normal."""
        edge = self._edges
        normal = np.stack([edge[:, 1], -edge[:, 0]], axis=1) / np.linalg.norm(edge, axis=1)[:, None]
        point = np.stack([s, z], axis=1)
        signed = np.einsum("nej,ej->ne", point[:, None] - self.corners[None, :-1], normal)
        worst = np.argmax(signed, axis=1)
        return signed[np.arange(len(s)), worst], normal[worst]


def _in_space(
    outward: np.ndarray, m: np.ndarray, bend: np.ndarray, hoop: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Gradient (n, 3) and Hessian (n, 3, 3) from the half-plane's m and its two curvatures."""
    n = len(m)
    normal = np.stack([m[:, 0] * outward[:, 0], m[:, 0] * outward[:, 1], m[:, 1]], axis=1)
    t = np.stack([-m[:, 1] * outward[:, 0], -m[:, 1] * outward[:, 1], m[:, 0]], axis=1)
    around = np.stack([-outward[:, 1], outward[:, 0], np.zeros(n)], axis=1)
    curvature = bend[:, None, None] * t[:, :, None] * t[:, None, :]
    return normal, curvature + hoop[:, None, None] * around[:, :, None] * around[:, None, :]
