# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The organ outside a patch, linear and condensed onto the patch's interface.

With interface displacements u_I, the far tetrahedra and capsule at rest stiffness, fixed supports held and the ground
of elastic ones at rest,

    W_far(u_I) = u_I^T S u_I / 2,      S = K_II - K_If K_ff^-1 K_fI

The supports, fixed ones and the springs' ground, move as one rigid body with six motions c, which are kept too:

    u = P (u_free, c),   W = u^T K u / 2 + (u - M c)^T K_e (u - M c) / 2

(K tissue, K_e springs, M the rigid motions of every node), so that one factorisation also gives the supports' reaction
as an operator, R = dW/dc = S_cI u_I at c = 0 (force and moment about the origin): an independent side of action and
reaction.  Nothing here knows the tool: every tool that presses here shares the result.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from palpate.fem_offline.linear_solver import schur_complement
from palpate.fem_offline.organ import Organ
from palpate.fem_offline.patch import Patch
from palpate.fem_offline.quadratic_space import QuadraticSpace

__all__ = ["FarField", "condense", "interface_nodes"]


@dataclass(frozen=True)
class FarField:
    """Condensed far field.

    Attributes:
        organ_nodes: (I,) the organ's quadratic nodes on the interface, held ones left out.
        stiffness: (3 I, 3 I) N/m, node-major.
        reaction: (6, 3 I); force (N/m) and moment (N) of the supports on the far part per interface displacement.
    """

    organ_nodes: np.ndarray
    stiffness: np.ndarray
    reaction: np.ndarray


def interface_nodes(organ: Organ, patch: Patch, space: QuadraticSpace) -> tuple[np.ndarray, np.ndarray]:
    """Quadratic nodes shared by patch and organ: patch node and organ node, (I,) each."""
    if len(patch.interface_faces) == 0:
        return np.zeros(0, int), np.zeros(0, int)
    patch_nodes = space.face_nodes(patch.interface_faces)
    organ_nodes = organ.space.face_nodes(patch.organ_vertex[patch.interface_faces])
    unique, first = np.unique(patch_nodes.ravel(), return_index=True)
    return unique, organ_nodes.ravel()[first]


def condense(organ: Organ, carved: np.ndarray, organ_nodes: np.ndarray) -> FarField:
    """Condense the tetrahedra outside `carved` onto interface nodes (I,) of the organ."""
    held = organ.held_nodes
    kept = np.setdiff1d(organ_nodes, held)
    far_nodes = np.setdiff1d(np.unique(organ.space.elements[~carved]), held)
    held_far = np.intersect1d(np.unique(organ.space.elements[~carved]), held)
    free = (3 * far_nodes[:, None] + np.arange(3)).ravel()
    fixed = (3 * held_far[:, None] + np.arange(3)).ravel()
    motions = sparse.csr_matrix(_rigid_motions(organ.space.nodes))
    count = motions.shape[0]
    moved = sparse.identity(count, format="csr")[:, free]
    led = sparse.diags(np.isin(np.arange(count), fixed).astype(float)) @ motions
    prolongation = sparse.hstack([moved, led]).tocsr()
    stretch = sparse.hstack([moved, led - motions]).tocsr()
    reduced = prolongation.T @ organ.rest_stiffness(~carved) @ prolongation
    reduced = (reduced + stretch.T @ organ.spring_stiffness(~carved) @ stretch).tocsr()
    # A support that the far part does not touch leaves an empty mode; a unit diagonal keeps the factorisation going.
    empty = np.flatnonzero(reduced.diagonal() == 0.0)
    reduced = reduced + sparse.csr_matrix((np.ones(len(empty)), (empty, empty)), shape=reduced.shape)
    upper = sparse.triu(reduced).tocsr()
    upper.sort_indices()
    node_at = np.searchsorted(far_nodes, kept)
    keep = np.concatenate([(3 * node_at[:, None] + np.arange(3)).ravel(), len(free) + np.arange(6)])
    schur = schur_complement(upper, keep)
    n = 3 * len(kept)
    return FarField(kept, schur[:n, :n], schur[n:, :n])


def _rigid_motions(points: np.ndarray) -> np.ndarray:
    """(3 n, 6): three translations, then rotations about the axes through the origin."""
    motions = np.zeros((len(points), 3, 6))
    motions[:, :, :3] = np.eye(3)
    for k in range(3):
        motions[:, :, 3 + k] = np.cross(np.eye(3)[k], points)
    return motions.reshape(-1, 6)
