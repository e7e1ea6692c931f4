# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Displacements of the whole organ under unit forces inside it: its Green's functions.

    K u_k = e_k

with K the rest stiffness of every tetrahedron, capsule and elastic support, fixed supports held, and e_k a unit force
on one component of one node.  One factorisation of the organ serves every contact and every tool: whatever a patch does
to the rest of the organ, it does through forces inside the patch, and so through a combination of these (far_modes.py).

Forces stand at nodes about LOAD_SPACING apart, chosen by the mesh alone; they are solved and kept in blocks, cubes of
BLOCK, each with the displacements that patches around it can ask for.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from palpate.fem_offline.organ import Organ

__all__ = ["BLOCK", "GreenBlock", "GreenStore", "blocks_around", "green_block"]

LOAD_SPACING = 7.0e-3
"""m; of the cubes that have one loaded node each."""
BLOCK = 2.0 * LOAD_SPACING
"""m; edge of the cubes that are solved at once."""
PATCH = 30.0e-3
"""m; patches up to this radius, of whatever tool, share blocks."""
WITHIN = 14.0e-3
"""m; how far around a contact forces stand for such patches."""

_ONE_AT_A_TIME = threading.Lock()
"""A factor's handle serves one thread at a time; presses may run in several."""

Cell = tuple[int, int, int]


@dataclass(frozen=True)
class GreenBlock:
    """Green's functions of the loads in one cube.

    Attributes:
        loaded: (L,) organ nodes that carry the unit forces.
        node: (M,) organ nodes, rising, where displacements are kept; zero at held ones.
        displacement: (M, 3, 3 L) m/N; of the loads in their order, three components each.
    """

    loaded: np.ndarray
    node: np.ndarray
    displacement: np.ndarray


GreenStore = Callable[[Cell, float, Callable[[], GreenBlock]], GreenBlock]
"""Returns the block of a cube with a sight (m), making it when it is not kept yet."""


def loaded_nodes(organ: Organ) -> np.ndarray:
    """(L,) one free node for each cube of LOAD_SPACING that has any: the one nearest the cube's middle."""
    free = np.setdiff1d(np.arange(organ.space.node_count), organ.held_nodes)
    x = organ.space.nodes[free]
    cube = np.floor(x / LOAD_SPACING)
    away = np.linalg.norm(x - (cube + 0.5) * LOAD_SPACING, axis=1)
    order = np.lexsort((away, *cube.T))
    _, first = np.unique(cube[order], axis=0, return_index=True)
    return np.sort(free[order][first])


def cells_around(organ: Organ, centre: np.ndarray, radius: float) -> Iterator[tuple[Cell, np.ndarray]]:
    """Cubes with loads within `radius` (m) of a point (3,) m, and the loaded nodes of each whole cube."""
    loaded = loaded_nodes(organ)
    x = organ.space.nodes[loaded]
    cell = np.floor(x / BLOCK).astype(int)
    near = np.linalg.norm(x - centre, axis=1) <= radius
    for index in np.unique(cell[near], axis=0):
        yield tuple(map(int, index)), loaded[(cell == index).all(axis=1)]


def sight(organ: Organ, radius: float) -> float:
    """m; how far from a block's middle patches of a radius (m) reach: half the block, the way from force to contact,
    the patch, and two tetrahedra; in steps of 10 mm."""
    a, b, _ = organ.space.edge_nodes.T
    edges = np.linalg.norm(organ.space.nodes[a] - organ.space.nodes[b], axis=1)
    patch = max(radius, PATCH)
    reach = 0.5 * np.sqrt(3.0) * BLOCK + _within(patch) + patch + 2.0 * float(np.percentile(edges, 99))
    return 10e-3 * float(np.ceil(reach / 10e-3))


def _within(radius: float) -> float:
    """m; how far around a contact the forces of a patch of this radius (m) stand."""
    return WITHIN * max(1.0, radius / PATCH)


def blocks_around(organ: Organ, centre: np.ndarray, radius: float, store: GreenStore) -> Iterator[GreenBlock]:
    """Blocks with the forces for a patch of `radius` (m) around a contact (3,) m."""
    seen = sight(organ, radius)
    for cell, loaded in cells_around(organ, centre, _within(radius)):
        yield store(cell, seen, lambda loaded=loaded: green_block(organ, loaded, seen))


def green_block(organ: Organ, loaded: np.ndarray, seen: float) -> GreenBlock:
    """Solve for unit forces on organ nodes (L,) of one cube; displacements within `seen` (m) of its middle are kept."""
    x = organ.space.nodes
    middle = (np.floor(x[loaded[0]] / BLOCK) + 0.5) * BLOCK
    node = np.flatnonzero(np.linalg.norm(x - middle, axis=1) <= seen)
    with _ONE_AT_A_TIME:
        factor, equation = organ.rest_factor
    b = np.zeros((factor.n, 3 * len(loaded)))
    b[equation.reshape(-1, 3)[loaded].ravel(), np.arange(3 * len(loaded))] = 1.0
    with _ONE_AT_A_TIME:
        solved = factor.solve(b)
    kept = equation.reshape(-1, 3)[node].ravel()
    displacement = np.where(kept[:, None] >= 0, solved[np.maximum(kept, 0)], 0.0)
    return GreenBlock(loaded, node, displacement.reshape(len(node), 3, -1))
