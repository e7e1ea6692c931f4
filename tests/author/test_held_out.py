# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A press whose truth is the field itself must be judged as exact; a wrong one by exactly how wrong it is."""

import numpy as np
import pytest
from known_organ import KnownOrgan, field_of

from palpate.author.held_out import judgement, percentiles
from palpate.author.press_jobs import PressJob, PressOutcome
from palpate.author.tool_stage import ToolShape
from palpate.fields.cook import cook
from palpate.fields.interpolation import evaluate
from palpate.runtime import Field

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


def test_a_failed_press_is_counted_and_never_met(field):
    good, bad = outcome(field, 1.0), outcome(field, 1.0)
    bad.values.update(converged=False, reason="stopped before 1 mm")
    judged = judgement(Field.open(cook(field)), 5e-3, [good, bad], [], 0.035)
    assert judged["failed"] == 1
    assert not judged["met"]


def test_percentiles_of_nothing_are_nothing():
    assert percentiles([None, None]) is None
