# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rows about near-incompressibility in three dimensions: a short beam that bends, a confined pad that is pressed.

Both are cut as coarsely as presses are, loaded at small strain, and compared by the load's work, 2 W = f . u, with a
mixed solution of another code (mixed_block.py).  Linear tetrahedra stand beside them: they lock.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from palpate.fem_offline.block import block
from palpate.fem_offline.material import FULL_SHARE, NeoHookean
from palpate.fem_offline.quadratic_space import quadratic_space
from palpate.fem_offline.verification.loaded_body import (
    LoadedBody,
    faces_where,
    small_strain,
    uniform_load,
)
from palpate.fem_offline.verification.mixed_block import STORED, YOUNGS_MODULUS
from palpate.fem_offline.verification.row import Row

__all__ = ["beam", "locking_rows", "pad"]

LOAD = np.array([0.0, 0.0, -1e3])
"""Pa."""


def beam(poissons_ratio: float, fineness: int, full_share: float = FULL_SHARE) -> LoadedBody:
    """40 x 10 x 10 mm in 4 x 1 x 1 cells times `fineness`, bonded at one end, sheared by 1 kPa at the other."""
    n = fineness
    mesh = block((0.04, 0.01, 0.01), (4 * n, n, n))
    space = quadratic_space(mesh.points, mesh.tets)
    held = np.repeat(space.nodes[:, [0]] < -0.02 + 1e-9, 3, axis=1)
    load = uniform_load(space, faces_where(space, lambda x: x[:, 0] > 0.02 - 1e-9), LOAD)
    return LoadedBody(space, NeoHookean(YOUNGS_MODULUS, poissons_ratio), held, load, full_share=full_share)


def pad(poissons_ratio: float, fineness: int, full_share: float = FULL_SHARE) -> LoadedBody:
    """20 x 20 x 5 mm in 5 x 5 x 1 cells times `fineness`, bonded but on top, pressed by 1 kPa on 4 x 4 mm of it."""
    n = fineness
    mesh = block((0.02, 0.02, 0.005), (5 * n, 5 * n, n))
    space = quadratic_space(mesh.points, mesh.tets)
    x = space.nodes
    bonded = (np.abs(x[:, :2]).max(axis=1) > 0.01 - 1e-9) | (x[:, 2] < -0.005 + 1e-9)
    pressed = faces_where(space, lambda x: (x[:, 2] > -1e-9) & (np.abs(x[:, :2]).max(axis=1) < 2e-3 + 1e-9))
    held = np.repeat(bonded[:, None], 3, axis=1)
    load = uniform_load(space, pressed, LOAD)
    return LoadedBody(space, NeoHookean(YOUNGS_MODULUS, poissons_ratio), held, load, full_share=full_share)


def locking_rows(confined: bool) -> Iterator[Row]:
    """The beam in 8 x 2 x 2 cells; with `confined`, the pad in 10 x 10 x 2 too."""
    for name, make in (("beam", beam), ("pad", pad))[: 1 + confined]:
        for nu in (0.49, 0.4999):
            body, expected = make(nu, 2), STORED[name, nu]
            work = body.work(small_strain(body)) / expected
            linear = body.work(small_strain(body, linear=True)) / expected
            reference = "Taylor-Hood tetrahedra, scikit-fem (stored)"
            note = f"linear tetrahedra give {linear:.2f}"
            title = {"beam": "bending", "pad": "confined pad"}[name]
            yield Row(f"{title}, nu = {nu:g}", reference, work, abs(work - 1.0), 0.03, note)
