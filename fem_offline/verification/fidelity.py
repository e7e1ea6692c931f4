# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rows about the near field: the patch alone nonlinear, against every tetrahedron nonlinear on the same mesh."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.press import press
from palpate.fem_offline.site import open_site, patch_size
from palpate.fem_offline.tool import Sphere
from palpate.fem_offline.verification.blocks import block_organ
from palpate.fem_offline.verification.row import Row, against

__all__ = ["fidelity_rows"]


def fidelity_rows() -> Iterator[Row]:
    """A 5 mm sphere, 5 mm deep, in a block of 120 x 120 x 60 mm."""
    organ = block_organ((0.12, 0.12, 0.06), (12, 12, 6), {0: NeoHookean(5400.0, 0.48)})
    tool, place = Sphere(5e-3), np.array([3e-3, 2e-3, 0.0])
    depths = np.array([1.25e-3, 2.5e-3, 3.75e-3, 5e-3])
    records = {}
    for fidelity in ("near_field", "full"):
        records[fidelity] = press(
            open_site(organ, place, tool, patch_size(tool, depths[-1]), fidelity), tool, depths
        )
        if not records[fidelity].converged:
            raise RuntimeError(f"{fidelity}: {records[fidelity].reason}")
    near, full = records["near_field"], records["full"]
    worst = float(full.reaction_error.max())
    yield Row("action and reaction, full", "support forces, computed on their own side", worst, worst, 1e-8)
    for k in (2, 4):
        name = f"near field, d/R = {depths[k - 1] / tool.radius:.3g}"
        yield against(name, "every tetrahedron nonlinear", float(near.force[k]), float(full.force[k]), 0.01)
