# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Presses into blocks: what the cases of mechanics have in common.

The block is 60 x 60 x 40 mm, glued at its base, pressed 1 mm deep by a ball of 5 mm beside its middle, on a patch that
is coarser than a product's (scaling laws hold on any mesh).  The half space is that of the verification table.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from palpate.author.extremes.case import Refused, Wrong
from palpate.fem_offline.material import Linear, Material, NeoHookean
from palpate.fem_offline.organ import Organ
from palpate.fem_offline.press import PressRecord, press
from palpate.fem_offline.site import open_site, patch_size
from palpate.fem_offline.tool import Sphere, Tool
from palpate.fem_offline.verification import blocks

__all__ = ["DEPTH", "MODULUS", "RADIUS", "block", "block_force", "half_space", "pressed"]

SIZE, CELLS = (0.06, 0.06, 0.04), (4, 4, 3)
PLACE = (1.3e-3, 0.7e-3, 0.0)
"""m; off every plane of symmetry of the mesh."""
RADIUS, DEPTH, MODULUS, POISSON = 5e-3, 1e-3, 5400.0, 0.48
COARSE = 0.6
"""Refinement of patches whose law does not care."""
SOUND = 2e-2
"""Work of the force against stored energy, a share of it, in ladders of few depths."""


def block(
    material: Material, scale: float = 1.0, cells: tuple[int, int, int] = CELLS, height: float = SIZE[2]
) -> Organ:
    """The block `scale` times as large, `height` (m, before scaling) high."""
    size = (scale * SIZE[0], scale * SIZE[1], scale * height)
    return blocks.block_organ(size, cells, {0: material})


@cache
def half_space(modulus: float, poissons_ratio: float) -> Organ:
    return blocks.half_space(NeoHookean(modulus, poissons_ratio))


def pressed(
    organ: Organ,
    tool: Tool,
    depths: Sequence[float],
    *,
    fidelity: str = "near_field",
    refinement: float = COARSE,
    patch: float = 10e-3,
    place: Sequence[float] = PLACE,
    friction: float = 0.0,
) -> PressRecord:
    """One press as the product does it: carve, refine, condense, press; and what any record has to keep to.

    Args:
        depths: m, rising.  patch: m, the product's 20 mm or less.

    Raises:
        Refused: the press says why it did not come to its end.
        Wrong: it says that it did, and its own accounts do not balance.
    """
    depth = np.asarray(depths, float)
    size = patch_size(tool, float(depth[-1]), radius=patch, refinement=refinement)
    site = open_site(organ, np.asarray(place, float), tool, size, fidelity)
    record = press(site, tool, depth, friction=friction)
    if not record.converged:
        raise Refused(record.reason)
    if not (np.isfinite(record.force).all() and (record.force[1:] > 0.0).all()):
        raise Wrong(f"converged with forces {record.force} N")
    if record.reaction_error.max() > 1e-8:
        raise Wrong(f"converged with action and reaction {record.reaction_error.max():.1e} apart")
    if len(depth) > 2 and record.work_mismatch > SOUND:
        raise Wrong(f"converged with work and energy {record.work_mismatch:.1e} apart")
    return record


@cache
def block_force(
    modulus: float = MODULUS,
    poissons_ratio: float = POISSON,
    scale: float = 1.0,
    linear: bool = False,
    fidelity: str = "near_field",
) -> float:
    """N; everything `scale` times as large."""
    law = Linear if linear else NeoHookean
    organ = block(law(modulus, poissons_ratio), scale)
    place = scale * np.array(PLACE)
    record = pressed(
        organ, Sphere(scale * RADIUS), [scale * DEPTH], fidelity=fidelity, patch=scale * 10e-3, place=place
    )
    return float(record.force[-1])
