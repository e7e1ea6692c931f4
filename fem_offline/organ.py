# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The organ as the mechanics sees it: tetrahedra, materials, supports, and the smooth surface that is pressed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from palpate.fem_offline.assembly import ElementSystem
from palpate.fem_offline.elastic_support import ElasticSupport, elastic_support
from palpate.fem_offline.errors import SupportError
from palpate.fem_offline.hessian_pattern import HessianPattern, hessian_pattern
from palpate.fem_offline.linear_solver import Factor
from palpate.fem_offline.material import Material
from palpate.fem_offline.membrane import Capsule, Membrane
from palpate.fem_offline.quadratic_space import QuadraticSpace, quadratic_space
from palpate.fem_offline.tissue import Tissue

__all__ = ["SAMPLES", "TET_FACES", "Organ", "boundary_faces", "faces_held"]

TET_FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])
"""Corners of the four faces of a positively oriented tetrahedron, outward."""


_STEPS = [(i, j, k, 3 - i - j - k) for i in range(4) for j in range(4 - i) for k in range(4 - i - j)]
SAMPLES = (np.array(_STEPS) + 0.25) / 4.0
"""(20, 4) barycentric points spread evenly over a tetrahedron."""


def boundary_faces(tets: np.ndarray) -> np.ndarray:
    """(B, 3) outward faces that belong to one tetrahedron only."""
    return _boundary(tets)[0]


def _boundary(tets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Boundary faces (B, 3) and the tetrahedra (B,) that they belong to."""
    faces = tets[:, TET_FACES].reshape(-1, 3)
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    single = np.sort(first[count == 1])
    return faces[single], single // len(TET_FACES)


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
        hash: hex digest of mesh, materials and their scale, capsule and supports.
        label_at: (n, 3) m -> (n,) region labels.  With it, a tetrahedron cut by a region's border mixes the energies
            of the materials at SAMPLES, so that the border is where the scene says and not where the mesh is.
        capsule: membrane that covers the whole surface, or None.
        elastic: stiffness of elastic supports, (n, 3) m -> (n,) Pa/m, zero where there are none; None: nowhere.
        scale: times the stored energy of whatever material is there, (n, 3) m -> (n,), above 0; None: 1.  A tetrahedron
            has the mean over SAMPLES; the capsule is not scaled.
    """

    points: np.ndarray
    tets: np.ndarray
    material: dict[int, Material]
    label: np.ndarray
    held: Callable[[np.ndarray], np.ndarray]
    project: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
    hash: str
    label_at: Callable[[np.ndarray], np.ndarray] | None = None
    capsule: Capsule | None = None
    elastic: Callable[[np.ndarray], np.ndarray] | None = None
    scale: Callable[[np.ndarray], np.ndarray] | None = None

    @cached_property
    def space(self) -> QuadraticSpace:
        return quadratic_space(self.points, self.tets)

    @cached_property
    def _surface(self) -> tuple[np.ndarray, np.ndarray]:
        return _boundary(self.tets)

    @property
    def faces(self) -> np.ndarray:
        """(B, 3) outward surface faces."""
        return self._surface[0]

    def faces_of(self, tets: np.ndarray) -> np.ndarray:
        """(B', 3) corners of the organ's surface faces that belong to tetrahedra (T,) bool."""
        return self.faces[tets[self._surface[1]]]

    def surface_of(self, tets: np.ndarray) -> np.ndarray:
        """(B', 6) quadratic nodes of the organ's surface faces that belong to tetrahedra (T,) bool."""
        return self.space.face_nodes(self.faces_of(tets))

    def thickness(self, point: np.ndarray, normal: np.ndarray) -> float:
        """m of tissue below a surface point (3,) m, along -normal: where that ray first leaves the tetrahedra.

        (Moeller and Trumbore, Fast, minimum storage ray/triangle intersection, 1997.)  Infinite where it never does,
        which only happens at the body's edge.
        """
        a, b, c = np.moveaxis(self.points[self.faces], 1, 0)
        ray = -np.asarray(normal, float)
        area = np.cross(b - a, c - a)
        leaving = area @ ray > 1e-6 * np.linalg.norm(
            area, axis=1
        )  # faces along the ray are never left through
        a, e1, e2 = a[leaving], (b - a)[leaving], (c - a)[leaving]
        h = np.cross(ray, e2)
        scale = 1.0 / np.einsum("ij,ij->i", e1, h)
        s = point - a
        u = scale * np.einsum("ij,ij->i", s, h)
        q = np.cross(s, e1)
        v = scale * (q @ ray)
        t = scale * np.einsum("ij,ij->i", e2, q)
        hit = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1.0 + 1e-9) & (t > 0.0)
        return float(t[hit].min()) if hit.any() else np.inf

    @cached_property
    def held_nodes(self) -> np.ndarray:
        """Quadratic nodes of the held faces."""
        held = self.faces[faces_held(self.points, self.faces, self.held)]
        return np.unique(self.space.face_nodes(held)) if len(held) else np.zeros(0, int)

    @property
    def materials(self) -> tuple[Material, ...]:
        """M materials, in the order of their labels."""
        return tuple(self.material[k] for k in sorted(self.material))

    def scale_at(self, point: np.ndarray) -> float:
        """What multiplies the stored energy at point (3,) m."""
        return 1.0 if self.scale is None else float(self.scale(point[None])[0])

    def fractions_of(self, points: np.ndarray, tets: np.ndarray, label: np.ndarray) -> np.ndarray:
        """(T, M); share of each material in tetrahedra (T, 4) on points (P, 3) m with region labels (T,).

        Energies are linear in it, so it carries the scale: a row adds up to the tetrahedron's.
        """
        share = np.eye(len(self.material))
        whole = self.label_at is None or len(self.material) == 1
        if whole and self.scale is None:
            return share[np.searchsorted(sorted(self.material), label)]
        x = np.einsum("sk,tkj->tsj", SAMPLES, points[tets]).reshape(-1, 3)
        found = np.repeat(label, len(SAMPLES)) if whole or self.label_at is None else self.label_at(x)
        parts = share[np.searchsorted(sorted(self.material), found)]
        if self.scale is not None:
            parts = parts * self.scale(x)[:, None]
        return parts.reshape(len(tets), len(SAMPLES), -1).mean(axis=1)

    @cached_property
    def fractions(self) -> np.ndarray:
        """(T, M); of the organ's own tetrahedra."""
        return self.fractions_of(self.points, self.tets, self.label)

    @cached_property
    def pattern(self) -> HessianPattern:
        """Pattern over all displacement components, held ones included."""
        return hessian_pattern(self.space.elements, np.zeros(3 * self.space.node_count, bool), [])

    def tissue(self, space: QuadraticSpace, fraction: np.ndarray, faces: np.ndarray) -> Tissue:
        """What stores energy on a mesh of this organ or of a part of it.

        Args:
            fraction: (T, M); share of each material in its tetrahedra.
            faces: (B, 6) quadratic nodes of its faces on the organ's surface.
        """
        skin, springs = self._skin(space.nodes, faces), self._springs(space.nodes, faces)
        return Tissue(ElementSystem(space, self.materials, fraction), skin, springs)

    def _skin(self, nodes: np.ndarray, faces: np.ndarray) -> Membrane | None:
        return None if self.capsule is None or not len(faces) else Membrane(nodes, faces, self.capsule)

    def _springs(self, nodes: np.ndarray, faces: np.ndarray) -> ElasticSupport | None:
        return None if self.elastic is None else elastic_support(nodes, faces, self.elastic)

    def rest_stiffness(self, tets: np.ndarray) -> sparse.csr_matrix:
        """Small-strain stiffness of some tetrahedra and the capsule on them over all components (3 N, 3 N), N/m.

        Symmetric, without supports: rigid motions meet no force.

        Args:
            tets: (T,) bool; which tetrahedra take part.
        """
        nothing = np.zeros((self.space.node_count, 3))
        system = ElementSystem(self.space, self.materials, self.fractions * tets[:, None])
        values = system.hessian(nothing, self.pattern)
        skin = self._skin(self.space.nodes, self.surface_of(tets))
        if skin is not None:
            values += skin.hessian(nothing, self.pattern)
        upper = self.pattern.matrix(values)
        return (upper + sparse.triu(upper, 1).T).tocsr()

    def stiffness_of(self, tets: np.ndarray) -> tuple[np.ndarray, sparse.csr_matrix, sparse.csr_matrix]:
        """Small-strain stiffness of a few tetrahedra (T,) bool.

        Returns:
            their nodes (n,), rising; (3 n, 3 n) N/m over those nodes' components, of the tetrahedra with the capsule on
            them, and of the elastic supports under them.
        """
        s = self.space
        nodes = np.unique(s.elements[tets])
        local = np.full(s.node_count, -1)
        local[nodes] = np.arange(len(nodes))
        elements = local[s.elements[tets]].astype(np.int32)
        part = QuadraticSpace(
            s.nodes[nodes], elements, s.corner_gradients[tets], s.volumes[tets], np.zeros((0, 3), int)
        )
        faces = local[self.surface_of(tets)]
        skin, springs = self._skin(part.nodes, faces), self._springs(part.nodes, faces)
        pattern = hessian_pattern(elements, np.zeros(3 * len(nodes), bool), [])
        tissue = Tissue(ElementSystem(part, self.materials, self.fractions[tets]), skin)
        upper = pattern.matrix(tissue.hessian(np.zeros_like(part.nodes), pattern))
        nothing = sparse.csr_matrix(upper.shape)
        return (
            nodes,
            (upper + sparse.triu(upper, 1).T).tocsr(),
            nothing if springs is None else springs.matrix(len(nodes)),
        )

    @cached_property
    def rest_factor(self) -> tuple[Factor, np.ndarray]:
        """Factor of the whole organ's rest stiffness over its free components; each component's equation (3 N,)."""
        everything = np.ones(len(self.tets), bool)
        stiffness = self.rest_stiffness(everything) + self.spring_stiffness(everything)
        free = np.ones((self.space.node_count, 3), bool)
        free[self.held_nodes] = False
        free = np.flatnonzero(free.ravel())
        upper = sparse.triu(stiffness[free][:, free]).tocsr()
        upper.sort_indices()
        factor = Factor(upper.indptr, upper.indices)
        factor.factorise(upper.data)
        equation = np.full(stiffness.shape[0], -1)
        equation[free] = np.arange(len(free))
        return factor, equation

    def spring_stiffness(self, tets: np.ndarray) -> sparse.csr_matrix:
        """Elastic supports under some tetrahedra (T,) bool, over all components (3 N, 3 N), N/m."""
        count = self.space.node_count
        springs = self._springs(self.space.nodes, self.surface_of(tets))
        return sparse.csr_matrix((3 * count, 3 * count)) if springs is None else springs.matrix(count)

    def require_support(self) -> None:
        """Raise SupportError where nothing holds the organ: one face, fixed or on springs, is enough."""
        on_springs = self.elastic is not None and faces_held(
            self.points, self.faces, lambda x: self.elastic(x) > 0.0
        )
        if not len(self.held_nodes) and not np.any(on_springs):
            raise SupportError(
                "nothing holds the organ, so a press would push it away", "organ",
                "a fixed or elastic support that covers a face of the surface",
            )  # fmt: skip
