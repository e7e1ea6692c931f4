# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""One press as people meet it: the answer, the picture, and files that other programs open."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from palpate.author.command_line import main
from palpate.author.errors import InputError
from palpate.author.press_command import PressFiles

AT = ["--at", "2 mm,1 mm,0.02", "--tool", "ball", "--depth", "1.5 mm", "--lateral", "0.05 mm,0"]


@pytest.fixture(scope="module")
def pressed(cube: Path):
    """The answer of one press that was asked for every file."""
    out = cube.parent / "out"
    files = ["--out", str(out), "--vtu", str(out / "a.vtu"), "--usd", str(out / "a.usda")]
    assert main(["press", str(cube), *AT, *files]) == 0
    (answer,) = (out / "presses").glob("ball_*.json")
    return json.loads(answer.read_text())


def test_the_answer_is_a_ladder_in_si_with_its_proofs(pressed: dict) -> None:
    assert pressed["depth"] == pytest.approx(np.linspace(0.0, 1.5e-3, 11))
    assert np.all(np.diff(pressed["force"]) > 0.0) and np.all(np.diff(pressed["energy"]) > 0.0)
    for key in ("area", "moment", "force_vector", "reaction_error", "penetration"):
        assert len(pressed[key]) == 11
    assert pressed["converged"] and pressed["reason"] == ""
    assert max(pressed["reaction_error"]) < 1e-8
    assert pressed["residual"] < 1e-8
    assert pressed["tool"] | {"hash": ""} == {
        "name": "ball", "shape": "sphere", "parameters": {"radius": 0.005}, "tilt": 0.0, "offset": 0.005, "hash": "",
    }  # fmt: skip
    (ladder,) = pressed["lateral"]
    assert np.linalg.norm(ladder["deflection"][-1]) == pytest.approx(5e-5)
    assert len(ladder["force_vector"]) == 5


def test_the_picture_is_there_and_not_empty(pressed: dict) -> None:
    from matplotlib.image import imread

    picture = imread(pressed["files"]["plot"])
    assert picture.shape[0] > 600 and picture.shape[1] > 1000
    assert 0.02 < np.mean(picture[:, :, :3].min(axis=2) < 0.9) < 0.5


def test_the_vtu_opens_and_shows_the_tool_s_dent(pressed: dict) -> None:
    import pyvista

    grid = pyvista.read(pressed["files"]["vtu"])
    assert set(grid.celltypes) == {pyvista.CellType.QUADRATIC_TETRA}
    assert set(grid.point_data) == {"displacement", "contact_pressure"}
    assert {"region", "volume_ratio"} <= set(grid.cell_data)
    moved = grid.point_data["displacement"]
    nearest = np.argmin(np.linalg.norm(grid.points - pressed["contact_point"], axis=1))
    assert moved[nearest] @ pressed["normal"] == pytest.approx(-1.5e-3, rel=0.03)
    assert grid.point_data["contact_pressure"].argmax() in np.flatnonzero(
        np.linalg.norm(grid.points - pressed["contact_point"], axis=1) < 2e-3
    )
    assert grid.field_data["depth"][0] == pytest.approx(1.5e-3)


def test_the_vtu_s_edges_lie_between_their_corners(pressed: dict) -> None:
    """Node order as VTK's: each mid-edge node is the middle of the corners that VTK says."""
    import pyvista

    grid = pyvista.read(pressed["files"]["vtu"])
    nodes = grid.points[grid.cells.reshape(-1, 11)[:, 1:]]
    for node, (a, b) in zip(range(4, 10), ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)), strict=True):
        assert np.abs(nodes[:, node] - 0.5 * (nodes[:, a] + nodes[:, b])).max() < 1e-8


def test_the_usd_opens_and_is_what_the_vtu_says(pressed: dict) -> None:
    import pyvista
    from pxr import Usd, UsdGeom, UsdValidation

    stage = Usd.Stage.Open(pressed["files"]["usd"])
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/press/Surface"))
    points = np.array(mesh.GetPointsAttr().Get(), float)
    triangles = np.array(mesh.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3)
    moved = np.array(UsdGeom.PrimvarsAPI(mesh).GetPrimvar("displacement").Get())
    assert len(points) == len(moved) == len(UsdGeom.PrimvarsAPI(mesh).GetPrimvar("displayColor").Get())
    grid = pyvista.read(pressed["files"]["vtu"])
    assert np.abs(moved).max() == pytest.approx(np.abs(grid.point_data["displacement"]).max())
    rest = points - moved
    dent = points[np.argmin(np.linalg.norm(rest - pressed["contact_point"], axis=1))]
    assert (dent - pressed["contact_point"]) @ pressed["normal"] == pytest.approx(-1.5e-3, rel=0.03)
    x = points[triangles]
    across = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    near = np.linalg.norm(rest[triangles[:, 0]] - pressed["contact_point"], axis=1) < 4e-3
    assert near.any() and (across[near] @ pressed["normal"] > 0.0).all()  # outward
    errors = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
    assert [error.GetMessage() for error in errors.Validate(stage)] == []


def test_a_second_look_solves_nothing_again(
    cube: Path, pressed: dict, capfd: pytest.CaptureFixture[str]
) -> None:
    out = cube.parent / "out"
    assert main(["press", str(cube), *AT, "--out", str(out), "--usd", str(out / "b.usda"), "--json"]) == 0
    again = json.loads(capfd.readouterr().out)
    assert again["kept"] and not pressed["kept"]
    assert again["force"] == pressed["force"]
    assert (out / "b.usda").is_file()


@pytest.mark.parametrize(
    ("kind", "name"), [("plot", "press.jpg"), ("vtu", "press.vtk"), ("usd", "press.obj")]
)
def test_a_file_with_another_suffix_is_refused(kind: str, name: str) -> None:
    with pytest.raises(InputError) as caught:
        PressFiles(**{kind: Path(name)})
    assert caught.value.problems[0].key == f"--{kind}"
    assert name in caught.value.problems[0].sentence


@pytest.mark.parametrize(
    ("options", "key", "words"),
    [
        (["--depth", "9 mm"], "--depth", "40 % of the local thickness"),
        (["--at", "0,0,0"], "--at", "support"),
        (["--tool", "bal"], "tool", "did you mean"),
    ],
)
def test_a_press_that_cannot_be_is_told_by_its_option(
    options: list[str], key: str, words: str, cube: Path, pressed: dict, capfd: pytest.CaptureFixture[str]
) -> None:
    arguments = dict(zip(AT[::2], AT[1::2], strict=True)) | dict([options])
    flat = [part for pair in arguments.items() for part in pair]
    assert main(["press", str(cube), *flat, "--out", str(cube.parent / "out"), "--json"]) == 2
    (problem,) = json.loads(capfd.readouterr().out)["error"]["problems"]
    assert problem["key"] == key
    assert words in problem["sentence"]
