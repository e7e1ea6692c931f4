# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Blocks that verification presses: flat on top, bonded below, large or layered on purpose.

How large is large?  A block's faces change the contact's compliance by 1.1 / (E* h) at most (base bonded at depth h,
endless sides; free sides act against it), against 1 / (2 E* a) of the contact itself, so force by about a / h.
With h = 0.5 m and contacts below 3 mm that is 0.6 % at the most; grading makes so large a block cheap.  (On a block of
120 x 120 x 60 mm it is 3 % at d = 0.1 R and 7 % at 0.3 R: enough to hide that a soft solid is softer than Hertz.)
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from palpate.fem_offline.block import block
from palpate.fem_offline.material import Material
from palpate.fem_offline.organ import Organ

__all__ = ["block_organ", "half_space", "two_stiffnesses"]


def block_organ(
    size: tuple[float, float, float],
    divisions: tuple[int, int, int],
    material: dict[int, Material],
    label: Callable[[np.ndarray], np.ndarray] = lambda middles: np.zeros(len(middles), int),
    finest: float | None = None,
) -> Organ:
    """A block with its top face at z = 0, bonded at its base.

    Args:
        size: m.  divisions: cells.  finest: m, at the middle of the top face; None: uniform.
        material: of each label.
        label: of tetrahedra with these middles (n, 3) m.
    """
    mesh = block(size, divisions, finest=finest)
    middles = mesh.points[mesh.tets].mean(axis=1)
    text = f"block {size} {divisions} {finest} {material}"

    def held(points: np.ndarray) -> np.ndarray:
        return points[:, 2] < -size[2] * (1.0 - 1e-9)

    return Organ(mesh.points, mesh.tets, material, label(middles), held, _surface_of(size), text)


def half_space(material: Material) -> Organ:
    """A block of 1 m x 1 m x 0.5 m, 8 mm cells under the contact."""
    return block_organ((1.0, 1.0, 0.5), (12, 12, 6), {0: material}, finest=8e-3)


def two_stiffnesses(soft: Material, stiff: Material, border: float) -> Organ:
    """A block of 120 x 120 x 60 mm that is stiff where x > border (m, on a cell face: a multiple of 10 mm)."""
    return block_organ(
        (0.12, 0.12, 0.06),
        (12, 12, 6),
        {0: soft, 1: stiff},
        lambda middles: (middles[:, 0] > border).astype(int),
    )


def _surface_of(size: tuple[float, float, float]) -> Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]:
    """Projector to the nearest of the box's six faces, and that face's normal."""
    face = np.array([0.5 * size[0], 0.5 * size[0], 0.5 * size[1], 0.5 * size[1], size[2], 0.0])
    outward = np.kron(np.eye(3), [[-1.0], [1.0]])  # -x, x, -y, y, -z, z
    low, high = -face[::2], face[1::2]

    def project(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        away = points @ outward.T - face
        nearest = np.argmin(np.abs(away), axis=1)[:, None]
        normal = outward[nearest[:, 0]]
        moved = points - np.take_along_axis(away, nearest, axis=1) * normal
        return np.clip(moved, low, high), normal  # beyond an edge, a face's plane is none of the box

    return project
