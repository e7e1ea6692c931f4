# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""No energy is created by friction, contrast, rate, tilt, swap, limit or organ motion (energy_paths.py)."""

import energy_paths
import numpy as np
import path_kinds
import pytest


@pytest.fixture(scope="module")
def six_to_one():
    return energy_paths.subject(0.5 * np.log(6.0), nodes=20, touches=10)


@pytest.mark.parametrize(
    ("paths", "nodes"), [(6_000, 25), pytest.param(1_000_000, 60, marks=pytest.mark.slow)]
)
def test_nothing_is_created_to_a_billionth_of_what_is_exchanged(paths, nodes):
    rows = energy_paths.table(paths, nodes=nodes)
    assert sum(row["paths"] for row in rows) >= paths
    assert {(row["contrast"], row["family"], row["kind"]) for row in rows} == {
        (c, f, k) for c in energy_paths.CONTRASTS for f in energy_paths.FAMILIES for k in energy_paths.KINDS
    }
    for row in rows:
        assert row["share"] < 1e-9, row
        assert row["created"] < 1e-13 and row["force_error"] < 1e-9 and row["balance"] < 1e-13, row
        assert row["touched"] > 0.9 * row["paths"] > 5 * row["left"] and row["exchanged"] > 0.0, row


@pytest.mark.parametrize(
    "spoil",
    [
        lambda force, s: (0.999 * force, s),
        lambda force, s: (force, s + 1e-6),
        lambda force, s: (force + 1e-2 * np.roll(force, 1, axis=2), s),
    ],
    ids=["a thousandth too soft", "an anchor a micrometre off", "a force turned by a hundredth"],
)
def test_the_judge_sees_energy_from_nowhere(six_to_one, spoil, monkeypatch):
    worst = max(
        row["share"] for row in energy_paths.run(six_to_one, "plain", 300, np.random.default_rng(2)).values()
    )
    assert worst < 1e-9
    judged = energy_paths.judged

    def spoilt(truth, ways, x, force, s, r, scale):
        return judged(truth, ways, x, *spoil(force, s), r, scale)

    monkeypatch.setattr(energy_paths, "judged", spoilt)
    rows = energy_paths.run(six_to_one, "plain", 300, np.random.default_rng(2))
    assert all(row["share"] > 1e-6 for row in rows.values()), rows


def test_paths_press_drag_lift_and_stand_on_borders(six_to_one):
    """What each kind is for happens: closed cycles, ticks exactly on cell borders, recorded hands that differ."""
    ground, rng = six_to_one.ground, np.random.default_rng(1)
    x, kind = path_kinds.paths_of(ground, np.full(2000, 1e-4), 0.0, rng)
    of = {name: x[kind == i] for i, name in enumerate(path_kinds.KINDS)}
    assert min(len(paths) for paths in of.values()) > 200
    np.testing.assert_allclose(of["cycle"][:, 0], of["cycle"][:, -1], atol=1e-15)
    for lattice in (ground.truth.amplitudes, ground.truth.geometry.signed_distance):
        u = (of["border"] - lattice.origin) / lattice.spacing
        on = np.abs(u - np.round(u)).min(axis=2) < 1e-9
        assert (on.sum(axis=1) > 3).mean() > 0.15
    depth = ground.organ.radius - ground.organ.signed_distance(of["recorded"].reshape(-1, 3)).reshape(
        -1, path_kinds.TICKS
    )
    assert (depth[:, 0] < 0).mean() > 0.95 and (depth.max(axis=1) > 1e-4).mean() > 0.95
    assert len(np.unique(ground.touches.round(9), axis=0)) == 10
