# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Which nodules are felt: with a law of contact whose answer is known, and one real press."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread
from stand_in_solvers import Inline, known_block

from palpate.author import detectability as module
from palpate.author import press_solve
from palpate.author.command_line import main
from palpate.author.detectability import detectability, reached_under, stiffened
from palpate.author.errors import InputError
from palpate.author.scene import load_scene
from palpate.author.scene_tables import Material, Reach

REACH = '\n[reach]\nsphere = { center = [0.0, 0.0, 0.02], radius = "4 mm" }\ndepth_max = "2 mm"\n'


def lumpy(mesh, job, folder, progress=None):
    """`known_block`, stiffer by (k - 1) 0.1 exp(-top / 3 mm) above a ball k times as stiff."""
    arrays, values = known_block(mesh, job, folder)
    if mesh.regions:
        (region,) = mesh.regions
        top = job.contact_point[2] - region.sphere.center[2] - region.sphere.radius
        k = region.material.shear_modulus / mesh.material.shear_modulus
        arrays["force_vector"] = arrays["force_vector"] * (1.0 + 0.1 * (k - 1.0) * np.exp(-top / 3e-3))
    return arrays, values


@pytest.fixture(scope="module")
def scene_file(cube: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    text = cube.read_text().replace('"cube.stl"', f'"{cube.parent}/cube.stl"')
    path = tmp_path_factory.mktemp("detect") / "scene.toml"
    path.write_text(text + REACH)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(press_solve, "solve", lumpy)
        patch.setattr(module, "press_executor", lambda *args: nullcontext(Inline()))
        yield path


@pytest.fixture(scope="module")
def out(scene_file: Path) -> Path:
    """One folder for all: the organ is meshed once."""
    return scene_file.parent / "out"


def test_a_cell_is_the_press_above_the_nodule_against_none(scene_file: Path, out: Path) -> None:
    result = detectability(
        load_scene(scene_file), out, under=(1e-3, 4e-3), radius=(2e-3,), stiffer=(2.0, 5.0)
    )
    got = {(cell["under"], cell["stiffer"]): cell["contrast"] for cell in result["cells"]}
    for (top, k), contrast in got.items():
        assert contrast == pytest.approx(0.1 * (k - 1.0) * np.exp(-top / 3e-3), rel=1e-3)
    rows = {row["stiffer"]: row for row in result["deepest_felt"]}
    assert rows[2.0]["under"] == pytest.approx(-3e-3 * np.log(0.7), rel=0.02)
    assert rows[5.0]["at_least"] and rows[5.0]["under"] == 4e-3
    assert imread(out / "detectability.png").std() > 0.02
    again = detectability(load_scene(scene_file), out, under=(1e-3, 4e-3), radius=(2e-3,), stiffer=(2.0, 5.0))
    assert result["fresh"] == 5 and again["fresh"] == 0


def test_a_press_that_stops_is_told_as_deep_as_it_came(
    scene_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stops(mesh, job, folder, progress=None):
        arrays, values = lumpy(mesh, job, folder)
        if mesh.regions:
            arrays["force_vector"] = arrays["force_vector"][:4]
            values |= {"converged": False, "reason": "stopped"}
        return arrays, values

    monkeypatch.setattr(press_solve, "solve", stops)
    asked = {"under": (1e-3,), "radius": (2e-3,), "stiffer": (3.0,)}
    (cell,) = detectability(load_scene(scene_file), tmp_path, **asked)["cells"]
    assert cell["contrast"] is None and cell["reached"] == pytest.approx(3 / 10 * 2e-3)
    assert cell["along"] == pytest.approx(3 * [0.2 * np.exp(-1 / 3)], rel=1e-3)


def test_a_nodule_that_does_not_fit_is_said_not_pressed(scene_file: Path, out: Path, capsys) -> None:
    asked = ["--under", "2 mm,14 mm", "--radius", "3 mm", "--stiffer", "3"]
    assert main(["detect", str(scene_file), "--out", str(out), *asked, "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert [cell["reason"] for cell in said["cells"]] == ["", "does not fit into the organ"]
    assert said["presses"] == 2


def test_bad_input_is_refused_with_a_sentence(scene_file: Path, out: Path, capsys) -> None:
    assert main(["detect", str(scene_file), "--out", str(out), "--stiffer", "0.5"]) == 2
    assert "is not stiffer; expected numbers above 1" in capsys.readouterr().err
    assert main(["detect", str(scene_file), "--out", str(out), "--depth", "9 mm"]) == 2
    assert "is pressed deeper than 40 % of the local thickness" in capsys.readouterr().err
    with pytest.raises(InputError, match="is not given"):
        detectability(
            load_scene(scene_file).model_copy(update={"reach": Reach()}),
            out,
        )


@pytest.mark.parametrize(
    "material",
    [
        Material(model="neo_hookean", youngs_modulus=5e3, poissons_ratio=0.48),
        Material(model="ogden", mu=(1e3, 500.0), alpha=(2.0, 6.0)),
        Material(model="mooney_rivlin", c10=500.0, c01=200.0),
        Material(model="yeoh", c10=500.0, c20=100.0, c30=10.0),
        Material(model="veronda_westmann", c1=300.0, c2=2.0),
    ],
    ids=lambda material: material.model,
)
def test_a_stiffer_material_has_all_its_stresses_times_the_factor(material: Material) -> None:
    from palpate.author.solid import solid_of

    harder = stiffened(material, 4.0)
    assert harder.shear_modulus == pytest.approx(4.0 * material.shear_modulus)
    assert harder.poissons_ratio == material.poissons_ratio
    assert type(solid_of(harder)) is type(solid_of(material))


def test_how_deep_is_felt_is_between_cells_and_never_beyond_them() -> None:
    felt = [0.07 * np.exp((5e-3 - u) / 2e-3) for u in (2e-3, 8e-3)]
    assert reached_under([2e-3, 8e-3], felt) == pytest.approx(5e-3)
    assert reached_under([2e-3, 8e-3], [0.5, 0.2]) == 8e-3
    assert reached_under([2e-3, 8e-3], [0.05, 0.01]) is None
    assert reached_under([2e-3, 8e-3], [None, None]) is None
