# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The published interpolation of forces at the contact point: what it creates, and how the energy rule ends it."""

from dataclasses import replace

import numpy as np
import pytest
import synthetic_field

from palpate.fields.cook import cook
from palpate.fields.response_field import DepthCurves
from palpate.runtime import Config, Field, Response, RuntimeFailure, Session, Tick

DEPTH = 4e-3  # m
SOFT = 75.0 * DEPTH**2 + 5e5 * DEPTH**4  # J, of f = 150 z + 2e6 z^3
ROUNDING = 1e-13  # J


@pytest.fixture(scope="module")
def two_points():
    """f = 150 z + 2e6 z^3 and six times that, 5 mm apart."""
    field = synthetic_field.FIELDS["plane"]()
    intervals, end = 200, synthetic_field.DEPTH_MAX
    h, z = end / intervals, np.linspace(0, end, intervals + 1)
    f, s = 75 * z**2 + 5e5 * z**4, 150 * z + 2e6 * z**3
    rise = np.diff(f) / h
    rows = np.stack(
        [f[:-1], s[:-1], (3 * rise - 2 * s[:-1] - s[1:]) / h, (s[:-1] + s[1:] - 2 * rise) / h**2], axis=1
    )
    return Field.open(cook(replace(field, energy_curves=DepthCurves(end, np.stack([rows, 0 * rows])))))


def press_soft_drag_to_stiff_lift(ticks=4000):
    z = 5e-3 - DEPTH
    down = np.linspace((-4e-3, 0, 5.2e-3), (-4e-3, 0, z), ticks)
    across = np.linspace((-4e-3, 0, z), (9e-3, 0, z), ticks)
    return np.concatenate([down, across, np.linspace((9e-3, 0, z), (9e-3, 0, 5.2e-3), ticks)])


def cycle(field, response, friction=0.0, ticks=4000):
    q = press_soft_drag_to_stiff_lift(ticks)
    r = Session(field, Config(friction_coefficient=friction, speed_max=0.0, response=response)).tick_batch(q)
    return q, r, -np.sum(r["force"][:-1] * np.diff(q, axis=0))


def test_as_published_a_cycle_creates_six_point_six_millijoules(two_points):
    _, r, work = cycle(two_points, Response.AXIAL_UNGUARDED)
    assert -work == pytest.approx(5 * SOFT, rel=5e-3)
    assert 6.6e-3 < -work < 6.7e-3
    last = r[-1]
    assert last["injected"] == pytest.approx(5 * SOFT, rel=5e-3)
    spent = last["dissipated_friction"] + last["dissipated_rule"]
    assert last["work_in"] + last["injected"] + last["hold_leak"] == pytest.approx(spent, abs=ROUNDING)


@pytest.mark.parametrize("friction", [0.0, 0.1, 0.3])
def test_with_the_rule_it_creates_nothing(two_points, friction):
    _, r, work = cycle(two_points, Response.AXIAL, friction)
    last = r[-1]
    assert last["injected"] == 0 and last["stored_energy"] == 0
    assert work + last["hold_leak"] >= -ROUNDING
    assert np.any(r["status"] & Tick.RULE_YIELDED)


def test_with_the_rule_a_drag_to_stiff_tissue_does_not_arrive_and_the_potential_does(two_points):
    """What the guard costs, and why the potential is the default."""
    arrived = {}
    for response in (Response.AXIAL, Response.POTENTIAL):
        arrived[response] = cycle(two_points, response, ticks=2000)[1][3999]["normal_force"]
    stuck = 6 * (150 * DEPTH + 2e6 * DEPTH**3)
    assert arrived[Response.POTENTIAL] == pytest.approx(stuck, rel=0.05)
    assert arrived[Response.AXIAL] < 0.6 * stuck


def test_axial_forces_have_no_part_along_the_surface_without_friction(two_points):
    _, r, _ = cycle(two_points, Response.AXIAL)
    pressed = r["normal_force"] > 0.1
    across = np.linalg.norm(
        r["force"] - np.sum(r["force"] * r["normal"], axis=1)[:, None] * r["normal"], axis=1
    )
    assert across[pressed].max() < 1e-9
    _, r, _ = cycle(two_points, Response.POTENTIAL)
    assert np.abs(r["force"][:, 0]).max() > 0.5  # the lateral push that was left out


def test_an_axial_force_is_the_sum_of_curves_where_nothing_yielded(two_points):
    _, r, _ = cycle(two_points, Response.AXIAL_UNGUARDED)
    at = 5900  # on the slope
    sample = two_points.sample(r["reference_point"][at : at + 1])[0]
    assert r["normal_force"][at] == pytest.approx(sample["normal_force"], rel=1e-6)


@pytest.mark.parametrize("response", [Response.AXIAL, Response.AXIAL_UNGUARDED])
def test_random_walks_balance_and_only_the_unguarded_one_is_injected_into(two_points, response):
    rng = np.random.default_rng(4)
    q = np.array([0, 0, 4e-3]) + np.cumsum(rng.normal(size=(20000, 3)) * 3e-5, axis=0)
    q = np.array([2e-3, 0, 4.5e-3]) + 5e-3 * np.sin(q / 5e-3 * 3) * [1, 1, 0.6]
    q[0] = (2e-3, 0, 6e-3)
    r = Session(two_points, Config(friction_coefficient=0.1, speed_max=0.0, response=response)).tick_batch(q)
    spent = r["stored_energy"] + r["dissipated_friction"] + r["dissipated_rule"]
    assert np.abs(r["work_in"] + r["injected"] + r["hold_leak"] - spent).max() < ROUNDING * 10
    assert np.all(np.diff(r["dissipated_rule"]) >= 0)
    assert r["injected"].any() == (response == Response.AXIAL_UNGUARDED)


def test_an_unknown_response_is_refused(two_points):
    with pytest.raises(RuntimeFailure):
        Session(two_points, Config(response=3))
