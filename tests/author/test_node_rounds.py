# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rounds of nodes through the executor that presses, with presses that are known (tests/fields/known_terrain.py)."""

from concurrent.futures import Future
from pathlib import Path

import numpy as np
import pytest
from known_terrain import DEPTH, RADIUS, KnownTerrain
from stand_in_solvers import BALL, AnyOrgan

from palpate.author.errors import Interrupted
from palpate.author.node_rounds import NodeRounds
from palpate.author.press_jobs import PressJob, run_jobs
from palpate.author.sampling_by_error import SamplingByError
from palpate.author.store import Store
from palpate.fields.node_fit import PressArrays, uniform_knots, why_unusable

KNOWN = KnownTerrain(seed=2, half=(0.04, 0.03), nodule=False, places=300)
MOST, WIDTH, SEEDS = 26, 3, 12
BAD = 5
"""The place of this seed gives a press that is of no use."""


class Shuffled:
    """An executor whose presses end in an order of its own; its `stop_after`-th press is a Ctrl-C."""

    workers = WIDTH

    def __init__(self, seed: int, stop_after: int = 10**9) -> None:
        self.pending: list[tuple[Future, tuple]] = []
        self.random, self.left, self.pressed = np.random.default_rng(seed), stop_after, 0

    def submit(self, fn, *args) -> Future:
        future: Future = Future()
        self.pending.append((future, (fn, args)))
        return future

    def end_some(self) -> None:
        for _ in range(int(self.random.integers(1, 3))):
            if self.pending:
                future, (fn, args) = self.pending.pop(int(self.random.integers(len(self.pending))))
                self.left -= 1
                self.pressed += 1
                if self.left < 0:
                    raise KeyboardInterrupt
                future.set_result(fn(*args))


def press(mesh: AnyOrgan, job: PressJob, folder: str):
    place = int(np.argmin(np.linalg.norm(KNOWN.terrain.position - job.contact_point, axis=1)))
    p = KNOWN.press(place)
    deep = 3 if place == KNOWN.terrain.even[BAD] else len(p.depth)
    arrays = {"depth": p.depth[:deep], "force_vector": p.force[:deep], "energy": p.energy[:deep]}
    return arrays, {"converged": deep > 3, "reason": "" if deep > 3 else "stopped", "seconds": 1.0}


def usable(outcome) -> PressArrays | None:
    a = outcome.arrays
    up = np.array([0.0, 0.0, 1.0])
    p = PressArrays(np.array(outcome.job.contact_point), up, a["depth"], a["force_vector"], a["energy"])
    return None if why_unusable(p, DEPTH) else p


def run(
    folder: Path,
    monkeypatch,
    order: int,
    stop_after: int = 10**9,
    late: int = 10**9,
    tolerance: float = 0.001,
):
    executor = Shuffled(order, stop_after)
    monkeypatch.setattr(
        "palpate.author.press_jobs.wait",
        lambda waiting, return_when: (executor.end_some(), ({f for f in waiting if f.done()}, None))[1],
    )
    rounds = NodeRounds(
        KNOWN.terrain.even[:SEEDS].tolist(),
        lambda i: PressJob(tuple(map(float, KNOWN.terrain.position[i])), BALL, (DEPTH,), "near_field"),
        usable,
        lambda: SamplingByError(KNOWN.terrain, KNOWN.geometry, RADIUS, tolerance, MOST),
        uniform_knots(DEPTH),
        WIDTH,
        lambda: executor.pressed >= late,
    )
    run_jobs(AnyOrgan(), rounds.seeds(), Store(folder), executor, rounds.arrived, press, rounds.more)
    return rounds, executor


@pytest.fixture(scope="module")
def first(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        return run(tmp_path_factory.mktemp("first"), patch, 1)


def places(rounds: NodeRounds) -> list[tuple[float, ...]]:
    return [outcome.job.contact_point for outcome in rounds.outcomes]


def test_rounds_go_on_to_the_most_nodes_and_press_no_place_twice(first):
    rounds, _ = first
    assert rounds.sampling.ended == "most nodes reached"
    assert len(places(rounds)) == len(set(places(rounds))) == MOST
    assert sum(not outcome.converged for outcome in rounds.outcomes) == 1
    assert rounds.sampling.rounds[0].nodes == SEEDS - 1  # the useless press is no node


def test_a_field_that_seems_near_enough_is_believed_only_after_a_batch_that_tests_it(tmp_path, monkeypatch):
    rounds, _ = run(tmp_path, monkeypatch, 1, tolerance=50.0)
    assert rounds.sampling.ended == "tolerance met by estimate"
    assert len(places(rounds)) == SEEDS + WIDTH
    assert [r.nodes for r in rounds.sampling.rounds] == [SEEDS - 1, SEEDS - 1 + WIDTH]
    assert rounds.sampling.rounds[-1].missed is not None


def test_nodes_do_not_depend_on_the_order_in_which_presses_end(first, tmp_path, monkeypatch):
    assert places(run(tmp_path, monkeypatch, 2)[0]) == places(first[0])


def test_a_run_that_was_interrupted_goes_the_same_way_and_presses_only_the_rest(first, tmp_path, monkeypatch):
    with pytest.raises(Interrupted, match="presses are kept"):
        run(tmp_path, monkeypatch, 3, stop_after=18)
    kept = len(list((tmp_path / "press").glob("*.npz")))
    again, executor = run(tmp_path, monkeypatch, 4)
    assert kept >= 16 and executor.pressed == MOST - kept
    assert places(again) == places(first[0])


def test_the_time_budget_ends_the_rounds_with_a_prefix_of_the_same_nodes(first, tmp_path, monkeypatch):
    rounds, _ = run(tmp_path, monkeypatch, 1, late=16)
    assert rounds.sampling.ended == "time budget spent"
    assert SEEDS < len(places(rounds)) < MOST
    assert places(rounds) == places(first[0])[: len(places(rounds))]
