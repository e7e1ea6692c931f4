# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
import trimesh

from palpate.fem_offline.signed_distance import SignedDistance, vertex_normals


@pytest.fixture(scope="module")
def cube() -> SignedDistance:
    box = trimesh.creation.box((2.0, 2.0, 2.0))
    return SignedDistance(box.vertices, box.faces)


def cube_distance(p: np.ndarray) -> np.ndarray:
    q = np.abs(p) - 1.0
    return np.linalg.norm(np.maximum(q, 0.0), axis=1) + np.minimum(q.max(axis=1), 0.0)


def test_distance_to_a_cube_is_exact_inside_outside_and_past_edges_and_corners(cube):
    p = np.random.default_rng(1).uniform(-2.0, 2.0, (5000, 3))
    assert np.abs(cube(p) - cube_distance(p)).max() < 1e-12


def test_sign_is_right_within_a_hair_of_faces_edges_and_corners(cube):
    x = np.array([[1.0, 0.3, 0.2], [1.0, 1.0, 0.2], [1.0, 1.0, 1.0], [1.0, 1.0, -1.0], [0.3, -1.0, 0.3]])
    outward = np.where(np.abs(x) == 1.0, np.sign(x), 0.0)
    for hair in (1e-3, 1e-6, 1e-9):
        assert (cube(x + hair * outward) > 0.0).all()
        assert (cube(x - hair * outward) < 0.0).all()


def test_sign_is_right_next_to_a_deep_crease():
    # An open book: the closest point to its mouth lies on a concave or convex edge, by turns.
    outline = np.array([[0, 0], [4, 0], [4, 3], [2, 0.05], [0, 3]], float)
    book = trimesh.creation.extrude_triangulation(outline, np.array([[0, 3, 4], [0, 1, 3], [1, 2, 3]]), 4.0)
    phi = SignedDistance(book.vertices, book.faces)
    assert phi.vertices.shape[0] == 10 and trimesh.Trimesh(phi.vertices, phi.triangles).is_watertight
    p = np.random.default_rng(2).uniform([1.5, -0.1, 1.0], [2.5, 0.5, 3.0], (4000, 3))
    x, y = p[:, 0], p[:, 1]
    roof = 0.05 + np.abs(x - 2.0) * (2.95 / 2.0)
    inside = (y > 0.0) & (y < roof)
    assert ((phi(p) < 0.0) == inside).all()


def test_projection_lands_on_the_surface_with_continuous_outward_normals():
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.03)
    phi = SignedDistance(ball.vertices, ball.faces)
    direction = np.random.default_rng(3).normal(size=(1000, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    x, n = phi.project(0.035 * direction)
    assert np.abs(phi(x)).max() < 1e-12
    assert np.degrees(np.arccos(np.einsum("ij,ij->i", n, direction))).max() < 1.0
    # across an edge: the triangles' own normals jump by 4 degrees, these do not
    edge = ball.vertices[ball.edges_unique].mean(axis=1)
    aside = np.cross(edge, ball.vertices[ball.edges_unique[:, 1]] - edge)
    aside *= 1e-8 / np.linalg.norm(aside, axis=1, keepdims=True)
    jump = np.linalg.norm(phi.project(edge + aside)[1] - phi.project(edge - aside)[1], axis=1)
    assert jump.max() < 1e-5


def test_barycentric_weights_give_the_closest_point_back():
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.03)
    phi = SignedDistance(ball.vertices, ball.faces)
    x, triangle, weights = phi.closest(np.random.default_rng(4).uniform(-0.05, 0.05, (500, 3)))
    assert np.abs(np.einsum("nk,nkj->nj", weights, ball.vertices[ball.faces[triangle]]) - x).max() < 1e-12


def test_normals_do_not_depend_on_how_faces_are_cut_in_triangles():
    box = trimesh.creation.box((2.0, 2.0, 2.0))
    assert np.allclose(vertex_normals(box.vertices, box.faces), np.sign(box.vertices) / np.sqrt(3.0))
