# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rigid shapes: mass properties against closed forms, polyhedra against Euler, and what is refused."""

import numpy as np
import pytest
import trimesh

from palpate.author.errors import InputError
from palpate.author.rigid import shapes
from palpate.author.rigid.body import combined
from palpate.author.rigid.cook import cooked_rigid
from palpate.author.rigid.polyhedron import box, plate_with_hole, polyhedron

R, L = 0.02, 0.08


@pytest.mark.parametrize(
    ("body", "volume", "moments"),
    [
        (shapes.sphere(R), 4 / 3 * np.pi * R**3, [0.4 * R**2] * 3),
        (shapes.cylinder(R, L), np.pi * R**2 * L, [R**2 / 4 + L**2 / 12] * 2 + [R**2 / 2]),
        (shapes.cone(R, L), np.pi * R**2 * L / 3, [3 / 20 * R**2 + 3 / 80 * L**2] * 2 + [0.3 * R**2]),
        (
            shapes.torus(R, 0.005),
            2 * np.pi**2 * R * 0.005**2,
            [R**2 / 2 + 5 / 8 * 0.005**2] * 2 + [R**2 + 0.75 * 0.005**2],
        ),
        (box((0.01, 0.02, 0.03)), 6e-6, [13e-4 / 12, 10e-4 / 12, 5e-4 / 12]),
        (
            shapes.tube(0.01, R, L),
            np.pi * (R**2 - 1e-4) * L,
            [(R**2 + 1e-4) / 4 + L**2 / 12] * 2 + [(R**2 + 1e-4) / 2],
        ),
    ],
)
def test_mass_properties_are_the_closed_forms(body, volume, moments):
    assert body.volume == pytest.approx(volume, rel=1e-9)
    assert body.inertia(1.0) == pytest.approx(np.diag(moments), rel=1e-9, abs=1e-15)


def test_a_capsule_is_its_cylinder_and_two_half_balls():
    whole = shapes.capsule(R, L)
    assert whole.volume == pytest.approx(np.pi * R**2 * L + 4 / 3 * np.pi * R**3, rel=1e-12)


def test_parts_have_the_mass_of_the_whole():
    halves = [box((0.02, 0.04, 0.01)).moved(np.eye(3), np.array([0, 0, z])) for z in (-0.005, 0.005)]
    whole, both = box((0.02, 0.04, 0.02)), combined(halves)
    assert both.volume == pytest.approx(whole.volume)
    assert both.inertia(2.0) == pytest.approx(whole.inertia(2.0), abs=1e-15)


def test_moment_about_any_axis_takes_the_tensors_own_products():
    """I_nn = n . I n; positive products of inertia come with a minus (the paper's sidebar: plus)."""
    rng = np.random.default_rng(1)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    body = box((0.01, 0.02, 0.04)).moved(turn * np.linalg.det(turn), np.zeros(3))
    n = np.array([0.36, 0.48, 0.8])
    points = (rng.uniform(-0.5, 0.5, (200_000, 3)) * [0.01, 0.02, 0.04]) @ (turn * np.linalg.det(turn)).T
    off = np.sum(points**2, axis=1) - (points @ n) ** 2
    assert n @ body.inertia(1.0) @ n == pytest.approx(off.mean(), rel=0.02)


def test_coplanar_triangles_are_one_face():
    body = box((0.01, 0.02, 0.03))
    kinds = [e.kind for e in body.elements]
    assert [kinds.count(k) for k in ("polygon", "segment", "vertex")] == [6, 12, 8]


def test_a_hole_leaves_ring_faces_and_no_vertex_beside_reflex_edges():
    body = plate_with_hole((0.1, 0.1, 0.02), (0.02, 0.03))
    assert body.volume == pytest.approx(0.02 * (0.01 - 0.0006))
    kinds = [e.kind for e in body.elements]
    assert [kinds.count(k) for k in ("polygon", "segment", "vertex")] == [10, 20, 8]


def two(mesh):
    return np.concatenate([mesh.faces, mesh.faces + 8])


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda m: (m.vertices, m.faces[:-1]), "open"),
        (lambda m: (m.vertices * 1e-6, m.faces), "volume"),
        (lambda m: (np.tile(m.vertices, (2, 1)) + np.repeat([[0] * 3, [0.3, 0.2, 0.1]], 8, 0), two(m)), "crosses"),
    ],
)  # fmt: skip
def test_bad_meshes_are_refused_by_name(make, says):
    with pytest.raises(InputError, match=says):
        polyhedron(*make(trimesh.creation.box()))


def test_what_cannot_be_rendered_is_refused_by_name():
    floor = shapes.plane(1, 1)
    for held, fixed, mass, says in (
        (shapes.sphere(R), floor, 0.0, "mass above 0"),
        (shapes.sphere(R), floor, float("nan"), "mass above 0"),
        (shapes.plane(1, 1), floor, 1.0, "no volume"),
        (box((0.1, 0.1, 0.001)), floor, 1.0, "thin"),
        (shapes.paraboloid(20, 0.03), shapes.bowl(10, 0.05, 0.02), 1.0, "not computed"),
    ):
        with pytest.raises(InputError, match=says):
            cooked_rigid(held, fixed, mass)
