# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""How many depth knots the nodes' curves need: as few as give back the force between them.

Between knots a node's curve is what kriging makes of it (site_curves.py): the cubic through y = log(Phi / d^2.5) and
its slope; below the first knot a power of depth.  Each press's own curve is cut down to the knots and compared with
itself between them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from palpate.fields.depth_curve import DepthCurve, fit_depth_curve
from palpate.fields.node_fit import PressArrays, uniform_knots

__all__ = ["KNOT_COUNTS", "knot_error", "knots_by_error"]

KNOT_COUNTS = (5, 7, 9, 13, 17, 25, 33)
"""Tried in turn, depth 0 included."""
KNOT_ERROR = 1e-3
"""Fraction of the force at a depth; a thirtieth of the usual tolerance, and less than what fitting a press leaves."""
FELT = 0.05
"""Share of the deepest force from which errors count."""
HERTZ = 2.5
"""Exponent of depth in y; any would do."""
BETWEEN = 4
"""Depths looked at between two knots."""


def knots_by_error(presses: Sequence[PressArrays], depth_max: float) -> np.ndarray:
    """(K,) m, uniform depth knots from 0 to `depth_max`: the fewest of KNOT_COUNTS that lose at most KNOT_ERROR of
    force in nineteen of twenty presses; the most of them where none does.
    """
    curves = [
        fit_depth_curve(press.depth, press.force @ press.normal, press.energy)
        for press in presses
        if press.depth.max() >= 0.999 * depth_max
    ]
    if not curves:
        return uniform_knots(depth_max)
    for count in KNOT_COUNTS:
        knots = uniform_knots(depth_max, count)
        if np.quantile([knot_error(curve, knots) for curve in curves], 0.95) <= KNOT_ERROR:
            return knots
    return uniform_knots(depth_max, KNOT_COUNTS[-1])


def knot_error(curve: DepthCurve, knots: np.ndarray) -> float:
    """Largest error of force between `knots` (K,) m, as a fraction of the force there, where a press is felt."""
    own = knots[1:]
    energy, force, _ = curve(own)
    if np.any(energy <= 0) or np.any(force <= 0):
        return np.inf
    y = CubicHermiteSpline(own, np.log(energy / own**HERTZ), force / energy - HERTZ / own)
    step = (np.arange(BETWEEN) + 0.5) / BETWEEN
    d = (knots[:-1, None] + step * np.diff(knots)[:, None]).ravel()
    exponent = own[0] * force[0] / energy[0]
    inside = np.maximum(d, own[0])
    kept = np.exp(y(inside)) * inside**HERTZ
    slope = np.where(d < own[0], exponent / d, y(inside, 1) + HERTZ / inside)
    found = kept * np.minimum(d / own[0], 1.0) ** exponent * slope
    true = curve(d)[1]
    felt = true > FELT * force[-1]
    return float(np.abs(found / np.where(felt, true, 1.0) - 1.0)[felt].max())
