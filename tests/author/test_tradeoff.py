# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The trade-off, the whole way, on presses of a law that is known (stand_in_solvers.py).

Linear presses are 20 % too soft.
"""

from __future__ import annotations

import csv
import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from plotly.offline import get_plotlyjs
from stand_in_solvers import Inline, known_block

from palpate import runtime
from palpate.author import field_stage, tool_work, tradeoff_command
from palpate.author.command_line import main
from palpate.author.errors import InputError
from palpate.author.press_jobs import PressJob
from palpate.author.scene import load_scene
from palpate.author.tool_work import ToolWork
from palpate.author.tradeoff import files, knobs, sweep, tradeoff
from palpate.author.tradeoff.knobs import Pressing, Setting, setting_of
from palpate.author.tradeoff.scene_file import write_scene

CPU_SECONDS = {"linear": 1.0, "near_field": 3.0, "full": 10.0}
"""Of a press; those of a rough patch cost half."""
SOFT = 0.8
SOLVED: list[PressJob] = []
TICK = {"p50": 150.0, "p99": 160.0, "p999": 170.0, "max": 180.0}


def known_by_fidelity(mesh, job: PressJob, folder: str, progress=None):
    SOLVED.append(job)
    arrays, values = known_block(mesh, job, folder)
    factor = SOFT if job.fidelity == "linear" else 1.0
    for name in ("force_vector", "energy", "sticking_stiffness"):
        arrays[name] = factor * arrays[name]
    cost = CPU_SECONDS[job.fidelity] * (0.5 if job.refinement < 1.0 else 1.0)
    return arrays, {**values, "cpu_seconds": cost, "peak_memory": 0}


@pytest.fixture(scope="module")
def scene_file(cube: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    text = cube.read_text().replace(
        'name = "cube"', 'name = "cube"\neffects = ["response", "friction"]  # both'
    )
    text = text.replace('"cube.stl"', f'"{cube.parent}/cube.stl"')
    text = text.replace('radius = "5 mm"', 'radius = "5 mm"\nfriction = 0.1')
    text += '\n[reach]\nsphere = { center = [0.0, 0.0, 0.02], radius = "4 mm" }\ndepth_max = "3 mm"\n'
    text += '\n[accuracy]\nforce_tolerance = "5 %"\nheld_out = 4\n'
    path = tmp_path_factory.mktemp("tradeoff") / "scene.toml"
    path.write_text(text)
    return path


@pytest.fixture(scope="module")
def few():
    """Few settings, no finite elements, and a tick that is given."""
    bench = {f"{kind}_ns": TICK for kind in ("stick", "slide", "free", "cold")}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sweep, "node_counts", lambda planned: [4, 6])
        patch.setattr(tool_work, "node_count", lambda area, tolerance: 6)
        patch.setattr(knobs, "KNOT_COUNTS", (5,))
        patch.setattr(knobs, "MESH_STEPS", ())
        patch.setattr(knobs, "RADIUS_STEPS", ())
        patch.setattr(knobs, "FIDELITIES", ("linear", "near_field", "near_field"))
        patch.setattr(field_stage, "AMPLITUDE_SPACINGS", (5e-3,))
        made: list = []  # every sweep here has the same organ and reach
        fresh = sweep.contact_geometry_of
        patch.setattr(
            sweep, "contact_geometry_of", lambda *a: made[0] if made else made.append(fresh(*a)) or made[0]
        )
        patch.setattr(runtime, "bench", lambda path: {**bench, "load_ms": 0.1, "machine": "none"})
        yield


def with_the_mesh_of(other: Path, out: Path) -> Path:
    for kind in ("surface", "mesh", "price"):
        shutil.copytree(other / "work" / kind, out / "work" / kind)
    return out


def weigh(scene_file: Path, out: Path, **options):
    return tradeoff(
        load_scene(scene_file), out, executor=Inline(), solver=known_by_fidelity, held_out=6, **options
    )


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("out")


@pytest.fixture(scope="module")
def weighed(scene_file: Path, out: Path, few):
    SOLVED.clear()
    result = weigh(scene_file, out, write_scene=out / "taken.toml", confirm_seeds=2)
    first = len(SOLVED)
    again = weigh(scene_file, out)
    return result, again, (first, len(SOLVED))


def rows_like(result, **asked):
    return [
        row for row in result["rows"] if all(row["setting"][key] == value for key, value in asked.items())
    ]


def test_rows_say_what_a_setting_costs_alone(weighed):
    result = weighed[0]
    (row,) = rows_like(result, fidelity="near_field", nodes=6, knots="auto", response="potential", float_bits=32,
                       patch_radius=20e-3, patch_refinement=1.0)  # fmt: skip
    assert row["press_cpu_seconds"] == 6 * CPU_SECONDS["near_field"]
    (linear,) = rows_like(result, fidelity="linear", nodes=4)
    assert linear["press_cpu_seconds"] == 4 * CPU_SECONDS["linear"]
    assert linear["organ_cpu_seconds"] == row["organ_cpu_seconds"] > 0
    parts = ("organ_cpu_seconds", "geometry_cpu_seconds", "press_cpu_seconds", "fit_cpu_seconds")
    assert row["cpu_seconds"] == pytest.approx(sum(row[part] for part in parts))


def test_an_error_that_is_known_is_the_one_in_the_row(weighed):
    result = weighed[0]
    (linear,) = rows_like(result, fidelity="linear", nodes=6)
    assert linear["force_error"]["p50"] == pytest.approx(1 - SOFT, abs=0.01)
    assert not linear["met"] and linear["chance"] == 0.0
    near = rows_like(result, fidelity="near_field", response="potential")
    assert all(row["force_error"]["max"] < 0.03 for row in near)


def test_what_is_made_of_presses_presses_nothing_anew(weighed):
    result, again, (first, after) = weighed
    node_presses = [job for job in SOLVED if not job.moves]
    assert len(node_presses) == 6 * len({json.dumps(
        {key: row["setting"][key] for key in ("fidelity", "mesh_size", "patch_radius", "patch_refinement")}
    ) for row in result["rows"]})  # fmt: skip
    assert first == after  # the second run had all presses
    assert [row["force_error"] for row in again["rows"]] == [row["force_error"] for row in result["rows"]]
    assert [row["cpu_seconds"] - row["geometry_cpu_seconds"] for row in again["rows"]] == pytest.approx(
        [row["cpu_seconds"] - row["geometry_cpu_seconds"] for row in result["rows"]]
    )


def test_all_settings_are_judged_by_the_same_full_presses(weighed):
    judging = [job for job in SOLVED if job.moves]
    assert {job.fidelity for job in judging} == {"full"}
    assert len(judging) == 6 + 2 * 4  # held out, and two fresh seeds of as many as the scene holds out
    assert len({job.contact_point for job in SOLVED if job.moves}) > 10
    assert {row["points"] for row in weighed[0]["rows"]} == {6}


def test_the_cheapest_setting_that_meets_the_tolerance_is_taken(weighed):
    result = weighed[0]
    best = result["rows"][result["recommended"]]
    assert best["offered"] and best["met"] and best["setting"]["fidelity"] == "near_field"
    assert best["setting"]["patch_refinement"] < 1.0 and best["setting"]["nodes"] == 4
    cheaper = [row for row in result["rows"] if row["cpu_seconds"] < best["cpu_seconds"] and row["offered"]]
    assert all(not row["met"] for row in cheaper)
    assert result["recommended"] in result["pareto"]


def test_what_the_runtime_does_not_render_has_no_tick_and_beats_nothing(weighed):
    result = weighed[0]
    others = [i for i, row in enumerate(result["rows"]) if not row["offered"]]
    assert {row["setting"]["response"] for row in result["rows"]} == {"potential", "axial"}
    assert {row["setting"]["float_bits"] for row in result["rows"]} == {16, 32, 64}
    assert others and not set(others) & set(result["pareto"])
    assert all(result["rows"][i]["tick_ns"] is None for i in others)
    (exact,) = rows_like(result, float_bits=64)
    (stored,) = rows_like(result, fidelity="near_field", nodes=exact["setting"]["nodes"], knots="auto",
                          response="potential", float_bits=32, patch_radius=20e-3, patch_refinement=1.0)  # fmt: skip
    assert exact["force_error"]["p95"] == pytest.approx(stored["force_error"]["p95"], abs=1e-4)
    assert exact["stuck_error"]["p95"] == pytest.approx(stored["stuck_error"]["p95"], abs=1e-4)
    assert exact["bytes"] > stored["bytes"]


def test_the_recommended_setting_is_confirmed_where_nobody_pressed(weighed):
    confirmed = weighed[0]["confirmed"]
    assert (confirmed["seeds"], confirmed["points"], confirmed["met"], confirmed["bar"]) == (2, 4, 2, 2)
    assert confirmed["enough"] and len(confirmed["by_seed"]) == 2


def test_the_written_scene_asks_for_the_recommended_setting_and_keeps_its_comments(weighed, out, scene_file):
    result = weighed[0]
    text = (out / "taken.toml").read_text()
    scene, setting = load_scene(out / "taken.toml"), result["rows"][result["recommended"]]["setting"]
    assert "# both" in text
    assert scene.organ.surface == load_scene(scene_file).organ.surface
    assert scene.accuracy.nodes == setting["nodes"]
    assert scene.accuracy.patch_refinement == pytest.approx(setting["patch_refinement"])
    assert scene.accuracy.fidelity == setting["fidelity"]


def test_a_scene_that_names_nodes_and_patch_presses_so(weighed, out):
    from palpate.author.organ_stage import mesh_organ
    from palpate.author.store import Store

    scene = load_scene(out / "taken.toml")
    work = ToolWork(scene, mesh_organ(scene, Store(out / "work")), scene.tool[0])
    job = work._job(np.zeros(3), scene.accuracy.fidelity)
    assert work.most == 4
    assert job.refinement == pytest.approx(0.7) and job.patch_radius is None
    assert all(held.refinement == 1.0 for held in work.held_jobs)  # what judges stays as it is


def test_every_knob_is_written_back(scene_file, tmp_path):
    setting = Setting(Pressing("linear", 9e-3, 25e-3, 0.5), 17, 21)
    scene = load_scene(write_scene(load_scene(scene_file), setting, tmp_path / "deeper" / "a.toml"))
    own = scene.accuracy
    assert (own.fidelity, own.nodes, own.knots) == ("linear", 17, 21)
    assert (scene.organ.mesh_size, own.patch_radius, own.patch_refinement) == pytest.approx(
        (9e-3, 25e-3, 0.5)
    )
    again = knobs.scene_s_pressing(scene, scene.organ.mesh_size)
    assert again.name == setting.pressing.name
    assert setting_of(setting.as_json()) == setting


def test_files_hold_the_same_rows(weighed, out):
    result = weighed[1]  # the last run in this folder
    twin = json.loads((out / "tradeoff.json").read_text())
    assert len(twin["rows"]) == len(result["rows"]) and twin["pareto"] == result["pareto"]
    with (out / "tradeoff.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert tuple(rows[0]) == files.COLUMNS
    assert [float(row["cpu_seconds"]) for row in rows] == pytest.approx(
        [row["cpu_seconds"] for row in twin["rows"]]
    )
    assert [i for i, row in enumerate(rows) if row["pareto"] == "True"] == result["pareto"]
    assert (out / "tradeoff.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    page = (out / "index.html").read_text()
    assert len(page) < 8e6 and page.count("<tr data-row=") == len(rows)
    own = page.replace(get_plotlyjs(), "")  # which names addresses that it asks only for maps
    assert len(own) < 1e6 and 'src="http' not in own and 'href="http' not in own


def test_a_budget_that_ends_before_a_row_keeps_what_is_there(scene_file, tmp_path, weighed, out):
    with pytest.raises(InputError, match="0 of 6 held-out presses"):
        weigh(scene_file, with_the_mesh_of(out, tmp_path), budget=1e-3)


def test_what_the_budget_does_not_hold_is_named(scene_file, tmp_path, weighed, out, monkeypatch):
    monkeypatch.setattr(sweep.Presses, "has", lambda self, seconds: False)
    made = []
    monkeypatch.setattr(sweep.Sweep, "_rows", lambda self, pressed: made.extend(pressed) or [])
    result = weigh(scene_file, with_the_mesh_of(out, tmp_path))
    own = Pressing("near_field", 8e-3, 20e-3, 1.0)
    assert made == [own] and result["recommended"] is None
    named = [item for item in result["left_out"] if "pressing" in item]
    assert [item["pressing"] for item in named] == [one.name for one in knobs.pressings(own)]
    assert all("budget" in item["reason"] for item in named)


def test_several_radii_are_refused(scene_file, tmp_path):
    path = tmp_path / "family.toml"
    path.write_text(scene_file.read_text().replace('radius = "5 mm"', 'radius = ["4 mm", "5 mm"]'))
    with pytest.raises(InputError, match="radius"):
        tradeoff(load_scene(path), tmp_path / "out")


@pytest.mark.parametrize(
    "options", [("--budget", "5 mm"), ("--budget", "0"), ("--write-scene", "a.json"), ("--tool", "absent")]
)
def test_bad_options_are_told(scene_file, tmp_path, options, capfd):
    assert main(["tradeoff", str(scene_file), "--out", str(tmp_path), *options, "--json"]) == 2
    told = json.loads(capfd.readouterr().out)["error"]["problems"]
    assert len(told) == 1


def test_times_are_read_with_their_units():
    assert tradeoff_command._seconds("30 min") == 1800.0
    assert tradeoff_command._seconds("90") == 90.0
    assert tradeoff_command._seconds("none") is None
