# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Meshes and organs at their ends: slivers, one element thick, 1 mm and 10 m.

Meshes: the same press on a good one.  Organs: s times as large, s^2 times the force.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache

import numpy as np

from palpate.author.extremes import block_press as b
from palpate.author.extremes.case import Case, close_to, must_refuse
from palpate.fem_offline.block import block as block_mesh
from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.organ import Organ
from palpate.fem_offline.tool import Sphere

__all__ = ["mesh_cases"]

SCALES = {"1 mm": 1 / 60, "6 mm": 0.1, "0.6 m": 10.0, "10 m": 1000 / 6}
"""Longest side of the organ: over that of the block."""
SLIVERS = (1e-2, 1e-4, 1e-6, 1e-9)
"""Height of a flattened tetrahedron over its usual one."""
SIZE, CELLS = (0.06, 0.06, 0.04), (6, 6, 4)


def mesh_cases() -> Iterator[Case]:
    for flat in SLIVERS:
        yield Case("mesh", f"slivers {flat:g} of their height", lambda f=flat: _sliver(f), flat == 1e-4)
    for flat in (0.0, -0.1):
        what = "flat" if not flat else "inside out"
        yield Case("mesh", f"tetrahedra {what}", lambda f=flat: must_refuse(lambda: _sliver_force(f)), True)
    for layers in (1, 2):
        yield Case("mesh", f"{layers} element{'s' * (layers > 1)} thick", lambda n=layers: _thick(n))
    yield Case("mesh", "one element thick, 40 long", lambda: _long(40))
    for name, scale in SCALES.items():
        quick = scale in (SCALES["1 mm"], SCALES["10 m"])
        yield Case("organ_size", name, lambda s=scale: _size(s), quick)


def _sound() -> Organ:
    return b.blocks.block_organ(SIZE, CELLS, {0: NeoHookean(b.MODULUS, 0.48)})


@cache
def _sound_force() -> float:
    return float(b.pressed(_sound(), Sphere(b.RADIUS), [b.DEPTH]).force[-1])


def _sliver_force(flat: float) -> float:
    """With one inner vertex far from the contact moved so near to a face that tetrahedra there are `flat` as high.

    Raises:
        MeshError: they have no volume, or are inside out.
    """
    mesh = block_mesh(SIZE, CELLS)
    inside = np.flatnonzero(
        (np.abs(mesh.points[:, :2]) < np.array([0.029, 0.029])).all(axis=1)
        & (mesh.points[:, 2] < -0.029) & (mesh.points[:, 2] > -0.039)
    )  # fmt: skip
    vertex = inside[np.argmax(mesh.points[inside, 0])]
    mine = mesh.tets[(mesh.tets == vertex).any(axis=1)]
    face = mine[0][mine[0] != vertex]
    a, b_, c = mesh.points[face]
    normal = np.cross(b_ - a, c - a)
    normal /= np.linalg.norm(normal)
    height = float((mesh.points[vertex] - a) @ normal)
    points = mesh.points.copy()
    points[vertex] -= (1.0 - flat) * height * normal
    organ = replace(_sound(), points=points, hash=f"sliver {flat}")
    return float(b.pressed(organ, Sphere(b.RADIUS), [b.DEPTH]).force[-1])


def _sliver(flat: float) -> str:
    return close_to("force against the good mesh", _sliver_force(flat), _sound_force(), 0.01)


SLAB, SLAB_PATCH = 10e-3, 15e-3
"""m; height, and radius of its patch: one and a half of the mesh's edges.  With one edge (10 mm) these forces are 2 to
8 % off, and the near field's estimate, which is of nonlinearity alone, does not see it."""


@cache
def _layer_force(layers: int, cells: int = 6) -> float:
    organ = b.block(NeoHookean(b.MODULUS, 0.48), cells=(cells, cells, layers), height=SLAB)
    press = b.pressed(organ, Sphere(b.RADIUS), [b.DEPTH], refinement=1.0, patch=SLAB_PATCH)
    return float(press.force[-1])


def _thick(layers: int) -> str:
    """Layers of the organ's own mesh; the patch under the tool is finer."""
    return close_to(
        "force against a mesh six elements thick", _layer_force(layers), _layer_force(6, 12), 0.01
    )


def _long(cells: int) -> str:
    """A strip of 600 x 15 mm, 2 mm thick."""
    law = {0: NeoHookean(b.MODULUS, 0.48)}
    forces = []
    for n, layers in ((cells, 1), (2 * cells, 2)):
        organ = b.blocks.block_organ((0.6, 0.015, 0.002), (n, 2, layers), law)
        forces.append(float(b.pressed(organ, Sphere(b.RADIUS), [4e-4], refinement=1.0).force[-1]))
    return close_to("force against a mesh twice as fine", *forces, 0.02)


def _size(scale: float) -> str:
    force = b.block_force(scale=scale) / scale**2
    bar = (
        5e-3 if scale < 1.0 else 0.02
    )  # a larger tool's patch is meshed finer away from it (site.py, COARSEST)
    return close_to("force over length squared", force, b.block_force(), bar)
