# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Quadratic B-spline lattices in space, stored sparsely in blocks of 4 x 4 x 4 coefficients.

A lattice holds one or more scalar channels s_c(q).  With u = (q - origin) / spacing, i = floor(u) and
t = u - i per axis,

    s_c(q) = sum_{a,b,c' in 0..2} w_a(t_x) w_b(t_y) w_c'(t_z) C[i + (a, b, c'), c]
    w_0 = (1 - t)^2 / 2,   w_1 = 1/2 + t (1 - t),   w_2 = t^2 / 2

which is C1 everywhere (de Boor, A Practical Guide to Splines, 1978, uniform quadratic case).
Coefficient (i, j, k) lives in block (i // 4, j // 4, k // 4) at place (i % 4, j % 4, k % 4); so the 27
coefficients of a cell touch at most 8 blocks.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["ABSENT_INSIDE", "ABSENT_OUTSIDE", "ABSENT_UNREACHED", "BLOCK_EDGE", "Lattice"]

BLOCK_EDGE = 4
"""Coefficients along one edge of a block (count)."""

ABSENT_OUTSIDE = -1
"""Block index where nothing is stored and space is free."""
ABSENT_INSIDE = -2
"""Block index where nothing is stored and space is deeper in the tissue than any press went."""
ABSENT_UNREACHED = -3
"""Block index where nothing is stored, near a surface that the scene declares out of reach."""


@dataclass(frozen=True)
class Lattice:
    """A sparse lattice of quadratic B-spline coefficients.

    Attributes:
        origin: (3,) m, organ axes.
        spacing: m.
        block_index: (bx, by, bz) int32; >= 0: row of `coefficients`; < 0: one of the ABSENT_ values.
        coefficients: (block_count, 4, 4, 4, channel_count) float64; unit of the channel.
    """

    origin: np.ndarray
    spacing: float
    block_index: np.ndarray
    coefficients: np.ndarray

    @property
    def channel_count(self) -> int:
        return int(self.coefficients.shape[4])

    @property
    def block_count(self) -> int:
        return int(self.coefficients.shape[0])
