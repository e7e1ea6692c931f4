# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline.block import block
from palpate.fem_offline.contact import Sticking, Unilateral, contact_surface
from palpate.fem_offline.organ import boundary_faces
from palpate.fem_offline.quadratic_space import quadratic_space
from palpate.fem_offline.tool import Pose, Sphere

R = 5e-3


@pytest.fixture(scope="module")
def top():
    """Nodes of a 10 mm block and the contact surface of its top face."""
    mesh = block((0.01, 0.01, 0.005), (4, 4, 2))
    space = quadratic_space(mesh.points, mesh.tets)
    faces = boundary_faces(mesh.tets)
    faces = faces[(mesh.points[faces][:, :, 2] > -1e-9).all(axis=1)]
    return space.nodes, contact_surface(space.nodes, space.face_nodes(faces))


@pytest.fixture
def pressed(top):
    """A sphere 1 mm into the top with uneven multipliers, and a displacement."""
    nodes, surface = top
    random = np.random.default_rng(0)
    multiplier = random.uniform(0.0, 2e3, surface.point_shape)
    contact = Unilateral(surface, Sphere(R), 4e7, Pose.upright([2e-4, -3e-4, R - 1e-3]), multiplier)
    return contact, 1e-5 * random.standard_normal(nodes.shape)


def stuck_like(surface, contact, u):
    stuck = Sticking(surface, 4e8, surface.points(u), contact.state(u).traction, contact.pose.position.copy())
    stuck.translation = np.array([1e-5, -2e-5, 5e-6])
    return stuck


def dense(contact, surface, u, geometric):
    """(3 N, 3 N) Hessian."""
    H = np.zeros((u.size, u.size))
    found = contact.hessian(u, geometric)
    for face, local in zip(found.face, found.local, strict=True):
        dof = (3 * surface.faces[face][:, None] + np.arange(3)).ravel()
        H[np.ix_(dof, dof)] += local
    return H


@pytest.mark.parametrize("kind", ["unilateral", "sticking"])
def test_gradient_and_hessian_are_derivatives(top, pressed, kind):
    _, surface = top
    contact, u = pressed
    if kind == "sticking":
        contact, u = stuck_like(surface, contact, u), u + 2e-6
    random = np.random.default_rng(1)
    v = random.standard_normal(u.shape)
    h = 1e-9
    slope = (contact.state(u + h * v).energy - contact.state(u - h * v).energy) / (2 * h)
    assert slope == pytest.approx(np.sum(contact.state(u).gradient * v), rel=1e-5)
    change = (contact.state(u + h * v).gradient - contact.state(u - h * v).gradient).ravel() / (2 * h)
    exact = dense(contact, surface, u, True) @ v.ravel()
    assert np.linalg.norm(change - exact) < 1e-5 * np.linalg.norm(exact)


def test_force_on_the_tool_is_minus_the_load_on_the_tissue(top, pressed):
    contact, u = pressed
    state = contact.state(u)
    assert state.force == pytest.approx(state.gradient.sum(axis=0), rel=1e-12)


def test_force_is_minus_the_energy_slope_over_the_tool_position(pressed):
    contact, u = pressed
    exact, home, h = contact.state(u).force, contact.pose, 1e-9
    for k in range(3):
        energies = []
        for sign in (1, -1):
            contact.pose = home.at(home.position + sign * h * np.eye(3)[k])
            energies.append(contact.state(u).energy)
        assert -(energies[0] - energies[1]) / (2 * h) == pytest.approx(
            exact[k], abs=1e-5 * np.linalg.norm(exact)
        )


def test_a_frictionless_sphere_feels_no_moment_about_its_centre(pressed):
    contact, u = pressed
    state = contact.state(u)
    assert np.abs(state.moment).max() < 1e-12 * R * np.linalg.norm(state.force)


def test_moment_is_the_sum_of_r_cross_f(top, pressed):
    _, surface = top
    contact, u = pressed
    stuck = stuck_like(surface, contact, u)
    state = stuck.state(u)
    load = surface.weight[:, :, None] * state.traction
    arm = surface.points(u) - (contact.pose.position + stuck.translation)
    assert state.moment == pytest.approx(-np.cross(arm, load).reshape(-1, 3).sum(axis=0), rel=1e-12)
    assert np.linalg.norm(state.moment) > 1e-3 * R * np.linalg.norm(state.force)


def test_nothing_pulls(top):
    nodes, surface = top
    away = Unilateral(surface, Sphere(R), 4e7, Pose.upright([0.0, 0.0, R + 1e-6]))
    state = away.state(np.zeros_like(nodes))
    assert not state.force.any() and state.area == 0.0 and not away.touches(np.zeros_like(nodes))


def test_update_keeps_the_pressure_of_the_state_it_was_found_in(pressed):
    contact, u = pressed
    before = np.linalg.norm(contact.state(u).traction, axis=2)
    contact.update(u)
    assert contact.multiplier == pytest.approx(before, rel=1e-12)


def test_sticking_begins_in_balance(top, pressed):
    """No move, no change: the base traction is what the frictionless contact carried."""
    _, surface = top
    contact, u = pressed
    stuck = Sticking(surface, 4e8, surface.points(u), contact.state(u).traction, contact.pose.position)
    assert stuck.state(u).gradient == pytest.approx(contact.state(u).gradient, abs=1e-15)
    assert stuck.state(u).force == pytest.approx(contact.state(u).force, rel=1e-12)


def test_load_of_translation_is_a_derivative(top, pressed):
    nodes, surface = top
    contact, u = pressed
    stuck = stuck_like(surface, contact, u)
    load, home, h = stuck.load_of_translation(len(nodes)), stuck.translation.copy(), 1e-8
    for k in range(3):
        gradients = []
        for sign in (1, -1):
            stuck.translation = home + sign * h * np.eye(3)[k]
            gradients.append(stuck.state(u).gradient)
        slope = (gradients[0] - gradients[1]) / (2 * h)
        assert load[:, :, k] == pytest.approx(-slope, abs=1e-6 * np.abs(slope).max())


def test_uniform_traction_loads_mid_edges_only(top):
    """The consistent load of a quadratic triangle: a third of the face's load at each mid-edge, none at corners."""
    nodes, surface = top
    load = surface.nodal(np.broadcast_to([0.0, 0.0, 1.0], (*surface.point_shape, 3)), len(nodes))[:, 2]
    corners = np.unique(surface.faces[:, :3])
    assert np.abs(load[corners]).max() < 1e-18
    assert load.sum() == pytest.approx(1e-4, rel=1e-12)
