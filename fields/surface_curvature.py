# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Curvature of the organ where a tool touches, from the contact geometry.

At a point q at distance s = phi(q) from the surface point c, the normal field n = grad phi has the derivative
H(q) = dn/dq, and on the surface W = dn/dc (shape operator; a sphere of radius R has W = 1/R along the surface).
Parallel surfaces (do Carmo, Differential Geometry of Curves and Surfaces, 1976, sec. 3-5, ex. 11) relate them:

    dq = (I + s W) dc  along the surface,   H = W (I + s W)^-1,   W = H (I - s H)^-1

Hence the gradient of a potential over q becomes one over surface points as  d/dc = (I + s W) d/dq.
The normal is differenced over one lattice spacing, because the second derivatives of a quadratic spline jump.
"""

from __future__ import annotations

import numpy as np

from palpate.fields.lattice_stencil import sample_lattice
from palpate.fields.response_field import ContactGeometry

__all__ = ["foot_points", "normal_derivative", "shape_operator", "tangent_frame"]

SMALLEST_STRETCH = 0.2
"""Least eigenvalue of I + s W that is believed: nearer to a concave surface's focal point, c(q) is not a function."""


def unit_normals(geometry: ContactGeometry, points: np.ndarray) -> np.ndarray:
    gradient = sample_lattice(geometry.signed_distance, points).gradient[:, 0]
    return gradient / np.maximum(np.linalg.norm(gradient, axis=1, keepdims=True), 1e-12)


def foot_points(geometry: ContactGeometry, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nearest surface points (n, 3) m and unit normals (n, 3) of reference `points` (n, 3) m."""
    sample = sample_lattice(geometry.signed_distance, points)
    gradient = sample.gradient[:, 0]
    normal = gradient / np.maximum(np.linalg.norm(gradient, axis=1, keepdims=True), 1e-12)
    return points - sample.value * normal, normal


def normal_derivative(geometry: ContactGeometry, points: np.ndarray, step: float | None = None) -> np.ndarray:
    """H(q), (n, 3, 3) 1/m, symmetric and tangential, at `points` (n, 3) m in the band, differenced over `step` m."""
    h = geometry.signed_distance.spacing if step is None else step
    columns = [
        (unit_normals(geometry, points + h * e) - unit_normals(geometry, points - h * e)) / (2 * h)
        for e in np.eye(3)
    ]
    H = np.stack(columns, axis=-1)
    n = unit_normals(geometry, points)
    P = np.eye(3) - n[:, :, None] * n[:, None, :]
    return P @ (0.5 * (H + H.swapaxes(1, 2))) @ P


def shape_operator(geometry: ContactGeometry, points: np.ndarray) -> np.ndarray:
    """W, (n, 3, 3) 1/m, at the surface points below `points` (n, 3) m, which lie in the band."""
    s = sample_lattice(geometry.signed_distance, points).value[:, 0]
    eigenvalue, vector = np.linalg.eigh(normal_derivative(geometry, points))
    # 1 / (1 - s H) = 1 + s W; keep it at or above SMALLEST_STRETCH and below its inverse.
    stretch = np.clip(1.0 - s[:, None] * eigenvalue, SMALLEST_STRETCH, 1.0 / SMALLEST_STRETCH)
    return (vector * (eigenvalue / stretch)[:, None, :]) @ vector.swapaxes(1, 2)


def tangent_frame(normal: np.ndarray) -> np.ndarray:
    """Two unit tangents (n, 2, 3), deterministic, orthogonal to each `normal` (n, 3)."""
    normal = np.asarray(normal, dtype=float)
    helper = np.eye(3)[np.argmin(np.abs(normal), axis=1)]
    first = np.cross(normal, helper)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([first, np.cross(normal, first)], axis=1)
