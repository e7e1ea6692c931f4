# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A patch of organ around one contact, carved out of the coarse tetrahedra and refined alone.

The interface to the rest of the organ keeps its triangles, so that the quadratic nodes on it are shared to rounding;
the outer surface is laid onto the smooth surface that the field uses (a coarse facet sags by several percent of a
press).  Refinement: mmg3d (Dapogny, Dobrzynski and Frey 2014) through mmgpy.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import spsolve
from scipy.spatial import cKDTree

from palpate.fem_offline.organ import TET_FACES, Organ, boundary_faces
from palpate.fem_offline.pose import tangents

__all__ = ["Patch", "PatchError", "PatchSize", "carve", "refine"]

OUTER, INTERFACE = 1, 2
MILLIMETRE = 1.0e-3  # mmg's tolerances expect numbers of the order of one


class PatchError(RuntimeError):
    """A patch could not be meshed well enough."""


@dataclass(frozen=True)
class PatchSize:
    """Edge lengths of a patch.

    Attributes:
        radius: m; coarse tetrahedra with a corner this near the contact belong to the patch.
        finest: m; edge length within `core` of the contact.
        core: m.
        growth: edge length gained per metre beyond the core.
        coarsest: m.
        extent: m; what may touch lies this near the contact.
        spine: (m, 2) m along the contact's tangents (pose.py); the core is around each of these points.
        rim: (k, 2) m likewise; edges are `rim_finest` (m) at these.
    """

    radius: float
    finest: float
    core: float
    growth: float
    coarsest: float
    extent: float = 0.0
    spine: np.ndarray = field(default_factory=lambda: np.zeros((1, 2)))
    rim: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    rim_finest: float = 0.0

    def on(self, organ: Organ, centre: np.ndarray, normal: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """Edge length m of points (n, 3) m around a contact, with spine and rim laid onto the surface."""
        frame = tangents(normal)
        spine = organ.project(centre + self.spine @ frame)[0]
        tree = cKDTree(spine)
        rim = cKDTree(organ.project(centre + self.rim @ frame)[0]) if len(self.rim) else None

        def edge_length(points: np.ndarray) -> np.ndarray:
            target = self.finest + self.growth * (tree.query(points)[0] - self.core)
            target = np.maximum(target, self.finest)
            if rim is not None:
                target = np.minimum(target, self.rim_finest + self.growth * rim.query(points)[0])
            return np.minimum(target, self.coarsest)

        return edge_length


@dataclass(frozen=True)
class Patch:
    """A refined patch.

    Attributes:
        points: (P, 3) m; tets: (T, 4); label: (T,) region labels.
        outer_faces: (B, 3) on the organ's surface.
        interface_faces: (I, 3) shared with the rest of the organ.
        organ_vertex: (P,) the organ's point of each interface vertex, -1 elsewhere.
        carved: (T_organ,) bool; the organ's tetrahedra that it replaces.
        quality: smallest mmg quality (1: regular).
    """

    points: np.ndarray
    tets: np.ndarray
    label: np.ndarray
    outer_faces: np.ndarray
    interface_faces: np.ndarray
    organ_vertex: np.ndarray
    carved: np.ndarray
    quality: float


def carve(organ: Organ, centre: np.ndarray, radius: float) -> np.ndarray:
    """(T,) bool; tetrahedra with a corner within `radius` of `centre`, one face-connected piece."""
    near = np.linalg.norm(organ.points - centre, axis=1) <= radius
    chosen = np.flatnonzero(near[organ.tets].any(axis=1))
    if len(chosen) == 0:
        raise PatchError(f"no tetrahedron within {radius:g} m of the contact at {centre}")
    faces = np.sort(organ.tets[chosen][:, TET_FACES].reshape(-1, 3), axis=1)
    _, face = np.unique(faces, axis=0, return_inverse=True)
    owner = np.repeat(np.arange(len(chosen)), 4)
    incidence = sparse.coo_matrix((np.ones(len(face)), (owner, face.ravel()))).tocsr()
    _, piece = connected_components(incidence @ incidence.T, directed=False)
    centroid = organ.points[organ.tets[chosen]].mean(axis=1)
    home = piece[np.argmin(np.linalg.norm(centroid - centre, axis=1))]
    carved = np.zeros(len(organ.tets), bool)
    carved[chosen[piece == home]] = True
    return carved


def refine(organ: Organ, carved: np.ndarray, centre: np.ndarray, size: PatchSize, passes: int = 3) -> Patch:
    """Refine carved tetrahedra towards `centre` (on the surface) and lay their outer faces onto the smooth surface.

    Raises:
        PatchError: mmg failed, or a tetrahedron ended inverted.
    """
    ids = np.unique(organ.tets[carved])
    local = np.full(len(organ.points), -1)
    local[ids] = np.arange(len(ids))
    points, tets, label = organ.points[ids], local[organ.tets[carved]], organ.label[carved]
    if organ.label_at is not None:  # the coarse labels' staircase is no border to keep
        label = np.zeros_like(label)
    faces = boundary_faces(tets)
    surface_keys = _keys(organ.faces, len(organ.points))
    outer = np.isin(_keys(ids[faces], len(organ.points)), surface_keys)
    interface = ids[np.unique(faces[~outer])]
    face_kind = np.where(outer, OUTER, INTERFACE)
    quality = 0.0
    edge_length = size.on(organ, centre, organ.project(centre[None])[1][0])
    for step in range(passes):
        points, tets, label, faces, face_kind, quality = _remesh(
            points, tets, label, faces, face_kind, centre, size, edge_length
        )
        points = _lay_on_surface(points, tets, faces, face_kind, organ, step == passes - 1)
    volumes = _volumes(points, tets)
    if volumes.min() <= 0.0:
        raise PatchError(
            f"{np.count_nonzero(volumes <= 0)} tetrahedra inverted on the curved surface at {centre}"
        )
    if organ.label_at is not None:
        label = organ.label_at(points[tets].mean(axis=1))
    organ_vertex = np.full(len(points), -1)
    nodes = np.unique(faces[face_kind == INTERFACE])
    if len(nodes):
        distance, which = cKDTree(organ.points[interface]).query(points[nodes])
        if distance.max() > 1e-9:
            raise PatchError(f"interface vertices moved by {distance.max():.2e} m")
        # exact positions, so that shared nodes agree to the last bit
        points[nodes] = organ.points[interface[which]]
        organ_vertex[nodes] = interface[which]
    return Patch(
        points,
        tets,
        label,
        faces[face_kind == OUTER],
        faces[face_kind == INTERFACE],
        organ_vertex,
        carved,
        quality,
    )


def _keys(faces: np.ndarray, count: int) -> np.ndarray:
    s = np.sort(faces, axis=1).astype(np.int64)
    return (s[:, 0] * count + s[:, 1]) * count + s[:, 2]


def _volumes(points: np.ndarray, tets: np.ndarray) -> np.ndarray:
    x = points[tets]
    return np.linalg.det(x[:, 1:] - x[:, :1]) / 6.0


def _remesh(points, tets, label, faces, face_kind, centre, size: PatchSize, edge_length):
    import mmgpy

    mesh = mmgpy.MmgMesh3D()
    mesh.set_mesh_size(vertices=len(points), tetrahedra=len(tets), triangles=len(faces))
    mesh.set_vertices((points - centre) / MILLIMETRE)
    mesh.set_tetrahedra(tets.astype(np.int32), label.astype(np.int32) + 1)
    mesh.set_triangles(faces.astype(np.int32), face_kind.astype(np.int32))
    required = np.flatnonzero(face_kind == INTERFACE)
    if len(required):
        mesh.set_required_triangles(required.astype(np.int32))
    mesh["metric"] = (edge_length(points) / MILLIMETRE)[:, None]
    # how far mmg may be off the surface, onto which vertices are laid afterwards
    off = max(2.0, 0.25 * size.coarsest / MILLIMETRE)
    try:
        # hgradreq -1: else the interface's coarse triangles spread their size inwards and the contact stays coarse
        mesh.remesh(hausd=off, angle=0, hgrad=1.0 + 2.5 * size.growth, hgradreq=-1.0, verbose=-1)
    except RuntimeError as error:
        raise PatchError(f"mmg failed at {centre}: {error}") from error
    tets, refs = mesh.get_tetrahedra_with_refs()
    faces, kind = mesh.get_triangles_with_refs()
    points = mesh.get_vertices() * MILLIMETRE + centre
    keep = np.isin(kind, (OUTER, INTERFACE))
    faces, kind = _orient(faces[keep], kind[keep], tets, len(points))
    return points, tets, np.asarray(refs) - 1, faces, kind, float(mesh.get_element_qualities().min())


def _orient(faces, kind, tets, count):
    """Outward faces of the tetrahedra, with the kinds that mmg kept."""
    outward = boundary_faces(tets)
    order = np.argsort(_keys(faces, count))
    keys = _keys(faces, count)[order]
    at = np.searchsorted(keys, _keys(outward, count))
    if np.any(at >= len(keys)) or np.any(keys[at] != _keys(outward, count)):
        raise PatchError("mmg lost a boundary triangle")
    return outward, np.asarray(kind)[order][at]


def _lay_on_surface(points, tets, faces, face_kind, organ: Organ, last: bool) -> np.ndarray:
    """Move outer vertices (those of the interface stay) onto the smooth surface; the inside follows harmonically."""
    fixed = np.unique(faces[face_kind == INTERFACE])
    free = np.setdiff1d(np.unique(faces[face_kind == OUTER]), fixed)
    target, _ = organ.project(points[free])
    shift = np.zeros_like(points)
    shift[free] = target - points[free]
    pairs = tets[:, [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]]].reshape(-1, 2)
    pairs = np.unique(np.sort(pairs, axis=1), axis=0)
    weight = 1.0 / np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
    n = len(points)
    adjacency = sparse.coo_matrix((weight, (pairs[:, 0], pairs[:, 1])), shape=(n, n)).tocsr()
    adjacency = adjacency + adjacency.T
    laplacian = (sparse.diags(np.asarray(adjacency.sum(axis=1)).ravel()) - adjacency).tocsr()
    known = np.union1d(fixed, free)
    inside = np.setdiff1d(np.arange(n), known)
    if len(inside):
        right = -(laplacian[inside][:, known] @ shift[known])
        shift[inside] = spsolve(laplacian[inside][:, inside].tocsc(), right).reshape(-1, 3)
    if not last:  # a move that would invert is retried after the next remeshing
        for _ in range(6):
            if _volumes(points + shift, tets).min() > 0.0:
                break
            shift *= 0.5
    return points + shift
