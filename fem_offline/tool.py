# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rigid tools as signed distances g(x), positive outside the tool.

Sphere of radius R at p:  g = |x - p| - R,  n = grad g = (x - p) / |x - p|,  Hess g = (1 - n n^T) / |x - p|.

A tool has a reference point (the one whose position the response field is a function of) and an offset rho:
depth = rho - phi(reference point), phi the organ's signed distance.  A sphere's reference point is its centre and
rho its radius, so its orientation never matters.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from typing import Protocol

import numpy as np

__all__ = ["Sphere", "Tool", "ToolDistance"]


@dataclass(frozen=True)
class ToolDistance:
    """Signed distance of n points.

    Attributes:
        gap: (n,) m, negative inside the tool.
        normal: (n, 3) gradient of the gap.
        curvature: (n, 3, 3) 1/m; Hessian of the gap.
    """

    gap: np.ndarray
    normal: np.ndarray
    curvature: np.ndarray


class Tool(Protocol):
    """What a press needs to know of a tool."""

    offset: float
    contact_radius: float

    def distance(self, points: np.ndarray, reference_point: np.ndarray) -> ToolDistance: ...

    def hash(self) -> str: ...


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
    def offset(self) -> float:
        return self.radius

    @property
    def contact_radius(self) -> float:
        """Radius of curvature at the touching point, m."""
        return self.radius

    def distance(self, points: np.ndarray, reference_point: np.ndarray) -> ToolDistance:
        """Gap of points (n, 3) m to the sphere centred at reference_point (3,) m."""
        away = points - reference_point
        length = np.maximum(np.linalg.norm(away, axis=1), 1e-300)
        normal = away / length[:, None]
        curvature = (np.eye(3) - normal[:, :, None] * normal[:, None, :]) / length[:, None, None]
        return ToolDistance(length - self.radius, normal, curvature)

    def hash(self) -> str:
        """Hex digest of shape and size; a field is valid for this tool only."""
        text = json.dumps({"shape": "sphere", "radius": self.radius, "reference": "centre"}, sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()
