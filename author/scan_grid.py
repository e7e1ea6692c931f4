# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A regular grid on the surface that a tool may press, as seen straight on.

The view is along the mean normal of the reach; a grid point is where a line of sight meets the surface.  What faces
away or sideways is not seen, and counted.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import cKDTree

from palpate.author.organ_stage import OrganMesh
from palpate.author.sampling import ReachSamples

__all__ = ["ScanGrid", "scan_grid"]

FACING = 0.3
"""Least cosine between normal and view: a square of the grid covers at most 3.3 times its own area."""
MOST = 20_000
"""Grid points when no step is asked for, about; a finer grid shows no more."""
STEP = 1e-3
"""m; the finest step that is taken unasked."""
FEWEST = 9
"""Grid points that make a map."""
SQUARES = 4_000_000
"""Of the view that a step may ask for; each costs some hundred bytes before the tool moves at all."""


@dataclass(frozen=True)
class ScanGrid:
    """Squares of a plane and the surface under them.

    Attributes:
        step: m.  origin: (3,) m.  axes: (3, 3) rows: to the right, upwards, towards the eye; unit.
        column, row: (n,) int; a point's place in the picture.
        points, normals: (n, 3); on the surface, m and unit.
        area: (n,) m2 of surface in each square.
        unseen: share of the reach that faces away.
    """

    step: float
    origin: np.ndarray
    axes: np.ndarray
    column: np.ndarray
    row: np.ndarray
    points: np.ndarray
    normals: np.ndarray
    area: np.ndarray
    unseen: float

    @property
    def plane(self) -> np.ndarray:
        """(n, 2) m, right and up from the origin."""
        return (self.points - self.origin) @ self.axes[:2].T

    def picture(self, values: np.ndarray) -> np.ndarray:
        """(rows, columns) of values (n,); NaN where no point is."""
        shown = np.full((self.row.max() + 1, self.column.max() + 1), np.nan)
        shown[self.row, self.column] = values
        return shown

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """left, right, bottom, top of the picture, m from the origin."""
        low = self.plane.min(axis=0) - 0.5 * self.step
        high = low + self.step * np.array([self.column.max() + 1, self.row.max() + 1])
        return float(low[0]), float(high[0]), float(low[1]), float(high[1])


def scan_grid(mesh: OrganMesh, samples: ReachSamples, step: float | None = None) -> ScanGrid:
    """The grid over what `samples` allows.

    Args:
        step: m; when None STEP, or what gives MOST points on a large reach.

    Raises:
        ValueError: the step is not above 0, leaves fewer than FEWEST points, or makes more than SQUARES.
    """
    if step is not None and not step > 0.0:
        raise ValueError("is not above 0")
    points, normals = samples.points[samples.allowed], samples.normals[samples.allowed]
    eye = normals.mean(axis=0)
    eye /= np.linalg.norm(eye)
    right = np.array([1.0, 0.0, 0.0]) if abs(eye[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    right = right - (right @ eye) * eye
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(eye, right), eye])
    seen = normals @ eye > FACING
    if step is None:
        step = max(STEP, samples.spacing * float(np.sqrt(len(points) / MOST)))
    origin = points[seen].mean(axis=0)
    local = (points[seen] - origin) @ axes.T
    low, high = local[:, :2].min(axis=0), local[:, :2].max(axis=0)
    squares = float(np.prod((high - low) / step))
    if squares > SQUARES:
        raise ValueError(f"makes {squares:.2g} places")
    across, up = (np.arange(low[k] + 0.5 * step, high[k], step) for k in (0, 1))
    column, row = (index.ravel() for index in np.meshgrid(np.arange(len(across)), np.arange(len(up))))
    plane = np.stack([across[column], up[row]], axis=1)
    near = cKDTree(local[:, :2]).query(plane)[0] <= 1.5 * samples.spacing  # no holes between neighbours
    column, row, plane = column[near], row[near], plane[near]
    height = _heights(local, plane) if len(plane) > 3 and len(local) > 3 else np.zeros(len(plane))
    known = np.isfinite(height)
    column, row, plane, height = column[known], row[known], plane[known], height[known]
    foot, normal = mesh.distance.project(origin + np.column_stack([plane, height]) @ axes)
    drift = np.linalg.norm((foot - origin) @ axes[:2].T - plane, axis=1)
    facing = normal @ eye
    kept = (drift < 0.5 * step) & (facing > FACING)
    if kept.sum() < FEWEST:
        raise ValueError(f"leaves {kept.sum()} points on {1e4 * len(points) * samples.spacing**2:.2g} cm2")
    column, row = column[kept] - column[kept].min(), row[kept] - row[kept].min()
    return ScanGrid(
        step, origin, axes, column, row, foot[kept], normal[kept], step**2 / facing[kept], 1.0 - seen.mean()
    )


def _heights(local: np.ndarray, plane: np.ndarray) -> np.ndarray:
    """Heights over the plane at (n, 2), from points (m, 3) of the surface; NaN outside them."""
    return LinearNDInterpolator(local[:, :2], local[:, 2])(plane)
