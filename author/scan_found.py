# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a map of force says about what lies under the surface, and how near that is to the truth.

The border of what is felt is the contour around the largest normal force f along which f falls off most steeply,

    argmax over levels L of the mean of |grad f| along the border of { f >= L }, the piece that holds the largest f

(the edge of an image, Marr and Hildreth, Theory of edge detection, Proc. R. Soc. B 207, 1980), which needs no level of
what is normal: on an organ the force differs from place to place without any nodule.  Contrast is f / f_0 - 1, with f_0
the lower quartile of f outside the border, up to AROUND of its radius from its centre.  Truth is the shadow of a region
of the scene: the surface straight under which the region lies.  With A found and B true, both areas of the surface,

    overlap = 2 |A n B| / (|A| + |B|)        (Dice, Measures of the amount of ecologic association, Ecology 1945)

centre error is the distance of their centroids, and a radius that of a disc of the same area.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.ndimage import binary_erosion, label

from palpate.author.organ_stage import OrganMesh
from palpate.author.scan_grid import ScanGrid

__all__ = ["Found", "against_truth", "find", "shadow"]

LEVELS = 40
"""Contours that are tried between the smallest and the largest force."""
FEWEST = 9
"""Points of a piece whose border is judged."""
QUIET_QUANTILE, AROUND = 0.25, 3.0
SHADOW_STEP, SHADOW_DEPTH = 0.5e-3, 60e-3
"""m; a region is looked for straight under the surface in such steps, down to there."""


@dataclass(frozen=True)
class Found:
    """What the map alone says.

    Attributes:
        background: N; force beside what is found.
        contrast: (n,) fraction of it.  peak: the largest.
        inside: (n,) bool.
    """

    background: float
    contrast: np.ndarray
    peak: float
    inside: np.ndarray


def find(grid: ScanGrid, force: np.ndarray) -> Found:
    """What is felt in normal forces (n,) N at the grid's points."""
    top = int(np.argmax(force))
    shown = grid.picture(force)
    up, across = (np.asarray(np.gradient(shown, grid.step, axis=axis)) for axis in (0, 1))
    slope = np.hypot(up, across)
    steepest, inside = -1.0, np.zeros(len(force), bool)
    for level in np.linspace(force.min(), force[top], LEVELS + 1)[1:-1]:
        pieces = np.asarray(label(np.nan_to_num(shown, nan=-np.inf) >= level)[0])  # type: ignore[index]
        piece = pieces == pieces[grid.row[top], grid.column[top]]
        border = slope[piece & ~binary_erosion(piece)]
        if piece.sum() >= FEWEST and np.isfinite(border).any() and np.nanmean(border) > steepest:
            steepest, inside = float(np.nanmean(border)), piece[grid.row, grid.column]
    centre = (
        np.average(grid.points[inside], axis=0, weights=grid.area[inside])
        if inside.any()
        else grid.points[top]
    )
    radius = np.sqrt(grid.area[inside].sum() / np.pi)
    beside = ~inside & (np.linalg.norm(grid.points - centre, axis=1) < AROUND * radius)
    quiet = force[beside] if beside.any() else force
    background = float(np.quantile(quiet, QUIET_QUANTILE))
    contrast = force / background - 1.0
    return Found(background, contrast, float(contrast[top]), inside)


def shadow(mesh: OrganMesh, grid: ScanGrid, region: int) -> tuple[np.ndarray, float | None]:
    """Where a region lies straight under the surface.

    Args:
        region: label, 1 for the scene's first.

    Returns:
        (n,) bool; and how far under the surface it begins, m, None where it lies under none of it.
    """
    steps = np.arange(SHADOW_STEP, SHADOW_DEPTH, SHADOW_STEP)
    inward = grid.points[:, None] - steps[None, :, None] * grid.normals[:, None]
    held = (mesh.label_at(inward.reshape(-1, 3)) == region).reshape(len(grid.points), -1)
    first = np.where(held.any(axis=1), steps[np.argmax(held, axis=1)], np.inf)
    return np.isfinite(first), float(first.min()) if np.isfinite(first).any() else None


def against_truth(grid: ScanGrid, found: np.ndarray, true: np.ndarray) -> dict[str, Any]:
    """Overlap, centre error and radii (m) of what is found (n,) bool against what is there (n,) bool."""
    area = grid.area
    both, one, other = (float(area[mask].sum()) for mask in (found & true, found, true))
    centres = [np.average(grid.points[mask], axis=0, weights=area[mask]) for mask in (found, true)]
    radii = [float(np.sqrt(size / np.pi)) for size in (one, other)]
    return {
        "overlap": 2.0 * both / (one + other),
        "centre_found": centres[0].tolist(),
        "centre_true": centres[1].tolist(),
        "centre_error": float(np.linalg.norm(centres[0] - centres[1])),
        "radius_found": radii[0],
        "radius_true": radii[1],
        "radius_error": radii[0] - radii[1],
    }
