# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rows that press a bonded neo-Hookean layer here and in CalculiX: two codes, two meshes, two kinds of contact.

Ours is a square block of as many half-widths as CalculiX's disc has radii; both have their free sides four thicknesses
or more away, where they no longer matter (two thicknesses: 0.7 % of force).  CalculiX's penalty takes 0.3 % off.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.press import press
from palpate.fem_offline.site import open_site, patch_size
from palpate.fem_offline.tool import Sphere
from palpate.fem_offline.verification.blocks import block_organ
from palpate.fem_offline.verification.calculix import PACKAGE, CalculixMissingError
from palpate.fem_offline.verification.calculix_layer import LayerPress, calculix_force
from palpate.fem_offline.verification.hertz import sphere_force
from palpate.fem_offline.verification.row import Row, against, not_run

__all__ = ["calculix_rows", "layer_force", "tool_size_rows"]

TISSUE = NeoHookean(5400.0, 0.48)
FRICTION = 0.3
BAR = 0.02
PLACE = np.array([1.3e-3, 0.7e-3, 0.0])
"""Off the block's planes of symmetry."""


def layer_force(pressed: LayerPress, fidelity: str = "full", refinement: float = 1.0) -> np.ndarray:
    """(K,) N; the product's press of the same layer.

    Raises:
        RuntimeError: it did not converge.
    """
    h, width = pressed.thickness, pressed.width
    cells = 2 * int(np.ceil(width / h))
    organ = block_organ((2.0 * width, 2.0 * width, h), (cells, cells, 2), {0: pressed.material})
    tool, depths = Sphere(pressed.radius), np.array(pressed.depths)
    size = patch_size(tool, float(depths[-1]), radius=4.0 / 3.0 * h, refinement=refinement)
    site = open_site(organ, PLACE, tool, size, fidelity)
    record = press(site, tool, depths, friction=pressed.friction)
    if not record.converged:
        raise RuntimeError(record.reason)
    return record.force[1:]


def calculix_rows() -> Iterator[Row]:
    """A sphere of 5 and one of 10 mm, up to 0.6 R deep in a layer of 15 mm, without friction and with."""
    for friction in (0.0, FRICTION):
        for radius in (5e-3, 10e-3):
            depths = tuple(radius * np.array([0.2, 0.4, 0.6]))
            yield from _rows(LayerPress(radius, 15e-3, 60e-3, TISSUE, depths, friction))


def _rows(pressed: LayerPress) -> Iterator[Row]:
    sphere = f"sphere of {1e3 * pressed.radius:g} mm on {1e3 * pressed.thickness:g} mm"
    if pressed.friction:
        sphere += f", friction {pressed.friction:g}"
    names = [f"{sphere}, d/R = {d / pressed.radius:.2g}" for d in pressed.depths]
    try:
        expected = calculix_force(pressed)
    except CalculixMissingError as error:
        yield from (not_run(name, PACKAGE, BAR, str(error)) for name in names)
        return
    for name, ours, theirs in zip(names, layer_force(pressed), expected, strict=True):
        yield against(name, PACKAGE, float(ours), float(theirs), BAR)


def tool_size_rows() -> Iterator[Row]:
    """Four times the radius, the same 2 mm deep in a layer of 5 mm: Hertz has twice the force, whatever the depth.

    The effect is that of figure 8 in Hayward and others' account of tool geometry in force feedback; sizes are ours.
    """
    small, large = (LayerPress(radius, 5e-3, 30e-3, TISSUE, (1e-3, 2e-3)) for radius in (2.5e-3, 10e-3))
    ours = layer_force(large)[-1] / layer_force(small)[-1]
    hertz = sphere_force(1.0, large.radius, 2e-3) / sphere_force(1.0, small.radius, 2e-3)
    short = max(0.0, 1.5 * hertz - ours) / hertz
    note = f"a half space would have {hertz:.3g}"
    yield Row(
        "four times the radius on a thin layer: force ratio",
        "over 1.5 times Hertz' ratio",
        ours,
        short,
        0.0,
        note,
    )
    name = "four times the radius on a thin layer, force ratio against CalculiX"
    try:
        theirs = calculix_force(large)[-1] / calculix_force(small)[-1]
    except CalculixMissingError as error:
        yield not_run(name, PACKAGE, BAR, str(error))
        return
    yield against(
        name, PACKAGE, ours, theirs, BAR, f"ours {ours:.4g}, CalculiX {theirs:.4g}, Hertz {hertz:.4g}"
    )
