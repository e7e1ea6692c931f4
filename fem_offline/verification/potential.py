# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rows about the lateral push: it must be the slope of the stored energy along the surface.

The tool presses 8 mm beside a border behind which the block is five times as stiff, and is pushed away from it.  At
the same height of the tool over the flat top,

    B(x) = f_x(x) = -dW/dx  ~  -(W(x + s/2) - W(x - s/2)) / s,   s = 0.5 mm

once with the tool moved over one and the same mesh (an identity of the discrete system, up to penalty, s^2 and the
ripple that faces of finite size put on B), once with a mesh made anew for each of the three places, which is what the
field's fit will meet: 0.1 % of scatter in W from mesh to mesh is 0.2 % of the normal force here.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.organ import Organ
from palpate.fem_offline.press import PressRecord, press
from palpate.fem_offline.site import open_site, patch_size
from palpate.fem_offline.tool import Sphere
from palpate.fem_offline.verification.blocks import two_stiffnesses
from palpate.fem_offline.verification.row import Row

__all__ = ["lateral_rows"]

SPACING = 0.5e-3
PLACE = np.array([2e-3, 0.7e-3, 0.0])
TOOL = Sphere(5e-3)
DEPTHS = np.array([0.75e-3, 1.5e-3, 2.25e-3, 3e-3])


def lateral_rows(anew: bool) -> Iterator[Row]:
    """On one mesh; with `anew`, on meshes of their own as well."""
    soft, stiff = NeoHookean(5400.0, 0.48), NeoHookean(27000.0, 0.48)
    organ = two_stiffnesses(soft, stiff, border=10e-3)
    middle = open_site(organ, PLACE, TOOL, patch_size(TOOL, DEPTHS[-1]))
    record = press(middle, TOOL, DEPTHS)
    shift = np.array([0.5 * SPACING, 0.0, 0.0])
    moved = [press(replace(middle, contact_point=PLACE + t * shift), TOOL, DEPTHS) for t in (-1.0, 1.0)]
    yield _row("lateral push is the energy's slope, one mesh", record, moved)
    if anew:
        moved = [_press_at(organ, PLACE + t * shift) for t in (-1.0, 1.0)]
        yield _row("lateral push is the energy's slope, meshes anew", record, moved)


def _press_at(organ: Organ, place: np.ndarray) -> PressRecord:
    return press(open_site(organ, place, TOOL, patch_size(TOOL, DEPTHS[-1])), TOOL, DEPTHS)


def _row(name: str, record: PressRecord, moved: list[PressRecord]) -> Row:
    for each in (record, *moved):
        if not each.converged:
            raise RuntimeError(each.reason)
    slope = -(moved[1].energy[-1] - moved[0].energy[-1]) / SPACING
    push, normal = float(record.force_vector[-1, 0]), float(record.force[-1])
    # 5 % of B, or 0.3 % of the normal force where B is less than 6 % of it
    off = abs(push - slope)
    note = f"B is {abs(push) / normal:.1%} of the normal force; the difference is {off / normal:.2%} of it"
    error = off / max(abs(slope), 0.06 * normal)
    return Row(name, "-dW/dx between presses 0.5 mm apart", push / slope, error, 0.05, note)
