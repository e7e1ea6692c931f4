# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Fitting a sparse quadratic B-spline lattice to samples, by least squares with a little smoothing.

    minimise  sum_i v_i (s(q_i) - y_i)^2 + lambda sum (second differences of C)^2 + epsilon sum (first differences)^2

over the coefficients C that are asked for; all others are zero.  The second differences let data speak beyond its
edge as a straight line, the much weaker first differences hold what no sample touches.  B-splines are a well
conditioned basis, so conjugate gradients with the diagonal as preconditioner converge in some hundred steps, where
a sparse factorisation of a band of 100,000 coefficients takes minutes in SciPy.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from palpate.fields.lattice import BLOCK_EDGE, Lattice
from palpate.fields.lattice_stencil import stencil

__all__ = ["LatticeFit", "lattice_from_values"]


class LatticeFitError(RuntimeError):
    """The coefficients could not be found to the accuracy asked for."""


@dataclass
class LatticeFit:
    """The unknown coefficients of a lattice and the equations for them.

    Attributes:
        origin: (3,) m.
        spacing: m.
        wanted: (nx, ny, nz) bool; the coefficients that exist; a multiple of 4 along each axis.
    """

    origin: np.ndarray
    spacing: float
    wanted: np.ndarray

    def __post_init__(self) -> None:
        self.index = np.argwhere(self.wanted)
        self.column = np.full(self.wanted.shape, -1, dtype=np.int64)
        self.column[tuple(self.index.T)] = np.arange(len(self.index))

    def columns_at(self, index: np.ndarray) -> np.ndarray:
        """Unknown number (...,) of coefficients `index` (..., 3); -1 where there is none."""
        shape = np.array(self.wanted.shape)
        inside = np.all((index >= 0) & (index < shape), axis=-1)
        safe = np.clip(index, 0, shape - 1)
        return np.where(inside, self.column[safe[..., 0], safe[..., 1], safe[..., 2]], -1)

    def rows(self, points: np.ndarray) -> sparse.csr_matrix:
        """Equations (n, unknowns) whose product with C is s at `points` (n, 3) m."""
        s = stencil(points, self.origin, self.spacing)
        column = self.columns_at(s.index)
        known = column >= 0
        point = np.broadcast_to(np.arange(len(points))[:, None], column.shape)
        return sparse.csr_matrix(
            (s.value[known], (point[known], column[known])), shape=(len(points), len(self.index))
        )

    def differences(self, order: int) -> sparse.csr_matrix:
        """Differences of C of `order` 1 or 2 along each axis, wherever all of their coefficients exist."""
        weights = {1: (-1.0, 1.0), 2: (1.0, -2.0, 1.0)}[order]
        blocks = []
        for axis in range(3):
            step = np.eye(3, dtype=np.int64)[axis]
            columns = np.stack([self.columns_at(self.index + j * step) for j in range(order + 1)], axis=1)
            columns = columns[np.all(columns >= 0, axis=1)]
            row = np.repeat(np.arange(len(columns)), order + 1)
            data = np.tile(weights, len(columns))
            blocks.append(
                sparse.csr_matrix((data, (row, columns.ravel())), shape=(len(columns), len(self.index)))
            )
        return sparse.csr_matrix(sparse.vstack(blocks))

    def solve(
        self,
        points: np.ndarray,
        targets: np.ndarray,
        weights: np.ndarray,
        *,
        smoothing: float,
        hold: float,
        tolerance: float = 1e-9,
    ) -> np.ndarray:
        """Coefficients (unknowns, C) for samples.

        Args:
            points: (n, 3) m.
            targets: (n, C) values of the channels there.
            weights: (n,) v_i >= 0; 1 is an ordinary sample.
            smoothing: lambda, in units of one sample's weight.
            hold: epsilon, likewise.
            tolerance: relative residual at which conjugate gradients stop.

        Raises:
            LatticeFitError: when conjugate gradients do not reach the tolerance.
        """
        A = self.rows(points)
        N = (A.T @ A.multiply(np.asarray(weights)[:, None])).tocsr()
        for order, weight in ((1, hold), (2, smoothing)):
            D = self.differences(order)
            N = N + weight * (D.T @ D)
        N = sparse.csr_matrix(N + 1e-3 * hold * sparse.identity(N.shape[0]))
        rhs = A.T @ (np.asarray(targets) * np.asarray(weights)[:, None])
        inverse_diagonal = 1.0 / N.diagonal()
        preconditioner = sparse.diags(inverse_diagonal)
        solution = np.zeros_like(rhs)
        for channel in range(rhs.shape[1]):
            if not rhs[:, channel].any():
                continue
            x, status = sparse.linalg.cg(N, rhs[:, channel], rtol=tolerance, maxiter=20000, M=preconditioner)
            if status != 0:
                raise LatticeFitError(
                    f"lattice channel {channel}: conjugate gradients stopped at {status} steps"
                )
            solution[:, channel] = x
        return solution


def blocks_of(wanted: np.ndarray) -> np.ndarray:
    """(bx, by, bz) bool: blocks that hold any of the `wanted` (4 bx, 4 by, 4 bz) coefficients."""
    bx, by, bz = (n // BLOCK_EDGE for n in wanted.shape)
    return wanted.reshape(bx, BLOCK_EDGE, by, BLOCK_EDGE, bz, BLOCK_EDGE).any(axis=(1, 3, 5))


def lattice_from_values(
    origin: np.ndarray, spacing: float, dense: np.ndarray, present: np.ndarray, absent: np.ndarray
) -> Lattice:
    """Pack dense coefficients (4 bx, 4 by, 4 bz, C) into the blocks that are `present` (bx, by, bz).

    Absent blocks carry their negative label from `absent` (bx, by, bz).
    """
    bx, by, bz = present.shape
    blocks = np.argwhere(present)
    block_index = np.asarray(absent, dtype=np.int32).copy()
    block_index[present] = np.arange(len(blocks), dtype=np.int32)
    tiles = dense.reshape(bx, BLOCK_EDGE, by, BLOCK_EDGE, bz, BLOCK_EDGE, -1).transpose(0, 2, 4, 1, 3, 5, 6)
    return Lattice(np.asarray(origin, dtype=float), float(spacing), block_index, tiles[present].copy())
