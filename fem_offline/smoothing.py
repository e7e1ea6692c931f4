# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Fairing a triangulated surface without shrinking it, within a stated distance of where it was.

    x <- x + lambda L x,   x <- x + mu L x,    L x = (mean of the neighbours) - x,  lambda = 0.5, mu = -0.53

(Taubin, A Signal Processing Approach to Fair Surface Design, SIGGRAPH 1995.)  Each vertex stays inside a
ball around its first position; what volume is left to restore goes into one offset along the normals, dV /
A.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from palpate.fem_offline.signed_distance import vertex_normals

__all__ = ["dihedral_angles", "faired", "solid_volume"]

_LAMBDA, _MU = 0.5, -0.53


def solid_volume(vertices: np.ndarray, triangles: np.ndarray) -> float:
    """m^3; positive when the closed surface is oriented outward."""
    a, b, c = np.moveaxis(vertices[triangles] - vertices[0], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def dihedral_angles(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(E,) degrees between the normals of neighbouring triangles; 0 where the surface is flat."""
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    edges = np.sort(
        np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1
    )
    face = np.tile(np.arange(len(triangles)), 3)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    edges, face = edges[order], face[order]
    pair = np.flatnonzero((edges[1:] == edges[:-1]).all(axis=1))
    cosine = np.einsum("ij,ij->i", normals[face[pair]], normals[face[pair + 1]])
    return np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))


def faired(
    vertices: np.ndarray,
    triangles: np.ndarray,
    limit: float,
    target: float = 8.0,
    passes_min: int = 0,
    passes_max: int = 60,
) -> tuple[np.ndarray, int]:
    """The smoothed vertices (V, 3) m and the number of passes.

    vertices (V, 3) m, triangles (F, 3) closed; limit: m, how far a vertex may move.  After `passes_min` it
    ends when the 95th percentile of the dihedral angles is below `target` (degrees) or falls no longer.

    A pass multiplies waves w edges long by (1 - lambda k)(1 - mu k), k = 1 - cos(2 pi / w) along a line:
    ten leave 7 % of those of four edges, the facets of a wrap, and 96 % of those of ten.
    """
    first = np.asarray(vertices, float)
    mean = _neighbour_mean(len(first), triangles)
    volume = solid_volume(first, triangles)
    x, passes, best = first, 0, np.inf
    while passes < passes_max:
        angle = float(np.percentile(dihedral_angles(x, triangles), 95))
        if passes >= passes_min and (angle < target or angle > 0.998 * best):
            break
        best = min(best, angle)
        for weight in (_LAMBDA, _MU):
            x = x + weight * (mean @ x - x)
        x = _within(first, x, limit)
        passes += 1
    if passes:
        area = 0.5 * np.linalg.norm(
            np.cross(x[triangles[:, 1]] - x[triangles[:, 0]], x[triangles[:, 2]] - x[triangles[:, 0]]), axis=1
        )
        lost = volume - solid_volume(x, triangles)
        x = _within(first, x + lost / area.sum() * vertex_normals(x, triangles), limit)
    return x, passes


def _within(first: np.ndarray, x: np.ndarray, limit: float) -> np.ndarray:
    moved = x - first
    length = np.linalg.norm(moved, axis=1, keepdims=True)
    return first + moved * np.minimum(1.0, limit / np.maximum(length, 1e-300))


def _neighbour_mean(count: int, triangles: np.ndarray) -> sparse.csr_matrix:
    i = triangles[:, [0, 1, 1, 2, 2, 0]].ravel()
    j = triangles[:, [1, 0, 2, 1, 0, 2]].ravel()
    adjacency = sparse.csr_matrix((np.ones(len(i)), (i, j)), shape=(count, count))
    adjacency.data[:] = 1.0
    return sparse.diags(1.0 / np.maximum(np.asarray(adjacency.sum(axis=1)).ravel(), 1.0)) @ adjacency
