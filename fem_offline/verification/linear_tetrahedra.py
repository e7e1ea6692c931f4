# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Linear (P1) tetrahedra: the negative control, which locks where the quadratic ones must not.

They need no elements of their own.  A quadratic displacement whose mid-edge values are the means of their corners' is
a linear one,

    u_P2 = Z u_P1,   K_P1 = Z^T K_P2 Z,   f_P1 = Z^T f_P2

and its gradient is constant in each tetrahedron, so that every quadrature rule, split kappa or not, gives the same.
"""

from __future__ import annotations

from scipy import sparse

from palpate.fem_offline.quadratic_space import QuadraticSpace

__all__ = ["linear_in_quadratic"]


def linear_in_quadratic(space: QuadraticSpace) -> sparse.csr_matrix:
    """Z, (3 N, 3 P): displacement components of all nodes from those of the P corners, which come first."""
    corners = space.node_count - len(space.edge_nodes)
    a, b, mid = space.edge_nodes.T
    identity = sparse.eye(corners, format="csr")
    nodal = sparse.lil_matrix((space.node_count, corners))
    nodal[:corners] = identity
    nodal[mid] = 0.5 * (identity[a] + identity[b])
    return sparse.kron(nodal, sparse.eye(3)).tocsr()
