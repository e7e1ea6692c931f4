# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Piecewise cubic, C2 functions of depth on uniform intervals (`DepthCurves`): making and reading them.

A C2 piecewise cubic with g(0) = g'(0) = 0 is exactly the double integral of a piecewise linear g'', so its values
g''(m h), m = 0..M, are all there is to know, and g'' >= 0 there is g'' >= 0 everywhere.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from palpate.fields.response_field import DepthCurves

__all__ = ["curves_from_second_derivative", "curves_from_values", "energy_basis", "evaluate_curves"]


def curves_from_second_derivative(depth_end: float, second: np.ndarray) -> DepthCurves:
    """Curves with g(0) = g'(0) = 0 from `second` (R, M + 1) = g'' at the ends of M uniform intervals."""
    second = np.asarray(second, dtype=float)
    h = depth_end / (second.shape[1] - 1)
    left, right = second[:, :-1], second[:, 1:]
    slope_step = 0.5 * h * (left + right)
    slope = np.cumsum(slope_step, axis=1) - slope_step
    value_step = slope * h + h * h * (left / 3 + right / 6)
    value = np.cumsum(value_step, axis=1) - value_step
    return DepthCurves(
        float(depth_end), np.stack([value, slope, 0.5 * left, (right - left) / (6 * h)], axis=-1)
    )


def curves_from_values(depth_end: float, values: np.ndarray) -> DepthCurves:
    """C2 curves through `values` (R, M + 1) at the ends of M uniform intervals (not-a-knot ends)."""
    values = np.asarray(values, dtype=float)
    spline = CubicSpline(np.linspace(0.0, depth_end, values.shape[1]), values, axis=1)
    return DepthCurves(float(depth_end), np.moveaxis(spline.c[::-1], 0, -1).swapaxes(0, 1).copy())


def evaluate_curves(curves: DepthCurves, depth: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """g, g' and g'' of every curve, each (n, R), at `depth` (n,) m; 0 for depth <= 0, quadratic beyond the end."""
    d = np.asarray(depth, dtype=float)
    count = curves.coefficients.shape[1]
    h = curves.depth_end / count
    inside = np.clip(d, 0.0, curves.depth_end)
    m = np.minimum((inside / h).astype(np.int64), count - 1)
    x = (inside - m * h)[:, None]
    c0, c1, c2, c3 = (curves.coefficients[:, m, j].T for j in range(4))
    value = c0 + x * (c1 + x * (c2 + x * c3))
    first = c1 + x * (2 * c2 + 3 * x * c3)
    second = 2 * c2 + 6 * x * c3
    over = np.maximum(d - curves.depth_end, 0.0)[:, None]
    value = value + over * (first + 0.5 * over * second)
    first = first + over * second
    touching = (d > 0)[:, None]
    return value * touching, first * touching, second * touching


def energy_basis(depth_end: float, intervals: int, depth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Value and slope, each (n, M + 1), of the curves whose g'' is one at one interval end and zero at the others."""
    value, first, _ = evaluate_curves(curves_from_second_derivative(depth_end, np.eye(intervals + 1)), depth)
    return value, first
