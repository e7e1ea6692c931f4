# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rate, time left and worst error of a run, by a clock that the test turns."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from stand_in_solvers import jobs

from palpate.author.effort import PRESS_SECONDS
from palpate.author.press_jobs import PressJob, PressOutcome
from palpate.author.press_rate import PressRate


class Clock:
    now = 0.0

    def __call__(self) -> float:
        return self.now


def outcome(job: PressJob, seconds: float = 10.0, fresh: bool = True, **values: Any) -> PressOutcome:
    found = {"converged": True, "reason": "", "seconds": seconds, **values}
    return PressOutcome(job, "key", {"depth": np.zeros(1)}, found, fresh)


def test_kept_presses_count_as_done_but_not_in_the_rate() -> None:
    clock, asked = Clock(), jobs(6)
    rate = PressRate(asked, lambda: 2, clock)
    for job in asked[:2]:
        rate.arrived(outcome(job, fresh=False))
    assert rate.per_minute is None
    clock.now = 10.0
    rate.arrived(outcome(asked[2]))
    rate.arrived(outcome(asked[3]))
    assert rate.per_minute == pytest.approx(12.0)
    assert rate.left == pytest.approx(2 * 10.0 / 2)


def test_time_left_takes_each_fidelity_by_what_it_took_and_the_workers_at_work() -> None:
    near = jobs(4)
    full = [replace(job, fidelity="full") for job in near]
    workers = [2]
    rate = PressRate([*full, *near], lambda: workers[0], Clock())
    planned = 4 * PRESS_SECONDS["full"] + 4 * PRESS_SECONDS["near_field"]
    assert rate.left == pytest.approx(planned / 2)
    rate.arrived(outcome(full[0], seconds=2 * PRESS_SECONDS["full"]))  # twice as slow as planned
    assert rate.left == pytest.approx(2 * (planned - PRESS_SECONDS["full"]) / 2)
    rate.arrived(outcome(near[0], seconds=1.0))
    workers[0] = 1
    assert rate.left == pytest.approx(3 * 2 * PRESS_SECONDS["full"] + 3 * 1.0)


def test_the_worst_error_so_far_is_named_for_what_it_is() -> None:
    asked = jobs(4)
    rate = PressRate(asked, lambda: 1, Clock())
    rate.arrived(outcome(asked[0], work_mismatch=0.002))
    assert "work and energy differ by 0.2 %" in rate.note
    rate.arrived(outcome(asked[1], work_mismatch=0.001, estimate=None))
    assert "0.2 %" in rate.note
    rate.arrived(outcome(asked[2], estimate=0.013))
    assert "near field off by an estimated 1.3 %" in rate.note
    rate.arrived(outcome(asked[3], converged=False))
    assert "1 failed" in rate.note
