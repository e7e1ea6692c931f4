# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A box of structured tetrahedra, finer towards a point: the body of verification tests.

Each cell is split into five tetrahedra (one in the middle, four at corners), mirrored from cell to cell, so
that faces match and the mesh is symmetric about its own grid planes.  Along each axis, with 0 <= t <= 1
uniform,

    x(t) = x0 + delta sinh(tau (t - t0)),      x(0) = 0,  x(1) = L

puts the finest spacing, delta tau / n, at the focus x0 (Roberts 1971, as in Anderson, Tannehill and Pletcher,
Computational Fluid Mechanics and Heat Transfer, section 5.6).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from palpate.fem_offline.errors import MeshError
from palpate.fem_offline.tetrahedra import TetMesh, tet_mesh

__all__ = ["block", "graded"]

_MIDDLE_AND_CORNERS = np.array(
    [
        [[0, 0, 0], [1, 1, 0], [0, 1, 1], [1, 0, 1]],
        [[1, 0, 0], [1, 1, 0], [0, 0, 0], [1, 0, 1]],
        [[0, 1, 0], [0, 0, 0], [1, 1, 0], [0, 1, 1]],
        [[0, 0, 1], [0, 1, 1], [1, 0, 1], [0, 0, 0]],
        [[1, 1, 1], [1, 0, 1], [0, 1, 1], [1, 1, 0]],
    ]
)
"""(5 tetrahedra, 4 corners, 3 axes): offsets in an even cell; odd cells are mirrored in x."""


def block(
    size: Sequence[float],
    divisions: Sequence[int],
    focus: Sequence[float] = (0.0, 0.0, 0.0),
    finest: float | Sequence[float] | None = None,
) -> TetMesh:
    """The box [-a/2, a/2] x [-b/2, b/2] x [-c, 0], its top face at z = 0.

    Args:
        size: (a, b, c) m.
        divisions: cells along each axis; even counts put nodes on the planes x = 0 and y = 0.
        focus: m, where spacing is finest, inside or on the box; the default is the middle of the top face.
        finest: m, spacing there (one for all axes, or one each); None: uniform.

    Raises:
        MeshError: not a box, no cells, focus outside, or finest coarser than a uniform grid.
    """
    lengths, counts = np.array(size, float), np.array(divisions, int)
    if lengths.shape != (3,) or (lengths <= 0.0).any() or counts.shape != (3,) or (counts < 1).any():
        raise MeshError(
            f"size {size} in {divisions} cells is no block", "block", "three positive numbers each"
        )
    low = np.array([-lengths[0] / 2, -lengths[1] / 2, -lengths[2]])
    spacing = np.broadcast_to(lengths / counts if finest is None else np.asarray(finest, float), 3)
    axes = [
        low[k] + graded(lengths[k], int(counts[k]), float(focus[k] - low[k]), spacing[k]) for k in range(3)
    ]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    cell = np.stack(np.meshgrid(*[np.arange(n) for n in counts], indexing="ij"), axis=-1).reshape(-1, 1, 1, 3)
    offset = np.broadcast_to(_MIDDLE_AND_CORNERS, (len(cell), 5, 4, 3)).copy()
    odd = cell[:, 0, 0].sum(axis=1) % 2 == 1
    offset[odd, ..., 0] = 1 - offset[odd, ..., 0]
    offset[odd] = offset[odd][:, :, [0, 2, 1, 3]]  # a mirror image turns inside out
    i, j, k = np.moveaxis((cell + offset).reshape(-1, 4, 3), 2, 0)
    return tet_mesh(points, (i * (counts[1] + 1) + j) * (counts[2] + 1) + k)


def graded(length: float, count: int, focus: float, finest: float) -> np.ndarray:
    """(count + 1,) m from 0 to `length`, closest together (`finest`, m) around `focus` (m)."""
    uniform = length / count
    if not (0.0 <= focus <= length and 0.0 < finest <= uniform * (1 + 1e-9)):
        raise MeshError(
            f"spacing {finest:g} m around {focus:g} m does not fit {count} cells over {length:g} m",
            "block",
            f"a focus on the block and at most {uniform:g} m",
        )
    t = np.linspace(0.0, 1.0, count + 1)
    if finest > uniform * (1 - 1e-6):
        return length * t
    low, high = 1e-6, 60.0
    for _ in range(80):  # the spacing at the focus falls with tau
        tau = 0.5 * (low + high)
        low, high = (tau, high) if _map(tau, length, focus)[1] * tau / count > finest else (low, tau)
    t0, delta = _map(tau, length, focus)
    x = focus + delta * np.sinh(tau * (t - t0))
    x[0], x[-1] = 0.0, length
    return x


def _map(tau: float, length: float, focus: float) -> tuple[float, float]:
    """t0 and delta of x(t), from x(0) = 0 and x(1) = L."""
    share = focus / length
    t0 = 0.5 / tau * np.log((1.0 + np.expm1(tau) * share) / (1.0 + np.expm1(-tau) * share))
    if share < 0.5:
        return t0, (length - focus) / np.sinh(tau * (1.0 - t0))
    return t0, focus / np.sinh(tau * t0)
