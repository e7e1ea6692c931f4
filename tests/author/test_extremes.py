# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The table of extremes: what counts as wrong, the cheap cases, its files, its exit code."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from palpate.author.command_line import main
from palpate.author.extremes import servo_cases as servo
from palpate.author.extremes.books import books, judged
from palpate.author.extremes.case import Case, Refused, Wrong, close_to, must_refuse, outcome_of
from palpate.author.extremes.path_cases import path_cases
from palpate.author.extremes.scene_cases import ENDS, SHIPPED, scene_cases, taken
from palpate.author.extremes.table import all_cases, run
from palpate.author.scene_types import Quantity
from palpate.fem_offline.sphere import Sphere


def outcome(work, **how) -> str:
    return outcome_of(Case("axis", "value", work), **how).outcome


def test_a_number_that_disagrees_or_is_none_is_wrong():
    assert outcome(lambda: close_to("force", 1.009, 1.0, 0.01)) == "verified"
    assert outcome(lambda: close_to("force", 1.011, 1.0, 0.01)) == "wrong"
    assert outcome(lambda: close_to("force", float("nan"), 1.0, 0.01)) == "wrong"


def test_only_a_sentence_of_this_project_is_a_refusal():
    assert outcome(lambda: must_refuse(lambda: Sphere(-1.0))) == "refused"
    assert outcome(lambda: must_refuse(lambda: None)) == "wrong"
    assert (
        outcome(lambda: str(np.linalg.inv(np.zeros((2, 2))))) == "wrong"
    )  # "Singular matrix" names no input
    assert outcome(lambda: [][0]) == "wrong"


def test_a_case_that_does_not_end_is_wrong():
    def forever() -> str:
        while True:
            pass

    assert outcome(forever, time_limit=0.1) == "wrong"


@pytest.mark.parametrize(
    ("key", "value", "expected"),
    [
        (key, value, read)
        for keys in ENDS.values()
        for key, values in keys
        for value, read in values
        if read is not None
    ],
)
def test_a_scene_may_have_its_numbers_at_their_ends(key, value, expected):
    assert "SI" in taken(SHIPPED, key, value, expected)


def test_a_scene_beyond_its_ends_is_refused_in_words():
    rows = [outcome_of(case) for case in scene_cases()]
    assert [row for row in rows if row.outcome != "refused"] == []
    assert len(rows) > 20


def test_a_scene_that_took_too_much_would_be_noticed(monkeypatch):
    monkeypatch.setattr(Quantity, "read", lambda self, value: float(value))
    assert outcome(lambda: taken(SHIPPED, "tool.0.friction", 0.0, None)) == "wrong"


def test_rates_quantised_places_and_bad_input_hold_in_the_servo_loop():
    chosen = ("servo_rate", "quantisation", "input")
    rows = [outcome_of(case) for case in servo.servo_cases() if case.axis in chosen]
    assert [row for row in rows if row.outcome == "wrong"] == []
    assert {row.outcome for row in rows if row.axis == "input"} == {"refused"}


def test_paths_at_the_ends_of_a_plane_create_no_energy():
    rows = [outcome_of(case) for case in path_cases() if case.quick and "friction 0.5" in case.value]
    assert [row for row in rows if row.outcome == "wrong"] == []


def test_the_books_find_created_energy_and_a_foreign_force():
    truth, field = servo._field()
    q = servo._path(1e3, 0.1)
    r = servo._session().tick_batch(q, dt=1e-3)
    sigma = field.info.stiffness_max
    honest = books(truth, q, r, sigma)
    assert "created" in judged(honest, len(q))
    pushed = r.copy()
    pushed["force"] *= 1.0 + 1e-4 * np.arange(len(q))[:, None] / len(q)
    with pytest.raises(Wrong):
        judged(books(truth, q, pushed, sigma), len(q))
    with pytest.raises(Wrong, match="created"):
        judged(replace(honest, created=1e-6 * honest.exchanged), len(q))
    with pytest.raises(Refused):
        judged(replace(honest, felt=0.0), len(q))


def test_at_least_120_cases_are_in_the_table_and_none_twice(tmp_path):
    cases = [(case.axis, case.value) for case in all_cases(None, tmp_path)]
    assert len(cases) >= 120
    assert len(set(cases)) == len(cases)


def test_a_case_that_took_long_is_kept_and_a_wrong_one_is_run_again(tmp_path, monkeypatch):
    monkeypatch.setattr("palpate.author.extremes.table.CHEAP", -1.0)
    calls = []

    def good() -> str:
        calls.append("good")
        return "as it should be"

    def bad() -> str:
        calls.append("bad")
        raise Wrong("off by half")

    cases = [Case("a", "1", good), Case("a", "2", bad)]
    for case in cases:
        case.run.__module__ = "palpate.author.extremes.mesh_cases"
    first, second = run(cases, tmp_path, ""), run(cases, tmp_path, "")
    assert [row.outcome for row in first] == [row.outcome for row in second] == ["verified", "wrong"]
    assert calls == ["good", "bad", "bad"]


def test_the_command_writes_its_tables_and_fails_where_a_case_is_wrong(tmp_path, capfd, monkeypatch):
    given = ["extremes", "--quick", "--axis", "tolerance,knots", "--out", str(tmp_path), "--json"]
    assert main(given) == 0
    answer = json.loads(capfd.readouterr().out)
    assert answer["silent_failures"] == 0 and {"axis", "value", "outcome", "reason"} <= set(answer["rows"][0])
    assert all((tmp_path / f"extremes.{kind}").stat().st_size > 200 for kind in ("md", "json", "csv", "png"))
    monkeypatch.setattr("palpate.author.extremes.scene_cases.plan", lambda scene: None)
    monkeypatch.setattr("palpate.author.extremes.scene_cases.load_scene", lambda path: answer_to_all())
    assert main(given) == 1
    assert json.loads(capfd.readouterr().out)["silent_failures"] > 0


def answer_to_all():
    """A scene that takes anything."""
    from palpate.author.scene import load_scene

    return load_scene(SHIPPED)


def test_an_axis_that_is_none_is_refused(tmp_path, capfd):
    assert main(["extremes", "--quick", "--axis", "colour", "--out", str(tmp_path)]) == 2
    assert "colour" in capfd.readouterr().err
