# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The organ outside a patch, linear and condensed onto the patch's interface.

With interface displacements u_I, the far tetrahedra, capsule and elastic supports at rest stiffness, fixed supports
held,

    W_far(u_I) = u_I^T S u_I / 2,      S = K_II - K_If K_ff^-1 K_fI

exactly, at the price of a factorisation of the organ for every patch.  It preconditions the full body, and is what the
modes of far_modes.py are measured against.
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
    """

    organ_nodes: np.ndarray
    stiffness: np.ndarray


def interface_nodes(organ: Organ, patch: Patch, space: QuadraticSpace) -> tuple[np.ndarray, np.ndarray]:
    """Quadratic nodes shared by patch and organ: patch node and organ node, (I,) each, the organ's rising."""
    if len(patch.interface_faces) == 0:
        return np.zeros(0, int), np.zeros(0, int)
    patch_nodes = space.face_nodes(patch.interface_faces)
    organ_nodes = organ.space.face_nodes(patch.organ_vertex[patch.interface_faces])
    unique, first = np.unique(organ_nodes.ravel(), return_index=True)
    return patch_nodes.ravel()[first], unique


def condense(organ: Organ, carved: np.ndarray, organ_nodes: np.ndarray) -> FarField:
    """Condense the tetrahedra outside `carved` (T,) bool onto interface nodes (I,) of the organ, rising and free."""
    far_nodes = np.setdiff1d(np.unique(organ.space.elements[~carved]), organ.held_nodes)
    free = (3 * far_nodes[:, None] + np.arange(3)).ravel()
    stiffness = organ.rest_stiffness(~carved) + organ.spring_stiffness(~carved)
    upper = sparse.triu(stiffness[free][:, free]).tocsr()
    upper.sort_indices()
    node_at = np.searchsorted(far_nodes, organ_nodes)
    return FarField(organ_nodes, schur_complement(upper, (3 * node_at[:, None] + np.arange(3)).ravel()))
