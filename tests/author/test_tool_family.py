# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A tool family, the whole way: pressed at the same places, one variant, a field of any radius between.

The presses are a law that is known at every radius (stand_in_solvers.py); real ones are in the decisions' numbers.
"""

from __future__ import annotations

import json
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest
from stand_in_solvers import Inline, known_block

from palpate.author import capabilities, pipeline, press_solve, validate
from palpate.author.command_line import main
from palpate.author.errors import InputError
from palpate.author.report import write
from palpate.author.scene import load_scene
from palpate.author.tool_family import family_held_out, judged_radii, radius_of
from palpate.author.tool_members import members_of
from palpate.fields.rfield_read import read_rfield
from palpate.fields.usd_read import read_field, tools
from palpate.fields.usd_validators import asset_errors
from palpate.runtime import Field

FAMILY = """
effects = ["response", "friction"]
"""
REST = """
[reach]
sphere = { center = [0.0, 0.0, 0.02], radius = "4 mm" }
depth_max = "3 mm"

[accuracy]
held_out = 4
"""


@pytest.fixture(scope="module")
def scene_file(cube: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    text = cube.read_text().replace('name = "cube"', 'name = "cube"' + FAMILY)
    text = text.replace('"cube.stl"', f'"{cube.parent}/cube.stl"').replace('"ball"', '"balls"')
    text = text.replace('radius = "5 mm"', 'radius = ["2 mm", "5 mm"]\nfriction = 0.1') + REST
    path = tmp_path_factory.mktemp("family") / "scene.toml"
    path.write_text(text)
    return path


@pytest.fixture(scope="module")
def known(scene_file: Path):
    """Nothing here solves finite elements."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(press_solve, "solve", known_block)
        patch.setattr(pipeline, "_here", lambda *args: nullcontext(Inline()))
        patch.setattr(validate, "press_executor", lambda *args: nullcontext(Inline()))
        patch.setattr(write, "pictures", lambda *args: ([], []))
        yield


@pytest.fixture(scope="module")
def made(scene_file: Path, known: None) -> tuple[dict, Path]:
    out = scene_file.parent / "out"
    return pipeline.author(load_scene(scene_file), out), out


def answer(capsys: pytest.CaptureFixture, *arguments: str) -> tuple[int, dict]:
    code = main([*arguments, "--json"])
    return code, json.loads(capsys.readouterr().out)


def test_one_variant_holds_the_curves_of_every_radius_at_the_same_places(made: tuple[dict, Path]) -> None:
    result, out = made
    assert tools(out) == ["balls"] and asset_errors(out) == []
    field = read_field(out, "balls")
    assert [member.radius for member in field.family] == [2e-3, 5e-3]
    assert [member.nodes.depth_knots[-1] for member in field.family] == pytest.approx([2.4e-3, 3e-3])
    assert field.tool.parameters == {"radius": 5e-3}
    hashes = [set(member.nodes.press_hash) for member in field.family]
    assert not hashes[0] & hashes[1] and len(hashes[0]) == field.nodes.node_count
    row = result["tools"][0]
    assert [Path(one["rfield"]).name for one in row["radii"]] == ["balls-2mm.rfield", "balls-5mm.rfield"]
    assert row["presses"] == 2 * row["nodes"] + 4 and row["failed"] == 0


def test_fresh_presses_judge_radii_that_were_pressed_and_radii_between(made: tuple[dict, Path]) -> None:
    family = made[0]["tools"][0]["family"]
    assert [row["radius"] for row in family["radii"]] == pytest.approx([2e-3, np.sqrt(10) * 1e-3, 5e-3])
    assert [row["pressed"] for row in family["radii"]] == [True, False, True]
    assert family["pressed"]["points"] == family["between"]["points"] == 2
    assert family["between"]["force_error"]["max"] < 0.01 and family["pressed"]["force_error"]["max"] < 0.01
    assert family["between"]["lateral_error"]["max"] < 0.01 and family["between"]["stuck_error"]["max"] < 0.01
    assert made[0]["tolerance_met"]


def test_a_radius_between_is_cooked_and_validated_from_the_asset_alone(
    made: tuple[dict, Path], capsys: pytest.CaptureFixture
) -> None:
    asset = str(made[1])
    code, cooked = answer(capsys, "cook", asset, "--tool", "balls", "--radius", "3.5 mm")
    assert code == 0 and Path(cooked["tools"][0]["rfield"]).name == "balls-3.5mm.rfield"
    info = Field.open(cooked["tools"][0]["rfield"]).info
    assert info.tool_name == "balls" and info.tool_offset == 3.5e-3
    assert 2.4e-3 < info.depth_max < 3e-3
    code, judged = answer(capsys, "validate", asset, "--radius", "3.5 mm", "--points", "3")
    assert code == 0 and judged["points"] == 3 and judged["force_error"]["max"] < 0.01
    assert [row["radius"] for row in judged["family"]["radii"]] == [3.5e-3]


def test_validate_judges_the_asset_alone_as_the_pipeline_did(made: tuple[dict, Path]) -> None:
    judged = validate.validate(made[1], points=4, seed=1)
    assert judged["force_error"] == made[0]["tools"][0]["force_error"]
    assert judged["family"] == made[0]["tools"][0]["family"]


def test_a_pressed_radius_is_cooked_as_the_pipeline_did(
    made: tuple[dict, Path], tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    answer(capsys, "cook", str(made[1]), "--out", str(tmp_path))
    for name in ("balls-2mm.rfield", "balls-5mm.rfield"):
        again, first = (read_rfield((folder / name).read_bytes()) for folder in (tmp_path, made[1]))
        assert np.array_equal(again.amplitudes.coefficients, first.amplitudes.coefficients)
        assert again.tool.hash == first.tool.hash and again.depth_max == first.depth_max


@pytest.mark.parametrize("command", ["cook", "validate"])
def test_a_radius_outside_what_was_pressed_is_refused_by_name(
    command: str, made: tuple[dict, Path], capsys: pytest.CaptureFixture
) -> None:
    code, refused = answer(capsys, command, str(made[1]), "--tool", "balls", "--radius", "6 mm")
    assert code == 2
    problem = refused["error"]["problems"][0]
    assert problem["key"] == "--radius" and "pressed with (2, 5 mm)" in problem["what"]
    assert problem["expected"] == "2 mm to 5 mm"


def test_the_report_tells_the_radii_apart(made: tuple[dict, Path]) -> None:
    page = (made[1] / "report" / "index.html").read_text()
    assert "none: made from the radii beside it" in page and "3.162 mm" in page


def test_one_press_of_a_family_says_which_ball(
    scene_file: Path, known: None, capsys: pytest.CaptureFixture
) -> None:
    at = ("press", str(scene_file), "--at", "0,0,0.02", "--tool", "balls", "--depth", "1 mm")
    code, refused = answer(capsys, *at)
    assert code == 2 and "2, 5 mm" in refused["error"]["problems"][0]["what"]


def test_each_radius_presses_to_the_depth_or_to_its_own_share(scene_file: Path) -> None:
    scene = load_scene(scene_file)
    members = members_of(scene, scene.tool[0])
    assert [one.radius for _, one in members] == [(2e-3,), (5e-3,)]
    assert [own.depth_max(one) for own, one in members] == pytest.approx([1.2 * 2e-3, 3e-3])
    shallow = scene.model_copy(update={"reach": scene.reach.model_copy(update={"depth_max": 1e-3})})
    assert [own.depth_max(one) for own, one in members_of(shallow, scene.tool[0])] == [1e-3, 1e-3]


def test_judged_radii_alternate_and_every_one_has_its_turn() -> None:
    turns = judged_radii([2e-3, 5e-3, 10e-3], [2e-3, 4e-3, 4e-3])
    assert [turn.pressed for turn in turns] == [True, False] * 6
    assert {turn.radius for turn in turns if turn.pressed} == {2e-3, 5e-3, 10e-3}
    assert len({turn.radius for turn in turns if not turn.pressed}) == 2
    jobs = family_held_out(np.zeros((5, 3)), turns, 0.1, "full", 1)
    assert [radius_of(job) for job in jobs] == [turn.radius for turn in turns[:5]]


def test_several_radii_of_a_tool_that_is_no_ball_are_refused(scene_file: Path, tmp_path: Path) -> None:
    path = tmp_path / "punch.toml"
    path.write_text(scene_file.read_text().replace('shape = "sphere"', 'shape = "flat_punch"'))
    with pytest.raises(
        InputError, match=r"several radii of a flat_punch.*one radius, or several of a sphere"
    ):
        capabilities.require_capabilities(load_scene(path))
