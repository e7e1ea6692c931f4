# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A surface that moves by a known law, on the plane z = 0 under a ball of 5 mm, and a model of it.

    u = -d (1 + x_c / 50 mm) / (1 + R^2 / a^2) e_z,     a = 3 mm + d,     stuck: du/dD = 1 / (1 + (R / a)^2)

x_c is the contact point's x, so amplitudes change along the surface; a gradient of 10 1/m in x adds harmonic 1.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from palpate.fields.deformation import Deformation, ToolGap
from palpate.fields.deformation_fit import SurfacePress, fit_deformation

RADIUS, REACH = 5e-3, 25e-3
DEPTHS = np.linspace(0.0, 4e-3, 11)
UP = np.array([0.0, 0.0, 1.0])


def moved(points: np.ndarray, c: np.ndarray, depth: float) -> np.ndarray:
    """(V, 3) m."""
    r = points - c
    bell = 1.0 / (1.0 + np.sum(r * r, axis=1) / (3e-3 + depth) ** 2)
    return -depth * ((1.0 + c[0] / 50e-3 + 10.0 * r[:, 0]) * bell)[:, None] * UP


def press_at(x: float, y: float, seed: int) -> SurfacePress:
    rng = np.random.default_rng(seed)
    c = np.array([x, y, 0.0])
    R, angle = REACH * 1.2 * rng.random(1500) ** 1.5, 2 * np.pi * rng.random(1500)
    points = c + np.stack([R * np.cos(angle), R * np.sin(angle), 0 * R], axis=1)
    stuck = np.stack(
        [np.eye(3) / (1.0 + (r / (3e-3 + DEPTHS[-1])) ** 2) for r in np.linalg.norm(points - c, axis=1)]
    )
    displacement = np.array([moved(points, c, d) for d in DEPTHS])
    return SurfacePress(c, UP, DEPTHS, points, displacement, DEPTHS[-1:], stuck[None])


def ball_gap() -> ToolGap:
    step = 0.1e-3
    height, across = np.meshgrid(step * np.arange(-2, 70), step * np.arange(80), indexing="ij")
    return ToolGap(step, np.hypot(height - RADIUS, across) - RADIUS)


@cache
def known_deformation() -> Deformation:
    places = [(x, y) for x in (-8e-3, 0.0, 8e-3) for y in (-8e-3, 0.0, 8e-3)]
    presses = [press_at(x, y, i) for i, (x, y) in enumerate(places)]
    return fit_deformation(presses, 4e-3, REACH, ball_gap())
