# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Where a rigid tool is, how it is held against a surface, and distances carried between its frame and the organ's.

Tool frame: the origin is the reference point (the one whose position the response field is a function of), +z points
out of the tissue when the tool is held upright.  A pose takes it into the organ's frame,

    x = p + Q X

A way of touching is a tilt: the angle between the tool's axis Q e_z and the surface normal n.  With the tangents
t_1, t_2 of `tangents`, the tool is turned about t_2 by the tilt, so that its axis leans towards t_1,

    Q = [cos b t_1 - sin b n,   t_2,   cos b n + sin b t_1]

"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

__all__ = ["Pose", "ToolDistance", "tangents", "tilted"]


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

    def turned(self, rotation: np.ndarray) -> ToolDistance:
        """The same, found in a frame whose axes are the columns of rotation (3, 3)."""
        curvature = np.einsum("ij,njk,lk->nil", rotation, self.curvature, rotation, optimize=True)
        return ToolDistance(self.gap, self.normal @ rotation.T, curvature)


@dataclass(frozen=True)
class Pose:
    """Where a tool is.

    Attributes:
        position: (3,) m; its reference point.
        rotation: (3, 3) orthonormal, determinant 1; columns are the tool's axes.
    """

    position: np.ndarray
    rotation: np.ndarray

    @classmethod
    def upright(cls, position: np.ndarray) -> Pose:
        """Unturned, at position (3,) m."""
        return cls(np.asarray(position, float), np.eye(3))

    def at(self, position: np.ndarray) -> Pose:
        """Turned alike, elsewhere: position (3,) m."""
        return replace(self, position=np.asarray(position, float))

    def into_tool(self, points: np.ndarray) -> np.ndarray:
        """(n, 3) m in the tool's frame, of points (n, 3) m."""
        return (points - self.position) @ self.rotation


def tangents(normal: np.ndarray) -> np.ndarray:
    """(2, 3) orthonormal tangents of a unit normal; the first leans on the axis that the normal avoids most.

    t_1 x t_2 = n.
    """
    axis = np.eye(3)[np.argmin(np.abs(normal))]
    first = axis - (axis @ normal) * normal
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(normal, first)])


def tilted(normal: np.ndarray, tilt: float = 0.0) -> np.ndarray:
    """(3, 3) rotation Q of a tool held against a surface.

    Args:
        normal: (3,) outward unit normal.
        tilt: rad between the tool's axis and the normal; positive leans the axis towards the first tangent.
    """
    first, second = tangents(normal)
    c, s = np.cos(tilt), np.sin(tilt)
    return np.stack([c * first - s * normal, second, c * normal + s * first], axis=1)
