# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The whole way on the shipped block, with few presses: surface, tets, FEM, field, USD, .rfield, runtime, report."""

import json
from pathlib import Path

import numpy as np
import pytest

from palpate.assets import scene_path
from palpate.author import field_stage, pipeline, tool_work
from palpate.author.errors import InputError, PalpateError
from palpate.author.place import Sphere
from palpate.author.scene import load_scene
from palpate.author.two_contacts import two_contacts
from palpate.author.validate import validate
from palpate.fem_offline.equilibrium import EquilibriumError
from palpate.fem_offline.two_contacts import TwoContacts
from palpate.fields.usd_read import read_field, tools
from palpate.fields.usd_validators import asset_errors
from palpate.runtime import Field

NODES = 5


@pytest.fixture(scope="module")
def out(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("block")


@pytest.fixture(scope="module")
def block(out, tmp_path_factory):
    """The shipped scene with a smaller reach and fewer presses, and its result."""
    text = scene_path("palpation_block").read_text()
    text = text.replace('"../phantoms/', f'"{scene_path("palpation_block").parents[1]}/phantoms/')
    text = text.replace('radius = "15 mm"', 'radius = "8 mm"').replace("held_out = 4", "held_out = 1")
    path = tmp_path_factory.mktemp("scene") / "block.toml"
    path.write_text(text)
    scene = load_scene(path)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tool_work, "node_count", lambda area, tolerance: NODES)
        patch.setattr(tool_work, "NEAR_CHECKS", 1)
        result = pipeline.author(scene, out)
        again = pipeline.author(scene, out)
    return result, again, path


def with_tool(path, radius):
    """The scene with a second tool, another ball."""
    more = f'[[tool]]\nname = "another"\nshape = "sphere"\nradius = "{radius}"\nfriction = 0.3\n'
    other = path.with_name("two_tools.toml")
    other.write_text(path.read_text() + more)
    return load_scene(other)


def test_the_rendered_force_is_within_the_scene_s_tolerance_of_fresh_finite_elements(block):
    tool = block[0]["tools"][0]
    assert tool["nodes"] == NODES and tool["failed"] == 0 and tool["held_out"] == 1
    assert tool["force_error"]["max"] < 0.05
    assert tool["lateral_error"]["max"] < 0.02
    assert tool["stuck_error"]["max"] < 0.05
    assert tool["far_field_error"]["max"] < 0.01
    assert block[0]["tolerance_met"]


def test_the_asset_is_clean_and_cooks_to_the_runtime_s_field(block, out):
    assert asset_errors(out) == []
    assert tools(out) == ["ball_5mm"]
    field = read_field(out, "ball_5mm")
    assert field.nodes.node_count == NODES
    assert field.nodes.residual.max() < 0.01
    info = Field.open(out / "ball_5mm.rfield").info
    assert info.tool_hash == field.tool.hash
    assert info.depth_max == pytest.approx(4e-3)
    assert info.bytes < 1_000_000


def test_action_and_reaction_are_in_every_record(block, out):
    errors = [np.load(path)["reaction_error"].max() for path in (out / "work" / "press").glob("*.npz")]
    assert len(errors) == NODES + 2
    assert max(errors) < 1e-8


def test_a_second_run_presses_nothing_again_and_gives_the_same_field(block, out):
    first, again, _ = block
    assert again["tools"][0]["force_error"] == first["tools"][0]["force_error"]
    assert {row["name"]: row["seconds"] for row in again["stages"]}["presses"] < 5.0


def test_validate_judges_the_asset_alone_as_the_pipeline_did(block, out):
    judged = validate(out, points=1, seed=1)
    assert judged["force_error"] == pytest.approx(block[0]["tools"][0]["force_error"])
    assert json.loads(Path(judged["record"]).read_text())["points"] == 1


def test_validate_draws_points_in_a_ball_only(block, out):
    place = np.load(next((out / "work" / "press").glob("*.npz")))["contact_point"]
    ball = Sphere(center=tuple(place), radius=0.3e-3)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("palpate.author.validate.TRUTH", "near_field")
        judged = validate(out, points=1, seed=3, within=ball)
    assert np.linalg.norm(np.array(judged["presses"][0]["contact_point"]) - place) < 0.3e-3
    assert "within" in Path(judged["record"]).name
    with pytest.raises(InputError, match="holds no surface that the tool may press"):
        validate(out, points=1, seed=3, within=Sphere(center=(1.0, 1.0, 1.0), radius=0.1))


def test_two_contacts_are_kept_and_shown(block, out, monkeypatch):
    def pressed(organ, points, tool, depths, size):
        normal = np.array([[0.0, 0.0, 1.0]] * 2)
        alone = np.array([[[0.0, 0.0, 1.0], [0.0, 0.0, 2.0]]] * 2)
        return TwoContacts(points, normal, depths, alone / np.array([[[1.1], [1.25]]]), alone, 1e-9, 1e-12)

    monkeypatch.setattr("palpate.fem_offline.two_contacts.press_two", pressed)
    with pytest.raises(
        InputError, match=r"--apart = \"90 mm\" is more than the reach holds; expected at most 8 mm"
    ):
        two_contacts(out, [0.09])
    with pytest.raises(InputError, match="so near that the contacts overlap"):
        two_contacts(out, [5e-3])
    monkeypatch.setattr(
        "palpate.author.two_contacts._pair", lambda *a: np.array([[0.0] * 3, [0.02, 0.0, 0.0]])
    )

    def stopped(*given):
        raise EquilibriumError("no convergence in 40 Newton steps")

    with monkeypatch.context() as patch:
        patch.setattr("palpate.fem_offline.two_contacts.press_two", stopped)
        with pytest.raises(PalpateError, match="two contacts 20 mm apart: no convergence"):
            two_contacts(out, [0.02])
    found = two_contacts(out, [0.02])
    assert found["pairs"][0]["normal_error"] == [pytest.approx([0.1, 0.25])] * 2
    report = json.loads((out / "report" / "report.json").read_text())
    assert report["tools"][0]["two_contacts"][0]["normal"] == pytest.approx(0.25)
    assert "25.0" in (out / "report" / "index.html").read_text().split("Two tools at once")[1][:2000]


def test_the_report_is_there(block, out):
    assert (out / "report" / "index.html").stat().st_size > 100_000
    assert "ball_5mm" in (out / "report" / "index.html").read_text()


def test_a_second_tool_is_added_and_touches_nothing_of_the_first(block, out, monkeypatch):
    """It has the first one's shape, so that its nodes are kept presses; what is new finds the far field kept."""
    first = [
        out / "fields" / "ball_5mm.usdc",
        out / "ball_5mm.rfield",
        out / "contact.usdc",
        out / "geometry.usdc",
    ]
    before = [(path.read_bytes(), path.stat().st_mtime_ns) for path in first]
    records = set((out / "work" / "press").glob("*.npz"))
    monkeypatch.setattr(tool_work, "node_count", lambda area, tolerance: NODES)
    monkeypatch.setattr(tool_work, "TRUTH", "near_field")
    monkeypatch.setattr(tool_work, "NEAR_CHECKS", 0)
    result = pipeline.author(with_tool(block[2], "5 mm"), out, tool="another")
    assert [(path.read_bytes(), path.stat().st_mtime_ns) for path in first] == before
    assert tools(out) == ["another", "ball_5mm"] and asset_errors(out) == []
    assert [row["name"] for row in result["tools"]] == ["ball_5mm", "another"] and not result["not_judged"]
    assert result["tools"][0] == json.loads(json.dumps(block[1]["tools"][0]))
    new = set((out / "work" / "press").glob("*.npz")) - records
    assert len(new) == 1  # the held-out one, which is pushed aside as far as this friction lets it
    assert json.loads(str(np.load(new.pop())["_json"]))["far_field_kept"]


def test_a_tool_that_does_not_go_with_the_asset_is_refused_before_anything_is_pressed(
    block, out, monkeypatch
):
    scene = load_scene(block[2])
    with pytest.raises(InputError, match=r"is no tool of this scene.*ball_5mm"):
        pipeline.author(scene, out, tool="knife")
    with pytest.raises(
        InputError, match=r"known from 0\.5 to 9\.0 mm from the surface; this asset knows it from -0\.5 to 8"
    ):
        pipeline.author(with_tool(block[2], "6 mm"), out, tool="another")
    with monkeypatch.context() as patch:
        patch.setattr(field_stage, "GEOMETRY_SPACINGS", (2e-3, 1e-3))
        patch.setattr(field_stage, "SPACING_IN_DEPTHS", 0.1)
        with pytest.raises(
            InputError, match=r"presses 4\.0 mm deep.*too coarse: every \d\.\d mm, off by \d+ um"
        ):
            pipeline.author(with_tool(block[2], "5 mm"), out, tool="another")
    held = scene.organ.support[0].model_copy(update={"kind": "elastic", "stiffness": 1e6})
    other = scene.model_copy(update={"organ": scene.organ.model_copy(update={"support": [held]})})
    with pytest.raises(InputError, match="not this scene's"):
        pipeline.author(other, out, tool="ball_5mm")
