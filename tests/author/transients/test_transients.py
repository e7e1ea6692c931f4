# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A device that is known exactly is identified, inverted and felt as the thing that was tapped."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.io import wavfile

from palpate.author.command_line import main
from palpate.author.errors import InputError
from palpate.author.transients.assessment import (
    RECORDED,
    TARGET,
    after_contact,
    identified,
    recorded_library,
)
from palpate.author.transients.flat_surface import RuntimeLoop
from palpate.author.transients.identification import BAND, DeviceModel, empirical_transfer, sweep
from palpate.author.transients.inversion import inverted, require_invertible, spectrum_error
from palpate.author.transients.library import Library, library_of
from palpate.author.transients.library_file import read_library
from palpate.author.transients.recordings import Recording, read_recording, require_usable
from palpate.author.transients.samples import FIRM, PULSE, REAL, SOFT, Rendering, controller, layer_of
from palpate.author.transients.shapes import decaying_sinusoid, modal_sum, pulse
from palpate.author.transients.shock import loss, shock
from palpate.author.transients.stylus import Stylus
from palpate.author.transients.tap import swept, tapped

STYLUS = Stylus()


@pytest.fixture(scope="module")
def model() -> DeviceModel:
    return identified(STYLUS, runs=2)


@pytest.fixture(scope="module")
def library(model: DeviceModel) -> Library:
    return recorded_library(STYLUS, model)


def test_the_chain_without_hand_resonates_where_it_says() -> None:
    stylus = Stylus(dampings=(1e-6, 1e-6, 1e-6), hand_stiffness=1e-9)
    a, _ = stylus.matrices()
    found = np.unique(np.round(abs(np.linalg.eigvals(a).imag) / (2 * np.pi), 3))
    assert found[-2:] == pytest.approx([stylus.resonance, stylus.second], rel=1e-4)


def test_the_stylus_is_of_order_7_and_relative_degree_4() -> None:
    f = np.array([2e4, 4e4])
    h = abs(STYLUS.transfer(f))
    assert np.log2(h[0] / h[1]) == pytest.approx(4.0, abs=0.05)
    assert len(STYLUS.matrices()[0]) == 7


def test_a_simulated_sweep_has_the_stylus_own_transfer() -> None:
    force = sweep(0.5, STYLUS.rate)
    found = empirical_transfer(force, swept(STYLUS, force), STYLUS.rate)
    inside = (found.frequency > 20) & (found.frequency < 400)
    ratio = (found.transfer / STYLUS.transfer(found.frequency))[inside]
    assert np.max(abs(20 * np.log10(abs(ratio)))) < 0.2 and np.max(abs(np.angle(ratio, deg=True))) < 2.0


def test_identification_at_20_db_is_within_1_db_and_10_degrees(model: DeviceModel) -> None:
    f = np.linspace(20.0, 400.0, 400)
    ratio = model.transfer(f) / STYLUS.transfer(f)
    assert np.max(abs(20 * np.log10(abs(ratio)))) < 1.0
    assert np.max(abs(np.angle(ratio, deg=True))) < 10.0
    assert len(model.denominator) - len(model.numerator) == 4 and np.all(np.roots(model.denominator).real < 0)


@pytest.mark.parametrize("damping", [0.0, 2e4, 2e5])
def test_the_shock_loses_what_the_closed_form_says(damping: float) -> None:
    depth, speed, force = shock(0.1, 0.05, 2e4, damping, rate=2e5)
    area = np.trapezoid(force, depth)
    expected = loss(0.1, 0.05, 2e4, damping)
    assert area == pytest.approx(expected, rel=0.01, abs=1e-8)
    assert 0.5 * 0.05 * (0.1**2 - speed[-1] ** 2) == pytest.approx(expected, rel=1e-4, abs=1e-10)
    assert force[0] == 0.0 and abs(force[-1]) < 1e-6 * force.max()


def test_the_shock_refuses_what_is_no_shock() -> None:
    with pytest.raises(InputError, match=r"shock\.mass = -1"):
        shock(0.1, -1.0, 2e4, 0.0)
    with pytest.raises(InputError, match=r"more than 0\.5 s"):
        shock(0.1, 1.0, 1e-3, 0.0)


def test_shapes_scale_with_velocity_and_end() -> None:
    t = np.arange(0.0, 0.1, 1e-4)
    assert pulse(t, 0.1, 5.7, 0.02).max() == pytest.approx(0.57) and np.all(
        pulse(t, 0.1, 5.7, 0.02)[200:] == 0
    )
    one = decaying_sinusoid(t, 0.1, 15.9, 36.2, 0.055)
    assert decaying_sinusoid(t, 0.2, 15.9, 36.2, 0.055) == pytest.approx(2 * one)
    both = modal_sum(t, 0.1, [(1.0, 80.0, 0.01), (2.0, 300.0, 0.005)], 0.05)
    alone = modal_sum(t, 0.1, [(1.0, 80.0, 0.01)], 0.05) + modal_sum(t, 0.1, [(2.0, 300.0, 0.005)], 0.05)
    assert both == pytest.approx(alone)


def test_renderings_of_the_runtime_keep_the_order_of_the_study_and_matched_ones_are_within_15_percent(
    model: DeviceModel, library: Library
) -> None:
    v = np.array([0.05, 0.11, 0.20])
    target = after_contact(tapped(STYLUS, v, REAL[TARGET]))

    def error(rendering: Rendering, of: Library | None = None, attenuation: float = 1.0) -> float:
        loop = RuntimeLoop(STYLUS, rendering.stiffness, layer_of(rendering, STYLUS, of, attenuation))
        after = after_contact(tapped(STYLUS, v, controller=loop))
        assert list(loop.events) == [0 if rendering.transient == "none" else 1] * len(v)
        return max(spectrum_error(a, t, STYLUS.rate) for a, t in zip(after, target, strict=True))

    beside = recorded_library(STYLUS, model, velocity=RECORDED[::3], stiffness=FIRM)
    matched = error(Rendering(FIRM, "library"), beside)
    plain = error(Rendering(FIRM, "library"), library)
    attenuated = error(Rendering(FIRM, "library"), library, 0.8)
    shaped = [error(Rendering(FIRM, kind)) for kind in ("pulse", "sinusoid")]
    assert matched < 0.15 and matched < plain < attenuated < min(shaped)
    assert max(shaped) < error(Rendering(FIRM))
    assert error(Rendering(FIRM)) < error(Rendering(SOFT))


@pytest.mark.parametrize("transient", ["none", "pulse", "sinusoid"])
def test_the_runtime_commands_what_the_paper_s_loop_does(transient: str) -> None:
    rendering, v = Rendering(FIRM, transient), np.array([0.05, 0.15])
    loop = RuntimeLoop(STYLUS, FIRM, layer_of(rendering, STYLUS))
    ours = tapped(STYLUS, v, controller=loop).command
    theirs = tapped(STYLUS, v, controller=controller(rendering, STYLUS)).command
    assert np.linalg.norm(ours - theirs) < 0.03 * np.linalg.norm(theirs)


def test_an_encoder_s_steps_change_the_measured_velocity_by_less_than_two_percent() -> None:
    """A pulse's height is the velocity at which the runtime thinks that the tip came."""
    v = np.array([0.05, 0.08, 0.13, 0.2])
    loop = RuntimeLoop(STYLUS, 1e-3, layer_of(Rendering(1e-3, "pulse"), STYLUS))
    command = tapped(STYLUS, v, controller=loop).command
    assert -command.min(axis=1) / PULSE[0] == pytest.approx(v, rel=0.02)


def test_a_library_at_velocities_between_its_own_is_within_10_percent(
    model: DeviceModel, library: Library
) -> None:
    between = [0.05, 0.11, 0.19]
    fresh = recorded_library(STYLUS, model, velocity=between)
    for v, force in zip(between, fresh.force, strict=True):
        assert np.linalg.norm(library.at(v) - force) < 0.10 * np.linalg.norm(force)
    assert library.force[:, 0] == pytest.approx(0.0) and library.force[:, -1] == pytest.approx(0.0)
    assert library.at(0.0) == pytest.approx(0.0)
    assert library.at(9.0) == pytest.approx(library.force[-1])


def test_a_model_that_cannot_be_inverted_in_the_band_is_refused(model: DeviceModel) -> None:
    w = 2 * np.pi * 150.0
    silent = DeviceModel(np.array([1.0, 0.0, w**2]), np.poly([-500.0, -500.0, -500.0]), 0.0)
    with pytest.raises(InputError, match="at 150 Hz"):
        require_invertible(silent, 1e4)
    growing = DeviceModel(np.ones(1), np.poly([500.0, -500.0]), 0.0)
    with pytest.raises(InputError, match="unstable"):
        require_invertible(growing, 1e4)
    with pytest.raises(InputError, match="at least 2000 Hz"):
        require_invertible(model, 1000.0)
    with pytest.raises(InputError, match="short"):
        inverted(model, np.zeros(100), 0.1, 1e4)
    tap = after_contact(tapped(STYLUS, np.array([0.1]), REAL[TARGET]))[0]
    assert inverted(model, tap, 0.1, STYLUS.rate).error < 0.12
    for hertz, fine in ((20.0, False), (50.0, False), (200.0, False), (2000.0, True)):
        z = (
            2.0 * np.pi * hertz
        )  # no slower, no louder, but late: its inverse would have to begin before the contact
        late = DeviceModel(
            np.polymul(model.numerator, [1.0, -z]), np.polymul(model.denominator, [1.0, z]), 0.0
        )
        require_invertible(late, STYLUS.rate)
        for stiffness in (0.0, FIRM):
            if fine:
                inverted(late, tap, 0.1, STYLUS.rate, stiffness)
            else:
                with pytest.raises(InputError, match=r"before the contact at 0\.1 m/s"):
                    inverted(late, tap, 0.1, STYLUS.rate, stiffness)
    with pytest.raises(InputError, match="cannot index a library"):
        library_of(model, [np.zeros(1000)] * 2, [0.1, 0.1], 1e4)


def test_bad_recordings_are_refused_by_name(tmp_path: Path) -> None:
    force = sweep(1.0, 1e4)
    good = swept(STYLUS, force)
    require_usable(Recording("good", 1e4, good, force), BAND, sweep=True)
    cut = np.clip(good, -0.5 * good.max(), 0.5 * good.max())
    for recording, match in (
        (Recording("r", 1e4, cut, force), "clipped"),
        (Recording("r", 1e4, np.roll(good, 900), force), "misaligned"),
        (Recording("r", 1e4, good[1:], force), "samples and acceleration"),
        (Recording("r", 1e3, good, force), "at least 2000 Hz"),
        (Recording("r", 1e4, good), "force is missing"),
        (Recording("r", 1e4, good * np.nan, force), "is no signal"),
    ):
        with pytest.raises(InputError, match=match):
            require_usable(recording, BAND, sweep=True)
    tap = after_contact(tapped(STYLUS, np.array([0.1]), REAL[TARGET]))[0]
    require_usable(Recording("good", 1e4, tap), BAND)
    for wrong, match in (
        (np.r_[np.zeros(600), tap], "= 0.06.* misaligned"),
        (tap[np.argmax(abs(tap)) :], "begins after the contact"),
        (np.clip(tap, -0.5 * abs(tap).max(), 0.5 * abs(tap).max()), "clipped"),
    ):
        with pytest.raises(InputError, match=match):
            require_usable(Recording("r", 1e4, wrong), BAND)
    (tmp_path / "a.txt").write_text("x")
    with pytest.raises(InputError, match="no known kind"):
        read_recording(tmp_path / "a.txt")


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("empty.csv", b""), ("headed.csv", b"time,acceleration\n"), ("one.csv", b"time,acceleration\n0,1\n"),
        ("bytes.csv", bytes(range(256))), ("ragged.csv", b"time,acceleration\n0,1\n1\n2,3\n"),
        ("bare.csv", b"0,1\n1,2\n2,3\n"), ("empty.npz", b""), ("no.npz", b"hello"), ("cut.npz", b"PK\x03\x04111111"),
        ("no.wav", b"hello"), ("cut.wav", b"RIFFxxxx"), ("rates.npz", {"rate": np.ones(3)}),
        ("velocities.npz", {"velocity": np.ones(2)}), ("words.npz", {"acceleration": np.array(["a", "b"])}),
        ("complex.npz", {"acceleration": 1j * np.ones(99)}), ("three.wav", np.zeros((99, 3), np.float32)),
    ],
)  # fmt: skip
@pytest.mark.filterwarnings("ignore:genfromtxt")
def test_a_file_that_is_no_recording_is_refused_by_name(name: str, content: object, tmp_path: Path) -> None:
    path = tmp_path / name
    if isinstance(content, bytes):
        path.write_bytes(content)
    elif isinstance(content, dict):
        np.savez(path, **({"rate": 1e4, "acceleration": np.zeros(99)} | content))
    else:
        wavfile.write(path, 10_000, content)
    with pytest.raises(InputError, match=name):
        read_recording(path)
    if path.suffix == ".npz":
        with pytest.raises(InputError, match=name):
            read_library(path)


@pytest.mark.parametrize(
    ("kind", "full", "middle"),
    [(np.uint8, 127, 128), (np.int16, 2**15 - 1, 0), (np.int32, 2**31 - 1, 0), (np.float32, 1, 0)],
)
def test_sound_files_of_every_width_say_the_same(kind: type, full: int, middle: int, tmp_path: Path) -> None:
    tap = 0.8 * np.sin(0.3 * np.arange(500)) * np.exp(-np.arange(500) / 100.0)
    scaled = full * tap + middle
    wavfile.write(tmp_path / "tap.wav", 10_000, (scaled if full == 1 else np.round(scaled)).astype(kind))
    read = read_recording(tmp_path / "tap.wav", (1.0, 50.0))
    assert read.acceleration == pytest.approx(50.0 * tap, abs=25.0 / full + 1e-5)


@pytest.mark.parametrize(
    "wrong", [["--amplitude", "inf"], ["--rate", "nan"], ["--rate", "inf"], ["--rate", "1000"]]
)
def test_a_sweep_that_nothing_plays_is_refused_by_name(
    wrong: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["transients", "plan", "--out", str(tmp_path), *wrong]) == 2
    assert wrong[0] in capsys.readouterr().err and not list(tmp_path.iterdir())


@pytest.mark.parametrize("stiffness", ["nan", "inf", "-1"])
def test_a_library_beside_no_stiffness_is_refused(
    stiffness: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["transients", "library", str(tmp_path / "a.npz"), "--model", str(tmp_path / "model.json")]
    assert main([*command, "--out", str(tmp_path), "--beside", stiffness]) == 2
    assert "--beside" in capsys.readouterr().err


def test_commands_go_from_a_plan_to_a_library(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["transients", "plan", "--out", str(tmp_path), "--json"]) == 0
    planned = json.loads(capsys.readouterr().out)
    force = np.loadtxt(planned["file"], delimiter=",", skiprows=1)[:, 1]
    answer = swept(STYLUS, force)
    table = np.column_stack([np.arange(len(force)) / 1e4, force, answer])
    np.savetxt(tmp_path / "run.csv", table, delimiter=",", header="time,force,acceleration", comments="")
    both = np.column_stack([force, answer / 200.0]).astype(np.float32)
    wavfile.write(tmp_path / "run.wav", 10_000, both)
    read = read_recording(tmp_path / "run.wav", (1.0, 200.0))
    assert read.acceleration == pytest.approx(answer, abs=1e-4) and read.rate == 1e4
    assert (
        main(
            [
                "transients",
                "fit",
                str(tmp_path / "run.csv"),
                "--out",
                str(tmp_path),
                "--delay",
                "0.25e-3",
                "--json",
            ]
        )
        == 0
    )
    fitted = json.loads(capsys.readouterr().out)
    assert fitted["gain_error"] < 1.0 and Path(fitted["picture"]).stat().st_size > 10_000
    taps = tapped(STYLUS, np.array([0.08, 0.16]), REAL[TARGET])
    files = []
    for v, a in zip(taps.velocity, taps.acceleration[:, 200:], strict=True):
        np.savez(tmp_path / f"{v}.npz", rate=1e4, acceleration=a, velocity=v)
        files.append(str(tmp_path / f"{v}.npz"))
    made = ["transients", "library", *files, "--model", fitted["model"], "--out", str(tmp_path), "--json"]
    assert main(made) == 0
    library = json.loads(capsys.readouterr().out)
    assert library["velocity"] == pytest.approx([0.08, 0.16]) and max(library["forward_error"]) < 0.15
    assert wavfile.read(library["sound"])[0] == 44100
    made[made.index(fitted["model"])] = str(tmp_path / "run.csv")
    assert main(made) == 2
