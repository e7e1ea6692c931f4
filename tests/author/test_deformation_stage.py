# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What the effect `deformation` asks of presses, and that nothing of it is there where no scene asks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from palpate.author import press_solve
from palpate.author.capabilities import require_capabilities
from palpate.author.deformation_stage import surface_press, tool_gap
from palpate.author.errors import InputError
from palpate.author.mechanics import mechanics_version
from palpate.author.plan import plan
from palpate.author.press_jobs import PressJob, PressOutcome
from palpate.author.scene import load_scene
from palpate.author.scene_types import digest
from palpate.author.tool_stage import ToolShape
from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.verification.blocks import block_organ

BALL = ToolShape("sphere", (("radius", 3e-3),))
PLAIN = PressJob((2e-3, 1e-3, 0.0), BALL, (3e-4, 6e-4), "near_field", refinement=0.6)
UNASKED = ("surface", "patch_radius", "stiffness")
WITH = 'name = "block"\neffects = ["response", "deformation"]'


@pytest.fixture(scope="module")
def records(tmp_path_factory):
    organ = block_organ((0.08, 0.08, 0.03), (8, 8, 3), {0: NeoHookean(5400.0, 0.48)})
    mesh, folder = SimpleNamespace(hash="block", organ=organ), str(tmp_path_factory.mktemp("presses"))
    return [press_solve.solve(mesh, job, folder)[0] for job in (PLAIN, replace(PLAIN, surface=True))]


def test_keys_of_presses_that_were_not_asked_are_as_before():
    mesh = SimpleNamespace(hash="block")
    asked = {name: value for name, value in vars(PLAIN).items() if name not in UNASKED}
    known = {"organ": "block", "job": {**asked, "tool": BALL.hash}, "mechanics": mechanics_version()}
    assert PLAIN.key(mesh) == digest(known) != replace(PLAIN, surface=True).key(mesh)


def test_a_record_keeps_the_surface_only_where_it_is_asked_for(records):
    plain, with_surface = records
    assert {name for name in with_surface if name not in plain} == {
        "surface_point", "surface_displacement", "surface_stuck", "surface_stuck_depth"
    }  # fmt: skip
    for name in plain:
        np.testing.assert_allclose(with_surface[name], plain[name], rtol=1e-6, atol=1e-12)


def test_the_surface_lies_on_the_tool_and_follows_it(records):
    outcome = PressOutcome(replace(PLAIN, surface=True), "key", records[1], {})
    press = surface_press(outcome, 2)
    assert press is not None and surface_press(outcome, 3) is None and not press.displacement[0].any()
    c, n, depth = press.contact_point, press.normal, press.depth[-1]
    middle = c + (3e-3 - depth) * n
    moved = press.point + press.displacement[-1]
    near = np.linalg.norm(press.point - c, axis=1) < 0.5e-3
    gap = np.linalg.norm(moved[near] - middle, axis=1) - 3e-3
    assert near.sum() > 3 and np.abs(gap).max() < 0.03 * depth
    followed = press.stuck[-1][
        near
    ]  # the tool moves along x: what it touches goes with it, and nothing far away
    assert followed[:, 0, 0] == pytest.approx(1.0, abs=0.05)
    far = np.linalg.norm(press.point - c, axis=1) > 15e-3
    assert np.abs(press.stuck[-1][far]).max() < 0.15


def test_a_tools_distance_is_that_of_its_shape():
    gap = tool_gap(BALL, 2e-3)
    heights, distances = (gap.step * np.arange(size) for size in gap.value.shape)
    law = np.hypot(heights[:, None] - 2 * gap.step - 3e-3, distances[None]) - 3e-3
    np.testing.assert_allclose(gap.value, law, atol=1e-12)


@pytest.mark.parametrize(
    ("tool", "key"),
    [('shape = "sphere"\nradius = ["2 mm", "4 mm"]', "tool[0].radius"),
     ('shape = "cone"\nhalf_angle = "40 deg"\ntilt = "20 deg"', "tool[0].tilt"),
     ('shape = "cylinder"\nradius = "2 mm"\nlength = "9 mm"\naxis = [1.0, 0.0, 0.0]', "tool[0].axis")],
)  # fmt: skip
def test_tools_that_are_not_round_upright_are_refused_by_name(write_scene: Callable[..., Path], tool, key):
    path = write_scene("", ('name = "block"', WITH))
    text = path.read_text()
    head, rest = text.split("[[tool]]", 1)
    path.write_text(head + '[[tool]]\nname = "odd"\n' + tool + "\n" + "".join(rest.partition("\n[")[1:]))
    with pytest.raises(InputError) as error:
        require_capabilities(load_scene(path))
    assert [p.key for p in error.value.problems] == [key]


def test_a_plan_says_what_it_adds(write_scene: Callable[..., Path]):
    without = plan(load_scene(write_scene())).result
    with_effect = plan(load_scene(write_scene("", ('name = "block"', WITH)))).result
    assert "deformation" in with_effect["stored"] and "deformation" not in without["stored"]
    tool = with_effect["tools"][0]
    own = tool["layers"]["deformation"]["bytes"]
    assert own == tool["bytes"] - without["tools"][0]["bytes"]
    assert own - 336 * tool["expected"] == pytest.approx(
        95e3, rel=0.1
    )  # tables of all depths; the rest a node
    assert "deformation" in without["not_modelled"] and "deformation" not in with_effect["not_modelled"]
