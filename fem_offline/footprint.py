# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Where a rigid tool will touch flat tissue, from its geometry alone: what a mesh needs to know before it is made.

At depth d the contact is taken to be the tool's section d/2 above its lowest point.  For a paraboloid that is Hertz'
a = sqrt(R d), for a flat punch its face, for a cone 0.79 of Sneddon's a = 2/pi d tan(alpha); for a tilted punch, an
edge and a mesh it is as good a guess as any.  Sections are found on a grid that is zoomed onto them.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import distance_transform_edt

from palpate.fem_offline.pose import Pose

if TYPE_CHECKING:
    from palpate.fem_offline.tool import Tool

__all__ = ["Footprint", "footprint"]

_COARSE, _FINE = 24, 80
"""Cells along a grid: while zooming, and in the end."""
_HEIGHTS = (0.25, 0.5, 0.75, 1.0)
"""Shares of the depth at which sections are looked at for the extent."""


EDGE = 0.5
"""A rim is an edge where the tool's radius of curvature is less than this share of the contact's size: pressure peaks
there, the more the sharper it is."""


@dataclass(frozen=True)
class Footprint:
    """The contact on a plane with normal e_z through the contact point.

    Attributes:
        size: m; radius of the largest circle in the contact: its radius, or half its width.
        extent: m; radius around the contact point that contains it.
        spine: (m, 2) m from the contact point; points of the contact that are farther than 0.8 `size` from its rim.
        edge: (k, 2) m; points on the rim where the tool has an edge.  edge_radius: m, the sharpest; inf without edges.
    """

    size: float
    extent: float
    spine: np.ndarray
    edge: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    edge_radius: float = np.inf


def footprint(tool: Tool, depth: float, rotation: np.ndarray) -> Footprint:
    """Of a tool `depth` (m) into the plane z = 0, its reference point above the origin.

    Args:
        rotation: (3, 3) of the tool.

    Raises:
        ValueError: depth is not positive.
    """
    if not depth > 0.0:
        raise ValueError(f"depth is {depth} m; it must be positive")
    offset = tool.offset_along(-rotation[2])
    pose = Pose(np.array([0.0, 0.0, offset]), rotation)  # its lowest point at z = 0
    reach = max(tool.offset_along(sign * rotation[k]) for k in (0, 1) for sign in (1.0, -1.0))
    extent = 0.0
    for share in _HEIGHTS:
        x, y, gap = _section(tool, pose, share * depth, reach)
        inside = gap < 0.0
        cell = x[1, 0] - x[0, 0]
        if inside.any():
            extent = max(extent, float(np.hypot(x[inside], y[inside]).max()) + 0.5 * cell)
        if share == 0.5:
            within = distance_transform_edt(np.pad(inside, 1))[1:-1, 1:-1] * cell
            size = max(float(within.max()) - 0.5 * cell, cell)
            spine = within >= 0.8 * within.max()
            spine_points = np.stack([x[spine], y[spine]], axis=1)
            rim = inside & (within < 1.5 * cell)
            rim_points = np.stack([x[rim], y[rim]], axis=1)
            on_rim = np.column_stack([rim_points, np.full(len(rim_points), share * depth)])
    bend = 1.0 / np.maximum(np.linalg.eigvalsh(tool.distance(on_rim, pose).curvature)[:, -1], 1e-9)
    sharp = bend < EDGE * size
    radius = float(bend[sharp].min()) if sharp.any() else np.inf
    return Footprint(size, extent, spine_points, rim_points[sharp], radius)


def _section(
    tool: Tool, pose: Pose, height: float, reach: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Grid x, y and gap, each (n, n) m, closely around where the tool is cut at a height."""
    middle, half = np.zeros(2), reach
    for _ in range(12):
        x, y, gap = _grid(tool, pose, height, middle, half, _COARSE)
        # a distance changes by no more than the way gone, so no part of the section is farther from a cell's corners
        near = gap < np.sqrt(2.0) * 2.0 * half / _COARSE
        if not near.any():
            break
        low = np.array([x[near].min(), y[near].min()])
        high = np.array([x[near].max(), y[near].max()])
        tighter = 0.5 * float((high - low).max()) + 2.0 * half / _COARSE
        if tighter > 0.9 * half:
            break
        middle, half = 0.5 * (low + high), tighter
    return _grid(tool, pose, height, middle, half, _FINE)


def _grid(tool: Tool, pose: Pose, height: float, middle: np.ndarray, half: float, cells: int):
    axis = np.linspace(-half, half, cells + 1)
    x, y = np.meshgrid(middle[0] + axis, middle[1] + axis, indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), np.full(x.size, height)], axis=1)
    return x, y, tool.distance(points, pose).gap.reshape(x.shape)
