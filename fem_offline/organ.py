# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The organ as the mechanics sees it: tetrahedra, materials, supports, and the smooth surface that is pressed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from palpate.fem_offline.assembly import ElementSystem, HessianPattern, hessian_pattern
from palpate.fem_offline.material import Material
from palpate.fem_offline.quadratic_space import QuadraticSpace, quadratic_space

__all__ = ["SAMPLES", "TET_FACES", "Organ", "boundary_faces", "faces_held"]

TET_FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])
"""Corners of the four faces of a positively oriented tetrahedron, outward."""


_STEPS = [(i, j, k, 3 - i - j - k) for i in range(4) for j in range(4 - i) for k in range(4 - i - j)]
SAMPLES = (np.array(_STEPS) + 0.25) / 4.0
"""(20, 4) barycentric points spread evenly over a tetrahedron."""


def boundary_faces(tets: np.ndarray) -> np.ndarray:
    """(B, 3) outward faces that belong to one tetrahedron only."""
    faces = tets[:, TET_FACES].reshape(-1, 3)
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    return faces[np.sort(first[count == 1])]


def faces_held(points: np.ndarray, faces: np.ndarray, held: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """(B,) bool; faces whose three corners lie in the supports."""
    return held(points)[faces].all(axis=1)


@dataclass(frozen=True)
class Organ:
    """An organ ready to be pressed.

    Attributes:
        points: (P, 3) m; tets: (T, 4), positively oriented.
        material: of each region label.
        label: (T,) region label of each tetrahedron (of its middle, where `label_at` is given).
        held: predicate of fixed supports, (n, 3) m -> (n,) bool; surface faces inside it are fixed.
        project: (n, 3) m -> points on the smooth surface and outward unit normals, both (n, 3).
        hash: hex digest of mesh, materials and supports.
        label_at: (n, 3) m -> (n,) region labels.  With it, a tetrahedron cut by a region's border mixes the energies
            of the materials at SAMPLES, so that the border is where the scene says and not where the mesh is.
    """

    points: np.ndarray
    tets: np.ndarray
    material: dict[int, Material]
    label: np.ndarray
    held: Callable[[np.ndarray], np.ndarray]
    project: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
    hash: str
    label_at: Callable[[np.ndarray], np.ndarray] | None = None

    @cached_property
    def space(self) -> QuadraticSpace:
        return quadratic_space(self.points, self.tets)

    @cached_property
    def faces(self) -> np.ndarray:
        """(B, 3) outward surface faces."""
        return boundary_faces(self.tets)

    @cached_property
    def held_nodes(self) -> np.ndarray:
        """Quadratic nodes of the held faces."""
        held = self.faces[faces_held(self.points, self.faces, self.held)]
        return np.unique(self.space.face_nodes(held)) if len(held) else np.zeros(0, int)

    @property
    def materials(self) -> tuple[Material, ...]:
        """M materials, in the order of their labels."""
        return tuple(self.material[k] for k in sorted(self.material))

    def fractions_of(self, points: np.ndarray, tets: np.ndarray, label: np.ndarray) -> np.ndarray:
        """(T, M); share of each material in tetrahedra (T, 4) on points (P, 3) m with region labels (T,)."""
        share = np.eye(len(self.material))
        if self.label_at is None or len(self.material) == 1:
            return share[np.searchsorted(sorted(self.material), label)]
        x = np.einsum("sk,tkj->tsj", SAMPLES, points[tets])
        found = self.label_at(x.reshape(-1, 3)).reshape(len(tets), len(SAMPLES))
        return share[np.searchsorted(sorted(self.material), found)].mean(axis=1)

    @cached_property
    def fractions(self) -> np.ndarray:
        """(T, M); of the organ's own tetrahedra."""
        return self.fractions_of(self.points, self.tets, self.label)

    @cached_property
    def pattern(self) -> HessianPattern:
        """Pattern over all displacement components, held ones included."""
        return hessian_pattern(self.space.elements, np.zeros(3 * self.space.node_count, bool), [])

    def rest_stiffness(self, tets: np.ndarray) -> sparse.csr_matrix:
        """Small-strain stiffness of some tetrahedra over all components (3 N, 3 N), symmetric, N/m.

        Args:
            tets: (T,) bool; which tetrahedra take part.
        """
        system = ElementSystem(self.space, self.materials, self.fractions * tets[:, None])
        upper = self.pattern.matrix(system.hessian(np.zeros((self.space.node_count, 3)), self.pattern))
        return (upper + sparse.triu(upper, 1).T).tocsr()
