# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A scene asks for textures by name, with units; what cannot be felt is refused by name; an asset keeps them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from viewed_organ import write_two_tools

from palpate.author.errors import InputError
from palpate.author.plan import plan
from palpate.author.scene import Scene, load_scene
from palpate.author.texture.texture_stage import textures_of, with_texture
from palpate.fields.texture_layout import read_texture, texture_bytes
from palpate.fields.usd_read import read_field
from palpate.fields.usd_validators import asset_errors
from palpate.fields.usd_write import add_tool

EFFECTS = ('name = "block"', 'name = "block"\neffects = ["response", "texture"]')
GRATING = """
[[texture]]
kind = "grating"
amplitude = "20 um"
wavelength = "1.25 mm"
direction = [2, 0, 0]
"""
NOISE = """
[[texture]]
kind = "noise"
amplitude = "5 um"
band = ["0.5 1/mm", "2000 m^-1"]
seed = 7
direction = [0, 0, 1]
"""
PAINT = '\n[organ.paint]\ntexture_amplitude = "palpate:texture_amplitude"\n'
PROFILE = """
[[texture]]
kind = "profile"
file = "wood.csv"
direction = [0, 1, 0]
waves = 4
"""


@pytest.fixture
def asked(write_scene: Callable[..., Path], folder: Path) -> Callable[..., Scene]:
    x = np.arange(400) * 25e-6  # m; 10 mm
    h = 12e-6 * np.sin(2 * np.pi * 300.0 * x) + 4e-6 * np.cos(2 * np.pi * 1200.0 * x + 0.3)
    rows = "\n".join(f"{a:.9e},{b:.9e}" for a, b in zip(x, h, strict=True))
    (folder / "wood.csv").write_text(f"position (m),height (m)\n{rows}\n")
    np.savez(folder / "wood.npz", position=x, height=h)
    return lambda table, *more: load_scene(write_scene(table, EFFECTS, *more))


def test_a_grating_is_the_wave_that_the_scene_says(asked: Callable[..., Scene]) -> None:
    made = textures_of(asked(GRATING))
    assert made is not None
    wave = made[0].waves[0]
    assert wave.vector == pytest.approx(np.array([[800.0, 0.0, 0.0]]))
    assert wave.amplitude == pytest.approx([20e-6])
    assert made[0].fade_depth == pytest.approx(80e-6)
    same = textures_of(asked(GRATING.replace('wavelength = "1.25 mm"', 'spatial_frequency = "0.8 1/mm"')))
    assert same is not None and same[0].waves[0].vector == pytest.approx(wave.vector)


def test_noise_lies_in_its_band_across_its_direction_and_has_its_root_mean_square(asked) -> None:
    made = textures_of(asked(NOISE))
    assert made is not None
    waves = made[0].waves[0]
    k = waves.spatial_frequency
    assert len(k) == 8 and 500.0 <= k.min() and k.max() <= 2000.0
    assert waves.vector[:, 2] == pytest.approx(0.0, abs=1e-9)
    places = np.random.default_rng(1).uniform(-1.0, 1.0, (200_000, 3))
    assert np.sqrt(np.mean(waves.height(places)[0] ** 2)) == pytest.approx(5e-6, rel=0.01)
    again = textures_of(asked(NOISE))
    assert again is not None and np.array_equal(again[0].waves[0].vector, waves.vector)


@pytest.mark.parametrize("file", ["wood.csv", "wood.npz"])
def test_a_profile_is_its_strongest_harmonics(asked: Callable[..., Scene], file: str) -> None:
    made = textures_of(asked(PROFILE.replace("wood.csv", file)))
    assert made is not None
    waves = made[0].waves[0]
    x = np.arange(400) * 25e-6
    h = 12e-6 * np.sin(2 * np.pi * 300.0 * x) + 4e-6 * np.cos(2 * np.pi * 1200.0 * x + 0.3)
    along = np.column_stack([np.zeros(400), x, np.zeros(400)])
    assert waves.height(along)[0] == pytest.approx(h - h.mean(), abs=1e-10)
    assert made[1]["textures"][0]["left_out"] < 1e-6
    coarse = textures_of(asked(PROFILE + 'band = ["1 1/m", "500 1/m"]\namplitude = "1 um"\n'))
    assert coarse is not None
    assert coarse[0].waves[0].spatial_frequency == pytest.approx([300.0])
    assert coarse[1]["textures"][0]["left_out"] == pytest.approx(0.1, rel=1e-3)  # 4^2 of 12^2 + 4^2


DEVICE = '\n[device]\ndamping = 1\nfriction = 0\nresolution = "{}"\nmax_force = 8\n'
BROKEN = {
    "no such kind": (GRATING, ('"grating"', '"gratings"'), "texture[0].kind", "did you mean"),
    "no direction": (GRATING, ("direction = [2, 0, 0]", ""), "texture[0].direction", "is missing"),
    "no wavelength": (GRATING, ('wavelength = "1.25 mm"', ""), "texture[0].wavelength", "is missing"),
    "wavelength twice": (
        GRATING, ("direction", 'spatial_frequency = "1 1/mm"\ndirection'), "texture[0].wavelength", "given twice",
    ),
    "another kind's key": (GRATING, ("direction", "seed = 3\ndirection"), "texture[0].seed", "is not used"),
    "finer than a file holds": (GRATING, ('"1.25 mm"', '"1 nm"'), "texture[0].wavelength", "is out of range"),
    "a wrong unit": (GRATING, ('"1.25 mm"', '"1.25 Hz"'), "texture[0].wavelength", "not a length"),
    "a falling band": (NOISE, ('"0.5 1/mm"', '"5 1/mm"'), "texture[0].band", "does not rise"),
    "no file": (PROFILE, ("wood.csv", "none.csv"), "texture[0].file", "is no file"),
    "finer than the device": (
        GRATING + DEVICE.format("0.7 mm"), None, "texture[0].wavelength", "the device resolves 700 um",
    ),
    "noise finer than the device": (
        NOISE + DEVICE.format("0.3 mm"), None, "texture[0].band[1]", "the device resolves 300 um",
    ),
    "two places": (
        GRATING + "sphere = { center = [0, 0, 0], radius = 1 }\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n",
        None, "texture[0].sphere", "beside box",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", BROKEN, ids=list(BROKEN))
def test_what_contradicts_itself_is_refused_by_name(asked: Callable[..., Scene], case: str) -> None:
    table, change, key, what = BROKEN[case]
    if change:
        assert change[0] in table
        table = table.replace(*change)
    with pytest.raises(InputError) as told:
        asked(table)
    assert key in str(told.value) and what in str(told.value)


@pytest.mark.parametrize(
    ("table", "key", "what"),
    [
        (GRATING.replace("20 um", "0.7 mm"), "texture[0].amplitude", "at most 0.000625 m together"),
        (GRATING + 'fade_depth = "50 um"\n', "texture[0].fade_depth", "at least 8e-05 m"),
        (NOISE + "waves = 16\n" + GRATING, "texture", "at most 4"),
        (PROFILE + 'band = ["1e5 1/m", "2e5 1/m"]\n', "texture[0].file", "no height in its band"),
    ],
)
def test_what_cannot_be_stored_is_refused_before_any_press(asked, table: str, key: str, what: str) -> None:
    if "waves = 16" in table:
        table += 'sphere = { center = [0, 0, 0], radius = "1 m" }\n'
    with pytest.raises(InputError) as told:
        textures_of(asked(table))
    assert key in str(told.value) and what in str(told.value)


@pytest.mark.parametrize("content", [b"", b"hello", b"PK\x03\x04111111", b"\xff\x00\x80"])
@pytest.mark.parametrize("file", ["wood.csv", "wood.npz"])
def test_a_file_that_is_no_profile_is_refused(asked, folder: Path, file: str, content: bytes) -> None:
    scene = asked(PROFILE.replace("wood.csv", file))
    (folder / file).write_bytes(content)
    with pytest.raises(InputError, match=r"texture\[0\]\.file.*is no profile"):
        textures_of(scene)


def test_a_profile_in_a_wrong_unit_is_refused_before_anything_is_pressed(asked, folder: Path) -> None:
    """All of it is finer than a runtime takes: 300 1/m over a million times shorter a profile are 3e8 1/m."""
    scene = asked(PROFILE.replace("wood.csv", "wood.npz"))
    x = np.arange(400) * 25e-12
    np.savez(folder / "wood.npz", position=x, height=1e-6 * np.sin(2 * np.pi * 300e6 * x))
    with pytest.raises(InputError, match=r"texture\[0\]\.file.*no height in its band"):
        textures_of(scene)


def test_an_effect_without_a_table_and_a_table_without_the_effect_are_refused(write_scene, asked) -> None:
    with pytest.raises(InputError, match=r"a table \[\[texture\]\]"):
        asked("")
    with pytest.raises(InputError, match=r"texture\[0\].*leaves out"):
        load_scene(write_scene(GRATING))


def test_a_device_finer_profile_is_cut_to_what_it_resolves(asked: Callable[..., Scene]) -> None:
    made = textures_of(asked(PROFILE + DEVICE.format("0.5 mm")))  # up to 1 / (2 0.5 mm) = 1,000 1/m
    assert made is not None
    assert made[0].waves[0].spatial_frequency == pytest.approx([300.0])
    assert made[0].limits.resolution == 0.5e-3 and made[0].limits.time_factor == 2.0


def test_the_plan_tells_of_it(asked: Callable[..., Scene]) -> None:
    result = plan(asked(GRATING)).result
    row = next(one for one in result["added"]["effects"] if one["name"] == "texture")
    assert (row["presses"], row["bytes"]) == (0, 320) and 0 < row["tick_ns"] < 100
    assert "texture" in result["stored"] and "texture" not in result["not_modelled"]


def test_places_and_paint_become_masks(asked: Callable[..., Scene], tmp_path: Path) -> None:
    scene = asked(GRATING + 'sphere = { center = [0, 0, 0.01], radius = "8 mm" }\n' + NOISE)
    field = read_field(write_two_tools(tmp_path), "ball")
    closest = SimpleNamespace(closest=lambda q: (q * [1, 1, 0], None, None))
    mesh = SimpleNamespace(distance=closest, painted=lambda kind, q: None)
    made, told = with_texture(scene, field, mesh)  # type: ignore[arg-type]
    texture = read_texture(made.layers["texture"])
    assert [w.mask for w in texture.waves] == [-1, 0]
    assert told["bytes"] == len(made.layers["texture"]) and told["stiffness"] > 0
    assert texture.masks is not None
    inside = texture.masks.coefficients[..., 0]
    assert set(np.unique(inside)) <= {0.0, 1.0}
    mesh.painted = lambda kind, q: 0.5 * np.ones(len(q))
    scene = asked(GRATING + 'sphere = { center = [0, 0, 0.01], radius = "8 mm" }\n' + NOISE + PAINT)
    painted = read_texture(with_texture(scene, field, mesh)[0].layers["texture"])  # type: ignore[arg-type]
    assert painted.masks is not None
    assert painted.masks.coefficients[..., 0] == pytest.approx(0.5 * inside)
    everywhere = painted.masks.coefficients[
        np.unique(painted.masks.block_index[painted.masks.block_index >= 0])
    ]
    assert everywhere[..., 1] == pytest.approx(0.5) and painted.masks.channel_count == 4


def test_an_asset_keeps_it(asked: Callable[..., Scene], tmp_path: Path) -> None:
    asset = write_two_tools(tmp_path)
    field = read_field(asset, "ball")
    mesh = SimpleNamespace(
        distance=SimpleNamespace(closest=lambda q: (q, None, None)),
        painted=lambda kind, q: np.clip(0.5 + 20.0 * q[:, 0], 0.0, 1.0),
    )
    made, told = with_texture(asked(GRATING + NOISE + PAINT), field, mesh)  # type: ignore[arg-type]
    assert all(row["masked"] for row in told["textures"])
    add_tool(asset, made, per_vertex=False)
    assert asset_errors(asset) == []
    again = read_field(asset, "ball")
    assert again.layers == made.layers
    force = read_texture(again.layers["texture"]).normal_force
    assert force == np.max(field.nodes.normal_force) > 0.0
    _older(asset)
    assert asset_errors(asset) == []
    older = read_texture(read_field(asset, "ball").layers["texture"])
    assert older.normal_force == 0.0
    assert texture_bytes(replace(older, normal_force=force)) == made.layers["texture"]
    add_tool(asset, replace(made, layers={}), per_vertex=False)
    assert read_field(asset, "ball").layers == {}


def _older(asset: Path) -> None:
    """Takes out of `asset` what files did not have at first."""
    from pxr import Sdf

    found = 0
    for file in asset.parent.rglob("*.usd*") if asset.is_file() else asset.rglob("*.usd*"):
        layer = Sdf.Layer.FindOrOpen(str(file))
        prims = []
        layer.Traverse("/", lambda path, into=prims: into.append(path))
        for path in prims:
            if path.name == "palpate:texture:normalForce":
                del layer.GetPrimAtPath(path.GetPrimPath()).properties[path.name]
                layer.Save()
                found += 1
    assert found == 1
