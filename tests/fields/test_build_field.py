# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The built field against an organ that is known exactly, and against itself."""

from dataclasses import replace

import numpy as np
import pytest
from known_organ import BALL, FLAT, KnownOrgan, field_of, geometry_of, held_out, nodes_of

from palpate.fields.build_field import build_field
from palpate.fields.cook import cook
from palpate.fields.interpolation import energy_hessian, evaluate
from palpate.fields.lattice_stencil import sample_lattice
from palpate.fields.response_field import ToolReference
from palpate.fields.rfield_read import read_header
from palpate.fields.shared_curves import evaluate_curves

ORGAN = KnownOrgan(FLAT)
TOOL = ToolReference("ball", "sphere", ORGAN.radius, {"radius": ORGAN.radius}, "")


def relative_errors(organ: KnownOrgan, **options) -> tuple[np.ndarray, np.ndarray]:
    """Normal and lateral force error, relative to the normal force at the same place and depth."""
    q, n = held_out(organ)
    true, said = organ.force(q), evaluate(field_of(organ, **options), q).force
    size = np.sum(true * n, axis=1)
    off = said - true
    normal = np.sum(off * n, axis=1)
    return np.abs(normal) / size, np.linalg.norm(off - normal[:, None] * n, axis=1) / size


def band(count: int, seed: int = 0, extent: float = 19e-3) -> np.ndarray:
    """Tool positions from just outside contact to depth_max."""
    rng = np.random.default_rng(seed)
    c = ORGAN.random_cap(count, rng, extent)
    return c + rng.uniform(0.0, 5.3e-3, (count, 1)) * ORGAN.normal(c)


@pytest.mark.parametrize(
    ("axes", "count", "bar"), [(BALL, 12, 0.015), (BALL, 25, 0.004), (FLAT, 12, 0.015), (FLAT, 25, 0.004)]
)
def test_held_out_force_without_noise(axes, count, bar):
    normal, lateral = relative_errors(KnownOrgan(axes), count=count)
    assert np.quantile(normal, 0.95) < bar
    assert np.quantile(lateral, 0.95) < bar


def test_held_out_force_with_half_a_percent_of_noise():
    normal, lateral = relative_errors(ORGAN, count=25, noise=0.005)
    assert np.quantile(normal, 0.95) < 0.015
    assert np.quantile(lateral, 0.95) < 0.006


def test_lateral_reactions_save_presses():
    with_them, _ = relative_errors(ORGAN, count=12)
    without, _ = relative_errors(ORGAN, count=12, with_gradients=False)
    assert np.quantile(with_them, 0.95) < 0.3 * np.quantile(without, 0.95)


def test_friction_spring_and_coefficient_are_rendered():
    field = field_of(ORGAN, 25)
    q, n = held_out(ORGAN)
    said, h = evaluate(field, q), 1e-5
    truth = (
        ORGAN.stiffness_ratio
        * np.sum((ORGAN.force(q - h * n) - ORGAN.force(q + h * n)) * n, axis=1)
        / (2 * h)
    )
    error = np.abs(said.friction_stiffness / truth - 1)
    assert (
        np.median(error) < 0.02 and np.quantile(error, 0.95) < 0.08
    )  # U's own curvature along the surface remains
    np.testing.assert_allclose(said.friction_coefficient, 0.1, rtol=1e-3)


def test_force_is_minus_the_gradient_of_the_energy():
    field, h = field_of(ORGAN, 25), 1e-7
    q = np.concatenate([band(300), band(300, 1, 34e-3)])  # reach and margin
    said = evaluate(field, q)
    assert said.valid.all()
    numeric = np.stack(
        [
            (evaluate(field, q + h * e).energy - evaluate(field, q - h * e).energy) / (2 * h)
            for e in np.eye(3)
        ],
        axis=-1,
    )
    np.testing.assert_allclose(said.force, -numeric, atol=1e-6 * np.abs(said.force).max())


def test_energy_hessian_is_the_derivative_of_the_gradient():
    field, q, h = field_of(ORGAN, 25), band(100), 1e-8
    numeric = np.stack(
        [
            (evaluate(field, q + h * e).gradient - evaluate(field, q - h * e).gradient) / (2 * h)
            for e in np.eye(3)
        ],
        axis=-1,
    )
    hessian = energy_hessian(field, q)
    assert np.quantile(np.abs(hessian - numeric).max(axis=(1, 2)), 0.95) < 1e-5 * np.abs(hessian).max()


def test_force_is_continuous_everywhere_also_at_contact_reach_and_margin():
    """Along straight lines through reach, margin and beyond, force steps fall with the path's steps."""
    field = field_of(ORGAN, 25)
    for angle in (0.3, 2.0, 4.1):
        c = ORGAN.foot(np.array([[39e-3 * np.cos(angle), 39e-3 * np.sin(angle), 18e-3]]))[0]
        start, end = np.array([-2e-3, 1e-3, 0.033]), c + 1e-3 * ORGAN.normal(c[None])[0]
        steps = []
        for count in (500, 5000):
            said = evaluate(field, start + np.linspace(0, 1, count)[:, None] * (end - start))
            inside = said.valid.copy()
            steps.append(np.linalg.norm(np.diff(said.force[inside], axis=0), axis=1).max())
            last = np.flatnonzero(inside)[-1]
            assert np.abs(said.force[last]).max() == 0.0  # faded before the geometry ends
        assert steps[1] < 0.12 * steps[0]


def test_nothing_is_felt_beyond_the_margin_and_before_contact():
    field = field_of(ORGAN, 25)
    c = ORGAN.random_cap(2000, np.random.default_rng(0), 36e-3)
    far = np.linalg.norm(c[:, :2], axis=1) >= 35e-3
    said = evaluate(field, c[far] + 2e-3 * ORGAN.normal(c[far]))
    assert far.sum() > 10 and np.abs(said.force).max() == 0.0 and np.abs(said.energy).max() == 0.0
    outside = evaluate(field, c + 5.1e-3 * ORGAN.normal(c))
    assert np.abs(outside.force).max() == 0.0 and not outside.friction_stiffness.any()


def test_a_reader_may_drop_every_cell_that_touches_an_absent_block():
    field = field_of(ORGAN, 25)
    q = band(3000, 2, 36e-3)
    sample = sample_lattice(field.amplitudes, q)
    assert (~sample.present).any()
    assert np.abs(sample.value[~sample.present]).max() == 0.0


@pytest.mark.parametrize("noise", [0.0, 0.005])
def test_force_rises_with_depth_as_at_the_nodes(noise):
    """Phi'' = sum phi_r'' a_r >= 0 at fixed amplitudes, at every depth."""
    field = field_of(ORGAN, 25, noise)
    c = ORGAN.cap_points(100, np.random.default_rng(4))
    amplitude = sample_lattice(field.amplitudes, c + 2e-3 * ORGAN.normal(c)).value[
        :, : field.energy_curves.curve_count
    ]
    bend = evaluate_curves(field.energy_curves, np.linspace(1e-5, 5e-3, 200))[2] @ amplitude.T
    assert bend.min() > -0.01 * bend.max()
    assert (bend < 0).mean() < 0.001


def test_representation_is_reported_and_true():
    field, nodes = field_of(ORGAN, 25), nodes_of(ORGAN, 25, 0.0, 2)
    told = field.representation
    knots = nodes.depth_knots[1:]
    worst = []
    for i in range(nodes.node_count):
        q = nodes.position[i] + (ORGAN.radius - knots)[:, None] * nodes.normal[i]
        f = evaluate(field, q).force @ nodes.normal[i]
        worst.append(np.abs(f - nodes.normal_force[i, 1:]) / nodes.normal_force[i, -1])
    assert told["node_force_max"] == pytest.approx(np.max(worst))
    assert told["node_force_max"] < 0.01 and told["site_force_p95"] < 0.003
    for key in (
        "node_energy_p95",
        "node_lateral_p95",
        "leave_one_out_force_p95",
        "low_rank_force_p95",
        "kriging_length",
    ):
        assert np.isfinite(told[key])


def test_leave_one_out_tells_the_order_of_the_held_out_error():
    nodes = nodes_of(ORGAN, 50, 0.005, 2)
    field = build_field(nodes, geometry_of(ORGAN), TOOL, ORGAN.reach)
    normal, _ = relative_errors(ORGAN, count=50, noise=0.005)
    told = field.representation["leave_one_out_force_p50"]
    assert 0.5 * np.median(normal) < told < 5 * np.median(normal)


def test_invalid_points_are_zero_and_said_so():
    said = evaluate(field_of(ORGAN, 25), np.array([[np.nan, 0, 0], [1.0, 1.0, 1.0], [0.0, 0.0, 0.0]]))
    assert not said.valid.any() and not said.force.any() and np.isnan(said.depth).all()


def test_same_nodes_give_the_same_bits():
    nodes = nodes_of(ORGAN, 12, 0.005, 2)
    a, b = (build_field(nodes, geometry_of(ORGAN), TOOL, ORGAN.reach) for _ in range(2))
    assert np.array_equal(a.amplitudes.coefficients, b.amplitudes.coefficients)
    assert np.array_equal(a.energy_curves.coefficients, b.energy_curves.coefficients)
    assert a.representation == b.representation


def test_one_node_and_no_friction_still_make_a_field():
    organ = KnownOrgan(FLAT, friction=0.0, stiffness_ratio=0.0)
    field = field_of(organ, 1)
    c = field.nodes.position[0]
    said = evaluate(field, (c + 1e-3 * field.nodes.normal[0])[None])
    assert said.normal_force[0] > 0 and said.friction_coefficient[0] == 0.0


def test_a_margin_that_would_be_felt_within_the_reach_is_refused():
    with pytest.raises(ValueError, match=r"at least 3\.75 amplitude spacings"):
        build_field(nodes_of(ORGAN, 12, 0.005, 2), geometry_of(ORGAN), TOOL, ORGAN.reach, margin=12e-3)


def test_several_ways_of_touching_in_one_field_are_each_as_true_as_alone():
    """The same places pressed in two ways whose moduli vary differently; shared curves, amplitudes of their own."""
    organs = ORGAN, KnownOrgan(FLAT, contrast=0.3)
    upright, tilted = (nodes_of(organ, 25, 0.0, 2) for organ in organs)
    other = replace(TOOL, tilt=0.5, hash="tilted")
    field = build_field(upright, geometry_of(ORGAN), TOOL, ORGAN.reach, tilted=[(other, tilted)])
    q, _ = held_out(ORGAN)
    for organ, way in zip(organs, field.fields_by_way(), strict=True):
        force = organ.force(q)
        error = np.linalg.norm(evaluate(way, q).force - force, axis=1) / np.linalg.norm(force, axis=1)
        assert np.quantile(error, 0.95) < 0.006
    assert field.fields_by_way()[1].tool.hash == "tilted"
    header = read_header(cook(field))
    assert header["way_count"] == 2 and header["way_cosine"][1] == pytest.approx(np.cos(0.5))
