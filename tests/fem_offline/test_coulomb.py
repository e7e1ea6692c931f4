# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest

from palpate.fem_offline.block import block
from palpate.fem_offline.contact import Unilateral, contact_surface
from palpate.fem_offline.coulomb import Coulomb
from palpate.fem_offline.organ import boundary_faces
from palpate.fem_offline.quadratic_space import quadratic_space
from palpate.fem_offline.tool import Pose, Sphere, tilted

R, MU, EPS = 5e-3, 0.4, 4e7
AHEAD, UP = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
MOVE = np.array([3e-5, -1e-5, -5e-6])
TURNED = tilted(UP, 0.3)


def move(contact, step):
    contact.pose = Pose(contact.pose.position + step, contact.pose.rotation)


@pytest.fixture(scope="module")
def top():
    """Nodes of a 10 mm block and the contact surface of its top face."""
    mesh = block((0.01, 0.01, 0.005), (4, 4, 2))
    space = quadratic_space(mesh.points, mesh.tets)
    faces = boundary_faces(mesh.tets)
    faces = faces[(mesh.points[faces][:, :, 2] > -1e-9).all(axis=1)]
    return space.nodes, contact_surface(space.nodes, space.face_nodes(faces))


@pytest.fixture
def dragged(top):
    """A sphere 1 mm into the top, moved aside after a step that left uneven tractions, and a displacement."""
    nodes, surface = top
    random = np.random.default_rng(0)
    multiplier = random.uniform(0.0, 2e3, surface.point_shape)
    contact = Coulomb(
        surface, Sphere(R), EPS, Pose(np.array([2e-4, -3e-4, R - 1e-3]), TURNED), multiplier,
        friction=MU, tangential_penalty=10 * EPS,
    )  # fmt: skip
    u = 1e-5 * random.standard_normal(nodes.shape)
    contact.start(u)
    contact.commit(u)
    move(contact, 0.05 * MOVE)
    contact.commit(u + 1e-7 * random.standard_normal(nodes.shape))
    move(contact, MOVE)
    # displacements follow the tool in part, so that some points stick
    follow = random.uniform(0.0, 1.0, len(nodes)).round()[:, None] * MOVE
    u = u + follow
    contact.lag(u)
    contact.anchor(u)
    return contact, u


def parts(contact, u):
    """Pressure (B, Q) and friction traction (B, Q, 3) of the true law at u."""
    contact.lag(u)
    traction = contact.state(u).traction
    pressure = np.einsum("bqi,bqi->bq", traction, contact.normal)
    return pressure, traction - pressure[:, :, None] * contact.normal


def test_some_points_stick_and_some_slide(dragged):
    contact, u = dragged
    check = contact.check(u, contact.state(u))
    assert 0.05 < check.sliding < 0.95 and check.failure() == "" and check.dissipation > 0.0


def test_gradient_and_hessian_are_derivatives_with_lagged_pressure(dragged):
    contact, u = dragged
    random = np.random.default_rng(1)
    v = random.standard_normal(u.shape)
    h = 1e-11
    slope = (contact.state(u + h * v).energy - contact.state(u - h * v).energy) / (2 * h)
    assert slope == pytest.approx(np.sum(contact.state(u).gradient * v), rel=1e-5)
    change = (contact.state(u + h * v).gradient - contact.state(u - h * v).gradient).ravel() / (2 * h)
    exact = dense(contact, contact.hessian(u, True), u) @ v.ravel()
    assert np.linalg.norm(change - exact) < 1e-5 * np.linalg.norm(exact)


def dense(contact, found, u):
    H = np.zeros((u.size, u.size))
    for face, local in zip(found.face, found.local, strict=True):
        dof = (3 * contact.surface.faces[face][:, None] + np.arange(3)).ravel()
        H[np.ix_(dof, dof)] += local
    return H


def test_the_unsymmetric_part_completes_the_derivative_of_the_true_law(dragged):
    contact, u = dragged
    v = np.random.default_rng(2).standard_normal(u.shape)
    h = 1e-11

    def gradient(u):
        contact.lag(u)
        return contact.state(u).gradient

    change = (gradient(u + h * v) - gradient(u - h * v)).ravel() / (2 * h)
    contact.lag(u)
    symmetric = dense(contact, contact.hessian(u, False), u)
    whole = symmetric + dense(contact, contact.surface.hessian(contact.unsymmetric(u)), u)
    scale = np.linalg.norm(change)
    assert np.linalg.norm(change - whole @ v.ravel()) < 1e-5 * scale
    assert np.linalg.norm(change - symmetric @ v.ravel()) > 1e-3 * scale


def test_friction_stays_in_the_cone_in_the_tangent_plane(dragged):
    contact, u = dragged
    pressure, tau = parts(contact, u)
    assert (np.linalg.norm(tau, axis=2) <= MU * pressure * (1 + 1e-12) + 1e-12).all()
    assert np.abs(np.einsum("bqi,bqi->bq", tau, contact.normal)).max() < 1e-9


def test_hessian_is_symmetric_and_positive(dragged):
    contact, u = dragged
    H = dense(contact, contact.hessian(u, False), u)
    assert np.abs(H - H.T).max() < 1e-12 * np.abs(H).max()
    assert np.linalg.eigvalsh(H)[0] > -1e-9 * np.abs(H).max()


def test_no_friction_is_unilateral_contact(top, dragged):
    contact, u = dragged
    contact.friction = 0.0
    contact.lag(u)
    plain = Unilateral(contact.surface, contact.tool, EPS, contact.pose, contact.multiplier)
    ours, theirs = contact.state(u), plain.state(u)
    assert ours.energy == theirs.energy and (ours.gradient == theirs.gradient).all()
    assert (ours.force == theirs.force).all() and (ours.moment == theirs.moment).all()


def test_sliding_far_reaches_mu_times_the_pressure_against_the_motion(top):
    """The tool moves over tissue at rest by far more than the elastic give."""
    nodes, surface = top
    u = np.zeros_like(nodes)
    contact = Coulomb(
        surface, Sphere(R), EPS, Pose.upright((R - 1e-4) * UP), friction=MU, tangential_penalty=10 * EPS
    )
    contact.start(u)
    contact.commit(u)
    for _ in range(20):
        move(contact, 1e-5 * AHEAD)
        contact.lag(u)
        contact.anchor(u)
        check = contact.check(u, contact.state(u))
        assert check.failure() == "" and check.dissipation >= 0.0
        contact.commit(u)
    pressure, tau = parts(contact, u)
    on = (pressure > 0.0) & (contact.reached > 0.0)
    along = tau[on] / (MU * pressure[on])[:, None]
    # tissue is dragged along with the tool
    assert along[:, 0].min() > 0.98 and np.linalg.norm(along, axis=1) == pytest.approx(1.0, rel=1e-12)


def test_a_tool_pressed_straight_onto_flat_tissue_rubs_no_point_that_it_just_met(top):
    """The approach is no slip: the anchor of a point is where it touched, not where it was when the step began."""
    nodes, surface = top
    u = np.zeros_like(nodes)
    contact = Coulomb(surface, Sphere(R), EPS, Pose.upright(R * UP), friction=MU, tangential_penalty=10 * EPS)
    contact.start(u)
    contact.pose = Pose.upright((R - 1e-4) * UP)
    # points follow the tool as far as they touch: straight down
    z = np.minimum(
        0.0, -np.sqrt(np.maximum(R**2 - (nodes[:, :2] ** 2).sum(axis=1), 0.0)) + contact.pose.position[2]
    )
    u[:, 2] = z
    contact.lag(u)
    contact.anchor(u)
    pressure, tau = parts(contact, u)
    assert np.linalg.norm(tau, axis=2).max() < 0.1 * MU * pressure.max()


def test_a_state_that_breaks_the_law_is_told(dragged):
    contact, u = dragged
    good = contact.state(u)
    pressure, tau = parts(contact, u)
    normal = pressure[:, :, None] * contact.normal

    def failure(traction):
        return contact.check(u, type(good)(**{**good.__dict__, "traction": traction})).failure()

    assert failure(good.traction) == ""
    assert "exceeds" in failure(normal + 1.1 * tau)
    assert "oppose" in failure(normal - tau)
    assert "pulls" in failure(-normal)


def test_open_points_forget(dragged):
    contact, u = dragged
    contact.commit(u)
    assert contact.base.any()
    move(contact, 5e-3 * UP)
    contact.multiplier[:] = 0.0
    contact.commit(u)
    assert not contact.base.any() and not contact.reached.any()


def test_a_contact_that_turns_with_the_tool_keeps_its_friction(dragged):
    """Tissue and tool turned together: tractions turn with them."""
    contact, u = dragged
    contact.commit(u)
    before = contact.state(u)
    Q = tilted(UP, 0.2)
    turned = contact.surface.points(u) @ Q.T
    rest = contact.surface.rest
    contact.surface = replace(contact.surface, rest=turned - (contact.surface.points(u) - rest))
    contact.pose = Pose(Q @ contact.pose.position, Q @ contact.pose.rotation)
    contact.anchor(u)
    contact.lag(u)
    assert contact.state(u).traction == pytest.approx(
        before.traction @ Q.T, abs=1e-6 * MU * contact.limit.max()
    )
