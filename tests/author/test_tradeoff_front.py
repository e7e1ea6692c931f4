# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Front, recommendation, prices and stand-ins of the trade-off, each by its law."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from palpate.author.press_jobs import PressJob
from palpate.author.tool_stage import ToolShape
from palpate.author.tradeoff.cost import PricedStore
from palpate.author.tradeoff.front import TICK_NOISE, chance, pareto, recommended
from palpate.author.tradeoff.knobs import Pressing, Setting, changed, node_counts, pressings, settings_of
from palpate.author.tradeoff.not_rendered import Axial
from palpate.author.tradeoff.rows import judged_again

BASE = Pressing("near_field", 8e-3, 20e-3, 1.0)


def row(cpu: float, error: float, tick: float = 100.0, size: int = 1000, **more):
    errors = {"p50": error / 2, "p95": error, "max": 1.5 * error}
    own = {"cpu_seconds": cpu, "bytes": size, "tick_ns": tick, "force_error": errors, "lateral_error": errors}
    return {**own, "stuck_error": None, "offered": True, "met": error < 0.05, "chance": 1.0, **more}


def press(error: float):
    return {
        "converged": True, "seconds": 0.0, "force_error": [None, error, error], "lateral_error": [None, 0.0, 0.0],
        "moves": [], "slides": [],
    }  # fmt: skip


def test_nothing_on_the_front_is_beaten_and_all_else_is():
    rows = [row(1, 0.2), row(2, 0.1), row(3, 0.15), row(2, 0.1, tick=90.0), row(0.5, 0.01, offered=False)]
    assert pareto(rows) == [0, 3]


def test_ticks_within_their_noise_are_equal_and_never_beat_in_a_circle():
    close = 100.0 * (1 + 0.5 * TICK_NOISE)
    assert pareto([row(1, 0.1, tick=close), row(2, 0.1, tick=100.0)]) == [0]
    ticks = [100.0 * (1 + 0.9 * TICK_NOISE) ** k for k in range(4)]
    assert pareto([row(1, 0.1, tick=tick) for tick in ticks])


def test_what_differs_in_the_third_digit_is_no_choice_and_the_first_such_row_stays():
    assert pareto([row(93.1, 0.1, size=85_986), row(93.0, 0.1, size=85_982), row(93.2, 0.1)]) == [2]
    assert pareto([row(93.1, 0.1, size=85_986), row(93.0, 0.1, size=85_982)]) == [0]


def test_the_cheapest_sure_row_is_recommended():
    rows = [row(1, 0.2), row(2, 0.04, chance=0.9), row(3, 0.04), row(4, 0.01), row(0.1, 0.01, offered=False)]
    assert recommended(rows) == 2
    assert recommended(rows[:2]) is None


def test_a_chance_is_that_of_not_drawing_the_bad_press():
    presses = [press(0.01)] * 7 + [press(0.5)]
    assert chance(presses, 0.05, 4) == pytest.approx((7 / 8) ** 4, abs=0.08)
    assert chance(presses[:7], 0.05, 4) == 1.0
    assert chance([], 0.05, 4) == 0.0


@pytest.mark.parametrize("error", [0.049, 0.051])
def test_a_redraw_is_judged_as_held_out_presses_are(error):
    assert chance([press(error)], 0.05, 3) == float(judged_again([press(error)] * 3, 0.05)["met"])


def test_knobs_are_turned_one_at_a_time_and_no_setting_stands_twice():
    base = Setting(BASE, 12)
    for pressing in pressings(BASE):
        assert len(changed(Setting(pressing, 12), base)) == 1
    settings = [s for p in (BASE, *pressings(BASE)) for s in settings_of(p, node_counts(12), base)]
    assert len(set(settings)) == len(settings)
    assert base in settings


def test_a_result_that_is_kept_keeps_its_price(tmp_path):
    def work():
        x = 0
        for i in range(300_000):
            x += i
        return {}, {"x": x}

    store, again = PricedStore(tmp_path), PricedStore(tmp_path)
    store.kept("thing", "key", work)
    assert store.cpu_seconds > 0.0
    again.kept("thing", "key", lambda: pytest.fail("made twice"))
    assert again.cpu_seconds == store.cpu_seconds
    for path in (tmp_path / "price").iterdir():
        path.unlink()
    lost = PricedStore(tmp_path)
    assert lost.kept("thing", "key", work)[1] == {"x": 44999850000}
    assert lost.cpu_seconds > 0.0


def test_a_patch_radius_of_its_own_makes_another_press_and_none_leaves_its_key():
    ball, mesh = ToolShape("sphere", (("radius", 5e-3),)), SimpleNamespace(hash="organ")
    plain, wide = (PressJob((0.0,) * 3, ball, (1e-3,), "full", patch_radius=r) for r in (None, 0.03))
    assert plain.key(mesh) != wide.key(mesh)


def test_axial_forces_at_a_node_are_the_node_s_and_between_nodes_the_weighted_mean(monkeypatch):
    from palpate.author.tradeoff import not_rendered

    position = np.array([[0.0, 0.0, 0.0], [0.01, 0.0, 0.0], [0.0, 0.01, 0.0], [0.01, 0.01, 0.0]])
    knots = np.array([0.0, 1e-3, 2e-3])
    force = np.arange(1.0, 5.0)[:, None] * knots * 1e3
    nodes = SimpleNamespace(
        position=position, normal=np.tile([0.0, 0.0, 1.0], (4, 1)), depth_knots=knots, normal_force=force,
        lateral_gradient=np.zeros((4, 3, 3)), friction_stiffness=0.0 * force, friction_coefficient=0.0 * force,
    )  # fmt: skip
    flat = SimpleNamespace(signed_distance=None)
    field = SimpleNamespace(nodes=nodes, geometry=flat, tool=SimpleNamespace(offset=0.0), depth_max=2e-3)
    monkeypatch.setattr(not_rendered, "sample_lattice", lambda lattice, q: SimpleNamespace(value=q[:, 2:3]))
    monkeypatch.setattr(
        not_rendered, "foot_points", lambda g, q: (q * [1, 1, 0], np.tile([0.0, 0.0, 1.0], (len(q), 1)))
    )
    at = lambda x, y: Axial(field).rendered(0.0, [np.array([x, y, 1e-3]), np.array([x, y, -2e-3])]).force[0]  # noqa: E731
    assert at(0.01, 0.0) == pytest.approx([0.0, 0.0, 4.0])
    assert at(0.0, 0.005) == pytest.approx([0.0, 0.0, 4.0])  # of 2 and 6
    assert at(0.02, 0.0)[2] == pytest.approx(4.0)  # outside: the nearest triangle's edge
