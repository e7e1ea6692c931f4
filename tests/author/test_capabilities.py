# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What this version cannot do is refused by name, all of it at once; what it can do passes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from palpate.author import capabilities
from palpate.author.capabilities import CAPABILITIES, require_capabilities
from palpate.author.errors import InputError, InputProblem
from palpate.author.scene import load_scene
from palpate.fields.deformation_layout import LIMITS
from palpate.fields.kriging import ROWS_MAX

REGION = '[[organ.region]]\nname = "a"\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n'
NEO_HOOKEAN = 'material = { model = "neo_hookean", mu = 1e4 }\n'

BEYOND: dict[str, tuple[str, tuple[str, str] | None, str]] = {
    # capability: (extra, replaced, key); what is switched on leaves this table
    "effects": ("", ('name = "block"', 'name = "block"\neffects = ["response", "cutting"]'), "scene.effects"),
    "material models": ('[organ.material]\nmodel = "linear"\nmu = 1e3', None, "organ.material.model"),
    "largest Poisson's ratio": (
        '[organ.material]\nmodel = "neo_hookean"\nmu = 1e3\npoissons_ratio = 0.4999',
        None,
        "organ.material.poissons_ratio",
    ),
    "smallest Poisson's ratio": (
        '[organ.material]\nmodel = "neo_hookean"\nmu = 1e3\npoissons_ratio = 0.1',
        None,
        "organ.material.poissons_ratio",
    ),
    "regions": (REGION + NEO_HOOKEAN, None, "organ.region[0]"),
    "capsule": ('[organ.capsule]\nthickness = "50 um"\n' + NEO_HOOKEAN, None, "organ.capsule"),
    "painted stiffness": ('[organ.paint]\nstiffness_scale = "s"', None, "organ.paint.stiffness_scale"),
    "painted friction": (
        '[organ.paint]\nfriction = "f"',
        ('name = "block"', 'name = "block"\neffects = ["response", "friction"]'),
        "organ.paint.friction",
    ),
    "painted reach": ('[organ.paint]\nreach = "r"', None, "organ.paint.reach"),
    "support kinds": (
        "",
        ("[[organ.support]]", '[[organ.support]]\nkind = "elastic"\nstiffness = "2 kPa/mm"'),
        "organ.support[0].kind",
    ),
    "tool shapes": ("", ('shape = "sphere"', 'shape = "flat_punch"'), "tool[0].shape"),
    "several radii of a tool": ("", ('"5 mm"', '["5 mm", "8 mm"]'), "tool[0].radius"),
    "several tilts of a tool": (
        "",
        ('shape = "sphere"', 'shape = "flat_punch"\ntilt = ["0 deg", "20 deg"]'),
        "tool[0].tilt",
    ),
    "depth over tool radius": ('[reach]\ndepth_max = "12 mm"', None, "reach.depth_max"),
    "responses": ('[accuracy]\nresponse = "axial"', None, "accuracy.response"),
    "fidelities": ('[accuracy]\nfidelity = "linear"', None, "accuracy.fidelity"),
    "time budget": ('[accuracy]\ntime_budget = "20 min"', None, "accuracy.time_budget"),
    "device": ('[device]\nprofile = "omega.6"', None, "device"),
}


def problems(path: Path) -> dict[str, InputProblem]:
    with pytest.raises(InputError) as caught:
        require_capabilities(load_scene(path))
    return {problem.key: problem for problem in caught.value.problems}


def test_the_smallest_scene_passes(write_scene: Callable[..., Path]) -> None:
    require_capabilities(load_scene(write_scene()))


@pytest.mark.parametrize("capability", BEYOND)
def test_what_is_not_there_yet_is_refused_by_name(
    capability: str, write_scene: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    off = {
        "effects": ("response",),
        "material models": ("neo_hookean",),
        "smallest Poisson's ratio": 0.3,
        "largest Poisson's ratio": 0.495,
        "support kinds": ("fixed",),
        "tool shapes": ("sphere",),
        "depth over tool radius": 1.0,
        "responses": ("potential",),
        "fidelities": ("full",),
    }
    monkeypatch.setitem(CAPABILITIES, capability, off.get(capability, False))
    extra, replaced, key = BEYOND[capability]
    found = problems(write_scene(extra, *([replaced] if replaced else [])))
    assert set(found) == {key}
    assert "not yet in this version; supported:" in found[key].sentence


def test_a_capability_that_is_switched_on_passes(
    write_scene: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(capabilities.CAPABILITIES, "regions", True)
    require_capabilities(load_scene(write_scene(REGION + NEO_HOOKEAN)))
    monkeypatch.setitem(capabilities.CAPABILITIES, "material models", ("neo_hookean",))
    ogden = REGION + 'material = { model = "ogden", mu = 1e4, alpha = 6 }\n'
    assert set(problems(write_scene(ogden))) == {"organ.region[0].material.model"}


@pytest.mark.parametrize(
    ("effects", "most"), [('"response"', ROWS_MAX // 3), ('"response", "deformation"', LIMITS["node_count"])]
)
def test_more_nodes_than_a_field_can_have_are_refused_before_a_press(
    write_scene: Callable[..., Path], effects: str, most: int
) -> None:
    change = 'name = "block"\n', f'name = "block"\neffects = [{effects}]\n'
    require_capabilities(load_scene(write_scene(f"[accuracy]\nnodes = {most}\n", change)))
    found = problems(write_scene(f"[accuracy]\nnodes = {most + 1}\n", change))
    assert set(found) == {"accuracy.nodes"} and f"at most {most}" in found["accuracy.nodes"].sentence


def test_the_complete_scene_asks_for_nothing_that_is_not_there(complete_scene: Path) -> None:
    require_capabilities(load_scene(complete_scene))


def test_a_scene_is_refused_for_everything_at_once(
    complete_scene: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    missing = {
        "organ.region[0]": "regions",
        "organ.capsule": "capsule",
        "organ.paint.stiffness_scale": "painted stiffness",
        "tool[2].tilt": "several tilts of a tool",
        "accuracy.time_budget": "time budget",
        "device": "device",
    }
    for capability in missing.values():
        monkeypatch.setitem(CAPABILITIES, capability, False)
    refused = problems(complete_scene)
    assert set(refused) == set(missing)
    assert all(problem.expected for problem in refused.values())
