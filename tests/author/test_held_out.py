# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A press whose truth is the field itself must be judged as exact; a wrong one by exactly how wrong it is."""

from itertools import pairwise

import numpy as np
import pytest
from known_organ import KnownOrgan, field_of

from palpate.author.held_out import judgement, percentiles
from palpate.author.press_jobs import PressJob, PressOutcome
from palpate.author.tool_stage import ToolShape
from palpate.fields.cook import cook
from palpate.fields.interpolation import evaluate
from palpate.runtime import Config, Field, Session

BALL = ToolShape("sphere", (("radius", 5e-3),))


@pytest.fixture(scope="module")
def field():
    return field_of(KnownOrgan(), 12)


def outcome(field, factor: float, sideways: float = 0.0) -> PressOutcome:
    c, n = field.nodes.position[0], field.nodes.normal[0]
    depth = np.linspace(0.0, 5e-3, 11)
    response = evaluate(field, c + (5e-3 - depth[:, None]) * n)
    tangent = np.cross(n, [1.0, 0.0, 0.0])
    tangent /= np.linalg.norm(tangent)
    f_n = response.force @ n
    force = response.force + (factor - 1.0) * f_n[:, None] * n + sideways * f_n[:, None] * tangent
    arrays = {"contact_point": c, "normal": n, "depth": depth, "force_vector": force}
    values = {"converged": True, "reason": "", "seconds": 1.0, "lateral": []}
    return PressOutcome(PressJob(tuple(c), BALL, tuple(depth[1:]), "full"), "key", arrays, values)


def test_a_press_that_the_field_equals_has_no_error(field):
    judged = judgement(Field.open(cook(field)), 5e-3, [outcome(field, 1.0)], [], 0.035)
    assert judged["force_error"]["max"] < 2e-3  # float32 amplitudes and 16-bit distances
    assert judged["lateral_error"]["max"] < 2e-3
    assert judged["met"]


@pytest.mark.parametrize("wrong", [0.02, 0.10])
def test_a_wrong_press_is_wrong_by_that_much(field, wrong):
    judged = judgement(Field.open(cook(field)), 5e-3, [outcome(field, 1.0 + wrong, wrong)], [], 0.035)
    assert judged["force_error"]["p50"] == pytest.approx(wrong / (1.0 + wrong), abs=2e-3)
    assert judged["lateral_error"]["p50"] == pytest.approx(wrong / (1.0 + wrong), abs=2e-3)
    assert judged["met"] == (wrong < 0.035)


@pytest.mark.parametrize(("wrong", "met"), [(0.0, True), (0.1, False)])
def test_a_slide_is_judged_where_finite_elements_came_to_in_both_ways(field, wrong, met):
    """Sliding at constant height over a field of the same friction: f_n n - grad U aside - mu f_n s."""
    one = outcome(field, 1.0)
    c, n = one.arrays["contact_point"], one.arrays["normal"]
    s = np.cross(n, [1.0, 0.0, 0.0])
    s /= np.linalg.norm(s)
    depth, way = 4e-3, 3e-3
    paths = []
    for direction in (s, -s):
        # the runtime itself says what the ball feels there; friction holds against the way
        session = Session(Field.open(cook(field)), Config(friction_coefficient=0.1))
        ends = [c + (6e-3) * n, c + (5e-3 - depth) * n, c + (5e-3 - depth) * n + way * direction]
        legs = [a + np.linspace(0.0, 1.0, 400)[:, None] * (b - a) for a, b in pairwise(ends)]
        forces = session.tick_batch(np.concatenate(legs))["force"]
        force, pressed = forces[-1], 1.25 * forces[399]
        true = force * (1.0 + wrong)
        paths.append(
            {
                "depth": depth,
                "direction": direction.tolist(),
                "way": [0.0, way],
                "force_vector": [pressed.tolist(), true.tolist()],
                "steady": True,
            }
        )
    one.values["drag"] = {"paths": paths}
    judged = judgement(Field.open(cook(field)), 5e-3, [one], [], 0.035)
    assert judged["slid_error"]["max"] == pytest.approx(wrong / (1.0 + wrong), abs=0.02)
    assert judged["met"] == met
    slides = judged["presses"][0]["slides"]
    resistance = [np.dot(slide["rendered_force"], slide["move"]) for slide in slides]
    assert (
        sum(resistance) < 0.0
    )  # friction acts against both ways, the push along the surface with one of them
    assert judged["friction_press_error"]["max"] == pytest.approx(0.2, abs=0.02)
    half = judgement(Field.open(cook(field)), 5e-3, [one], [], 0.035, lambda at: (at - c) @ s)
    there, back = half["presses"][0]["slides"]  # the first ends outside
    assert there["error"] is None and there["error_beyond"] == pytest.approx(slides[0]["error"])
    assert half["slid_error"]["max"] == back["error"] and half["slides_beyond_reach"] == 1


def test_a_lateral_push_that_is_off_misses_the_tolerance(field):
    judged = judgement(Field.open(cook(field)), 5e-3, [outcome(field, 1.0, 0.05)], [], 0.035)
    assert judged["force_error"]["max"] < 0.035 < judged["lateral_error"]["p95"]
    assert not judged["met"]


def test_a_failed_press_is_counted_and_never_met(field):
    good, bad = outcome(field, 1.0), outcome(field, 1.0)
    bad.values.update(converged=False, reason="stopped before 1 mm")
    judged = judgement(Field.open(cook(field)), 5e-3, [good, bad], [], 0.035)
    assert judged["failed"] == 1
    assert not judged["met"]


def test_percentiles_of_nothing_are_nothing():
    assert percentiles([None, None]) is None
