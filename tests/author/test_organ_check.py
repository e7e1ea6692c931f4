# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What only the organ's surface can tell: units, and places that hold nothing."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh

from palpate.author.errors import InputError, InputProblem
from palpate.author.organ_check import OrganSummary, check_against_organ
from palpate.author.place import Place, Sphere
from palpate.author.scene import load_scene


def organ(path: Path, scale: float = 1.0) -> OrganSummary:
    mesh = trimesh.load_mesh(path.parent / "block.stl")
    return OrganSummary(np.asarray(mesh.vertices) * scale, np.asarray(mesh.faces))


def problems(path: Path, scale: float = 1.0) -> dict[str, InputProblem]:
    with pytest.raises(InputError) as caught:
        check_against_organ(load_scene(path), organ(path, scale))
    return {problem.key: problem for problem in caught.value.problems}


def test_a_fitting_scene_passes(write_scene: Callable[..., Path]) -> None:
    path = write_scene("[reach]\nsphere = { center = [0, 0, 0.04], radius = 0.02 }")
    check_against_organ(load_scene(path), organ(path))


def test_volume_and_area_of_a_block(write_scene: Callable[..., Path]) -> None:
    block = organ(write_scene())
    assert block.volume == pytest.approx(0.10 * 0.08 * 0.04, rel=1e-6)
    assert block.area == pytest.approx(2 * (0.1 * 0.08 + 0.1 * 0.04 + 0.08 * 0.04), rel=1e-6)


def test_the_share_of_a_place_is_a_share_of_the_area(write_scene: Callable[..., Path]) -> None:
    block = organ(write_scene())
    disc = Place(sphere=Sphere(center=(0, 0, 0.04), radius=0.02))
    assert block.share_within(disc) == pytest.approx(np.pi * 0.02**2 / block.area, rel=0.05)


@pytest.mark.parametrize(
    ("scale", "stated", "right"),
    [(1000.0, None, "mm"), (100.0, None, "cm"), (0.001, "mm", "m")],
)
def test_a_wrong_unit_is_told_with_the_right_one(
    scale: float, stated: str | None, right: str, write_scene: Callable[..., Path]
) -> None:
    surface = 'surface = "block.stl"'
    path = write_scene("", (surface, f'{surface}\nunits = "{stated}"' if stated else surface))
    found = problems(path, scale)
    assert set(found) == {"organ.units"}
    assert found["organ.units"].expected.startswith(f'"{right}", which makes it 0.1 m')
    assert found["organ.units"].value == (stated or "m")


def test_an_organ_of_200_m_is_told_as_millimetres(write_scene: Callable[..., Path]) -> None:
    found = problems(write_scene(), 2000.0)["organ.units"]
    assert "makes an organ of 200 m; millimetres taken for metres?" in found.sentence


@pytest.mark.parametrize(
    ("extra", "replace", "key", "what"),
    [
        ("", ('"5 mm"', '"60 mm"'), "tool[0].radius", "larger than the organ"),
        ("", ("max = [1.0, 1.0, 0.005]", "max = [1.0, 1.0, -0.005]"), "organ.support[0]", "holds nothing"),
        (
            "",
            ("max = [1.0, 1.0, 0.005]", "max = [1.0, 1.0, 1.0]"),
            "organ.support",
            "holds the whole surface",
        ),
        ("[reach]\nsphere = { center = [0, 0, 0.02], radius = 0.01 }", None, "reach", "contains none"),
        ("[reach]\nbox = { min = [-1, -1, -1], max = [1, 1, 0.003] }", None, "reach", "supports hold"),
        ('[reach]\ndepth_max = "45 mm"', None, "reach.depth_max", "goes through the organ"),
        (
            '[[organ.region]]\nname = "a"\nsphere = { center = [0, 0, 0.06], radius = 0.01 }\n'
            'material = { model = "neo_hookean", mu = 1e4 }',
            None,
            "organ.region[0]",
            "outside the organ",
        ),
    ],
)
def test_what_does_not_fit_is_told_alone(
    extra: str, replace: tuple[str, str] | None, key: str, what: str, write_scene: Callable[..., Path]
) -> None:
    found = problems(write_scene(extra, *([replace] if replace else [])))
    assert set(found) == {key}
    assert what in found[key].what


def test_a_region_deep_inside_is_inside(write_scene: Callable[..., Path]) -> None:
    path = write_scene(
        '[[organ.region]]\nname = "a"\nsphere = { center = [0, 0, 0.02], radius = 0.002 }\n'
        'material = { model = "neo_hookean", mu = 1e4 }'
    )
    check_against_organ(load_scene(path), organ(path))


def test_an_open_place_is_told(write_scene: Callable[..., Path]) -> None:
    path = write_scene('[reach]\nsurface = "open.stl"\n', ("5 mm", "5 mm"))
    mesh = trimesh.creation.icosphere(subdivisions=1)
    mesh.update_faces(np.arange(len(mesh.faces)) > 0)
    mesh.export(path.parent / "open.stl")
    assert "not a closed surface" in problems(path)["reach.surface"].what


def test_everything_that_does_not_fit_is_told_at_once(write_scene: Callable[..., Path]) -> None:
    path = write_scene(
        "[reach]\nsphere = { center = [0, 0, 1], radius = 0.01 }",
        ('"5 mm"', '"60 mm"'),
        ("0.005]", "-0.005]"),
    )
    assert set(problems(path)) == {"tool[0].radius", "organ.support[0]", "reach"}
