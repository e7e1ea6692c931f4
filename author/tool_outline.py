# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A tool's surface as triangles, to look at: solids of revolution by their rounded outline, meshes as they are."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from palpate.fem_offline.placed_tool import PlacedTool
    from palpate.fem_offline.revolved import Revolved

__all__ = ["outline_of"]

AROUND, ARC = 48, 6
"""Points around the axis, and on a quarter turn of a rounding."""


def outline_of(tool: PlacedTool) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V, 3) m in the tool's frame and outward triangles (G, 3) int32."""
    vertices, triangles = _lathe(_rounded_outline(tool.solid))
    return tool.into_tool_frame(vertices), triangles


def _rounded_outline(solid: Revolved) -> np.ndarray:
    """(m, 2) m; (s, z) from the lower end of the axis to the upper one: each corner's arc of the rounding."""
    corners = solid.corners
    edges = np.diff(corners, axis=0)
    turn = [-0.5 * np.pi, *(np.arctan2(edges[:, 1], edges[:, 0]) - 0.5 * np.pi), 0.5 * np.pi]
    points = []
    for corner, start, end in zip(corners, turn[:-1], turn[1:], strict=True):
        count = max(1, int(np.ceil(ARC * (end - start) / (0.5 * np.pi))))
        angle = np.linspace(start, end, count + 1)
        points.append(corner + solid.rounding * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    outline = np.concatenate(points)
    keep = np.append(True, np.linalg.norm(np.diff(outline, axis=0), axis=1) > 1e-9)
    return outline[keep]


def _lathe(outline: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Turn an outline about z; its first and last points lie on the axis."""
    angle = 2.0 * np.pi * np.arange(AROUND) / AROUND
    ring = outline[1:-1]
    x = ring[:, :1] * np.cos(angle)
    y = ring[:, :1] * np.sin(angle)
    z = np.broadcast_to(ring[:, 1:], x.shape)
    low, high = [0.0, 0.0, outline[0, 1]], [0.0, 0.0, outline[-1, 1]]
    vertices = np.concatenate([np.stack([x, y, z], axis=-1).reshape(-1, 3), [low, high]])
    k, after = np.arange(AROUND), (np.arange(AROUND) + 1) % AROUND
    bottom, top, last = len(vertices) - 2, len(vertices) - 1, AROUND * (len(ring) - 1)
    triangles = [np.stack([np.full(AROUND, bottom), after, k], axis=1)]
    for start in range(0, last, AROUND):
        a, b, c, d = start + k, start + after, start + AROUND + after, start + AROUND + k
        triangles += [np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]
    triangles.append(np.stack([np.full(AROUND, top), last + k, last + after], axis=1))
    return vertices, np.concatenate(triangles).astype(np.int32)
