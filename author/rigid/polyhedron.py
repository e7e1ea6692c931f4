# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A closed triangle mesh as faces, edges and vertices: coplanar triangles are one face, holes included."""

from __future__ import annotations

import numpy as np
import trimesh

from palpate.author.errors import InputError, InputProblem
from palpate.author.rigid.body import Body, Element, frame_of

__all__ = ["box", "plate_with_hole", "polyhedron"]

FLAT = 1e-6
"""sine of the angle between normals of triangles that are one face."""
STEEPEST = 4.0
"""How far past a nearly flat reflex edge a face goes on, in depths."""


def box(size: tuple[float, float, float]) -> Body:
    """A box about the origin with the edge lengths `size` (3,), m."""
    mesh = trimesh.creation.box(extents=size)
    return polyhedron(np.asarray(mesh.vertices), np.asarray(mesh.faces))


def plate_with_hole(size: tuple[float, float, float], hole: tuple[float, float]) -> Body:
    """A plate about the origin with the edge lengths `size` (3,), m, and a hole of edges (2,), m, along z."""
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2
    rings = [
        (square * size[:2], -size[2] / 2),
        (square * hole, -size[2] / 2),
        (square * size[:2], size[2] / 2),
    ]
    rings.append((square * hole, size[2] / 2))
    points = np.array([[*xy, z] for ring, z in rings for xy in ring])
    triangles = []
    for k in range(4):
        n = (k + 1) % 4
        for a, b in (
            (1, 0),
            (2, 3),
            (0, 2),
            (3, 1),
        ):  # bottom, top, outside, inside: ring a's edge, then ring b's
            low, high = 4 * a, 4 * b
            triangles += [(low + k, low + n, high + n), (low + k, high + n, high + k)]
    return polyhedron(points, np.array(triangles))


def polyhedron(vertices: np.ndarray, triangles: np.ndarray, name: str = "mesh") -> Body:
    """The polyhedron of a closed triangle mesh.

    Args:
        vertices: (n, 3) m.  triangles: (m, 3), counter-clockwise from outside.  name: for messages.

    Raises:
        InputError: open, crossing itself, without volume, or with more than 1024 elements.
    """
    mesh = trimesh.Trimesh(vertices, triangles, process=True)

    def refuse(what: str, expected: str) -> InputError:
        return InputError(InputProblem("", name, None, what, expected))

    if not (mesh.is_watertight and mesh.is_winding_consistent):
        raise refuse("is open: an edge does not have two triangles", "a closed triangle mesh")
    if mesh.volume < 0:
        mesh.invert()
    if not mesh.volume > 1e-15:
        raise refuse("has no volume", "a closed triangle mesh around a volume")
    if _crosses_itself(mesh):
        raise refuse("crosses itself", "a triangle mesh whose triangles meet in edges only")
    face_of, normals = _faces(mesh)
    pairs = mesh.face_adjacency
    edges = mesh.face_adjacency_edges
    convex = mesh.face_adjacency_convex
    split = face_of[pairs[:, 0]] != face_of[pairs[:, 1]]
    pairs, edges, convex = pairs[split], edges[split], convex[split]
    points = np.asarray(mesh.vertices)
    elements: list[Element] = []
    for f in range(len(normals)):
        own = np.any(face_of[pairs] == f, axis=1)
        beyond = normals[face_of[pairs[own]].sum(axis=1) - f]
        elements.append(_polygon(points, normals[f], edges[own], beyond, convex[own]))
    edge_ids: dict[int, list[tuple[int, int]]] = {}
    lines = _joined_edges(points, face_of[pairs], edges, convex)
    for (f, g), (a, b), bulges in lines:
        for end, other in ((a, b), (b, a)):
            edge_ids.setdefault(end, []).append((len(elements) if bulges else -1, other))
        if not bulges:
            continue
        along = points[b] - points[a]
        length = float(np.linalg.norm(along))
        middle = (points[a] + points[b]) / 2
        elements.append(
            Element(
                "segment", middle, along / length, high=length / 2, normal=np.array([normals[f], normals[g]]),
                bounds=(f, g), ball=(middle, length / 2),
            )
        )  # fmt: skip
    for v, ends in edge_ids.items():
        if len(ends) < 3 or any(
            e < 0 for e, _ in ends
        ):  # on a line, or beside a reflex edge: no vertex that a face can meet
            continue
        ups = {e for e, _ in ends} | {f for e, _ in ends for f in elements[e].bounds}
        to = np.array([points[other] - points[v] for _, other in ends])
        elements.append(
            Element("vertex", points[v], bounds=tuple(sorted(ups)), numbers=to, ball=(points[v], 0.0))
        )
    if len(elements) > 1000:
        raise refuse(f"has {len(elements)} faces, edges and vertices", "at most 1000: a coarser mesh")
    moments = mesh.moment_inertia  # about the centre of mass, density 1
    second = 0.5 * np.trace(moments) * np.eye(3) - moments
    return Body(
        tuple(elements), float(mesh.volume), np.asarray(mesh.center_mass), second, float(min(mesh.extents))
    )


def _faces(mesh: trimesh.Trimesh) -> tuple[np.ndarray, np.ndarray]:
    """Face of each triangle, and each face's normal (n, 3)."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    n = mesh.face_normals
    a, b = mesh.face_adjacency.T
    same = (np.linalg.norm(np.cross(n[a], n[b]), axis=1) < FLAT) & (np.einsum("ij,ij->i", n[a], n[b]) > 0)
    graph = coo_matrix((np.ones(same.sum()), (a[same], b[same])), shape=(len(n), len(n)))
    count, face_of = connected_components(graph, directed=False)
    weight = mesh.area_faces[:, None] * n
    normals = np.array([weight[face_of == f].sum(axis=0) for f in range(count)])
    return face_of, normals / np.linalg.norm(normals, axis=1)[:, None]


def _polygon(
    points: np.ndarray, normal: np.ndarray, boundary: np.ndarray, beyond: np.ndarray, convex: np.ndarray
) -> Element:
    """A face; `beyond` (k, 3): normals of the faces beyond its boundary lines."""
    ends = points[boundary]
    corners = ends.reshape(-1, 3)
    centre = (corners.min(axis=0) + corners.max(axis=0)) / 2
    centre = centre - normal * (normal @ (centre - corners[0]))
    across = frame_of(normal)
    plane = np.stack([across, np.cross(normal, across)])
    lines = np.concatenate([(ends[:, 0] - centre) @ plane.T, (ends[:, 1] - centre) @ plane.T], axis=1)
    ball = (centre, float(np.linalg.norm(corners - centre, axis=1).max()))
    cosine = beyond @ normal
    sine = np.sqrt(np.maximum(1 - cosine**2, 1e-12))
    out = (beyond @ plane.T) / sine[:, None] * np.where(convex, 1.0, -1.0)[:, None]
    reach = np.where(convex, 0.0, np.minimum((1 + np.abs(cosine)) / sine, STEEPEST))
    outward = np.concatenate([out, reach[:, None]], axis=1)
    return Element("polygon", centre, normal, across, numbers=lines, outward=outward, ball=ball)


def _joined_edges(points, faces, edges, convex):
    """Edges between the same two faces that go on in one line are one edge: ((f, g), (a, b), bulges) for each."""
    left = {i: (tuple(sorted(faces[i])), tuple(edges[i]), bool(convex[i])) for i in range(len(edges))}
    while left:
        _, (pair, (a, b), bulges) = left.popitem()
        grown = True
        while grown:
            grown = False
            for i, (other, (c, d), _) in list(left.items()):
                if other != pair or not {a, b} & {c, d}:
                    continue
                shared = ({a, b} & {c, d}).pop()
                end, new = (b if shared == a else a), (d if shared == c else c)
                if (
                    np.linalg.norm(np.cross(points[new] - points[shared], points[end] - points[shared]))
                    < 1e-12
                ):
                    a, b, grown = end, new, True
                    del left[i]
                    break
        yield pair, (a, b), bulges


def _crosses_itself(mesh: trimesh.Trimesh) -> bool:
    """Whether an edge goes through the inside of a triangle that it does not share a vertex with."""
    e = mesh.edges_unique
    p, d = mesh.vertices[e[:, 0]], mesh.vertices[e[:, 1]] - mesh.vertices[e[:, 0]]
    for t, corners in zip(mesh.faces, mesh.triangles, strict=True):
        apart = ~np.isin(e, t).any(axis=1)
        u, v = corners[1] - corners[0], corners[2] - corners[0]
        h = np.cross(d, v)
        det = h @ u
        ok = apart & (np.abs(det) > 1e-15)
        if not ok.any():
            continue
        inverse = 1 / np.where(ok, det, 1)
        s = p - corners[0]
        a = np.einsum("ij,ij->i", s, h) * inverse
        q = np.cross(s, u)
        b = np.einsum("ij,ij->i", d, q) * inverse
        k = (q @ v) * inverse
        inside = ok & (a > 1e-9) & (b > 1e-9) & (a + b < 1 - 1e-9) & (k > 1e-9) & (k < 1 - 1e-9)
        if inside.any():
            return True
    return False
