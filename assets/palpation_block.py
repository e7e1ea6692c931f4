# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A block to palpate, 80 x 60 x 30 mm with rounded edges, and the stiff nodule that hides in it.

Axes: z up, the block stands on z = 0; m.
"""

from __future__ import annotations

import numpy as np

from palpate.assets.implicit import ellipsoid, rounded_box

__all__ = ["BLOCK_BOX", "NODULE_BOX", "NODULE_CENTRE", "NODULE_RADII", "block", "nodule"]

LOW, HIGH, EDGE_RADIUS = (-0.040, -0.030, 0.0), (0.040, 0.030, 0.030), 0.006
"""Corners and edge radius of the block, m."""

NODULE_CENTRE, NODULE_RADII, NODULE_TILT = (0.014, 0.004, 0.0175), (0.009, 0.007, 0.006), (0.0, 0.0, 25.0)
"""m, m, degrees: 18 x 14 x 12 mm, its top 6.5 mm under the block's."""

BLOCK_BOX = np.array([[-0.048, -0.038, -0.008], [0.048, 0.038, 0.038]])
NODULE_BOX = np.array([[0.000, -0.010, 0.006], [0.028, 0.018, 0.029]])
"""(2, 3) m, hold the whole surfaces."""


def block(p: np.ndarray) -> np.ndarray:
    """(n, 3) m -> (n,) m, negative inside."""
    return rounded_box(p, LOW, HIGH, EDGE_RADIUS)


def nodule(p: np.ndarray) -> np.ndarray:
    """(n, 3) m -> (n,) m, negative inside."""
    return ellipsoid(p, NODULE_CENTRE, NODULE_RADII, NODULE_TILT)
