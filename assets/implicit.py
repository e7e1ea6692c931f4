# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Solids as functions, negative inside, and their smooth unions and differences.

    union     min_s(f, g) = min(f, g) - s h^2 / 4,       h = max(1 - |f - g| / s, 0)
    cut       max_s(f, -g) = -min_s(-f, g)

(Quilez, Smooth Minimum, 2013: the quadratic polynomial blend.)  s (m) is the width of the blend.
Ellipsoids are not exact distances: f = |p/r| (|p/r| - 1) / |p/r^2|, right to first order at the surface.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

__all__ = ["capsule", "cut", "ellipsoid", "rounded_box", "union"]


def ellipsoid(
    p: np.ndarray, centre: Sequence[float], radii: Sequence[float], tilt: Sequence[float] = (0.0, 0.0, 0.0)
) -> np.ndarray:
    """p (n, 3) m; tilt: degrees about x, then y, then z."""
    q = (p - np.asarray(centre, float)) @ _rotation(tilt)
    r = np.asarray(radii, float)
    k0 = np.linalg.norm(q / r, axis=1)
    k1 = np.linalg.norm(q / r**2, axis=1)
    return np.where(k1 > 1e-9, k0 * (k0 - 1.0) / np.maximum(k1, 1e-9), -r.min())


def capsule(
    p: np.ndarray, a: Sequence[float], b: Sequence[float], radius_a: float, radius_b: float
) -> np.ndarray:
    """A pear from a to b (m) whose radius runs linearly from radius_a to radius_b (m)."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    t = np.clip((p - a) @ (b - a) / np.sum((b - a) ** 2), 0.0, 1.0)
    return np.linalg.norm(p - a - t[:, None] * (b - a), axis=1) - (radius_a + t * (radius_b - radius_a))


def rounded_box(p: np.ndarray, low: Sequence[float], high: Sequence[float], radius: float) -> np.ndarray:
    """An exact signed distance: the box from low to high (m) with edges of `radius` (m)."""
    low, high = np.asarray(low, float), np.asarray(high, float)
    q = np.abs(p - 0.5 * (low + high)) - (0.5 * (high - low) - radius)
    outside = np.linalg.norm(np.maximum(q, 0.0), axis=1)
    return outside + np.minimum(q.max(axis=1), 0.0) - radius


def union(f: np.ndarray, g: np.ndarray, blend: float) -> np.ndarray:
    """f or g."""
    h = np.maximum(1.0 - np.abs(f - g) / blend, 0.0)
    return np.minimum(f, g) - 0.25 * blend * h * h


def cut(f: np.ndarray, g: np.ndarray, blend: float) -> np.ndarray:
    """f without g."""
    return -union(-f, g, blend)


def _rotation(tilt: Sequence[float]) -> np.ndarray:
    x, y, z = np.radians(tilt)
    about_x = np.array([[1, 0, 0], [0, np.cos(x), -np.sin(x)], [0, np.sin(x), np.cos(x)]])
    about_y = np.array([[np.cos(y), 0, np.sin(y)], [0, 1, 0], [-np.sin(y), 0, np.cos(y)]])
    about_z = np.array([[np.cos(z), -np.sin(z), 0], [np.sin(z), np.cos(z), 0], [0, 0, 1]])
    return about_z @ about_y @ about_x
