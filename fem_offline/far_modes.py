# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The organ outside a patch in a few smooth modes of the patch's interface, from the organ's Green's functions.

Whatever happens inside a patch reaches the rest of the organ as if forces stood inside it.  Each Green's function u_k
of such a force is in equilibrium outside the patch, so its trace on the interface, Phi_k = u_k|_I, is met by the forces

    F_k = (K_far u_k)|_I          and so        S_jk = Phi_j . F_k

exactly, without condensing anything.  A singular value decomposition of the traces, weighted by how near their forces
stand to the contact, leaves the modes that a press excites.  Six rigid motions P of the interface join them, so that
forces balance to rounding; their own stiffness, of which a press sees next to nothing, is bounded from above by that of
the tetrahedra at the interface:

    u_I = Phi q + P d,   W_far = (q, d) . S (q, d) / 2,   S = [Phi^T F, F^T P; ., P^T K_II P]

The supports' reaction to each Green's function is known from the force that made it, an independent side of action and
reaction.  Nothing here knows the tool.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from palpate.fem_offline.green import GreenBlock, GreenStore, blocks_around, green_block
from palpate.fem_offline.organ import Organ

__all__ = ["FarModes", "far_modes", "rigid_motions"]

MODES_MAX = 48
LOADS_LEAST = 10
"""Fewer common forces than this inside a patch do not make its modes."""
LOADS_OWN = 48
"""Forces of a patch that has too few common ones."""
SMALLEST = 1.0e-5
"""Singular value, over the largest, below which traces repeat one another."""


@dataclass(frozen=True)
class FarModes:
    """Far field of one patch.

    Attributes:
        organ_nodes: (I,) the organ's quadratic nodes on the interface, rising, held ones left out.
        trace: (3 I, m) displacement of the interface, node-major, of each coordinate; the last six are rigid.
        stiffness: (m, m) N/m.
        reaction: (3, m) N/m; force of the supports on the far part for each coordinate.
    """

    organ_nodes: np.ndarray
    trace: np.ndarray
    stiffness: np.ndarray
    reaction: np.ndarray

    @property
    def count(self) -> int:
        return self.trace.shape[1]


def far_modes(
    organ: Organ,
    carved: np.ndarray,
    organ_nodes: np.ndarray,
    centre: np.ndarray,
    radius: float,
    store: GreenStore,
) -> FarModes:
    """Modes of the tetrahedra outside `carved` (T,) bool on interface nodes (I,) of the organ, rising and free.

    Args:
        centre: (3,) m; the contact.  radius: m; of the patch.
        store: keeps Green's functions.
    """
    kept = organ_nodes
    if not len(kept):
        return FarModes(kept, np.zeros((0, 0)), np.zeros((0, 0)), np.zeros((3, 0)))
    inside = np.unique(organ.space.elements[carved])
    touching = ~carved & np.isin(organ.space.elements, kept).any(axis=1)
    far_nodes, tissue, springs = organ.stiffness_of(touching)
    asked = np.union1d(far_nodes, inside)
    far_stiffness = tissue + springs
    near_supports = _Supports.under(organ, carved)
    traces, forces, reactions, distances = [], [], [], []
    for block, use in _forces(organ, inside, asked, centre, radius, store):
        columns = (3 * use[:, None] + np.arange(3)).ravel()
        u = _at(block, far_nodes, columns)
        force = (far_stiffness @ u).reshape(len(far_nodes), 3, -1)
        own = np.searchsorted(far_nodes, kept)
        traces.append(u.reshape(len(far_nodes), 3, -1)[own].reshape(3 * len(kept), -1))
        forces.append(force[own].reshape(3 * len(kept), -1))
        # all supports carry the unit forces; those inside the patch are not the far field's
        reactions.append(-np.tile(np.eye(3), len(use)) - near_supports.force(_at(block, inside, columns)))
        away = np.linalg.norm(organ.space.nodes[block.loaded[use]] - centre, axis=1)
        distances.append(np.repeat(away, 3))
    trace, force, reaction = (np.concatenate(parts, axis=1) for parts in (traces, forces, reactions))
    weight = 1.0 / (1.0 + (np.concatenate(distances) / (0.25 * radius)) ** 2)
    weight /= np.linalg.norm(trace, axis=0).mean()
    left, size, right = np.linalg.svd(trace * weight, full_matrices=False)
    count = min(MODES_MAX, int(np.count_nonzero(size > SMALLEST * size[0])))
    combine = weight[:, None] * right[:count].T / size[:count]
    return _with_rigid(
        organ, kept, left[:, :count], force @ combine, reaction @ combine, far_nodes, far_stiffness
    )


def _forces(
    organ: Organ, inside: np.ndarray, asked: np.ndarray, centre: np.ndarray, radius: float, store: GreenStore
) -> list[tuple[GreenBlock, np.ndarray]]:
    """Blocks that see all nodes asked for, and which of their forces stand on nodes inside the patch."""
    found = [
        (block, np.flatnonzero(np.isin(block.loaded, inside)))
        for block in blocks_around(organ, centre, radius, store)
    ]
    found = [(block, use) for block, use in found if np.isin(asked, block.node).all()]
    if sum(len(use) for _, use in found) >= LOADS_LEAST:
        return [(block, use) for block, use in found if len(use)]
    free = np.setdiff1d(inside, organ.held_nodes)
    nearest = np.argsort(np.linalg.norm(organ.space.nodes[free] - centre, axis=1), kind="stable")[:LOADS_OWN]
    own = green_block(organ, np.sort(free[nearest]), np.inf)
    return [(own, np.arange(len(own.loaded)))]


def _with_rigid(organ, kept, trace, force, reaction, far_nodes, far_stiffness) -> FarModes:
    whole = rigid_motions(organ.space.nodes[kept])
    rest = whole - trace @ (trace.T @ whole)
    rest -= trace @ (trace.T @ rest)
    rigid, upper = np.linalg.qr(rest)
    own = (3 * np.searchsorted(far_nodes, kept)[:, None] + np.arange(3)).ravel()
    ceiling = rigid.T @ (far_stiffness[own][:, own] @ rigid)
    elastic = trace.T @ force
    cross = force.T @ rigid
    stiffness = np.block([[0.5 * (elastic + elastic.T), cross], [cross.T, ceiling]])
    # a translation is trace @ a + rigid @ b; the model's own force on the interface balances the supports'
    a, b = trace.T @ whole[:, :3], upper[:, :3]
    return FarModes(
        kept,
        np.concatenate([trace, rigid], axis=1),
        stiffness,
        np.concatenate([reaction, -(a.T @ cross + b.T @ ceiling)], axis=1),
    )


@dataclass(frozen=True)
class _Supports:
    """Supports of a few tetrahedra: (3, 3 n) N/m, their force on the tissue for displacements of its nodes."""

    operator: np.ndarray | None

    @classmethod
    def under(cls, organ: Organ, tets: np.ndarray) -> _Supports:
        nodes = np.unique(organ.space.elements[tets])
        held = np.isin(nodes, organ.held_nodes)
        if not held.any() and organ.elastic is None:
            return cls(None)
        _, tissue, springs = organ.stiffness_of(tets)
        sum_held = sparse.csr_matrix(np.repeat(held, 3) * np.tile(np.eye(3), len(nodes)))
        sum_all = sparse.csr_matrix(np.tile(np.eye(3), len(nodes)))
        return cls((sum_held @ tissue - sum_all @ springs).toarray())

    def force(self, u: np.ndarray) -> np.ndarray:
        """(3, c) N for displacements u (3 n, c) m."""
        return np.zeros((3, u.shape[1])) if self.operator is None else self.operator @ u


def _at(block: GreenBlock, nodes: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """(3 n, c) m/N; displacements at organ nodes (n,) of some of a block's columns."""
    return block.displacement[np.searchsorted(block.node, nodes)][:, :, columns].reshape(-1, len(columns))


def rigid_motions(points: np.ndarray) -> np.ndarray:
    """(3 n, 6) of points (n, 3) m: three translations, then rotations about the axes through their middle, scaled to
    the points' size."""
    x = points - points.mean(axis=0)
    x = x / max(float(np.sqrt((x**2).sum(axis=1).mean())), 1e-300)
    motions = np.zeros((len(points), 3, 6))
    motions[:, :, :3] = np.eye(3)
    for k in range(3):
        motions[:, :, 3 + k] = np.cross(np.eye(3)[k], x)
    return motions.reshape(-1, 6)
