# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The options of `palpate transients`: plan, fit, library, samples, modes, cook, assess; the work is in transients/."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from palpate.author.console import Answer, answer_of
from palpate.author.errors import InputError, InputProblem

__all__ = ["transients"]

transients = typer.Typer(
    help="Make a tap feel as the real thing does: identify, invert, assess.", no_args_is_help=True
)

Json = Annotated[bool, typer.Option("--json", help="one JSON object on stdout, everything else on stderr")]
Out = Annotated[Path, typer.Option("--out", metavar="DIR", help="where files go")]


@transients.command()
def plan(
    out: Out,
    amplitude: Annotated[float, typer.Option("--amplitude", help="N, of the swept force")] = 1.0,
    rate: Annotated[float, typer.Option("--rate", help="Hz, of the loop that plays it")] = 10_000.0,
    as_json: Json = False,
) -> None:
    """Write the force that identifies a device: a sweep from 10 to 500 Hz in 2.5 s."""

    def work() -> Answer:
        import numpy as np

        from palpate.author.transients.identification import BAND, sweep

        if not 0.0 < amplitude <= 1e3:
            expected = "above 0, at most 1000 N"
            raise InputError(InputProblem("", "--amplitude", amplitude, "is not usable", expected))
        force = sweep(amplitude, rate)
        out.mkdir(parents=True, exist_ok=True)
        file = out / "sweep.csv"
        table = np.column_stack([np.arange(len(force)) / rate, force])
        np.savetxt(file, table, delimiter=",", header="time,force", comments="", fmt="%.9g")
        result = {
            "file": str(file),
            "rate": rate,
            "band": list(BAND),
            "duration": len(force) / rate,
            "amplitude": amplitude,
        }
        told = (
            f"{file}: {len(force) / rate:g} s from {BAND[0]:g} to {BAND[1]:g} Hz; play it several times "
            "while a hand holds the device, and record time, force, acceleration"
        )
        return Answer(result, [told])

    _end(work, as_json)


@transients.command()
def fit(
    recordings: Annotated[
        list[Path], typer.Argument(metavar="RECORDING...", help="CSV, NPZ or WAV of sweeps")
    ],
    out: Out,
    order: Annotated[int, typer.Option("--order", help="poles of the model")] = 7,
    relative_degree: Annotated[int, typer.Option("--relative-degree", help="poles minus zeros")] = 4,
    delay: Annotated[float | None, typer.Option("--delay", help="s; fitted too when absent")] = None,
    as_json: Json = False,
) -> None:
    """Fit a model from force to acceleration to recorded sweeps."""

    def work() -> Answer:
        import numpy as np

        from palpate.author.transients.identification import BAND, empirical_transfer, fitted_model
        from palpate.author.transients.inversion import require_invertible
        from palpate.author.transients.pictures import bode_picture
        from palpate.author.transients.recordings import read_recording, require_usable

        runs = [read_recording(path) for path in recordings]
        for run in runs:
            require_usable(run, BAND, sweep=True)
            if abs(run.rate - runs[0].rate) > 1e-6 * runs[0].rate or len(run.acceleration) != len(
                runs[0].acceleration
            ):
                what = "differs in rate or length from the first recording"
                raise InputError(InputProblem(run.file, "", None, what, "runs of the same sweep"))
        measured = empirical_transfer(
            np.array([run.force for run in runs]), np.array([run.acceleration for run in runs]), runs[0].rate
        )
        model = fitted_model(measured, order, relative_degree, delay)
        require_invertible(model, runs[0].rate)
        out.mkdir(parents=True, exist_ok=True)
        result: dict[str, Any] = {
            "numerator": list(map(float, model.numerator)),
            "denominator": list(map(float, model.denominator)),
            "delay": model.delay,
            "gain_error": model.gain_error,
            "phase_error": model.phase_error,
            "runs": len(runs),
            "coherence": float(np.median(measured.coherence)),
            "model": str(out / "model.json"),
            "picture": str(out / "bode.png"),
        }
        (out / "model.json").write_text(json.dumps(result, indent=1) + "\n")
        bode_picture(measured, model, out / "bode.png")
        told = (
            f"{result['model']}: within {model.gain_error:.2g} dB and {model.phase_error:.2g} degrees "
            f"of {len(runs)} recordings from 20 to 400 Hz, delay {1e3 * model.delay:.3g} ms"
        )
        return Answer(result, [told])

    _end(work, as_json)


@transients.command()
def library(
    recordings: Annotated[
        list[Path], typer.Argument(metavar="RECORDING...", help="NPZ of contacts, each with its velocity")
    ],
    model: Annotated[Path, typer.Option("--model", help="model.json of `palpate transients fit`")],
    out: Out,
    stiffness: Annotated[
        float, typer.Option("--beside", help="N/m of the response beside it, whose own push is left to it")
    ] = 0.0,
    as_json: Json = False,
) -> None:
    """Turn recorded contacts into the forces that make the device repeat them."""

    def work() -> Answer:
        import numpy as np

        from palpate.author.transients.identification import BAND, DeviceModel
        from palpate.author.transients.library import library_of
        from palpate.author.transients.library_file import write_library
        from palpate.author.transients.pictures import library_picture, tap_sound
        from palpate.author.transients.recordings import read_recording, require_usable

        if not 0.0 <= stiffness < np.inf:
            raise InputError(InputProblem("", "--beside", stiffness, "is no stiffness", "0 N/m or more"))
        try:
            read = json.loads(model.read_text())
            device = DeviceModel(
                np.array(read["numerator"], float), np.array(read["denominator"], float), float(read["delay"])
            )
        except (OSError, ValueError, KeyError, TypeError) as error:
            what = f"is no model ({error})"
            raise InputError(
                InputProblem(str(model), "", None, what, "model.json of `palpate transients fit`")
            ) from error
        runs = [read_recording(path) for path in recordings]
        for run in runs:
            require_usable(run, BAND)
            if run.velocity is None:
                raise InputError(
                    InputProblem(run.file, "velocity", None, "is missing", "the speed before contact, m/s")
                )
            if abs(run.rate - runs[0].rate) > 1e-6 * runs[0].rate:
                raise InputError(
                    InputProblem(run.file, "rate", run.rate, "differs", f"{runs[0].rate:g} Hz, as the first")
                )
        rate = runs[0].rate
        made, found = library_of(
            device, [run.acceleration for run in runs], [run.velocity or 0.0 for run in runs], rate, stiffness
        )
        out.mkdir(parents=True, exist_ok=True)
        write_library(out / "library.npz", made, stiffness)
        library_picture(made, out / "library.png")
        tap_sound(runs[len(runs) // 2].acceleration, rate, out / "tap.wav")
        result = {
            "library": str(out / "library.npz"),
            "picture": str(out / "library.png"),
            "sound": str(out / "tap.wav"),
            "velocity": list(map(float, made.velocity)),
            "force_max": float(abs(made.force).max()),
            "forward_error": [None if t.error != t.error else t.error for t in found],
        }
        told = f"{result['library']}: {len(runs)} velocities, up to {result['force_max']:.3g} N"
        return Answer(result, [told])

    _end(work, as_json)


@transients.command()
def samples(out: Out, as_json: Json = False) -> None:
    """Write the eleven samples of the study as scenes, with the libraries that they play."""

    def work() -> Answer:
        from palpate.author.transients.sample_scenes import write_sample_scenes

        paths = [str(path) for path in write_sample_scenes(out)]
        return Answer({"scenes": paths}, ["\n".join(paths)])

    _end(work, as_json)


@transients.command()
def modes(
    scene: Annotated[Path, typer.Argument(metavar="SCENE", help="whose organ rings")],
    out: Annotated[
        Path, typer.Option("--out", metavar="DIR", help="as of `palpate author`, which meshes once")
    ],
    mass: Annotated[float, typer.Option("--mass", help="kg, of the tool that arrives")] = 0.05,
    damping_ratio: Annotated[float, typer.Option("--damping-ratio", help="share of critical damping")] = 0.1,
    density: Annotated[float, typer.Option("--density", help="kg/m3, of the organ")] = 1060.0,
    count: Annotated[int, typer.Option("--count", help="slowest modes")] = 8,
    free: Annotated[bool, typer.Option("--free", help="as if nothing held the organ")] = False,
    as_json: Json = False,
) -> None:
    """Find the modes of a scene's own organ, as lines for its [tool.transient]."""

    def work() -> Answer:
        from palpate.author.capabilities import require_capabilities
        from palpate.author.organ_stage import mesh_organ
        from palpate.author.scene import load_scene
        from palpate.author.store import Store
        from palpate.author.transients.organ_modes import organ_modes

        read = load_scene(scene)
        require_capabilities(read)
        mesh = mesh_organ(read, Store(out / "work"))
        found = organ_modes(read, mesh, mass, damping_ratio, density, count, free)
        lines = [
            f'    {{ amplitude = "{one.amplitude:.4g} N s/m", frequency = "{one.frequency:.5g} Hz", '
            f'decay = "{1e3 * one.decay:.4g} ms" }},'
            for one in found
        ]
        told = ['shape = "modal"', "mode = [", *lines, "]"]
        return Answer({"modes": [vars(one) for one in found]}, ["\n".join(told)])

    _end(work, as_json)


@transients.command()
def cook(
    scene: Annotated[Path, typer.Argument(metavar="SCENE", help="with tables [tool.transient]")],
    asset: Annotated[Path, typer.Option("--asset", metavar="DIR", help="made by `palpate author`")],
    tool: Annotated[str, typer.Option("--tool", help="this one only")] = "",
    as_json: Json = False,
) -> None:
    """Put a scene's transients into an asset that is there, without a press: USD and .rfield."""

    def work() -> Answer:
        from palpate.author.capabilities import require_capabilities
        from palpate.author.scene import load_scene
        from palpate.author.transients.cook import cook_transients

        read = load_scene(scene)
        require_capabilities(read)
        rows = cook_transients(read, asset, tool)
        told = [_cooked_line(row) for row in rows]
        return Answer({"asset": str(asset), "tools": rows}, ["\n".join(told)])

    _end(work, as_json)


def _cooked_line(row: dict[str, Any]) -> str:
    files = ", ".join(row["rfields"])
    if "shape" not in row:
        return f"{files}: no transients"
    low, high = row["velocity"]
    return (
        f"{files}: {row['shape']}, {row['velocity_count']} velocities from {low:g} to {high:g} m/s, "
        f"{1e3 * row['duration']:.0f} ms, up to {row['force_max']:.3g} N of {row['force_short']:g} N"
        + (", limited" if row["limited"] else "")
    )


@transients.command()
def assess(
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="where pictures and sounds go")
    ] = None,
    attenuated: Annotated[
        bool,
        typer.Option(
            "--attenuated", help="libraries know nothing of the response, and are scaled by the paper's 0.8"
        ),
    ] = False,
    as_json: Json = False,
) -> None:
    """Tap the eleven samples of the study with a simulated stylus and rank them: a physical measure, not a
    user study."""

    def work() -> Answer:
        from palpate.author.transients.assessment import assess as assessed
        from palpate.author.transients.pictures import accelerations_picture, spectra_picture, tap_sound

        result = assessed(
            attenuated=attenuated, progress=lambda line: print(line, file=sys.stderr, flush=True)
        )
        if out is not None:
            out.mkdir(parents=True, exist_ok=True)
            accelerations_picture(result, out / "accelerations.png")
            spectra_picture(result, out / "spectra.png")
            for name, curve in result["curves"].items():
                tap_sound(curve, result["rate"], out / f"{name}.wav")
        shown = {key: value for key, value in result.items() if key != "curves"}
        lines = [
            f"spectrum of a tap, 20 to 400 Hz, against {result['target']} (physical measure, not a user study)"
        ]
        lines += [
            f"{row['sample']:18s} off by {100 * row['spectrum_error_mean']:5.1f} % "
            f"(worst {100 * row['spectrum_error_worst']:.1f} %), shape {100 * row['shape_error']:4.1f} % at "
            f"x {row['gain']:.2f}, "
            f"peak x {row['peak_ratio']:.2f}, correlation {row['correlation']:.2f}"
            + (", saturated" if row["saturated"] else "")
            + (", limited" if row["limited"] else "")
            for row in result["rows"]
        ]
        lines.append(
            "the study's order of renderings is "
            + ("reproduced" if result["order_reproduced"] else "NOT reproduced")
        )
        return Answer(shown, ["\n".join(lines)], 0 if result["order_reproduced"] else 1)

    _end(work, as_json)


def _end(work: Callable[[], Answer], as_json: bool) -> None:
    raise typer.Exit(answer_of(work, as_json, "palpate transients"))
