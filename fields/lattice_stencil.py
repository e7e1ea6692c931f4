# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a quadratic B-spline lattice is at a point: 27 coefficients, their weights, and the weights' derivatives.

With u = (q - origin) / h, i = floor(u), t = u - i (lattice.py gives the sum), per axis

    w = ((1 - t)^2 / 2, 1/2 + t (1 - t), t^2 / 2),   h w' = (t - 1, 1 - 2 t, t),   h^2 w'' = (1, -2, 1)

Value and gradient are continuous; second derivatives jump between cells.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.fields.lattice import BLOCK_EDGE, Lattice

__all__ = ["LatticeSample", "Stencil", "block_and_place", "sample_lattice", "stencil"]

STENCIL_OFFSETS = np.stack(np.meshgrid(*[np.arange(3)] * 3, indexing="ij"), axis=-1).reshape(27, 3)
"""(27, 3) offsets of a cell's coefficients from the cell's index, last axis fastest."""


@dataclass(frozen=True)
class Stencil:
    """The 27 coefficients that make s(q) at n points.

    Attributes:
        index: (n, 27, 3) integer coefficient indices (may lie outside the lattice).
        value: (n, 27) weights.
        gradient: (n, 27, 3) 1/m; derivative of the weights along x, y, z.
        hessian: (n, 27, 3, 3) 1/m^2, or None when not asked for.
    """

    index: np.ndarray
    value: np.ndarray
    gradient: np.ndarray
    hessian: np.ndarray | None


@dataclass(frozen=True)
class LatticeSample:
    """A lattice's channels at n points; C channels; units of the channel per m^order.

    Attributes:
        value: (n, C).
        gradient: (n, C, 3).
        hessian: (n, C, 3, 3), or None when not asked for.
        present: (n,) bool; True where every block under the stencil is stored.  Absent coefficients count as 0.
    """

    value: np.ndarray
    gradient: np.ndarray
    hessian: np.ndarray | None
    present: np.ndarray


def stencil(points: np.ndarray, origin: np.ndarray, spacing: float, *, hessian: bool = False) -> Stencil:
    """Coefficients and weights at `points` (n, 3) m of a lattice with `origin` (3,) m and `spacing` m."""
    u = (np.asarray(points, dtype=float) - origin) / spacing
    cell = np.floor(u)
    t = u - cell
    w = np.stack([0.5 * (1 - t) ** 2, 0.5 + t * (1 - t), 0.5 * t * t], axis=-1)  # (n, axis, 3)
    dw = np.stack([t - 1, 1 - 2 * t, t], axis=-1) / spacing
    ddw = np.broadcast_to(np.array([1.0, -2.0, 1.0]) / spacing**2, w.shape)

    def product(*factors: np.ndarray) -> np.ndarray:
        x, y, z = (factor[:, axis] for axis, factor in enumerate(factors))
        return (x[:, :, None, None] * y[:, None, :, None] * z[:, None, None, :]).reshape(len(u), 27)

    gradient = np.stack([product(dw, w, w), product(w, dw, w), product(w, w, dw)], axis=-1)
    second = None
    if hessian:
        xx, yy, zz = product(ddw, w, w), product(w, ddw, w), product(w, w, ddw)
        xy, xz, yz = product(dw, dw, w), product(dw, w, dw), product(w, dw, dw)
        second = np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=-1).reshape(len(u), 27, 3, 3)
    index = cell.astype(np.int64)[:, None, :] + STENCIL_OFFSETS
    return Stencil(index, product(w, w, w), gradient, second)


def block_and_place(lattice: Lattice, index: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where coefficients are stored.

    Args:
        lattice: the lattice.
        index: (..., 3) integer coefficient indices.

    Returns:
        Block row (...,), negative where absent or outside the lattice, and place (...,) in 0..63 in the block.
    """
    block, place = index // BLOCK_EDGE, index % BLOCK_EDGE
    shape = np.array(lattice.block_index.shape)
    inside = np.all((block >= 0) & (block < shape), axis=-1)
    safe = np.clip(block, 0, shape - 1)
    row = np.where(inside, lattice.block_index[safe[..., 0], safe[..., 1], safe[..., 2]], -1)
    return row, (place[..., 0] * BLOCK_EDGE + place[..., 1]) * BLOCK_EDGE + place[..., 2]


def sample_lattice(lattice: Lattice, points: np.ndarray, *, hessian: bool = False) -> LatticeSample:
    """All channels of `lattice` at `points` (n, 3) m, with gradient and, when asked for, second derivatives."""
    points = np.asarray(points, dtype=float)
    finite = np.all(np.isfinite(points), axis=1)
    s = stencil(
        np.where(finite[:, None], points, lattice.origin), lattice.origin, lattice.spacing, hessian=hessian
    )
    row, place = block_and_place(lattice, s.index)
    stored = row >= 0
    table = lattice.coefficients.reshape(-1, lattice.channel_count)
    if len(table) == 0:
        table = np.zeros((1, lattice.channel_count))
    c = table[np.where(stored, row * BLOCK_EDGE**3 + place, 0)] * stored[..., None]  # (n, 27, C)
    return LatticeSample(
        value=np.einsum("ns,nsc->nc", s.value, c),
        gradient=np.einsum("nsa,nsc->nca", s.gradient, c),
        hessian=None if s.hessian is None else np.einsum("nsab,nsc->ncab", s.hessian, c),
        present=stored.all(axis=1) & finite,
    )
