# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Where to stand to see the reach: one view, or front and back when it goes round the organ."""

from __future__ import annotations

import numpy as np

from palpate.author.report.maps import ReachMap

__all__ = ["viewpoints"]

ALL_ROUND = 0.35
"""Length of the area's mean normal below which no single view shows the reach."""


def viewpoints(reach: ReachMap) -> list[tuple[np.ndarray, np.ndarray]]:
    """Unit directions (3,) from the organ to the eye, and up (3,), one or two pairs.  z is up, as in the asset."""
    z = np.array([0.0, 0.0, 1.0])
    a, b, c = (reach.vertices[reach.triangles[:, k]] for k in range(3))
    area = np.cross(b - a, c - a).sum(axis=0) if len(reach.triangles) else z
    total = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() if len(reach.triangles) else 1.0
    mean = area / max(float(total), 1e-30)
    if np.linalg.norm(mean) < ALL_ROUND:
        front = _unit(np.array([0.35, -1.0, 0.45]))
        return [(front, z), (front * (-1.0, -1.0, 1.0), z)]
    n = _unit(mean)
    if abs(n @ z) > 0.75:  # from above (or below), tilted so that the organ's shape is seen
        return [(_unit(0.85 * n + np.array([0.2, -0.6, 0.0])), z)]
    return [(_unit(n + 0.35 * z + 0.25 * np.cross(z, n)), z)]


def _unit(v: np.ndarray) -> np.ndarray:
    return v / np.linalg.norm(v)
