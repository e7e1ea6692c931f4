# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""No energy is created: not on any path, with any friction, recomputed without the runtime (energy_books.py)."""

import numpy as np
import pytest
from energy_books import books

from palpate.runtime import Config, Session

FRICTIONS = (0.0, 0.05, 0.1, 0.3, 1.0)
ROUNDING = 1e-14  # J; sums of some thousand terms of 1e-3 J in double
Z_FREE, Z_DEEP = 5.2e-3, 1.0e-3  # m; the ball's centre just free, and 4 mm deep


def trace(cooked, q, friction=None):
    """The runtime's responses (paths, ticks) to traces q (paths, ticks, 3); each path has a session of its own."""
    config = Config(friction_coefficient=friction, speed_max=0.0)
    return np.stack([Session(cooked.field, config).tick_batch(path) for path in q])


def balance(cooked, q, friction=None):
    return books(cooked.truth, q, trace(cooked, q, friction), cooked.field.info.stiffness_max, friction)


def press_soft_drag_to_stiff_lift(ticks):
    """(1, 4 ticks, 3): the cycle of passive_friction, down at x = -2 mm, across the 6:1 step, up at 7 mm."""
    down = np.linspace((-2e-3, 0, Z_FREE), (-2e-3, 0, Z_DEEP), ticks)
    across = np.linspace((-2e-3, 0, Z_DEEP), (7e-3, 0, Z_DEEP), 2 * ticks)
    up = np.linspace((7e-3, 0, Z_DEEP), (7e-3, 0, Z_FREE), ticks)
    back = np.linspace((7e-3, 0, Z_FREE), (-2e-3, 0, Z_FREE), 2)[1:]
    return np.concatenate([down, across, up, back])[None]


@pytest.mark.parametrize("friction", FRICTIONS)
def test_press_soft_drag_to_stiff_lift_creates_nothing(plane, friction):
    b = balance(plane, press_soft_drag_to_stiff_lift(1000), friction)
    assert b.created.max() <= ROUNDING
    assert b.net_work[0] + b.leak[0] >= -ROUNDING  # closed, free at both ends
    assert b.force_error < 1e-12 and b.cone_excess < 1e-12


@pytest.mark.parametrize("friction", FRICTIONS)
def test_the_hold_leaks_in_proportion_to_the_tick(plane, friction):
    coarse, fine = (balance(plane, press_soft_drag_to_stiff_lift(n), friction) for n in (300, 2400))
    assert abs(fine.leak[0]) < abs(coarse.leak[0]) / 6
    assert coarse.leak[0] <= coarse.leak_bound[0]


@pytest.mark.parametrize("friction", FRICTIONS)
def test_force_steps_shrink_with_the_tick(plane, friction):
    """First contact, slip, the stiffness step and lift-off are all on the way."""
    coarse, fine = (balance(plane, press_soft_drag_to_stiff_lift(n), friction) for n in (300, 2400))
    assert fine.force_step[0] < coarse.force_step[0] / 6


def test_without_friction_a_closed_path_gives_all_work_back(plane):
    """Of 2 mJ moved; what is missing is the hold's and falls with the tick."""
    coarse, fine = (balance(plane, press_soft_drag_to_stiff_lift(n), 0.0) for n in (500, 4000))
    assert abs(fine.net_work[0]) < 1e-6
    assert abs(fine.net_work[0]) < abs(coarse.net_work[0]) / 6


def random_paths(rng, paths, ticks, low, high, step):
    """(paths, ticks, 3) random walks with inertia between reflecting walls, half of them closed."""
    velocity = rng.normal(size=(paths, ticks, 3)) * step
    for i in range(1, ticks):
        velocity[:, i] += 0.9 * velocity[:, i - 1]
    q = rng.uniform(low, high, (paths, 1, 3)) + np.cumsum(velocity, axis=1)
    span = np.subtract(high, low)
    q = np.abs((q - low) % (2 * span) - span)  # a triangle wave: reflection, continuous
    q = low + span - q
    q[::2] = np.concatenate([q[::2, : ticks // 2], q[::2, : ticks - ticks // 2][:, ::-1]], axis=1)
    q[:, 0, 2] = high[2]  # free at first, and at the end where closed
    q[::2, -1] = q[::2, 0]
    return q


@pytest.mark.parametrize("friction", [None, 0.0, 0.3, 1.0])
def test_ten_thousand_random_and_closed_paths_create_nothing(plane, friction):
    """2,500 for each friction; half of them closed, steps from 0.02 mm to 0.5 mm a tick."""
    rng = np.random.default_rng(7 if friction is None else int(10 * friction))
    step = 10.0 ** rng.uniform(-5, -3.6, (2500, 1, 1))
    q = random_paths(rng, 2500, 40, np.array([-6e-3, -6e-3, 0.5e-3]), np.array([10e-3, 6e-3, 6e-3]), step)
    b = balance(plane, q, friction)
    assert b.created.max() <= ROUNDING
    assert b.force_error < 1e-11 and b.cone_excess < 1e-11
    closed = b.net_work[::2] + b.leak[::2]
    assert closed.min() >= -ROUNDING


def test_random_paths_on_a_curved_organ_create_nothing(sphere):
    """The normal turns under the friction spring all the time."""
    rng = np.random.default_rng(11)
    paths, ticks = 300, 300
    angle = np.cumsum(rng.normal(size=(paths, ticks, 2)) * 0.02, axis=1) + rng.uniform(0, 6, (paths, 1, 2))
    radius = 35e-3 - 4e-3 * np.abs(np.sin(np.cumsum(rng.normal(size=(paths, ticks)) * 0.1, axis=1))) + 0.5e-3
    radius[:, 0] = 36e-3
    q = radius[..., None] * np.stack(
        [np.cos(angle[..., 0]), np.sin(angle[..., 0]) * np.cos(angle[..., 1]),
         np.sin(angle[..., 0]) * np.sin(angle[..., 1])], axis=-1)  # fmt: skip
    b = balance(sphere, q, 0.4)
    assert b.created.max() <= ROUNDING
    assert b.force_error < 1e-11


def test_the_runtimes_own_accounts_agree_with_the_recomputed_ones(plane):
    q = press_soft_drag_to_stiff_lift(500)
    r = trace(plane, q, 0.1)
    b = books(plane.truth, q, r, plane.field.info.stiffness_max, 0.1)
    last = r[0, -1]
    assert last["work_in"] == pytest.approx(b.net_work[0], abs=ROUNDING)
    assert last["hold_leak"] == pytest.approx(b.leak[0], abs=ROUNDING)
    assert last["dissipated_friction"] == pytest.approx(-b.created[0, -1], abs=ROUNDING)
    assert last["dissipated_friction"] > 1e-5
    total = last["work_in"] + last["hold_leak"] - last["dissipated_friction"] - last["dissipated_rule"]
    assert total == pytest.approx(last["stored_energy"], abs=ROUNDING)


@pytest.mark.parametrize("friction", [0.0, 0.1, 0.3])
def test_dragging_over_the_step_arrives_at_the_stuck_response(plane, friction):
    dragged = trace(plane, press_soft_drag_to_stiff_lift(1000)[:, :3000], friction)[0, -1]
    straight = np.linspace((7e-3, 0, Z_FREE), (7e-3, 0, Z_DEEP), 1000)[None]
    stuck = trace(plane, straight, friction)[0, -1]
    assert dragged["normal_force"] == pytest.approx(stuck["normal_force"], rel=0.05)
    assert (
        dragged["normal_force"]
        > 3 * trace(plane, press_soft_drag_to_stiff_lift(1000), friction)[0, 999]["normal_force"]
    )


@pytest.mark.parametrize("friction", [0.1, 0.3])
def test_the_anchor_follows_a_long_drag(plane, friction):
    r = trace(plane, press_soft_drag_to_stiff_lift(1000), friction)[0, 1500:3000]
    stretch = np.linalg.norm(r["reference_point"] - r["anchor"], axis=1)
    limit = r["friction_coefficient"] * r["normal_force"] / r["friction_stiffness"]
    assert np.all(stretch <= limit * (1 + 1e-9)) and np.all(stretch > 0.5 * limit)
