# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A hidden lump is found where it is by force alone, through the runtime.

The presses are a law with a lump that is known (stand_in_solvers.py): force falls off most steeply at its width.
"""

from __future__ import annotations

import json
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread
from stand_in_solvers import LUMP, Inline, known_lump

from palpate.author import pipeline, press_solve
from palpate.author.command_line import main
from palpate.author.report import write
from palpate.author.scan import scan
from palpate.author.scan_found import against_truth, find
from palpate.author.scan_grid import ScanGrid
from palpate.author.scene import load_scene

REST = """
[[organ.region]]
name = "lump"
sphere = { center = [0.003, -0.002, 0.012], radius = "4 mm" }
material = { model = "neo_hookean", youngs_modulus = "50 kPa" }

[reach]
sphere = { center = [0.0, 0.0, 0.02], radius = "12 mm" }
depth_max = "2 mm"

[accuracy]
held_out = 1
force_tolerance = "3.5 %"
"""


@pytest.fixture(scope="module")
def asset(cube: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    text = cube.read_text().replace('"cube.stl"', f'"{cube.parent}/cube.stl"')
    folder = tmp_path_factory.mktemp("scan")
    (folder / "scene.toml").write_text(text + REST)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(press_solve, "solve", known_lump)
        patch.setattr(pipeline, "_here", lambda *args: nullcontext(Inline()))
        patch.setattr(write, "pictures", lambda *args: ([], []))
        pipeline.author(load_scene(folder / "scene.toml"), folder / "out")
    return folder / "out"


def test_what_is_hidden_is_found_where_it_is(asset: Path) -> None:
    result = scan(asset, depth=1.5e-3)
    (lump,) = result["regions"]
    assert result["not_in_contact"] == 0 and result["unseen"] == 0.0
    assert result["contrast"] == pytest.approx(LUMP[2], abs=0.05)
    assert lump["under"] == pytest.approx(4e-3, abs=0.5e-3)
    assert lump["radius_true"] == pytest.approx(4e-3, abs=0.4e-3)
    assert lump["radius_error"] == pytest.approx(0.0, abs=0.8e-3)
    assert lump["centre_error"] < 0.5e-3
    assert lump["overlap"] > 0.85


def test_the_command_draws_what_it_says(asset: Path, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    picture = tmp_path / "map.png"
    assert (
        main(["scan", str(asset), "--depth", "1 mm", "--step", "2 mm", "--out", str(picture), "--json"]) == 0
    )
    said = json.loads(capsys.readouterr().out)
    assert said["step"] == 2e-3 and said["depth"] == 1e-3 and said["noticeable"]
    assert imread(picture).std() > 0.05


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (
            ["--depth", "3 mm"],
            "--depth = 0.003 is not within what ball was pressed; expected above 0, at most 2 mm",
        ),
        (["--step", "50 mm"], "--step = 0.05 leaves 0 points on"),
        (
            ["--step", "7 mm"],
            "places, too few to see a border in; expected a length above 0 that makes 18 to",
        ),
        (["--step", "-1 mm"], "--step = -0.001 is not above 0"),
        (["--step", "1 um"], "places; expected a length above 0"),
        (["--out", "map.jpg"], "is no picture"),
        (["--tool", "spoon"], "is not in this asset"),
    ],
)
def test_bad_input_is_refused_with_a_sentence(asset: Path, options, sentence, capsys) -> None:
    assert main(["scan", str(asset), *options]) == 2
    assert sentence in capsys.readouterr().err


def flat(side: int = 31, step: float = 1e-3) -> ScanGrid:
    column, row = (index.ravel() for index in np.meshgrid(np.arange(side), np.arange(side)))
    points = step * np.column_stack([column, row, 0 * row]).astype(float)
    up = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    return ScanGrid(step, np.zeros(3), np.eye(3), column, row, points, up, np.full(len(points), step**2), 0.0)


@pytest.mark.parametrize("slope", [0.0, 10.0])
def test_the_border_is_where_force_falls_off_most_steeply(slope: float) -> None:
    """Of a Gaussian that is its width; to a step of the grid, on level ground and on ground that rises."""
    grid = flat()
    x, y = (grid.plane - 15e-3).T
    force = 1.0 + slope * x + 0.5 * np.exp(-(x**2 + y**2) / (2 * (5e-3) ** 2))
    found = find(grid, force)
    assert np.sqrt(grid.area[found.inside].sum() / np.pi) == pytest.approx(5e-3, abs=1e-3)
    assert np.linalg.norm(grid.points[found.inside].mean(axis=0)[:2] - 15e-3) < 1.2e-3


def test_the_same_place_overlaps_fully_and_another_not_at_all() -> None:
    grid = flat()
    left, right = grid.column < 10, grid.column > 20
    assert against_truth(grid, left, left)["overlap"] == 1.0
    apart = against_truth(grid, left, right)
    assert apart["overlap"] == 0.0 and apart["centre_error"] == pytest.approx(21e-3, abs=1e-9)
    assert apart["radius_error"] == pytest.approx(0.0, abs=1e-9)
