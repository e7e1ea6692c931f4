# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Elastic supports: springs between the organ's surface and the ground (a Winkler foundation).

    traction = -k (u - g),     W = 1/2 int k |u - g|^2 dA

over the reference surface, k per area, equal in all directions; the ground's displacement g is zero, or a rigid
motion where the far field is condensed.  Integrated with six points on quadratic faces, which is exact for constant
k.  The ground's own side of action and reaction comes from the springs alone:

    force = -int k u dA,   moment about the origin = -int (X + u) x k u dA = -int k X x u dA

A face is on springs when k > 0 at its three corners; k is linear in between.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from palpate.fem_offline.contact import SIX_POINT_RULE, ContactHessian, ContactSurface, contact_surface

__all__ = ["ElasticSupport", "elastic_support"]


@dataclass(frozen=True)
class ElasticSupport:
    """Springs under some surface faces.

    Attributes:
        surface: the faces and their quadrature points.
        stiffness: (B, Q) Pa/m.
    """

    surface: ContactSurface
    stiffness: np.ndarray

    def state(self, u: np.ndarray) -> tuple[float, np.ndarray]:
        """Energy, J, and nodal forces dW/du, (N, 3) N, at u (N, 3) m."""
        moved = self.surface.points(u) - self.surface.rest
        traction = self.stiffness[:, :, None] * moved
        energy = 0.5 * float(np.sum(self.surface.weight[:, :, None] * traction * moved))
        return energy, self.surface.nodal(traction, len(u))

    def hessian(self) -> ContactHessian:
        """Face by face; constant."""
        return self.surface.hessian(self.stiffness[:, :, None, None] * np.eye(3))

    def matrix(self, node_count: int) -> sparse.csr_matrix:
        """(3 N, 3 N) N/m; second derivative over all components."""
        found = self.hessian()
        dof = (3 * self.surface.faces[found.face][:, :, None] + np.arange(3)).reshape(-1, 18)
        rows, columns = np.broadcast_arrays(dof[:, :, None], dof[:, None, :])
        count = 3 * node_count
        entries = (found.local.ravel(), (rows.ravel(), columns.ravel()))
        return sparse.coo_matrix(entries, shape=(count, count)).tocsr()

    def reaction(self, u: np.ndarray) -> np.ndarray:
        """(6,) N, N m; force of the ground on the tissue and its moment about the origin."""
        X = self.surface.rest
        moved = self.surface.points(u) - X
        load = -(self.surface.weight * self.stiffness)[:, :, None] * moved
        return np.concatenate([load.sum(axis=(0, 1)), np.cross(X, load).sum(axis=(0, 1))])


def elastic_support(
    nodes: np.ndarray, faces: np.ndarray, stiffness: Callable[[np.ndarray], np.ndarray]
) -> ElasticSupport | None:
    """Springs under those of the faces (B, 6) that lie on elastic supports; None where there are none.

    Args:
        nodes: (N, 3) m.
        stiffness: (n, 3) m -> (n,) Pa/m, zero where nothing supports elastically.
    """
    used = np.unique(faces[:, :3])
    at_node = np.zeros(len(nodes))
    at_node[used] = stiffness(nodes[used])
    corner = at_node[faces[:, :3]]
    held = (corner > 0.0).all(axis=1)
    if not held.any():
        return None
    return ElasticSupport(contact_surface(nodes, faces[held]), corner[held] @ SIX_POINT_RULE.T)
