# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Quadratic (P2) displacement on straight tetrahedra: nodes, shape functions, quadrature.

Nodes of a tetrahedron: corners 0-3, then mid-edges in the order (01)(12)(02)(03)(13)(23), as in VTK and Abaqus.
With barycentric coordinates L:  N_corner = L (2 L - 1),  N_edge = 4 L_a L_b.
(Zienkiewicz, Taylor and Zhu, The Finite Element Method: Its Basis and Fundamentals, 2013, section 6.)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = [
    "CENTRE_RULE",
    "EDGES",
    "FACE_EDGES",
    "FOUR_POINT_RULE",
    "QuadraticSpace",
    "face_shape",
    "quadratic_space",
    "shape_gradients_barycentric",
]

EDGES = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])
"""Corner pairs of the six mid-edge nodes."""

FACE_EDGES = np.array([[0, 1], [1, 2], [0, 2]])
"""Corner pairs of the three mid-edge nodes of a triangle; its nodes are corners, then (01)(12)(02)."""

_A, _B = 0.5854101966249685, 0.1381966011250105
FOUR_POINT_RULE = np.array([[_A, _B, _B, _B], [_B, _A, _B, _B], [_B, _B, _A, _B], [_B, _B, _B, _A]])
"""(4, 4) barycentric points of equal weight 1/4, exact to degree 2 (Keast 1986)."""

CENTRE_RULE = np.full((1, 4), 0.25)
"""(1, 4) the centroid."""


def shape_gradients_barycentric(points: np.ndarray) -> np.ndarray:
    """dN_a / dL_i at barycentric points.

    Args:
        points: (Q, 4).

    Returns:
        (Q, 10, 4).
    """
    L = np.asarray(points, float)
    gradients = np.zeros((len(L), 10, 4))
    for a in range(4):
        gradients[:, a, a] = 4.0 * L[:, a] - 1.0
    for e, (a, b) in enumerate(EDGES):
        gradients[:, 4 + e, a] = 4.0 * L[:, b]
        gradients[:, 4 + e, b] = 4.0 * L[:, a]
    return gradients


def face_shape(points: np.ndarray) -> np.ndarray:
    """Shape functions of a quadratic triangle.

    Args:
        points: (Q, 3) barycentric.

    Returns:
        (Q, 6): corners, then (01)(12)(02).
    """
    L = np.asarray(points, float)
    corners = L * (2.0 * L - 1.0)
    edges = np.stack([4.0 * L[:, a] * L[:, b] for a, b in FACE_EDGES], axis=1)
    return np.concatenate([corners, edges], axis=1)


@dataclass(frozen=True)
class QuadraticSpace:
    """P2 nodes of a straight tetrahedral mesh.

    Attributes:
        nodes: (N, 3) m; the mesh's points come first, in their order.
        elements: (T, 10) int32.
        corner_gradients: (T, 4, 3) 1/m; gradients of the barycentric coordinates.
        volumes: (T,) m3, positive.
        edge_nodes: (E, 3) int; sorted corner pair and its mid-edge node.
    """

    nodes: np.ndarray
    elements: np.ndarray
    corner_gradients: np.ndarray
    volumes: np.ndarray
    edge_nodes: np.ndarray

    @property
    def node_count(self) -> int:
        return len(self.nodes)

    def face_nodes(self, faces: np.ndarray) -> np.ndarray:
        """Quadratic nodes of triangles given by corner nodes.

        Args:
            faces: (B, 3) corner node indices.

        Returns:
            (B, 6) corners, then mid-edges (01)(12)(02).

        Raises:
            KeyError: an edge that the mesh does not have.
        """
        stride = int(self.edge_nodes[:, :2].max()) + 1
        keys = self.edge_nodes[:, 0].astype(np.int64) * stride + self.edge_nodes[:, 1]
        order = np.argsort(keys)
        pairs = np.sort(faces[:, FACE_EDGES].reshape(-1, 2), axis=1)
        wanted = pairs[:, 0].astype(np.int64) * stride + pairs[:, 1]
        at = np.minimum(np.searchsorted(keys[order], wanted), len(keys) - 1)
        if np.any(keys[order][at] != wanted):
            raise KeyError("a face has an edge that the tetrahedra do not have")
        mids = self.edge_nodes[order[at], 2].reshape(-1, 3)
        return np.concatenate([faces, mids], axis=1).astype(np.int32)


def quadratic_space(points: np.ndarray, tets: np.ndarray) -> QuadraticSpace:
    """Add mid-edge nodes to a tetrahedral mesh.

    Args:
        points: (P, 3) m.
        tets: (T, 4), positively oriented.

    Raises:
        ValueError: a tetrahedron whose volume is not positive.
    """
    points = np.ascontiguousarray(points, float)
    tets = np.asarray(tets)
    pairs = np.sort(tets[:, EDGES].reshape(-1, 2), axis=1)
    unique, inverse = np.unique(pairs, axis=0, return_inverse=True)
    inverse = inverse.reshape(len(tets), 6)
    mid_nodes = len(points) + np.arange(len(unique))
    nodes = np.concatenate([points, points[unique].mean(axis=1)])
    elements = np.concatenate([tets, len(points) + inverse], axis=1).astype(np.int32)
    x = points[tets]
    edges = np.swapaxes(x[:, 1:] - x[:, :1], 1, 2)
    volumes = np.linalg.det(edges) / 6.0
    if not np.all(volumes > 0.0):
        worst = int(np.argmin(volumes))
        raise ValueError(f"tetrahedron {worst} has volume {volumes[worst]:.3e} m3; it must be positive")
    inverse_edges = np.linalg.inv(edges)
    corner_gradients = np.concatenate([-inverse_edges.sum(axis=1, keepdims=True), inverse_edges], axis=1)
    edge_nodes = np.concatenate([unique, mid_nodes[:, None]], axis=1)
    return QuadraticSpace(nodes, elements, corner_gradients, volumes, edge_nodes)
