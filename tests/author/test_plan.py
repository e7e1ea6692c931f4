# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The plan: what it counts, and that it names what is left out."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
import trimesh

import palpate.author.plan as plan_module
from palpate.author.capabilities import CAPABILITIES
from palpate.author.effort import NODES_AT_LEAST, node_count
from palpate.author.errors import InputError
from palpate.author.plan import plan
from palpate.author.scene import load_scene


def test_a_plan_measures_the_organ_and_names_what_is_left_out(write_scene: Callable[..., Path]) -> None:
    result = plan(load_scene(write_scene('[accuracy]\nheld_out = 5\nfidelity = "full"'))).result
    assert result["mesh"]["volume"] == pytest.approx(0.1 * 0.08 * 0.04, rel=1e-6)
    assert result["mesh"]["taken_from"] == "the closed surface"
    assert result["not_modelled"] == ["friction", "texture", "transient", "cutting", "rigid", "deformation"]
    assert set(result["stored"]) == {"response"}
    tool = result["tools"][0]
    assert tool["seeds"] <= tool["pressed"] <= tool["nodes"]
    assert tool["presses"] == tool["pressed"] + 5
    assert tool["friction"] is None
    assert tool["presses"] * tool["node_seconds"] < result["cpu_seconds"] < 2 * tool["cpu_seconds"]


def test_a_plan_states_memory_and_takes_no_more_workers_than_it_holds(
    write_scene: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = load_scene(write_scene())
    result = plan(scene, workers=3).result
    memory = result["memory"]
    assert result["workers"] == 3 and memory["workers"] == 3 * memory["worker"] > 3 * 10**8
    monkeypatch.setattr(plan_module, "available_memory", lambda: int(2.5 * memory["worker"]))
    answer = plan(scene, workers=3)
    assert answer.result["workers"] == 2
    assert "2 press instead" in answer.result["memory"]["limited"]
    assert answer.result["memory"]["limited"] in answer.shown[0]


def test_a_smaller_reach_takes_fewer_presses(write_scene: Callable[..., Path]) -> None:
    everything = plan(load_scene(write_scene())).result
    disc = "[reach]\nsphere = { center = [0, 0, 0.04], radius = 0.02 }"
    part = plan(load_scene(write_scene(disc))).result
    assert part["reach"]["area"] == pytest.approx(3.14159 * 0.02**2, rel=0.05)
    assert part["tools"][0]["nodes"] < everything["tools"][0]["nodes"]


def test_an_organ_in_many_open_parts_is_planned_from_its_hull(write_scene: Callable[..., Path]) -> None:
    path = write_scene("", ("block.stl", "parts.glb"))
    halves = trimesh.Scene()
    for name, x in (("left", -0.02), ("right", 0.02)):
        half = trimesh.creation.box((0.05, 0.08, 0.04))
        half.apply_translation((x, 0.0, 0.02))
        half.update_faces(half.face_normals[:, 2] < 0.5)  # takes the lid off
        halves.add_geometry(half, node_name=name)
    halves.export(path.parent / "parts.glb")
    mesh = plan(load_scene(path)).result["mesh"]
    assert mesh["parts"] == 2
    assert "convex hull" in mesh["taken_from"]
    assert mesh["volume"] == pytest.approx(0.09 * 0.08 * 0.04, rel=1e-5)


def test_millimetres_taken_for_metres_are_told_before_any_work(write_scene: Callable[..., Path]) -> None:
    path = write_scene("", ("block.stl", "large.stl"))
    trimesh.creation.box((200.0, 100.0, 80.0)).export(path.parent / "large.stl")
    with pytest.raises(InputError) as caught:
        plan(load_scene(path))
    (problem,) = caught.value.problems
    assert problem.key.startswith("organ.")
    assert "200 m" in problem.sentence
    assert '"mm"' in problem.expected


def test_the_estimate_reproduces_what_it_was_read_from() -> None:
    for nodes, error in ((100, 0.13), (200, 0.059), (400, 0.018)):
        assert node_count(148e-4, error) == pytest.approx(nodes, rel=0.25)
    assert node_count(1e-6, 0.035) == NODES_AT_LEAST


SPHERE = "[reach]\nsphere = { center = [0, 0, 0.04], radius = 0.03 }\n"
NODULE = """
[[organ.region]]
name = "nodule"
sphere = { center = [0.0, 0.0, 0.025], radius = "8 mm" }
material = { model = "neo_hookean", youngs_modulus = "40 kPa" }
"""


def test_a_time_budget_buys_nodes_but_seeds_and_judgement_are_always_pressed(write_scene) -> None:
    def tool(budget: str) -> dict:
        result = plan(load_scene(write_scene(f"[accuracy]\n{budget}\nheld_out = 4")), workers=2).result
        return result["tools"][0] | {"wall": result["seconds"]}

    free, some, none = tool(""), tool('time_budget = "20 min"'), tool('time_budget = "10 s"')
    assert none["pressed"] == none["seeds"] < some["pressed"] < free["pressed"]
    assert some["wall"] == pytest.approx(1200.0, rel=0.15)
    assert none["wall"] > 1.0


LAYERS = """
[[texture]]
kind = "grating"
amplitude = "20 um"
wavelength = "1 mm"
direction = [1, 0, 0]

[tool.transient]
shape = "pulse"
amplitude = "1 N s/m"
duration = "10 ms"
"""
KINDS = {
    "response": ("", ""),
    "response, friction": (", friction", ""),
    "all": (", friction, texture, transient, deformation", LAYERS),
}


@pytest.mark.parametrize("region", ["", NODULE])
@pytest.mark.parametrize("kind", KINDS)
def test_what_is_added_adds_up(write_scene, kind: str, region: str) -> None:
    more, tables = KINDS[kind]
    effects = ", ".join(f'"{effect}"' for effect in f"response{more}".split(", "))
    asked = ('name = "block"', f'name = "block"\neffects = [{effects}]')
    friction = ('radius = "5 mm"', f'radius = "5 mm"\nfriction = 0.1\n{tables}')
    result = plan(load_scene(write_scene(SPHERE + region, asked, friction))).result
    added, tools = result["added"], result["tools"]
    assert [row["name"] for row in added["effects"]] == effects.replace('"', "").split(", ")
    for key in ("presses", "cpu_seconds", "bytes", "tick_ns"):
        assert sum(row[key] or 0 for row in added["effects"]) == pytest.approx(
            sum(row[key] for row in added["tools"])
        )
    assert [row["presses"] > 0 for row in added["regions"]] == ([True] if region else [])
    without = plan(load_scene(write_scene(SPHERE, asked, friction))).result["tools"][0]
    assert tools[0]["presses"] - without["presses"] == sum(row["presses"] for row in added["regions"])


def test_one_tool_of_a_scene_is_planned_alone(write_scene) -> None:
    second = '[[tool]]\nname = "another"\nshape = "sphere"\nradius = "3 mm"\n'
    scene = load_scene(write_scene(SPHERE + second))
    both, one = plan(scene).result, plan(scene, tool="another").result
    assert [tool["name"] for tool in one["tools"]] == ["another"]
    assert one["cpu_seconds"] < both["cpu_seconds"]
    with pytest.raises(InputError):
        plan(scene, tool="spoon")


def test_every_effect_that_is_built_is_in_the_plan_with_its_price_or_as_not_known() -> None:
    from palpate.author.plan_costs import TICK

    assert {"response", "friction"} <= set(TICK) and set(TICK) <= set(CAPABILITIES["effects"])
