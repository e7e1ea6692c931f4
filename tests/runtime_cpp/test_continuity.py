# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Force steps shrink in proportion to the motion's steps, at each place where a formula changes, one at a time."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest
import synthetic_field

from palpate.runtime import Config, Field, Region, Session, Tick

FINER = 8


class Event(NamedTuple):
    """What the path does after it went down in the air and to `start`; what its answers have to show."""

    start: tuple[float, float, float]  # m
    points: tuple[tuple[float, float, float], ...]  # m; straight lines from the start
    happens: Callable[[np.ndarray], bool]
    frictions: tuple[float, ...] = (0.0, 0.1, 0.3)


def slips_after_sticking(r):
    slipping = (r["status"] & Tick.SLIPPING) != 0
    return bool(slipping[-1]) and not slipping[1]


def turns_around(r):
    stretch = (r["reference_point"] - r["anchor"])[:, 0]
    return stretch.max() > 0 > stretch.min() and slips_after_sticking(r)


def stiffens_sixfold(r):
    return r["normal_force"][-1] > 3.0 * r["normal_force"][0]


def crosses_cells(r):
    """Borders of the cells of both lattices (1.5 mm), across and in depth."""
    cells = np.floor(r["reference_point"] / 1.5e-3)
    return all(len(np.unique(cells[:, axis])) > 2 for axis in range(3))


EVENTS = {
    "first contact": Event(
        (-4e-3, 0, 5.1e-3),
        ((-3.9e-3, 0, 4.9e-3),),
        lambda r: not r["force"][0].any() and r["force"][-1].any(),
    ),
    "lift-off of a stretched spring": Event(
        (-4e-3, 0, 4e-3),
        ((-3e-3, 0, 4e-3), (-3e-3, 0, 5.1e-3)),
        lambda r: r["force"][0].any() and not r["force"][-1].any(),
    ),
    "slip": Event((-6e-3, 0, 3e-3), ((-4e-3, 0, 3e-3),), slips_after_sticking, (0.1, 0.3)),
    "slip the other way": Event(
        (-6e-3, 0, 3e-3), ((-4e-3, 0, 3e-3), (-6e-3, 0, 3e-3)), turns_around, (0.1, 0.3)
    ),
    "between nodes": Event((-8e-3, -5e-3, 4.6e-3), ((-3e-3, 4e-3, 0.4e-3),), crosses_cells),
    "a region six times as stiff": Event((-2e-3, 0, 2e-3), ((7e-3, 0, 2e-3),), stiffens_sixfold),
    "back to soft tissue": Event(
        (7e-3, 0, 2e-3), ((-2e-3, 0, 2e-3),), lambda r: r["normal_force"][-1] < r["normal_force"][0] / 3
    ),
    "the end of the curves": Event(
        (-4e-3, 0, 0.5e-3),
        ((-4e-3, 0.5e-3, -0.5e-3),),
        lambda r: (r["status"][0] & Tick.EXTRAPOLATED) == 0 < (r["status"][-1] & Tick.EXTRAPOLATED),
    ),
}


def path(event: Event, ticks: int) -> tuple[np.ndarray, int]:
    """(n, 3) m with `ticks` ticks to each line, and where the event's own part begins."""
    down = np.linspace((event.start[0], event.start[1], 6e-3), event.start, 2000)
    parts, here = [down], event.start
    for there in event.points:
        parts.append(np.linspace(here, there, ticks + 1)[1:])
        here = there
    return np.concatenate(parts), len(down)


def steps(field, event: Event, friction: float, ticks: int, **config) -> tuple[float, np.ndarray]:
    """The largest force step (N) in the event's part, and its answers."""
    q, begin = path(event, ticks)
    r = Session(field, Config(friction_coefficient=friction, speed_max=0.0, **config)).tick_batch(q)
    assert not (r["status"] & ~np.uint32(Tick.FELT)).any()
    return float(np.linalg.norm(np.diff(r["force"][begin - 1 :], axis=0), axis=1).max()), r[begin - 1 :]


@pytest.mark.parametrize(
    ("name", "friction"), [(name, mu) for name, event in EVENTS.items() for mu in event.frictions]
)
def test_force_steps_shrink_with_the_motions(plane, name, friction):
    event = EVENTS[name]
    coarse, _ = steps(plane.field, event, friction, 200)
    fine, r = steps(plane.field, event, friction, 200 * FINER)
    assert event.happens(r)
    assert 0.0 < fine < coarse / (0.8 * FINER)


@pytest.mark.parametrize("limit", [{"force_max": 0.05}, {"passivity_control": True}])
def test_a_limit_sets_in_without_a_step(plane, limit):
    event = Event((-4e-3, 0, 4.5e-3), ((-4e-3, 0, 1e-3), (-4e-3, 0, 4.5e-3)), lambda r: True)
    coarse, r = steps(plane.field, event, 0.1, 200, **limit)
    fine, _ = steps(plane.field, event, 0.1, 200 * FINER, **limit)
    assert (r["surface_offset"] > 0).any()
    assert 0.0 < fine < coarse / (0.8 * FINER)


@pytest.mark.parametrize("friction", [0.0, 0.1, 0.3])
def test_force_steps_shrink_with_the_motions_on_a_curved_organ(sphere, friction):
    """Around the organ by 0.6 rad over the stiffness step, the normal turning all the way, and off."""

    def largest(ticks):
        angle = np.concatenate([np.full(ticks, -0.2), np.linspace(-0.2, 0.4, 2 * ticks), np.full(ticks, 0.4)])
        lift = np.concatenate(
            [np.linspace(5.5e-3, 2e-3, ticks), np.full(2 * ticks, 2e-3), np.linspace(2e-3, 5.5e-3, ticks)]
        )
        q = (30e-3 + lift)[:, None] * np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=1)
        r = Session(sphere.field, Config(friction_coefficient=friction, speed_max=0.0)).tick_batch(q)
        assert r["normal_force"].max() > 0.3 and not r["force"][-1].any()
        return np.linalg.norm(np.diff(r["force"], axis=0), axis=1).max()

    assert largest(200 * FINER) < largest(200) / (0.8 * FINER)


@pytest.mark.parametrize("friction", [0.0, 0.1, 0.3])
def test_dragging_over_the_step_of_a_curved_organ_arrives_at_the_stuck_response(sphere, friction):
    def at(angle, height):
        return height[:, None] * np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=1)

    down = np.linspace(36e-3, 32e-3, 500)
    dragged = np.concatenate(
        [at(np.full(500, -0.15), down), at(np.linspace(-0.15, 0.3, 3000), np.full(3000, 32e-3))]
    )
    config = Config(friction_coefficient=friction, speed_max=0.0)
    arrived = Session(sphere.field, config).tick_batch(dragged)
    stuck = Session(sphere.field, config).tick_batch(at(np.full(500, 0.3), down))[-1]
    assert arrived["normal_force"][-1] == pytest.approx(stuck["normal_force"], rel=0.05)
    assert arrived["normal_force"][-1] > 3.0 * arrived["normal_force"][499]


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_force_steps_shrink_with_the_tilts(friction):
    """Held still and rocked through all ways of touching, softer and stiffer: the surface yields without a step."""
    field = Field.open(synthetic_field.three_ways())
    place = (-4e-3, 0, 2e-3)

    def largest(ticks):
        session = Session(field, Config(friction_coefficient=friction))
        upright = np.tile((0.0, 0.0, 0.0, 1.0), (500, 1))
        session.tick_batch(np.linspace((-4e-3, 0, 6e-3), place, 500), orientations=upright)
        angle = np.arccos(0.75 + 0.25 * np.cos(np.linspace(0, 4 * np.pi, ticks)))
        turned = np.stack([0 * angle, np.sin(angle / 2), 0 * angle, np.cos(angle / 2)], axis=1)
        r = session.tick_batch(np.tile(place, (ticks, 1)), orientations=turned)
        assert (r["status"] & Tick.RULE_YIELDED).any() and r["force"][-1, 2] > 0.01
        return np.linalg.norm(np.diff(r["force"], axis=0), axis=1).max()

    assert largest(500 * FINER) < largest(500) / (0.8 * FINER)


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_only_where_nothing_was_pressed_force_ends_at_once_and_the_status_says_so(plane, friction):
    """The border of the reach is a refusal, not a place to be felt."""
    x = np.linspace(-10e-3, -22e-3, 4000)
    q = np.concatenate(
        [np.linspace((-10e-3, 0, 8e-3), (-10e-3, 0, 2e-3), 500), np.stack([x, 0 * x, 0 * x + 2e-3], axis=1)]
    )
    r = Session(plane.field, Config(friction_coefficient=friction)).tick_batch(q)
    refused = np.flatnonzero(r["status"] & Tick.UNREACHED)
    first = refused[0]
    assert r["region"][first] == Region.UNREACHED and not r["force"][first:].any()
    inside = np.linalg.norm(np.diff(r["force"][500:first], axis=0), axis=1)
    assert inside.max() < 0.01 * np.linalg.norm(r["force"][first - 1])
