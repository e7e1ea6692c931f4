# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Words, digits and projection of the report, without an asset."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

from palpate.author.report.held_out_rows import held_out_rows
from palpate.author.report.node_origins import node_origins
from palpate.author.report.numbers import asked, percent, significant, written
from palpate.author.report.projection import WINDOW, Mesh, View
from palpate.author.report.render import render
from palpate.author.report.verdict import headline, overall, verdict


@pytest.mark.parametrize(
    ("fraction", "text"),
    [
        (0.03456, "3.46 %"), (0.123456, "12.3 %"), (1.5, "150 %"), (0.00351, "0.35 %"), (0.0999999, "10.0 %"),
        (0.0, "0 %"), (None, "–"), (3e-7, "< 0.001 %"), (0.0000321, "0.0032 %"),
    ],
)  # fmt: skip
def test_percentages_have_two_or_three_digits(fraction: float | None, text: str) -> None:
    assert percent(fraction) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [(1234.5, "1230"), (0.0123456, "0.0123"), (9.999, "10.0"), (-2.5, "-2.50"), (3e-9, "3.00e-09")],
)
def test_significant_digits(value: float, text: str) -> None:
    assert significant(value) == text


def test_chosen_numbers_get_no_digits_that_nobody_gave() -> None:
    assert asked(0.035) == "3.5 %" and asked(2 * 0.035) == "7 %"
    assert written(5e-3, "size") == "5 mm" and written(5e-3, "mm") == "5.00 mm"
    assert written(2711.0, "seconds") == "45.2 min" and written(254_321, "bytes") == "248 KiB"


def judged(p95: float, worst: float, failed: int = 0) -> dict:
    met = p95 <= 0.035 and worst <= 0.07 and not failed
    error = {"p50": 0.01, "p95": p95, "max": worst}
    return {"tolerance": 0.035, "met": met, "failed": failed, "fidelity": "full", "force_error": error}


def test_verdict_names_every_shortfall() -> None:
    met = verdict("ball", judged(0.021, 0.05), 8, 8)
    assert met["state"] == "met" and "falls short" not in met["sentence"]
    assert "within 2.10 % of finite elements" in met["sentence"] and "8 held-out points" in met["sentence"]
    missed = verdict("ball", judged(0.05, 0.09, 1), 8, 7)
    assert missed["state"] == "missed"
    for part in (
        "5.00 % at the 95th percentile is above 3.5 %",
        "9.00 % at worst is above 7 %",
        "1 held-out press failed",
    ):
        assert part in missed["sentence"]
    nothing = judged(0.0, 0.0) | {"force_error": None, "met": True}
    assert verdict("ball", nothing, 1, 0)["state"] == verdict("ball", None, 0, 0)["state"] == "unjudged"


def entry(name: str, validation: dict | None, failures: int = 0) -> dict:
    points = 0 if validation is None else 8
    converged = points - (validation or {}).get("failed", 0)
    told = verdict(name, validation, points, converged)
    counts = {"points": points, "converged": converged}
    return {
        "name": name,
        "verdict": told,
        "validation": validation,
        "judged": counts,
        "failures": [{}] * failures,
    }


def test_headline_says_by_how_much_and_hides_nothing() -> None:
    good, bad, unknown = judged(0.021, 0.05), judged(0.07, 0.09), None
    line = headline([entry("ball", good), entry("punch", bad, 2), entry("cone", unknown)], {}, None)
    assert line.startswith(
        "Not met: punch's normal force is 7.00 % off at the 95th percentile, 2.0 times the 3.5 %"
    )
    assert "ball is within 2.10 %" in line and "cone was never compared with finite elements" in line
    assert line.endswith("2 presses that build the field failed or stopped early.")
    assert headline([entry("ball", good)], {"too thin": 3}, 90).startswith("Met: ball is within 2.10 %")
    assert headline([entry("ball", good)], {"too thin": 3}, 90).endswith(
        "3 of 90 sampled places were left out (too thin)."
    )
    lost = headline([entry("ball", judged(0.02, 0.05, 1))], {}, None)  # only a press that failed
    assert lost.startswith("Not met: ball: 1 held-out press failed or stopped early.")
    assert headline([], {}, None) == "Not judged: the asset has no tool."


def field_of(hashes: list[str], provenance: dict) -> SimpleNamespace:
    nodes = SimpleNamespace(press_hash=np.array(hashes), node_count=len(hashes))
    return SimpleNamespace(nodes=nodes, provenance=provenance, ways=(), family=())


def test_why_nodes_are_there_is_recorded_or_follows_from_their_order() -> None:
    recorded = {"seed": ["aaaa"], "region": ["bbbb"], "error": ["cccc"]}
    both_leans = field_of(["bbbb01+dddd", "aaaa02", "cccc03", "eeee"], {})
    assert node_origins(both_leans, recorded) == ["region", "seed", "error", "unknown"]
    # 632 nodes at most, of which 60 for a region: 86 seeds are 15 % of 572
    told = {"sampling": {"most": 632, "rounds": {"nodes": [92]}}, "scene": {"region": [{}]}}
    names = [f"{i:04d}" for i in range(95)]
    assert node_origins(field_of(names, told), None) == ["seed"] * 86 + ["region"] * 6 + ["error"] * 3
    lost = told | {"failed_presses": [{"hash": "not among them"}]}
    assert set(node_origins(field_of(names, lost), None)) == {"unknown"}
    assert node_origins(field_of(["a"], {}), None) == ["unknown"]


def test_the_worst_verdict_counts() -> None:
    assert overall([{"state": "met"}, {"state": "missed"}, {"state": "unjudged"}]) == "missed"
    assert overall([{"state": "met"}, {"state": "unjudged"}]) == "unjudged" == overall([])
    assert overall([{"state": "met"}]) == "met"


def ball_view() -> View:
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.05)
    vertices, triangles = np.asarray(ball.vertices), np.asarray(ball.faces)
    eye = np.array([0.6, -0.64, 0.48])
    return View(eye, np.array([0.0, 0.0, 1.0]), vertices, 1.2, [Mesh(vertices, triangles, "#dddddd")])


def test_marks_behind_the_organ_are_not_seen() -> None:
    view = ball_view()
    directions = np.random.default_rng(4).normal(size=(300, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    facing = directions @ view.eye
    pixels, seen = view.project(0.05 * directions)
    clear = np.abs(facing) > 0.15  # at the rim, marks may lie under a facet
    np.testing.assert_array_equal(seen[clear], facing[clear] > 0)
    assert ((pixels > 0) & (pixels < WINDOW)).all()


def test_projection_is_where_the_renderer_draws(can_draw: None) -> None:
    view = ball_view()
    place = 0.05 * np.array([0.28, -0.96, 0.0])
    dot = trimesh.creation.icosphere(subdivisions=2, radius=0.002)
    dot = Mesh(np.asarray(dot.vertices) + place, np.asarray(dot.faces), "#ff0000")
    (image,) = render([View(view.eye, view.up, view.shown, view.margin, [*view.meshes, dot])])
    red = (image[..., 0] > 80) & (image[..., 1] < 40)
    rows, columns = np.nonzero(red)
    pixels, seen = view.project(place[None])
    assert seen.all()
    np.testing.assert_allclose(
        [columns.mean() + 0.5, rows.mean() + 0.5], pixels[0], atol=8.0
    )  # half is buried


def test_remarks_of_the_runtime_leave_out_what_is_expected() -> None:
    press = {
        "contact_point": [0.0, 0.0, 0.0], "normal": [0.0, 0.0, 1.0], "converged": True, "reason": "", "moves": [],
        "depth": [1e-3, 2e-3], "fem_force": [[0.0, 0.0, 0.1], [0.0, 0.1, 0.3]], "force_error": [None, 0.02],
        "rendered_force": [[0.0, 0.0, 0.1], [0.0, 0.1, 0.3]], "lateral_error": [None, 0.0],
    }  # fmt: skip
    remark = lambda status: held_out_rows({"presses": [{**press, "status": status}]})[0]["runtime"]  # noqa: E731
    assert remark([2, 3]) == ""  # slipping without friction; at depth_max within rounding
    assert remark([1, 1]) == "deeper than pressed"
    assert remark([0, 4]) == "out of reach, no force"
