# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""From press arrays to nodes."""

from dataclasses import replace

import numpy as np
import pytest
from known_organ import CURVED, FLAT, KnownOrgan, geometry_of, nodes_of

from palpate.fields.node_fit import fit_nodes, relative_gradient, uniform_knots, why_unusable

ORGAN = KnownOrgan(FLAT)
KNOTS = uniform_knots(ORGAN.depth_max)


def truth_at_knots(position: np.ndarray, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Energy, normal force and B of the known organ, (N, K, ...)."""
    q = position[:, None] + (ORGAN.radius - KNOTS)[None, :, None] * normal[:, None]
    shape, flat = q.shape[:2], q.reshape(-1, 3)
    force, n = ORGAN.force(flat), np.repeat(normal, len(KNOTS), axis=0)
    f = np.sum(force * n, axis=1)
    return ORGAN.energy(flat).reshape(shape), f.reshape(shape), (f[:, None] * n - force).reshape(*shape, 3)


@pytest.mark.parametrize(("noise", "force_bar", "lateral_bar"), [(0.0, 3e-4, 2e-4), (0.005, 8e-3, 6e-3)])
def test_nodes_hold_energy_force_and_lateral_gradient(noise, force_bar, lateral_bar):
    nodes = nodes_of(ORGAN, 25, noise, 2)
    energy, force, lateral = truth_at_knots(nodes.position, nodes.normal)
    deepest = force[:, -1:]
    assert np.quantile(np.abs(nodes.normal_force - force) / deepest, 0.95) < force_bar
    assert np.quantile(np.abs(nodes.stored_energy - energy) / energy[:, -1:], 0.95) < force_bar
    assert np.quantile(np.linalg.norm(nodes.lateral_gradient - lateral, axis=2) / deepest, 0.95) < lateral_bar
    assert np.abs(np.einsum("nki,ni->nk", nodes.lateral_gradient, nodes.normal)).max() < 1e-9
    assert np.all(nodes.stored_energy[:, 0] == 0) and np.all(nodes.normal_force[:, 0] == 0)
    assert nodes.residual.max() < 3e-4 + 5 * noise
    assert nodes.pressed.all() and len(set(nodes.press_hash)) == 25


def test_friction_stiffness_is_the_spring_alone_without_the_curvature_of_the_potential():
    """k = 0.7 Phi'' was put in; the straight lateral ladders also feel U curve by -f H."""
    organ, rng = KnownOrgan(CURVED, contrast=0.05), np.random.default_rng(4)
    presses = [organ.press(c, rng) for c in organ.cap_points(6, rng)]
    corrected = fit_nodes(presses, KNOTS, organ.radius, geometry_of(organ))
    blind = fit_nodes(presses, KNOTS, organ.radius)
    h = 1e-5
    q = corrected.position + (organ.radius - KNOTS[-1]) * corrected.normal
    n = corrected.normal
    truth = 0.7 * np.sum((organ.force(q - h * n) - organ.force(q + h * n)) * n, axis=1) / (2 * h)
    right, wrong = (np.abs(a.friction_stiffness[:, -1] / truth - 1) for a in (corrected, blind))
    assert right.max() < 0.02
    assert wrong.mean() > 4 * right.mean()


@pytest.mark.parametrize(("noise", "bar"), [(0.0, 1.0), (0.005, 5.0)])
def test_relative_gradient_is_the_gradient_of_log_energy(noise, bar):
    """b = grad log U along the surface, 1/m, from a quarter of the depth on; it reaches 80 1/m here."""
    nodes, h = nodes_of(ORGAN, 25, noise, 2), 1e-6
    b, slope = relative_gradient(nodes)
    for knot in (3, 7, 12):
        q = nodes.position + (ORGAN.radius - KNOTS[knot]) * nodes.normal
        truth = np.stack(
            [np.log(ORGAN.energy(q + h * e) / ORGAN.energy(q - h * e)) / (2 * h) for e in np.eye(3)], -1
        )
        truth -= np.sum(truth * nodes.normal, axis=1)[:, None] * nodes.normal
        assert np.sqrt(np.mean((b[:, knot] - truth) ** 2)) < bar
    assert np.abs(b).max() > 40
    np.testing.assert_allclose(
        slope[:, 6], (b[:, 7] - b[:, 5]) / (KNOTS[7] - KNOTS[5]), atol=1e-6 * np.abs(slope).max()
    )


def test_a_short_press_follows_the_others_shape_and_says_how_deep_it_went():
    rng = np.random.default_rng(2)
    presses = [ORGAN.press(c, rng) for c in ORGAN.cap_points(12, rng)]
    whole = fit_nodes(presses, KNOTS, ORGAN.radius)
    p = presses[3]
    presses[3] = replace(p, depth=p.depth[:7], force=p.force[:7], energy=p.energy[:7])
    nodes = fit_nodes(presses, KNOTS, ORGAN.radius)
    assert abs(nodes.depth_reached[3] - 3e-3) < 1e-12 and nodes.depth_reached[4] == 5e-3
    np.testing.assert_allclose(nodes.normal_force[3], whole.normal_force[3], rtol=0.08)
    np.testing.assert_allclose(nodes.stored_energy[3], whole.stored_energy[3], rtol=0.08, atol=1e-12)
    assert np.all(np.diff(nodes.normal_force[3]) > 0)


def test_unusable_presses_are_named():
    rng = np.random.default_rng(2)
    p = ORGAN.press(ORGAN.cap_points(1, rng)[0], rng)
    assert why_unusable(p, 5e-3) is None
    short = replace(p, depth=p.depth[:3], force=p.force[:3], energy=p.energy[:3])
    assert "stopped at 1.00 mm of 5.00 mm" in (why_unusable(short, 5e-3) or "")
    with pytest.raises(ValueError, match="press 1: stopped at"):
        fit_nodes([p, short], KNOTS, ORGAN.radius)
    with pytest.raises(ValueError, match="no press"):
        fit_nodes([], KNOTS, ORGAN.radius)


def test_presses_without_lateral_ladders_borrow_the_ratio_or_have_no_spring():
    rng = np.random.default_rng(2)
    presses = [ORGAN.press(c, rng) for c in ORGAN.cap_points(4, rng)]
    bare = [replace(p, lateral=(), friction_coefficient=0.0) for p in presses]
    assert not fit_nodes(bare, KNOTS, ORGAN.radius).friction_stiffness.any()
    mixed = fit_nodes([*presses[:3], bare[3]], KNOTS, ORGAN.radius, geometry_of(ORGAN))
    whole = fit_nodes(presses, KNOTS, ORGAN.radius, geometry_of(ORGAN))
    np.testing.assert_allclose(mixed.friction_stiffness[3], whole.friction_stiffness[3], rtol=0.08, atol=1e-9)


def test_friction_may_depend_on_depth():
    rng = np.random.default_rng(2)
    p = ORGAN.press(ORGAN.cap_points(1, rng)[0], rng)
    p = replace(p, friction_coefficient=np.array([[1e-3, 0.2], [5e-3, 0.1]]))
    mu = fit_nodes([p], KNOTS, ORGAN.radius).friction_coefficient[0]
    np.testing.assert_allclose(mu, np.interp(KNOTS, [1e-3, 5e-3], [0.2, 0.1]))
    with pytest.raises(ValueError, match="none below 0"):
        fit_nodes(
            [replace(p, friction_coefficient=np.array([[1e-3, 0.2], [5e-3, -0.1]]))], KNOTS, ORGAN.radius
        )


@pytest.mark.parametrize(("depth", "count"), [(5e-3, 1), (5e-3, 0), (0.0, 13), (-1e-3, 13), (np.nan, 13)])
def test_knots_that_are_no_ladder_are_refused(depth, count):
    with pytest.raises(ValueError, match="depth knots"):
        uniform_knots(depth, count)
