# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A function on a grid as a tensor product of cubic B-splines: C2, with its own exact gradient and Hessian.

    f(x) = sum_ijk c_ijk B(x/s - i) B(y/s - j) B(z/s - k),   B the centred cubic B-spline

    B on the four nodes around a point at t in [0, 1):  (1-t)^3 / 6,  (3t^3 - 6t^2 + 4) / 6,
                                                        (-3t^3 + 3t^2 + 3t + 1) / 6,  t^3 / 6

The coefficients interpolate the samples (Unser, Splines: a perfect fit for signal and image processing, IEEE Signal
Processing Magazine 16:22-38, 1999).  Smooth functions come out to fourth order in the spacing s; a kink is rounded
over about one spacing, with an overshoot of a few percent of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import spline_filter

__all__ = ["SplineGrid", "spline_grid"]

RIM = 2
"""Grid points at each side where the interpolation feels the grid's end: nothing is evaluated there."""

# powers of t, rising, of the four B-splines and of their first and second derivatives: (4 splines, 4 powers)
_VALUE = np.array([[1, -3, 3, -1], [4, 0, -6, 3], [1, 3, 3, -3], [0, 0, 0, 1]]) / 6.0
_SLOPE = np.array([[-3, 6, -3, 0], [0, -12, 9, 0], [3, 6, -9, 0], [0, 0, 3, 0]]) / 6.0
_BEND = np.array([[6, -6, 0, 0], [-12, 18, 0, 0], [6, -18, 0, 0], [0, 6, 0, 0]]) / 6.0


@dataclass(frozen=True)
class SplineGrid:
    """A cubic spline on a regular grid.

    Attributes:
        origin: (3,) m of the grid's first point.  spacing: s, m, the same in all directions.
        coefficients: (a, b, c).
    """

    origin: np.ndarray
    spacing: float
    coefficients: np.ndarray

    def holds(self, points: np.ndarray) -> np.ndarray:
        """(n,) bool; points (n, 3) m that can be evaluated."""
        t = (points - self.origin) / self.spacing
        return np.all((t >= RIM) & (t < np.array(self.coefficients.shape) - 1 - RIM), axis=1)

    def __call__(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Value (n,), gradient (n, 3) 1/m and Hessian (n, 3, 3) 1/m2 at points (n, 3) m that it holds."""
        t = (points - self.origin) / self.spacing
        cell = np.floor(t).astype(np.int64)
        powers = (t - cell)[:, :, None] ** np.arange(4)  # (n, 3 axes, 4 powers)
        # (n, 3 axes, 4 splines, 3: value, slope, bend)
        basis = np.stack([powers @ part.T for part in (_VALUE, _SLOPE, _BEND)], axis=3)
        i, j, k = (cell[:, axis, None] + np.arange(-1, 3) for axis in range(3))
        local = self.coefficients[i[:, :, None, None], j[:, None, :, None], k[:, None, None, :]]
        z = np.einsum("nijk,nkr->nijr", local, basis[:, 2])
        y = np.einsum("nijr,njq->niqr", z, basis[:, 1])
        f = np.einsum("niqr,nip->npqr", y, basis[:, 0])  # derivatives of order p, q, r along x, y, z
        gradient = np.stack([f[:, 1, 0, 0], f[:, 0, 1, 0], f[:, 0, 0, 1]], axis=1) / self.spacing
        xx, yy, zz = f[:, 2, 0, 0], f[:, 0, 2, 0], f[:, 0, 0, 2]
        xy, xz, yz = f[:, 1, 1, 0], f[:, 1, 0, 1], f[:, 0, 1, 1]
        rows = [np.stack(row, axis=1) for row in ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))]
        return f[:, 0, 0, 0], gradient, np.stack(rows, axis=1) / self.spacing**2


def spline_grid(samples: np.ndarray, origin: np.ndarray, spacing: float) -> SplineGrid:
    """Interpolate samples (a, b, c) on a grid from origin (3,) m with a spacing in m.

    Raises:
        ValueError: fewer than 6 samples along an axis.
    """
    if min(samples.shape) < 2 * RIM + 2:
        raise ValueError(
            f"a spline needs at least {2 * RIM + 2} samples along each axis, not {samples.shape}"
        )
    return SplineGrid(np.asarray(origin, float), float(spacing), spline_filter(samples, 3, mode="mirror"))
