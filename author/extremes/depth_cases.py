# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Depth at its end: shares of a slab's thickness, against a fresh press on another, finer mesh."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from palpate.author.extremes import block_press as b
from palpate.author.extremes.case import Case, close_to
from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.tool import Sphere

__all__ = ["depth_cases"]

SHARES = (0.1, 0.4, 0.9, 1.0, 1.5)
"""Of the thickness."""


def depth_cases() -> Iterator[Case]:
    for share in SHARES:
        yield Case("depth", f"{100 * share:g} % of 10 mm", lambda s=share: _depth(s), share == 1.5)


def _depth(share: float) -> str:
    """Of a slab that is one patch, so that all of it is nonlinear."""
    height, tool = 10e-3, Sphere(10e-3)
    ladder = share * height * (np.arange(1, 4) / 3 if share < 1.0 else np.ones(1))
    forces = []
    for cells, refinement in (((4, 4, 1), 0.6), ((5, 5, 2), 0.85)):
        organ = b.blocks.block_organ((0.04, 0.04, height), cells, {0: NeoHookean(b.MODULUS, 0.48)})
        record = b.pressed(organ, tool, ladder, patch=40e-3, refinement=refinement)
        forces.append(float(record.force[-1]))
    return close_to("force against a fresh press on a finer mesh", *forces, 0.03)
