# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A liver-like organ: two lobes, a thin left edge, a gallbladder bed, a domed upper and a hollow lower face.

Axes: x to the patient's left, y to the back, z to the head; m.  Shapes and sizes are drawn by eye after the
proportions of a liver; nothing is taken from a scan.
"""

from __future__ import annotations

import numpy as np

from palpate.assets.implicit import capsule, cut, ellipsoid, union

__all__ = ["BOX", "liver"]

BOX = np.array([[-0.112, -0.085, -0.100], [0.128, 0.085, 0.085]])
"""(2, 3) m, holds the whole organ."""

_SCALE = 0.978
"""The shape below holds 1.6 L; an adult liver about 1.5 L."""


def liver(p: np.ndarray) -> np.ndarray:
    """(n, 3) m -> (n,) m, negative inside."""
    p = p / _SCALE
    # Diaphragmatic side: a big right dome that runs out into a wide, flat left lobe.
    f = ellipsoid(p, (-0.034, 0.003, -0.004), (0.066, 0.062, 0.066), (0, -12, 0))
    f = union(f, ellipsoid(p, (-0.048, 0.000, -0.042), (0.046, 0.050, 0.052)), 0.03)
    f = union(f, ellipsoid(p, (0.042, -0.012, 0.026), (0.074, 0.050, 0.029), (0, 12, 6)), 0.045)
    # Visceral side: hollowed out by stomach, bowel and kidney, leaving a thin edge in front and on the left.
    f = cut(f, ellipsoid(p, (0.098, 0.022, -0.062), (0.098, 0.094, 0.074), (0, 26, 0)), 0.012)
    f = cut(f, ellipsoid(p, (0.004, 0.030, -0.114), (0.096, 0.110, 0.066), (20, -24, 0)), 0.008)
    f = cut(f, ellipsoid(p, (-0.058, 0.085, -0.052), (0.036, 0.038, 0.052), (-12, 0, 0)), 0.014)
    # Gallbladder bed under the right lobe, and the groove of the vena cava at the back.
    f = cut(f, capsule(p, (-0.026, -0.042, -0.083), (-0.008, 0.022, -0.055), 0.0135, 0.0085), 0.010)
    f = cut(f, capsule(p, (0.012, 0.070, -0.070), (0.004, 0.066, 0.080), 0.015, 0.015), 0.014)
    # The falciform ligament's line over the front, ending in a notch of the edge.
    x, y, z = p.T
    front = 1.0 / (1.0 + np.exp((y + 0.005) / 0.010))
    f = f + 0.0035 * front * np.exp(-(((x - 0.022 - 0.08 * (z - 0.02)) / 0.007) ** 2))
    f = cut(f, capsule(p, (0.019, -0.066, -0.020), (0.021, -0.030, -0.012), 0.010, 0.007), 0.010)
    return _SCALE * f
