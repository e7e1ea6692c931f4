# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A tool of several tilts, the whole way: pressed at the same places, one field, blended by the runtime.

The presses are a law that is known at every tilt (stand_in_solvers.py); real ones are in the decisions' numbers.
"""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from stand_in_solvers import Inline, known_probe

from palpate.author import pipeline, press_solve, validate
from palpate.author.capabilities import require_capabilities
from palpate.author.errors import InputError
from palpate.author.report import write
from palpate.author.scene import load_scene
from palpate.author.shared_places import mean_press
from palpate.author.tool_stage import ToolShape
from palpate.author.ways_of_touching import judged_ways, refuse_not_round, touching_error
from palpate.fields.node_fit import PressArrays
from palpate.fields.usd_read import read_field
from palpate.fields.usd_validators import asset_errors
from palpate.runtime import Field

TILT = np.pi / 6
PROBE = """shape = "cone"
half_angle = "40 deg"
edge_radius = "2 mm"
friction = 0.1
tilt = ["0 deg", "30 deg"]"""
REST = """
[reach]
sphere = { center = [0.0, 0.0, 0.02], radius = "4 mm" }
depth_max = "2 mm"

[accuracy]
held_out = 4
force_tolerance = "6 %"
"""


@pytest.fixture(scope="module")
def scene_file(cube: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    text = cube.read_text().replace('name = "cube"', 'name = "cube"\neffects = ["response", "friction"]')
    text = text.replace('"cube.stl"', f'"{cube.parent}/cube.stl"').replace('"ball"', '"probe"')
    path = tmp_path_factory.mktemp("ways") / "scene.toml"
    path.write_text(text.replace('shape = "sphere"\nradius = "5 mm"', PROBE) + REST)
    return path


@pytest.fixture(scope="module")
def made(scene_file: Path):
    """What the pipeline says, and where the asset is; nothing here solves finite elements."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(press_solve, "solve", known_probe)
        patch.setattr(pipeline, "_here", lambda *args: nullcontext(Inline()))
        patch.setattr(validate, "press_executor", lambda *args: nullcontext(Inline()))
        patch.setattr(write, "pictures", lambda *args: ([], []))
        out = scene_file.parent / "out"
        yield pipeline.author(load_scene(scene_file), out), out


def test_the_asset_holds_the_curves_of_every_way_at_the_same_places(made) -> None:
    result, out = made
    assert asset_errors(out) == []
    field = read_field(out, "probe")
    (way,) = field.ways
    assert field.tool.tilt == 0.0 and way.tool.tilt == pytest.approx(TILT)
    assert way.tool.offset == pytest.approx(2e-3 * (1 - np.cos(TILT)), abs=1e-6)
    ratio = way.nodes.normal_force[:, -1] / field.nodes.normal_force[:, -1]
    assert ratio == pytest.approx(1.5 * np.cosh(1e-3 / 40e-3), rel=2e-3)  # the mean of both leans
    assert all(len(key.split("+")) == 2 for key in way.nodes.press_hash)
    row = result["tools"][0]
    assert row["presses"] == 3 * row["nodes"] + 4 and row["failed"] == 0


def test_the_cooked_field_has_the_ways_that_were_pressed(made) -> None:
    info = Field.open(made[1] / "probe.rfield").info
    assert info.way_count == 2
    assert list(info.way_cosine[:2]) == pytest.approx([1.0, np.cos(TILT)])


def test_fresh_presses_judge_each_tilt_and_those_between_in_both_leans(made) -> None:
    ways = made[0]["tools"][0]["ways"]
    assert [round(np.degrees(way["tilt"])) for way in ways] == [0, 15, 30, -30]
    assert [way["pressed"] for way in ways] == [True, False, True, True]
    assert ways[0]["force_error"]["max"] < 0.01
    share = [way["normal_force_share"]["p50"] for way in ways]  # rendered over pressed
    aside = np.sin(np.radians(15)) / np.sin(TILT) * 1e-3
    expected = [1.0, np.exp(-aside / 40e-3), np.exp(-1e-3 / 40e-3), np.exp(1e-3 / 40e-3)]
    assert share == pytest.approx(expected, abs=0.01)  # what leaning to the stiff side or away from it costs
    turned = [way["turned_force_share"]["p50"] for way in ways]
    assert turned[0] == pytest.approx(share[0], abs=1e-3)  # nothing was turned
    assert all(
        0.2 < left < whole for left, whole in zip(turned[1:], share[1:], strict=True)
    )  # energy must not rise
    assert made[0]["tolerance_met"]


def test_validate_judges_the_asset_alone_as_the_pipeline_did(made) -> None:
    judged = validate.validate(made[1], points=4, seed=1)
    assert judged["ways"] == made[0]["tools"][0]["ways"]


def test_the_report_tells_the_ways_apart(made) -> None:
    page = (made[1] / "report" / "index.html").read_text()
    assert "none: blended from the tilts beside it" in page


def test_ways_are_judged_in_turn_and_in_both_leans() -> None:
    turns = judged_ways([0.0, 0.2, 0.6])
    assert [turn.tilt for turn in turns] == pytest.approx([0.0, 0.1, 0.2, 0.4, 0.6, -0.6, -0.4, -0.2, -0.1])
    assert [turn.pressed for turn in turns] == [True, False, True, False, True, True, False, True, False]


def test_the_mean_of_two_presses_is_as_deep_as_both_came() -> None:
    n = np.array([0.0, 0.0, 1.0])
    deep = PressArrays(0 * n, n, np.arange(4.0), np.outer(np.arange(4.0), n), np.arange(4.0), hash="a")
    short = PressArrays(0 * n, n, np.arange(3.0), np.outer(3 * np.arange(3.0), n), np.zeros(3), hash="b")
    mean = mean_press([deep, short])
    assert mean.depth.tolist() == [0, 1, 2] and mean.force[:, 2].tolist() == [0, 2, 4]
    assert mean.energy.tolist() == [0, 0.5, 1] and mean.hash == "a+b"
    with pytest.raises(ValueError, match="the same ladder is right"):
        mean_press([deep, replace(short, depth=2 * short.depth)])


def test_several_tilts_of_a_tool_that_is_not_round_are_refused(scene_file: Path) -> None:
    scene = load_scene(scene_file)
    lying = ToolShape("capsule", (("radius", 2e-3), ("length", 9e-3)), axis=(1.0, 0.0, 0.0))
    with pytest.raises(InputError, match="not round about its axis"):
        refuse_not_round(scene, scene.tool[0], lying)


def test_a_ball_s_end_touches_where_the_blend_says_and_a_flat_end_does_not() -> None:
    cone = ToolShape("cone", (("half_angle", 0.7), ("edge_radius", 2e-3)))
    assert touching_error(cone, [0.0, TILT]) < 1e-9
    punch = ToolShape("flat_punch", (("radius", 3e-3), ("edge_radius", 0.5e-3)))
    assert 0.3e-3 < touching_error(punch, [0.0, TILT]) < 0.4e-3
    assert touching_error(punch, [0.0, TILT / 3, 2 * TILT / 3, TILT]) < 0.12e-3


@pytest.mark.parametrize(
    "tilts, what",
    [
        ('["10 deg", "30 deg"]', "rises from upright"),
        ('["0 deg", "30 deg", "20 deg"]', "rises from upright"),
        ('["-30 deg", "0 deg"]', "rises from upright"),
        ('["0 deg", "10 deg", "20 deg", "30 deg", "40 deg"]', "at most 4"),
    ],
)
def test_tilts_that_make_no_ways_are_refused(tilts: str, what: str, scene_file: Path, tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(scene_file.read_text().replace('["0 deg", "30 deg"]', tilts))
    with pytest.raises(InputError, match=what):
        require_capabilities(load_scene(path))
