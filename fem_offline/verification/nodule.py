# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rows about a stiff nodule under the surface: it must be felt above, not beside, and alike on a finer mesh.

A ball of 12 mm, ten times as stiff as the block of 100 x 100 x 40 mm around it, its top 5 mm under the surface (liver
and hepatocellular carcinoma differ by a factor of 13 in shear modulus: PMC6925591, table 1).  The 10 mm cells of the
block know nothing of it: it enters by position (Organ.label_at).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.organ import Organ
from palpate.fem_offline.press import press
from palpate.fem_offline.site import open_site, patch_size
from palpate.fem_offline.tool import Sphere
from palpate.fem_offline.verification.blocks import block_organ
from palpate.fem_offline.verification.row import Row, against

__all__ = ["nodule_block", "nodule_rows"]

TOOL, DEPTHS = Sphere(5e-3), np.array([0.5e-3, 1.25e-3, 2e-3])
MIDDLE, RADIUS = np.array([0.0, 0.0, -11e-3]), 6e-3
ABOVE, BESIDE = np.array([0.7e-3, 0.4e-3, 0.0]), np.array([30e-3, 0.4e-3, 0.0])


def nodule_block() -> Organ:
    """Label 1 is the nodule."""
    soft, stiff = NeoHookean(5400.0, 0.48), NeoHookean(54000.0, 0.48)

    def label_at(points: np.ndarray) -> np.ndarray:
        return (np.linalg.norm(points - MIDDLE, axis=1) < RADIUS).astype(int)

    organ = block_organ((0.1, 0.1, 0.04), (10, 10, 4), {0: soft, 1: stiff}, label_at)
    return replace(organ, label_at=label_at, hash=organ.hash + f" nodule {MIDDLE} {RADIUS}")


def nodule_rows(refinement: float = 1.5) -> Iterator[Row]:
    """Presses above and beside on the default mesh, and above on one `refinement` times as fine."""
    organ = nodule_block()
    above, beside, finer = _force(organ, ABOVE), _force(organ, BESIDE), _force(organ, ABOVE, refinement)
    ratio = above / beside
    name = "stiff nodule: press above over press beside"
    yield Row(name, "stiffer by a tenth or more", ratio, max(0.0, 1.1 - ratio), 0.0)
    name = f"stiff nodule: default mesh against one {refinement:g} times as fine"
    note = f"the nodule's own share: {(above - beside) / (finer - beside):.3f} of the finer mesh's"
    yield against(name, "the same press, refined", above, finer, 0.01, note)


def _force(organ: Organ, place: np.ndarray, refinement: float = 1.0) -> float:
    """N at the deepest state.  Raises RuntimeError when it did not converge."""
    record = press(
        open_site(organ, place, TOOL, patch_size(TOOL, float(DEPTHS[-1]), refinement=refinement)),
        TOOL,
        DEPTHS,
    )
    if not record.converged:
        raise RuntimeError(record.reason)
    return float(record.force[-1])
