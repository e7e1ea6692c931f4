# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Sampling by error on a reach that is known everywhere (tests/fields/known_terrain.py)."""

import json

import numpy as np
import pytest
from known_terrain import RADIUS, KnownTerrain
from scipy.spatial.distance import cdist, pdist

from palpate.author.sampling_by_error import SamplingByError
from palpate.fields import kriging

HALF, SEEDS, WIDTH, TOLERANCE = (0.05, 0.035), 22, 6, 0.05


def sample(known: KnownTerrain, most: int, extra: tuple[int, ...] = ()) -> tuple[SamplingByError, list[int]]:
    """The sampling, and its nodes."""
    sampling = SamplingByError(known.terrain, known.geometry, RADIUS, TOLERANCE, most)
    index = [*known.terrain.even[:SEEDS].tolist(), *extra]
    while len(chosen := sampling.choose(known.nodes(index), index, [], WIDTH)):
        assert not np.isin(chosen, index).any()
        index += chosen.tolist()
    return sampling, index


@pytest.fixture(scope="module")
def with_nodule():
    known = KnownTerrain(seed=1, half=HALF, places=800)
    above = int(np.argmin(np.linalg.norm(known.terrain.position - known.nodule_at, axis=1)))
    sampling, index = sample(known, 120, (above,))
    return known, sampling, index, known.errors(known.kriged(index))


@pytest.fixture(scope="module")
def without():
    known = KnownTerrain(seed=2, half=HALF, nodule=False, places=800)
    sampling, index = sample(known, 120)
    return known, sampling, index, known.errors(known.kriged(index))


def test_a_small_stiff_nodule_gets_its_nodes(with_nodule):
    _, sampling, _, error = with_nodule
    assert sampling.ended == "tolerance met by estimate"
    assert error["near"][0] < 0.07
    assert error["off"][0] < TOLERANCE and error["off"][1] < 2 * TOLERANCE


def test_half_as_many_nodes_again_spread_evenly_are_no_match(with_nodule, monkeypatch):
    """Near the nodule whatever kriging does, over the whole reach with kriging of one length."""
    known, _, index, error = with_nodule
    places = known.terrain.even[: 3 * len(index) // 2]
    assert known.errors(known.kriged(places))["near"][0] > 4 * error["near"][0]
    monkeypatch.setattr(kriging, "EVIDENCE", np.inf)
    assert known.errors(known.kriged(places))["all"][0] > error["all"][0]


def test_the_estimate_is_honest(with_nodule, without):
    for _, sampling, _, error in (with_nodule, without):
        last = sampling.rounds[-1]
        assert error["all"][0] < last.estimate < 3.0 * error["all"][0]
        assert 0.9 * error["all"][1] < last.worst < 3.0 * error["all"][1]


def test_a_smooth_reach_ends_with_few_nodes(without):
    _, sampling, index, error = without
    assert sampling.ended == "tolerance met by estimate" and len(index) < 80
    assert error["all"][0] < TOLERANCE


def test_no_node_comes_nearer_to_another_than_told(with_nodule):
    known, _, index, _ = with_nodule
    position = known.terrain.position
    apart = 8e-3
    assert pdist(position[index]).min() < apart  # left to itself it goes nearer
    sampling = SamplingByError(known.terrain, known.geometry, RADIUS, TOLERANCE, 120, apart)
    index, busy = known.terrain.even[:SEEDS].tolist(), [int(known.terrain.even[SEEDS])]
    for _ in range(4):
        chosen = sampling.choose(known.nodes(index), index, busy, WIDTH).tolist()
        assert len(chosen) == WIDTH
        others = position[[*index, *busy]]
        assert cdist(position[chosen], others).min() >= apart and pdist(position[chosen]).min() >= apart
        index, busy = [*index, *busy], chosen


def test_every_round_says_what_it_knew(with_nodule):
    _, sampling, index, _ = with_nodule
    report = sampling.report()
    assert json.loads(json.dumps(report)) == report
    nodes = report["rounds"]["nodes"]
    assert nodes[-1] == len(index) and len(nodes) == len(sampling.rounds)
    assert sampling.rounds[0].missed is None and all(r.missed is not None for r in sampling.rounds[1:])
    assert f"{len(index)} of at most 120 nodes" in sampling.note
