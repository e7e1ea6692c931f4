# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A solid held as a tool: which of its directions points out of the tissue, and which of its points is tracked.

The solid has a frame of its own (y).  The tool frame (x) has its origin at the tip t, the reference point, and its +z
along the axis a; M is the smallest rotation that takes a to e_z:

    x = M (y - t)

(so a cylinder whose own axis is z lies along the tool's x when its axis key is x, along y when it is y).
Unless told otherwise the tip is the point of the touching plane below the solid's middle: y_m - (h(-a) + a . y_m) a,
h the support function.  With it offset_along(-e_z) = 0, and the position of the tip is what the field knows.
"""

from __future__ import annotations

import hashlib
import json
from abc import ABC, abstractmethod
from dataclasses import asdict, dataclass
from functools import cached_property, lru_cache
from typing import Protocol

import numpy as np

from palpate.fem_offline.footprint import Footprint, footprint
from palpate.fem_offline.pose import Pose, ToolDistance

__all__ = ["PlacedTool", "Solid"]


class Solid(Protocol):
    """A shape in its own frame."""

    @property
    def centre(self) -> np.ndarray:
        """(3,) m; a point in its middle."""
        ...

    def distance(self, points: np.ndarray) -> ToolDistance:
        """Gap of points (n, 3) m."""
        ...

    def support(self, direction: np.ndarray) -> float:
        """m; largest direction . y over the solid, direction (3,) of unit length."""
        ...


@dataclass(frozen=True, kw_only=True)
class PlacedTool(ABC):
    """A solid with an axis and a tip; what the shapes of this library have in common.

    Attributes:
        axis: in the solid's frame, points out of the tissue; need not be of unit length.
        tip: m in the solid's frame; the reference point.  None: below the solid's middle, on the touching plane.
    """

    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    tip: tuple[float, float, float] | None = None

    @property
    @abstractmethod
    def solid(self) -> Solid: ...

    @cached_property
    def _turn(self) -> np.ndarray:
        """M, (3, 3)."""
        a = np.array(self.axis, float)
        length = float(np.linalg.norm(a))
        if not (np.isfinite(length) and length > 0.0):
            raise ValueError(f"axis is {self.axis}; it must be a direction")
        a /= length
        if a[2] < -1.0 + 1e-12:
            return np.diag([1.0, -1.0, -1.0])
        v = np.array([a[1], -a[0], 0.0])  # a x e_z
        cross = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
        return np.eye(3) + cross + cross @ cross / (1.0 + a[2])

    @cached_property
    def _tip(self) -> np.ndarray:
        if self.tip is not None:
            return np.array(self.tip, float)
        a, middle = self._turn[2], self.solid.centre
        return middle - (self.solid.support(-a) + float(a @ middle)) * a

    @property
    def reference_point(self) -> np.ndarray:
        """(3,) m in the solid's frame; the tip."""
        return self._tip

    def into_tool_frame(self, points: np.ndarray) -> np.ndarray:
        """(n, 3) m in the tool frame, of points (n, 3) m of the solid's own frame."""
        return (points - self._tip) @ self._turn.T

    def distance(self, points: np.ndarray, pose: Pose) -> ToolDistance:
        """Gap of points (n, 3) m, with its gradient and Hessian, in the organ's frame."""
        found = self.solid.distance(pose.into_tool(points) @ self._turn + self._tip)
        return found.turned(pose.rotation @ self._turn)

    def offset_along(self, direction: np.ndarray) -> float:
        """m that the tool reaches from its tip in a unit direction (3,) of the tool frame."""
        d = np.asarray(direction, float) @ self._turn
        return self.solid.support(d) - float(d @ self._tip)

    def contact_size(self, depth: float, rotation: np.ndarray | None = None) -> float:
        """Radius of the contact, or half its width where it is long, m (footprint.py)."""
        return self.footprint(depth, rotation).size

    def contact_extent(self, depth: float, rotation: np.ndarray | None = None) -> float:
        """Radius around the contact point that contains the contact, m."""
        return self.footprint(depth, rotation).extent

    def footprint(self, depth: float, rotation: np.ndarray | None = None) -> Footprint:
        """Of the tool `depth` (m) into a plane with normal e_z, turned by rotation (3, 3)."""
        Q = np.eye(3) if rotation is None else rotation
        return _footprint(self, float(depth), tuple(map(tuple, np.asarray(Q).tolist())))

    def hash(self) -> str:
        """Hex digest of geometry, axis and reference point; a field is valid for this tool only."""
        values = {"shape": type(self).__name__, **asdict(self)}
        values["axis"], values["tip"] = self._turn[2].tolist(), self._tip.tolist()
        return hashlib.sha256(json.dumps(values, sort_keys=True).encode()).hexdigest()


@lru_cache(maxsize=256)
def _footprint(tool: PlacedTool, depth: float, rotation: tuple) -> Footprint:
    return footprint(tool, depth, np.array(rotation))
