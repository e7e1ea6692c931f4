# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The scene file: the whole contract, its smallest part, each optional table alone, all problems at once."""

from __future__ import annotations

import json
import math
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from pydantic import ValidationError

from palpate.author import scene as scene_module
from palpate.author.errors import InputError, InputProblem
from palpate.author.scene import load_scene, scene_schema


def problems(path: Path) -> dict[str, InputProblem]:
    with pytest.raises(InputError) as caught:
        load_scene(path)
    return {problem.key: problem for problem in caught.value.problems}


def test_the_complete_scene_is_read_in_si(complete_scene: Path) -> None:
    scene = load_scene(complete_scene)
    assert scene.name == "liver"
    assert scene.effects == ("response", "friction")
    assert scene.organ.surface == complete_scene.parent / "liver.obj"
    assert scene.organ.mesh_size == pytest.approx(8e-3)
    assert scene.organ.material.mu == (1800.0,)
    assert scene.organ.material.shear_modulus == 1800.0
    assert scene.organ.region[0].material.shear_modulus == pytest.approx(40e3 / (2 * 1.49))
    assert scene.organ.region[0].sphere is not None
    assert scene.organ.region[0].sphere.radius == pytest.approx(8e-3)
    assert scene.organ.capsule is not None
    assert scene.organ.capsule.thickness == pytest.approx(50e-6)
    assert scene.organ.paint is not None
    assert scene.reach.depth_max == pytest.approx(6e-3)
    assert [tool.radius for tool in scene.tool] == [(5e-3,), (2e-3, 5e-3, 10e-3), None]
    assert scene.tool[2].tilt == pytest.approx((0.0, math.radians(30)))
    assert scene.accuracy.force_tolerance == pytest.approx(0.035)
    assert scene.accuracy.time_budget == 1200.0
    assert scene.device is not None
    assert scene.device.rate == 1000.0


def test_the_smallest_scene_gets_the_stated_defaults(write_scene: Callable[..., Path]) -> None:
    scene = load_scene(write_scene())
    assert scene.effects == ("response",)
    assert scene.organ.material.shear_modulus == 1800.0
    assert not scene.reach.is_given
    assert scene.depth_max(scene.tool[0]) == 5e-3
    assert (scene.accuracy.force_tolerance, scene.accuracy.held_out, scene.accuracy.seed) == (0.035, 40, 1)
    assert scene.device is None


OPTIONAL_TABLES = {
    "organ.material": '[organ.material]\nmodel = "linear"\nyoungs_modulus = "5 kPa"\n',
    "organ.region": '[[organ.region]]\nname = "a"\nbox = { min = [0, 0, 0], max = [0.01, 0.01, 0.01] }\n'
    'material = { model = "neo_hookean", mu = "20 kPa" }\n',
    "organ.capsule": '[organ.capsule]\nthickness = "50 um"\nmaterial = { model = "neo_hookean", mu = 3e5 }\n',
    "organ.paint": '[organ.paint]\nstiffness_scale = "s"\n',
    "reach": '[reach]\ndepth_max = "2 mm"\n',
    "accuracy": "[accuracy]\nseed = 7\n",
    "device": '[device]\ndamping = "5 N s/m"\nfriction = "0.1 N"\nresolution = "10 um"\nmax_force = "12 N"\n',
}


@pytest.mark.parametrize("name", OPTIONAL_TABLES)
def test_each_optional_table_works_alone(name: str, write_scene: Callable[..., Path]) -> None:
    # [organ.x] tables may stand behind [[tool]] in TOML
    plain, with_table = load_scene(write_scene()), load_scene(write_scene(OPTIONAL_TABLES[name]))
    assert with_table.digest() != plain.digest()


@pytest.mark.parametrize(
    ("material", "shear_modulus"),
    [
        ('model = "linear", youngs_modulus = "3 kPa", poissons_ratio = 0.0', 1500.0),
        ('model = "neo_hookean", mu = "2 kPa"', 2000.0),
        ('model = "mooney_rivlin", c10 = "1 kPa", c01 = "0.5 kPa"', 3000.0),
        ('model = "ogden", mu = ["1 kPa", "2 kPa"], alpha = [2.0, 6.0]', 3000.0),
        ('model = "yeoh", c10 = "1 kPa", c20 = "0.1 kPa"', 2000.0),
        ('model = "veronda_westmann", c1 = "1 kPa", c2 = 2.0', 2000.0),
    ],
)
def test_every_material_states_its_initial_shear_modulus(
    material: str, shear_modulus: float, write_scene: Callable[..., Path]
) -> None:
    scene = load_scene(
        write_scene("", ('surface = "block.stl"', f'surface = "block.stl"\nmaterial = {{ {material} }}'))
    )
    assert scene.organ.material.shear_modulus == pytest.approx(shear_modulus)


def test_every_problem_is_told_at_once(folder: Path) -> None:
    path = Path(shutil.copy(Path(__file__).parent / "scenes" / "many_problems.toml", folder / "scene.toml"))
    found = problems(path)
    assert set(found) == {
        "reech",
        "scene.name",
        "scene.effects[0]",
        "scene.colour",
        "organ.surface",
        "organ.mesh_size",
        "organ.suport",
        "organ.material.youngs_modulus",
        "organ.material.poissons_ratio",
        "organ.support[0].box.min[2]",
        "tool[0].radius[1]",
        "tool[1].radius",
        "tool[1].name",
        "tool[2].shape",
        "tool[2].axis",
        "accuracy.force_tolerance",
        "accuracy.held_out",
        "accuracy.knots",
    }
    assert all(problem.file == str(path) and problem.expected for problem in found.values())
    assert found["organ.mesh_size"].value == "8 kPa"
    assert "pressure, not a length" in found["organ.mesh_size"].sentence
    assert '(did you mean "response"?)' in found["scene.effects[0]"].what
    assert '(did you mean "support"?)' in found["organ.suport"].what
    assert '(did you mean "reach"?)' in found["reech"].what
    assert '(did you mean "sphere"?)' in found["tool[2].shape"].what


@pytest.mark.parametrize(
    ("extra", "replace", "key"),
    [
        ("", ('name = "block"', 'name = "a block"'), "scene.name"),
        ("", ('name = "block"\n', 'name = "block"\neffects = []\n'), "scene.effects"),
        ("", ('name = "block"\n', 'name = "block"\neffects = ["texture"]\n'), "scene.effects"),
        (
            "",
            ('name = "block"\n', 'name = "block"\neffects = ["response", "friction"]\n'),
            "tool[0].friction",
        ),
        ("", ('surface = "block.stl"', 'surface = "absent.stl"'), "organ.surface"),
        ("", ('surface = "block.stl"', ""), "organ.surface"),
        ("", ("box = { min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 0.005] }", ""), "organ.support[0]"),
        ("", ("max = [1.0, 1.0, 0.005]", "max = [1.0, 1.0, -1.0]"), "organ.support[0].box"),
        ("", ("[[organ.support]]", '[[organ.support]]\nkind = "elastic"'), "organ.support[0].stiffness"),
        ("", ("[[organ.support]]", "[[organ.support]]\nstiffness = 1.0"), "organ.support[0].stiffness"),
        (
            "",
            ("[[organ.support]]", "[[organ.support]]\nsphere = { center = [0, 0, 0], radius = 1 }"),
            "organ.support[0]",
        ),
        ("", ('radius = "5 mm"', 'radius = "0 mm"'), "tool[0].radius"),
        ("", ('radius = "5 mm"', 'radius = ["5 mm", "3 mm"]'), "tool[0].radius"),
        ("", ('radius = "5 mm"', ""), "tool[0].radius"),
        ("", ('radius = "5 mm"', 'radius = "5 mm"\ntilt = ["30 deg"]'), "tool[0].tilt"),
        ("", ('name = "ball"', 'name = "1 ball"'), "tool[0].name"),
        ('[[tool]]\nname = "ball"\nshape = "sphere"\nradius = 0.01', None, "tool[1].name"),
        ("[reach]\ndepth_max = 0", None, "reach.depth_max"),
        ('[reach]\ndepth_max = "6 m"', None, "reach.depth_max"),
        ("[accuracy]\nforce_tolerance = 3.5", None, "accuracy.force_tolerance"),
        ("[accuracy]\nheld_out = 2.5", None, "accuracy.held_out"),
        ("[accuracy]\nseed = -1", None, "accuracy.seed"),
        ('[accuracy]\nknots = "many"', None, "accuracy.knots"),
        ("[device]\nrate = 1000", None, "device"),
        ('[organ.material]\nmodel = "neo_hookean"', None, "organ.material"),
        ('[organ.material]\nmodel = "ogden"\nmu = [1e3]', None, "organ.material.alpha"),
        ('[organ.material]\nmodel = "ogden"\nmu = [1e3]\nalpha = [1, 2]', None, "organ.material.alpha"),
        ('[organ.material]\nmodel = "neo_hookean"\nmu = 1e3\nalpha = 2', None, "organ.material.alpha"),
        ('[organ.material]\nmodel = "neo_hookean"\nmu = "0 Pa"', None, "organ.material.mu"),
        (
            '[organ.material]\nmodel = "neo_hookean"\nmu = 1e3\npoissons_ratio = 0.5',
            None,
            "organ.material.poissons_ratio",
        ),
        ('[organ.material]\nmodel = "jelly"\nmu = 1e3', None, "organ.material.model"),
    ],
)
def test_one_wrong_thing_is_told_at_its_key_and_alone(
    extra: str, replace: tuple[str, str] | None, key: str, write_scene: Callable[..., Path]
) -> None:
    assert set(problems(write_scene(extra, *([replace] if replace else [])))) == {key}


def test_missing_tables_are_told_together(folder: Path) -> None:
    path = folder / "empty.toml"
    path.write_text("")
    assert set(problems(path)) == {"scene", "organ", "tool"}


def test_tables_of_the_wrong_kind_are_told(folder: Path) -> None:
    path = folder / "kinds.toml"
    path.write_text('scene = 3\norgan = ["a"]\n[tool]\nname = "a"\n')
    assert set(problems(path)) == {"scene", "organ", "tool"}


@pytest.mark.parametrize("content", [b"[scene\n", b"\xff\xfe\x00"])
def test_a_file_that_is_no_toml_is_told(content: bytes, folder: Path) -> None:
    path = folder / "broken.toml"
    path.write_bytes(content)
    assert set(problems(path)) == {""}


def test_a_missing_file_is_told(folder: Path) -> None:
    assert "does not exist" in problems(folder / "absent.toml")[""].sentence


def test_a_scene_cannot_be_changed(write_scene: Callable[..., Path]) -> None:
    scene = load_scene(write_scene())
    with pytest.raises(ValidationError, match="frozen"):
        scene.organ.mesh_size = 1.0  # type: ignore[misc]


def test_the_digest_depends_on_meaning_and_not_on_spelling_or_place(
    write_scene: Callable[..., Path], tmp_path_factory: pytest.TempPathFactory
) -> None:
    plain = load_scene(write_scene())
    respelled = load_scene(write_scene("", ('"5 mm"', "0.005"), ('name = "ball"', 'name = "kugel"')))
    assert respelled.digest() == plain.digest()
    assert load_scene(write_scene("", ('"5 mm"', "0.0050001"))).digest() != plain.digest()

    elsewhere = tmp_path_factory.mktemp("elsewhere")
    for file in plain.organ.surface.parent.iterdir():
        shutil.copy(file, elsewhere)
    write_scene()
    shutil.copy(plain.file, elsewhere / "scene.toml")
    moved = load_scene(elsewhere / "scene.toml")
    assert moved.digest() == plain.digest()
    moved.organ.surface.write_bytes(moved.organ.surface.read_bytes() + b"\0")
    assert moved.digest() != plain.digest()


def test_a_tools_shape_digest_leaves_friction_out(write_scene: Callable[..., Path]) -> None:
    tool = load_scene(write_scene()).tool[0]
    dry = tool.model_copy(update={"friction": 0.3})
    assert dry.shape_digest() == tool.shape_digest()
    assert dry.digest() != tool.digest()


def test_an_unknown_tool_is_told_with_the_known_ones(write_scene: Callable[..., Path]) -> None:
    scene = load_scene(write_scene())
    assert scene.tool_named("ball") is scene.tool[0]
    with pytest.raises(InputError, match='did you mean "ball"'):
        scene.tool_named("bal")


def test_the_shipped_schema_is_current() -> None:
    shipped = Path(scene_module.__file__).with_name("scene.schema.json")
    assert json.loads(shipped.read_text()) == scene_schema(), (
        "renew with: palpate schema > author/scene.schema.json"
    )
