# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A scene asks for transients by name, with units; what cannot be played is refused by name; an asset keeps them."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from viewed_organ import ORGAN, write_two_tools

from palpate.author.command_line import main
from palpate.author.errors import InputError
from palpate.author.held_out import quasi_static
from palpate.author.plan import plan
from palpate.author.scene import Scene, load_scene
from palpate.author.tool_stage import reference_of, shape_of
from palpate.author.transients.library import Library
from palpate.author.transients.library_file import read_library, write_library
from palpate.author.transients.shapes import decaying_sinusoid, pulse
from palpate.author.transients.shock import shock
from palpate.author.transients.transient_stage import transients_of
from palpate.fields.rfield_read import read_rfield
from palpate.fields.transient_layout import TransientLayer, read_transient_layer
from palpate.fields.usd_read import read_field
from palpate.fields.usd_validators import asset_errors
from palpate.fields.usd_write import add_tool
from palpate.runtime import Field, Session
from palpate.runtime.layout import Tick

EFFECTS = ('name = "block"', 'name = "block"\neffects = ["response", "transient"]')
SINUSOID = """
[tool.transient]
shape = "decaying_sinusoid"
amplitude = "15.9 N s/m"
frequency = "66 Hz"
duration = "55 ms"
velocity = ["2 cm/s", "50 cm/s"]
"""


@pytest.fixture
def asked(write_scene: Callable[..., Path]) -> Callable[..., Scene]:
    return lambda table, *more: load_scene(write_scene(table, EFFECTS, *more))


def stored(scene: Scene) -> TransientLayer:
    made = transients_of(scene, scene.tool[0])
    assert made is not None
    return read_transient_layer(made[0])


def test_a_sinusoid_is_stored_as_the_paper_writes_it(asked: Callable[..., Scene]) -> None:
    layer = stored(asked(SINUSOID))
    assert layer.velocity == pytest.approx([0.02, 0.5])
    time = np.arange(551) / 1e4
    expected = decaying_sinusoid(time, 0.5, 15.9, 66.0, 0.055)
    assert layer.force[1, :490] == pytest.approx(expected[:490], rel=1e-6, abs=1e-9)
    assert (
        abs(np.diff(layer.force[1])).max() < 1.01 * abs(np.diff(expected[:490])).max()
    )  # the end does not click
    assert layer.numbers["attenuation"] == 1.0 and layer.numbers["force_short"] == 8.5


def test_pulse_modes_and_shock_are_their_own_formulas(asked: Callable[..., Scene]) -> None:
    time = np.arange(201) / 1e4
    table = '[tool.transient]\nshape = "pulse"\namplitude = "5.7 N s/m"\nduration = "20 ms"\n'
    assert stored(asked(table)).force[1, 1:-1] == pytest.approx(pulse(time, 0.5, 5.7, 0.02)[1:-1])
    table = (
        '[tool.transient]\nshape = "modal"\nduration = "20 ms"\n'
        'mode = [{ amplitude = 2.0, frequency = "100 Hz", decay = "5 ms" }, '
        '{ amplitude = 1.0, frequency = "310 Hz", decay = "2 ms" }]\n'
    )
    both = decaying_sinusoid(time, 0.5, 2.0, 100, 0.02, 5e-3) + decaying_sinusoid(
        time, 0.5, 1.0, 310, 0.02, 2e-3
    )
    assert stored(asked(table)).force[1, :180] == pytest.approx(both[:180], rel=1e-6, abs=1e-7)
    table = '[tool.transient]\nshape = "hunt_crossley"\nmass = "50 g"\nstiffness = 2e4\ndamping = 2e4\n'
    layer = stored(asked(table))
    assert len(layer.velocity) == 16 and layer.velocity[[0, -1]] == pytest.approx([0.02, 0.5])
    own = shock(float(layer.velocity[7]), 0.05, 2e4, 2e4)[2][:-1]
    assert layer.force[7, : len(own)] == pytest.approx(own, rel=1e-5, abs=1e-6)
    assert not layer.force[7, len(own) :].any()


def test_two_stored_shocks_make_the_one_between_within_a_percent(asked: Callable[..., Scene]) -> None:
    table = '[tool.transient]\nshape = "hunt_crossley"\nmass = "50 g"\nstiffness = 2e4\ndamping = 2e5\n'
    layer = stored(asked(table))
    v = float(np.sqrt(layer.velocity[9] * layer.velocity[10]))
    library = Library(1e4, layer.velocity, layer.force.astype(float))
    own = shock(v, 0.05, 2e4, 2e5)[2][:-1]
    expected = np.zeros(layer.force.shape[1])
    expected[: len(own)] = own
    assert np.linalg.norm(library.at(v) - expected) < 0.01 * np.linalg.norm(expected)


BROKEN = {
    "no such shape": (SINUSOID, ("decaying_sinusoid", "decaying_sinusoids"), "transient.shape", "did you mean"),
    "no duration": (SINUSOID, ('duration = "55 ms"\n', ""), "transient.duration", "is missing"),
    "another shape's key": (SINUSOID, ('duration', 'mass = "1 kg"\nduration'), "transient.mass", "is not used"),
    "a wrong unit": (SINUSOID, ('"66 Hz"', '"66 ms"'), "transient.frequency", "is a time, not a frequency"),
    "falling velocities": (SINUSOID, ('"50 cm/s"', '"1 cm/s"'), "transient.velocity", "does not rise"),
    "a rate too low": (SINUSOID, ('"66 Hz"', '"3 kHz"'), "transient.rate", "cannot carry 3000 Hz"),
    "a loop too slow": (
        SINUSOID + '[device]\ndamping = 1\nfriction = 0\nresolution = 1e-5\nmax_force = 8\nrate = "200 Hz"\n',
        None, "transient.frequency", "loop of 200 Hz",
    ),
    "more than the device": (
        SINUSOID + 'force_short = "9 N"\n'
        "[device]\ndamping = 1\nfriction = 0\nresolution = 1e-5\nmax_force = 8\n",
        None, "transient.force_short", "device.max_force",
    ),
    "too short": (SINUSOID, ('"55 ms"', '"0.1 ms"'), "transient.duration", "fewer than 8 samples"),
    "steady above short": (
        SINUSOID + 'force_short = "1 N"\nforce_steady = "2 N"\n', None, "transient.force_steady", "force_short",
    ),
    "no modes": ('[tool.transient]\nshape = "modal"\nduration = 0.02\nmode = []\n', None, "transient.mode", "nothing"),
    "no library": (
        '[tool.transient]\nshape = "library"\nlibrary = "none.npz"\n', None, "transient.library", "is no file",
    ),
    "nothing": ("", None, "scene.effects", "no tool describes"),
}  # fmt: skip


@pytest.mark.parametrize("case", BROKEN)
def test_what_cannot_be_played_is_refused_by_name(case: str, write_scene: Callable[..., Path]) -> None:
    table, change, key, words = BROKEN[case]
    if change:
        table = table.replace(*change)
    with pytest.raises(InputError) as caught:
        load_scene(write_scene(table, EFFECTS))
    (problem,) = [one for one in caught.value.problems if one.key.endswith(key)]
    assert words in str(caught.value)
    assert problem.expected


def test_a_table_without_the_effect_is_refused(write_scene: Callable[..., Path]) -> None:
    with pytest.raises(InputError, match=r"scene\.effects leaves out"):
        load_scene(write_scene(SINUSOID))


def recorded(folder: Path, beside: float = 0.0, **changed: object) -> Path:
    time = np.arange(500) / 1e4
    velocity = np.array([0.05, 0.1, 0.2])
    force = np.stack([10 * v**1.2 * np.sin(2 * np.pi * 80 * time) * np.hanning(500) for v in velocity])
    force[:, [0, -1]] = 0.0
    write_library(folder / "taps.npz", Library(1e4, velocity, force), beside)
    if changed:
        with np.load(folder / "taps.npz") as data:
            np.savez(folder / "taps.npz", **(dict(data) | changed))
    return folder / "taps.npz"


LIBRARY = '[tool.transient]\nshape = "library"\nlibrary = "taps.npz"\n'


def test_a_library_is_stored_as_it_is_and_attenuated_where_it_knows_no_response(
    asked: Callable[..., Scene], folder: Path
) -> None:
    made, _ = read_library(recorded(folder))
    layer = stored(asked(LIBRARY))
    assert layer.force == pytest.approx(made.force, rel=1e-6, abs=1e-7)
    assert layer.numbers["attenuation"] == 0.8
    recorded(folder, beside=680.0)
    assert stored(asked(LIBRARY)).numbers["attenuation"] == 1.0
    assert stored(asked(LIBRARY + "attenuation = 0.5\n")).numbers["attenuation"] == 0.5
    cut = stored(asked(LIBRARY + "velocity = [0.07, 0.15]\n"))
    assert cut.velocity == pytest.approx([0.07, 0.1, 0.15])
    assert cut.force[0] == pytest.approx(made.at(0.07), rel=1e-5, abs=1e-7)


def test_velocities_outside_the_library_and_libraries_that_are_none_are_refused(
    asked: Callable[..., Scene], folder: Path
) -> None:
    recorded(folder)
    with pytest.raises(InputError, match=r"outside the library, which was recorded from 0\.05 to 0\.2 m/s"):
        stored(asked(LIBRARY + "velocity = [0.01, 0.15]\n"))
    slow = "[device]\ndamping = 1\nfriction = 0\nresolution = 1e-5\nmax_force = 8\n"
    with pytest.raises(InputError, match="loop of 1000 Hz"):
        stored(asked(LIBRARY + slow))
    for changed, words in (
        ({"velocity": np.array([0.1, 0.05, 0.2])}, "does not rise"),
        ({"force": np.ones((3, 500))}, "begin and end at zero"),
        ({"force": np.ones((2, 500))}, "shapes"),
        ({"force": np.full((3, 500), np.nan)}, "not finite"),
        ({"rate": np.nan}, "no sample rate"),
        ({"rate": 1000.0}, "cannot carry 500 Hz"),
    ):
        recorded(folder, **changed)
        with pytest.raises(InputError, match=words):
            stored(asked(LIBRARY))
    (folder / "taps.npz").write_bytes(b"no archive")
    with pytest.raises(InputError, match="is no library"):
        stored(asked(LIBRARY))


def test_a_plan_counts_them(asked: Callable[..., Scene]) -> None:
    scene = asked(SINUSOID)
    result = plan(scene).result
    assert "transient" in result["stored"] and "transient" not in result["not_modelled"]
    (row,) = [one for one in result["added"]["effects"] if one["name"] == "transient"]
    made = transients_of(scene, scene.tool[0])
    assert made is not None
    assert row["bytes"] == len(made[0]) and row["presses"] == 0


def test_an_asset_keeps_what_is_cooked_into_it_and_plays_it(
    asked: Callable[..., Scene], folder: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    scene = asked(SINUSOID)
    asset = write_two_tools(folder / "asset")
    field = read_field(asset, "ball")
    own = reference_of("ball", shape_of(scene, scene.tool[0]))
    add_tool(asset, replace(field, tool=replace(field.tool, hash=own.hash)))
    bytes_before = (asset / "stiffer.rfield").read_bytes()
    command = ["transients", "cook", str(scene.file), "--asset", str(asset), "--json"]
    assert main(command) == 0
    (row,) = json.loads(capfd.readouterr().out)["tools"]
    assert row["shape"] == "decaying_sinusoid" and row["velocity_count"] == 2
    made = transients_of(scene, scene.tool[0])
    assert made is not None
    assert read_field(asset, "ball").layers["transient"] == made[0]
    assert read_rfield(row["rfields"][0]).layers["transient"] == made[0]
    assert (asset / "stiffer.rfield").read_bytes() == bytes_before
    assert asset_errors(asset / "ellipsoid.usda") == []
    assert main(["inspect", row["rfields"][0]]) == 0
    assert "transient" in capfd.readouterr().out

    top = np.array([0.0, 0.0, ORGAN.semi_axes[2] + ORGAN.radius])
    way = top + np.linspace(1e-3, -1e-3, 200)[:, None] * [0.0, 0.0, 1.0]  # 0.1 m/s at 10 kHz
    with_it = Session(Field.open(Path(row["rfields"][0]))).tick_batch(way, dt=1e-4)
    still = Session(quasi_static(Path(row["rfields"][0]).read_bytes())).tick_batch(way, dt=1e-4)
    assert np.any(with_it["status"] & Tick.TRANSIENT)
    assert not np.any(still["status"] & Tick.TRANSIENT)
    assert abs(with_it["force"] - still["force"]).max() > 0.3
    assert still["force"][-1, 2] > 0.0

    other = ('shape = "sphere"\nradius = "5 mm"', 'shape = "sphere"\nradius = "6 mm"')
    asked(SINUSOID, other)
    assert main(command) == 2
    assert "another tool" in capfd.readouterr().out
