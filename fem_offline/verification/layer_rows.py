# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rows that press spheres into bonded layers as thin as the contact is wide, against the layer's integral equation.

The equation is linear; a press is not.  d = R / 1000 keeps the strain (about d / a = 3 %) and the layer's thinning
(d / h, at most 3 %) small, and what they leave is told apart from error by the deepest of the smaller depths: the
ratio's change from d / 4 to d is of second order.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.press import PressSettings, press
from palpate.fem_offline.site import open_site, patch_size
from palpate.fem_offline.tool import Sphere
from palpate.fem_offline.verification.blocks import block_organ
from palpate.fem_offline.verification.bonded_layer import BondedLayer
from palpate.fem_offline.verification.row import Row, against

__all__ = ["LayerCase", "layer_rows", "press_layer"]

RADIUS, DEPTH = 0.05, 5e-5
"""m."""
HERTZ_CONTACT = float(np.sqrt(RADIUS * DEPTH))
"""m; a, the length that thicknesses are given in."""


@dataclass(frozen=True)
class LayerCase:
    """One layer: thickness in Hertz contact radii, and Poisson's ratio."""

    thickness: float
    poissons_ratio: float


CASES = (LayerCase(4.0, 0.48), LayerCase(2.0, 0.3), LayerCase(1.0, 0.48))


def press_layer(case: LayerCase) -> tuple[np.ndarray, np.ndarray]:
    """Forces of the press and of the equation, both (4,) N, at a quarter, half, three quarters and all of DEPTH.

    Raises:
        RuntimeError: the press did not converge.
    """
    a, E, nu = HERTZ_CONTACT, 5400.0, case.poissons_ratio
    h = case.thickness * a
    width = 5.0 * max(h, a) + 2.0 * a
    cells = 2 * int(np.ceil(width / h))
    organ = block_organ((2.0 * width, 2.0 * width, h), (cells, cells, 2), {0: NeoHookean(E, nu)})
    tool, depths = Sphere(RADIUS), DEPTH * np.array([0.25, 0.5, 0.75, 1.0])
    site = open_site(organ, a * np.array([0.1, 0.07, 0.0]), tool, patch_size(tool, DEPTH, radius=3.5 * a))
    record = press(site, tool, depths, PressSettings(penalty=30.0 / a))
    if not record.converged:
        raise RuntimeError(record.reason)
    layer = BondedLayer(E, nu, h)
    return record.force[1:], np.array([layer.sphere(RADIUS, float(d)).force for d in depths])


def layer_rows() -> Iterator[Row]:
    """Each case at its deepest."""
    for case in CASES:
        ours, expected = press_layer(case)
        name = f"sphere on a bonded layer, h = {case.thickness:g} a, nu = {case.poissons_ratio:g}"
        note = f"at a quarter of the depth {ours[0] / expected[0]:.4f}"
        yield against(
            name, "integral equation (Hayes 1972)", float(ours[-1]), float(expected[-1]), 0.03, note
        )
