# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A ball.

Radius R at p:  g = |x - p| - R,  n = grad g = (x - p) / |x - p|,  Hess g = (1 - n n^T) / |x - p|.

Its reference point is its centre, so its orientation never matters.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass

import numpy as np

from palpate.fem_offline.footprint import Footprint
from palpate.fem_offline.pose import Pose, ToolDistance

__all__ = ["Sphere"]


@dataclass(frozen=True)
class Sphere:
    """A rigid sphere.

    Attributes:
        radius: m.
    """

    radius: float

    def __post_init__(self) -> None:
        if not self.radius > 0.0:
            raise ValueError(f"radius is {self.radius} m; it must be positive")

    @property
    def contact_radius(self) -> float:
        """Radius of curvature at the touching point, m."""
        return self.radius

    def offset_along(self, direction: np.ndarray) -> float:
        """Radius, m, whatever the direction."""
        return self.radius

    def contact_size(self, depth: float, rotation: np.ndarray | None = None) -> float:
        """Hertz' contact radius sqrt(R d), m, at a depth m; no more than R."""
        return float(np.sqrt(self.radius * min(depth, self.radius)))

    def contact_extent(self, depth: float, rotation: np.ndarray | None = None) -> float:
        """Radius of the ball's section with the plane, m; no more than R."""
        return float(min(np.sqrt(2.0 * self.radius * depth), self.radius))

    def footprint(self, depth: float, rotation: np.ndarray | None = None) -> Footprint:
        """Of the ball `depth` (m) into a plane."""
        return Footprint(self.contact_size(depth), self.contact_extent(depth), np.zeros((1, 2)))

    def distance(self, points: np.ndarray, pose: Pose) -> ToolDistance:
        """Gap of points (n, 3) m."""
        away = points - pose.position
        length = np.maximum(np.linalg.norm(away, axis=1), 1e-300)
        normal = away / length[:, None]
        curvature = (np.eye(3) - normal[:, :, None] * normal[:, None, :]) / length[:, None, None]
        return ToolDistance(length - self.radius, normal, curvature)

    def hash(self) -> str:
        """Hex digest of shape and size; a field is valid for this tool only."""
        text = json.dumps({"shape": "sphere", "radius": self.radius, "reference": "centre"}, sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()
