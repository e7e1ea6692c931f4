# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A scene's tool presses as the scene says, and an asset keeps enough of it to press with it again."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh

from palpate.author.errors import InputError
from palpate.author.scene import load_scene
from palpate.author.tool_stage import (
    ToolShape,
    offset_of,
    reference_of,
    shape_of,
    shape_of_reference,
    solid_tool,
)
from palpate.fem_offline.pose import Pose, tilted

SPHERE = 'shape = "sphere"\nradius = "5 mm"'
SHAPES = {
    "sphere": SPHERE,
    "punch": 'shape = "flat_punch"\nradius = "3 mm"\nedge_radius = "0.5 mm"',
    "standing": 'shape = "cylinder"\nradius = "3 mm"\nlength = "20 mm"',
    "lying": 'shape = "cylinder"\nradius = "3 mm"\nlength = "20 mm"\naxis = [1, 0, 0]',
    "cone": 'shape = "cone"\nhalf_angle = "40 deg"\nedge_radius = "1 mm"',
    "capsule": 'shape = "capsule"\nradius = "3 mm"\nlength = "12 mm"\naxis = [0, 1, 0]',
    "leaning": 'shape = "flat_punch"\nradius = "3 mm"\ntilt = "20 deg"',
    "crooked": 'shape = "capsule"\nradius = "3 mm"\nlength = "12 mm"\naxis = [0.3, 0.2, 0.7]',
    "mesh": 'shape = "mesh"\nsurface = "wedge.stl"\nunits = "mm"\ntip = [0, 0, 0]\naxis = [0, 0.6, 0.8]',
    "held higher": 'shape = "flat_punch"\nradius = "3 mm"\ntip = [0, 0, "2 mm"]',
}

MESHED = [name for name in SHAPES if name != "sphere"]
"""A sphere is a sphere in USD too; the others are stored as triangles."""


def wedge() -> trimesh.Trimesh:
    """An irregular tetrahedron, mm, its lowest corner in the origin."""
    corners = [[0, 0, 0], [9, -4, 12], [-8, -5, 12], [1, 9, 13]]
    return trimesh.convex.convex_hull(np.array(corners, float))


@pytest.fixture(params=SHAPES)
def shape(request: pytest.FixtureRequest, write_scene: Callable[..., Path], folder: Path) -> ToolShape:
    wedge().export(folder / "wedge.stl")
    scene = load_scene(write_scene("", (SPHERE, SHAPES[request.param])))
    return shape_of(scene, scene.tool[0])


def surface_of(shape: ToolShape) -> trimesh.Trimesh:
    reference = reference_of("tool", shape)
    return trimesh.Trimesh(reference.vertices, reference.triangles, process=False)


def test_an_asset_s_tool_is_the_scene_s(shape: ToolShape) -> None:
    again = shape_of_reference(reference_of("tool", shape))
    assert again.hash == shape.hash
    assert offset_of(again) == offset_of(shape)


def test_at_the_offset_the_tool_just_touches(shape: ToolShape) -> None:
    """A plane below the reference point by the offset holds no point of the tool, and is touched."""
    rotation = tilted(np.array([0.0, 0.0, 1.0]), shape.tilt)
    pose = Pose(np.array([0.0, 0.0, offset_of(shape)]), rotation)
    x = np.linspace(-0.02, 0.02, 401)
    plane = np.stack([a.ravel() for a in np.meshgrid(x, x)] + [np.zeros(401**2)], axis=1)
    rounded = 1e-3 if shape.shape == "mesh" else 2e-5
    assert solid_tool(shape).distance(plane, pose).gap.min() == pytest.approx(0.0, abs=rounded)


@pytest.mark.parametrize("shape", MESHED, indirect=True)
def test_the_geometry_is_closed_outward_and_on_the_tool(shape: ToolShape) -> None:
    mesh = surface_of(shape)
    assert mesh.is_watertight and mesh.volume > 0.0
    upright = Pose.upright(np.zeros(3))
    gap = solid_tool(shape).distance(np.array(mesh.vertices), upright).gap
    assert np.abs(gap).max() < (2e-3 if shape.shape == "mesh" else 1e-9)  # a grid rounds a mesh's corners off


@pytest.mark.parametrize("shape", MESHED, indirect=True)
def test_its_lowest_point_is_the_offset_below_the_reference_point(shape: ToolShape) -> None:
    reference = reference_of("tool", shape)
    turned = reference.vertices @ reference.held_against(np.array([0.0, 0.0, 1.0])).T
    assert -turned[:, 2].min() == pytest.approx(reference.offset, abs=2e-5)


@pytest.mark.parametrize("normal", [(0.0, 0.0, 1.0), (0.6, 0.0, 0.8), (-0.48, 0.6, 0.64)])
def test_both_rooms_hold_a_tool_alike(shape: ToolShape, normal: tuple[float, ...]) -> None:
    n = np.array(normal)
    assert reference_of("tool", shape).held_against(n) == pytest.approx(tilted(n, shape.tilt), abs=1e-15)


def test_tilt_enters_the_hash_and_the_name_does_not(write_scene: Callable[..., Path]) -> None:
    upright = ToolShape("flat_punch", (("radius", 3e-3),))
    leaning = ToolShape("flat_punch", (("radius", 3e-3),), tilt=0.1)
    assert upright.hash != leaning.hash
    assert reference_of("a", upright).hash == reference_of("b", upright).hash == upright.hash


@pytest.mark.parametrize(
    ("text", "key", "words"),
    [
        ('shape = "flat_punch"\nradius = "3 mm"\nedge_radius = "4 mm"', "tool[0]", "at most the radius"),
        ('shape = "flat_punch"\nradius = "3 mm"\ntip = [0, 0, "-2 mm"]', "tool[0].tip", "outside the tool"),
    ],
)
def test_numbers_that_make_no_tool_are_told(
    text: str, key: str, words: str, write_scene: Callable[..., Path]
) -> None:
    scene = load_scene(write_scene("", (SPHERE, text)))
    with pytest.raises(InputError) as caught:
        shape_of(scene, scene.tool[0])
    (problem,) = caught.value.problems
    assert problem.key == key
    assert words in problem.sentence


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda mesh: mesh.update_faces(np.arange(len(mesh.faces)) > 0), "is open"),
        (lambda mesh: mesh.invert(), "inside out"),
    ],
)
def test_a_mesh_that_is_no_solid_is_refused(
    spoil: Callable[[trimesh.Trimesh], None], words: str, write_scene: Callable[..., Path], folder: Path
) -> None:
    mesh = wedge()
    spoil(mesh)
    mesh.export(folder / "wedge.stl")
    scene = load_scene(write_scene("", (SPHERE, SHAPES["mesh"])))
    with pytest.raises(InputError) as caught:
        shape_of(scene, scene.tool[0])
    (problem,) = caught.value.problems
    assert problem.key == "tool[0].surface"
    assert words in problem.sentence and "closed surface" in problem.sentence
