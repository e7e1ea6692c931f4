# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The `palpate` command: options here, work elsewhere, imported when its command runs.

Each command prints one answer on stdout (--json: one JSON object) and everything else on stderr.  Exit codes:
0 done; 1 done, but a stated tolerance is not met; 2 the input is wrong; 3 a bug or the machine.
"""

from __future__ import annotations

import json
import shlex
import sys
from collections.abc import Callable, Sequence
from contextvars import ContextVar
from pathlib import Path
from typing import Annotated

import typer

from palpate.author.answer_lines import (
    author_lines,
    certify_lines,
    percentiles,
    replay_lines,
    two_contact_lines,
)
from palpate.author.arguments import (
    ball_of,
    existing,
    fidelity_named,
    lengths,
    one_way_to_press,
    pressed_radius,
    radius_given,
    ready_scene,
)
from palpate.author.console import Answer, answer_of
from palpate.author.errors import InputError, InputProblem
from palpate.author.extremes_command import extremes
from palpate.author.report_command import report
from palpate.author.rigid_command import cooked_scene, rigid
from palpate.author.scan_command import detect, scan
from palpate.author.tradeoff_command import tradeoff
from palpate.author.transients_command import transients
from palpate.author.view_command import view

__all__ = ["app", "end", "main"]

app = typer.Typer(
    help="From an organ surface and a tool to a force that a hand can feel.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

app.add_typer(transients, name="transients")

SceneFile = Annotated[Path, typer.Argument(metavar="SCENE", help="scene file (TOML)")]
Asset = Annotated[Path, typer.Argument(metavar="ASSET", help="asset folder")]
_TYPED: ContextVar[str] = ContextVar("typed", default="")
"""The command, as it can be typed again."""
Json = Annotated[bool, typer.Option("--json", help="one JSON object on stdout, everything else on stderr")]


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs one command; gives the exit code."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    _TYPED.set(shlex.join(["palpate", *given]))
    try:
        code = app(args=given, prog_name="palpate", standalone_mode=False)
    except typer.Exit as end:
        return end.exit_code
    except typer.TyperException as error:  # wrong options or arguments
        show = getattr(error, "show", None)  # usage and hint, where typer has them
        show() if show else print(f"palpate: {error.format_message()}", file=sys.stderr)
        if "--json" in given:
            problem = InputProblem("", "", None, error.format_message())
            print(json.dumps({"error": {"exit_code": 2, "problems": [problem.as_json()]}}))
        return 2
    return code if isinstance(code, int) else 0


Workers = Annotated[
    int | None,
    typer.Option(
        "--workers",
        min=1,
        metavar="N",
        help="processes that press; one a core when absent, fewer where memory is short",
    ),
]

Device = Annotated[
    str,
    typer.Option(
        "--device",
        metavar="NAME",
        help="cpu, cuda or cuda:N: elements of many presses in common launches there",
    ),
]


@app.command()
def plan(
    scene: SceneFile,
    workers: Workers = None,
    tool: Annotated[str, typer.Option("--tool", metavar="NAME", help="one tool only")] = "",
    as_json: Json = False,
) -> None:
    """Show what will be meshed, pressed and stored, and what each effect, tool and region adds."""

    def work() -> Answer:
        from palpate.author.plan import plan as planned

        return planned(ready_scene(scene), workers, tool)

    _end(work, as_json)


@app.command()
def author(
    scene: SceneFile,
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="where the asset goes")],
    tool: Annotated[
        str,
        typer.Option(
            "--tool", metavar="NAME", help="add or replace this tool only; the others stay as they are"
        ),
    ] = "",
    workers: Workers = None,
    scheduler: Annotated[
        str, typer.Option("--scheduler", metavar="tcp://HOST:PORT", help="press on a Dask cluster instead")
    ] = "",
    device: Device = "",
    batch: Annotated[
        int | None,
        typer.Option(
            "--batch", min=1, metavar="N", help="with --device: presses at once; two a core when absent"
        ),
    ] = None,
    per_vertex: Annotated[
        bool, typer.Option("--per-vertex", help="curves at each vertex of the surface too, in the USD asset")
    ] = False,
    as_json: Json = False,
) -> None:
    """Make the asset: repair, tetrahedralise, press, fit, write, cook, validate, report."""

    def work() -> Answer:
        from palpate.author.progress import ConsoleProgress
        from palpate.author.rigid.scene import is_rigid_scene

        if is_rigid_scene(scene):  # nothing to press
            return cooked_scene(scene, out)
        one_way_to_press(workers, scheduler, device, batch)
        ready = ready_scene(scene)
        from palpate.author.pipeline import author as authored

        with ConsoleProgress() as progress:
            result = authored(
                ready,
                out,
                progress=progress,
                workers=workers,
                scheduler=scheduler,
                device=device,
                batch=batch,
                tool=tool,
                per_vertex=per_vertex,
            )
        return Answer(result, [author_lines(result)], 0 if result["tolerance_met"] else 1)

    _end(work, as_json)


@app.command()
def press(
    scene: SceneFile,
    at: Annotated[str, typer.Option("--at", metavar="X,Y,Z", help="m or with units; goes to the surface")],
    tool: Annotated[str, typer.Option("--tool", metavar="NAME", help="tool of the scene")],
    depth: Annotated[str, typer.Option("--depth", metavar="D", help='deepest state, such as "5 mm"')],
    lateral: Annotated[str, typer.Option("--lateral", metavar="DX,DY", help="then, sticking, aside")] = "",
    fidelity: Annotated[
        str, typer.Option("--fidelity", help="linear, near_field or full; default: scene's")
    ] = "",
    radius: Annotated[str, typer.Option("--radius", metavar="R", help="of a tool family: which ball")] = "",
    drag: Annotated[bool, typer.Option("--drag", help="then drag it both ways: friction over depth")] = False,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="keeps the work, the answer and a picture")
    ] = None,
    plot: Annotated[Path | None, typer.Option("--plot", metavar="FILE.png", help="curves")] = None,
    vtu: Annotated[Path | None, typer.Option("--vtu", metavar="FILE.vtu", help="deformed tetrahedra")] = None,
    usd: Annotated[Path | None, typer.Option("--usd", metavar="FILE.usda", help="deformed surface")] = None,
    device: Device = "",
    as_json: Json = False,
) -> None:
    """Press the tool into the organ once, by finite elements."""

    def work() -> Answer:
        from palpate.author.progress import ConsoleProgress

        place, deepest = lengths("--at", at, 3), lengths("--depth", depth, 1)[0]
        move = lengths("--lateral", lateral, 2) if lateral else None
        if deepest <= 0:
            raise InputError(InputProblem("", "--depth", depth, "is not above 0", 'a depth such as "5 mm"'))
        ready = ready_scene(scene)
        ready = pressed_radius(ready, ready.tool_named(tool), radius_given(radius))
        chosen = fidelity_named(fidelity or ready.accuracy.fidelity)
        from palpate.author.press_command import PressFiles, press_lines
        from palpate.author.press_command import press as pressed

        files = PressFiles(out, plot, vtu, usd)
        with ConsoleProgress() as progress:
            result = pressed(
                ready,
                at=place,
                tool=tool,
                depth=deepest,
                lateral=move,
                fidelity=chosen,
                progress=progress,
                drag=drag,
                files=files,
                device=device,
            )
        done = result["converged"] and (not drag or result["drag"]["converged"])
        return Answer(result, [press_lines(result)], 0 if done else 1)

    _end(work, as_json)


Radius = Annotated[
    str,
    typer.Option("--radius", metavar="R", help='of a tool family, any between pressed ones, as "3.5 mm"'),
]


@app.command()
def validate(
    asset: Asset,
    points: Annotated[int, typer.Option("--points", min=1, help="fresh presses")] = 40,
    seed: Annotated[int, typer.Option("--seed", min=0, help="draws the points")] = 1,
    tool: Annotated[str, typer.Option("--tool", metavar="NAME", help="one tool only")] = "",
    within: Annotated[
        str,
        typer.Option("--within", metavar="X,Y,Z,R", help="draws points only in this ball; m or with units"),
    ] = "",
    drag: Annotated[
        int,
        typer.Option("--drag", min=0, metavar="N", help="then drags the tool both ways at N of the points"),
    ] = 0,
    apart: Annotated[
        str,
        typer.Option(
            "--apart", metavar="L,...", help="presses two tools at once instead, these lengths apart"
        ),
    ] = "",
    radius: Radius = "",
    as_json: Json = False,
) -> None:
    """Press anew where the asset was never pressed, and compare with the runtime."""

    def work() -> Answer:
        from palpate.author.progress import ConsoleProgress

        existing(asset, "an asset folder")
        asked = radius_given(radius)
        for option, value in (("--within", within), ("--radius", radius), ("--drag", drag or "")):
            if apart and value:
                what, expected = "is for fresh points, and none is drawn", f"either {option} or --apart"
                raise InputError(InputProblem("", option, value, what, expected))
        if apart:
            from palpate.author.two_contacts import two_contacts

            with ConsoleProgress() as progress:
                pairs = two_contacts(asset, lengths("--apart", apart), seed, tool or None, progress)
            return Answer(pairs, [two_contact_lines(pairs)])
        from palpate.author.validate import validate as validated

        with ConsoleProgress() as progress:
            ball = ball_of("--within", within) if within else None
            result = validated(asset, points, seed, tool or None, progress, ball, drag, asked)
        shown = "\n".join(
            f"{key}: {percentiles(result[key])}"
            for key in ("force_error", "lateral_error", "stuck_error", "slid_error", "friction_press_error")
            if result[key]
        )
        return Answer(result, [shown], 0 if result["met"] else 1)

    _end(work, as_json)


@app.command()
def cook(
    asset: Asset,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="the asset folder when absent")
    ] = None,
    tool: Annotated[str, typer.Option("--tool", metavar="NAME", help="one tool only")] = "",
    radius: Radius = "",
    as_json: Json = False,
) -> None:
    """Cook an asset's response fields into .rfield files for the runtime."""

    def work() -> Answer:
        from palpate.author.cook_asset import cook_asset

        return cook_asset(existing(asset, "an asset folder"), out, tool or None, radius_given(radius))

    _end(work, as_json)


@app.command()
def inspect(
    path: Annotated[Path, typer.Argument(metavar="PATH", help="asset folder or .rfield")],
    as_json: Json = False,
) -> None:
    """Show tools, nodes, sizes, hashes and errors of an asset or a cooked field."""

    def work() -> Answer:
        from palpate.author.inspect_field import inspect_field

        return inspect_field(path)

    _end(work, as_json)


@app.command()
def replay(
    field: Annotated[Path, typer.Argument(metavar="FIELD", help=".rfield")],
    trace: Annotated[Path, typer.Argument(metavar="TRACE", help="x, y, z, dt in m and s; .csv or .npz")],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="the trace with forces and energies")
    ] = None,
    friction: Annotated[
        float | None, typer.Option("--friction", min=0, help="coefficient in place of the field's")
    ] = None,
    force_max: Annotated[
        float, typer.Option("--force-max", min=0, help="N; the device's limit; 0: none")
    ] = 0.0,
    as_json: Json = False,
) -> None:
    """Send a recorded trace through the runtime: forces and energies out."""

    def work() -> Answer:
        from palpate.author.replay import replay as replayed

        result = replayed(field, trace, out, friction=friction, force_max=force_max)
        return Answer(result, [replay_lines(result)])

    _end(work, as_json)


@app.command()
def bench(
    field: Annotated[
        Path | None, typer.Argument(metavar="[FIELD]", help=".rfield; a shipped one when absent")
    ] = None,
    as_json: Json = False,
) -> None:
    """Measure the runtime's tick on this machine."""

    def work() -> Answer:
        from palpate.author.bench import bench as benched

        return benched(field)

    _end(work, as_json)


@app.command()
def certify(
    field: Annotated[Path, typer.Argument(metavar="FIELD", help=".rfield")],
    scene: Annotated[
        Path | None,
        typer.Option("--scene", help="scene file with a table of the device; options replace its numbers"),
    ] = None,
    device: Annotated[
        str | None,
        typer.Option("--device", help='such as "omega.3"; of the scene, only the rate then counts'),
    ] = None,
    rate: Annotated[float | None, typer.Option("--rate", help="Hz, of the servo loop")] = None,
    damping: Annotated[float | None, typer.Option("--damping", help="N s/m, of the device")] = None,
    delay: Annotated[float | None, typer.Option("--delay", help="s, from the sample to the motors")] = None,
    quantum: Annotated[float | None, typer.Option("--quantum", help="m, of the encoders at the tip")] = None,
    dry_friction: Annotated[float | None, typer.Option("--dry-friction", help="N, of the device")] = None,
    max_force: Annotated[float | None, typer.Option("--max-force", help="N, of the device")] = None,
    mass: Annotated[float | None, typer.Option("--mass", help="kg, of the simulated device")] = None,
    simulate: Annotated[bool, typer.Option("--simulate", help="let simulated devices push into it")] = False,
    picture: Annotated[
        Path | None, typer.Option("--map", metavar="FILE.png", help="where on the organ it hums")
    ] = None,
    texture_device: Annotated[
        str | None,
        typer.Option("--texture-device", help="PHANTOM or Pantograph: what they render of textures"),
    ] = None,
    drag_picture: Annotated[
        Path | None,
        typer.Option(
            "--drag", metavar="FILE.png", help="a drag over the texture: force over time, its line at k v"
        ),
    ] = None,
    time_factor: Annotated[float | None, typer.Option("--time-factor", help="alpha of textures; 10")] = None,
    space_factor: Annotated[float | None, typer.Option("--space-factor", help="beta of textures; 10")] = None,
    force_factor: Annotated[
        float | None, typer.Option("--force-factor", help="gamma of textures; 10")
    ] = None,
    force_resolution: Annotated[
        float | None, typer.Option("--force-resolution", help="N, least force of the device")
    ] = None,
    control_stiffness: Annotated[
        float | None, typer.Option("--control-stiffness", help="N/m, largest that the device holds")
    ] = None,
    structural_frequency: Annotated[
        float | None, typer.Option("--structural-frequency", help="Hz, of the device's first mode")
    ] = None,
    normal_force: Annotated[
        float | None,
        typer.Option("--normal-force", help="N, at which textures are judged; the field's largest"),
    ] = None,
    as_json: Json = False,
) -> None:
    """Hold a haptic device against a field: does holding forces make it hum?"""

    def work() -> Answer:
        from palpate.author.certify import certify as certified
        from palpate.author.certify_map import certify_map, require_picture
        from palpate.author.haptic_device import device_from
        from palpate.author.texture.certify_texture import certified_drag, certified_texture

        for file, option in ((picture, "--map"), (drag_picture, "--drag")):
            if file is not None:
                require_picture(file, option)
        held = device_from(
            scene,
            name=device,
            rate=rate,
            damping=damping,
            delay=delay,
            quantum=quantum,
            dry_friction=dry_friction,
            max_force=max_force,
            mass=mass,
        )
        result = certified(
            field,
            rate=held.rate,
            damping=held.damping,
            delay=held.delay,
            quantum=held.resolution,
            dry_friction=held.friction,
            mass=held.mass,
            max_force=held.max_force,
            name=held.name,
            assumed=held.assumed,
            simulate=simulate,
        )
        if picture is not None:
            result["map"] = certify_map(field, held, picture)
        result["texture"] = certified_texture(
            field,
            scene,
            held,
            texture_device,
            {"time_factor": time_factor, "space_factor": space_factor, "force_factor": force_factor},
            {
                "force_resolution": force_resolution,
                "stiffness_max": control_stiffness,
                "structural_frequency": structural_frequency,
            },
            normal_force,
        )
        if drag_picture is not None:
            result["texture"]["drag"] = certified_drag(field, drag_picture)
        return Answer(result, [certify_lines(result)], 0 if result["met"] else 1)

    _end(work, as_json)


@app.command()
def verify(
    everything: Annotated[
        bool, typer.Option("--all", help="the slow rows too: a quarter of an hour")
    ] = False,
    as_json: Json = False,
) -> None:
    """Hold the finite elements against what is known, row by row."""

    def work() -> Answer:
        from palpate.author.verify import verify as verified

        return verified(everything, progress=lambda line: print(line, file=sys.stderr, flush=True))

    _end(work, as_json)


app.command()(extremes)


@app.command()
def doctor(as_json: Json = False) -> None:
    """Check what this machine has of what palpate needs."""

    def work() -> Answer:
        from palpate.author.doctor import doctor as examined

        return examined()

    _end(work, as_json)


app.command()(scan)
app.command()(detect)
app.command()(rigid)
app.command()(report)


@app.command(hidden=True)
def schema() -> None:
    """Print the JSON schema of a scene file."""

    def work() -> Answer:
        from palpate.author.scene import scene_schema

        return Answer({}, [json.dumps(scene_schema(), indent=2)])

    _end(work, as_json=False)


app.command()(tradeoff)
app.command()(view)


def end(work: Callable[[], Answer], as_json: bool) -> None:
    """Ends a command that has a file of its own, as `_end` those that are here."""
    _end(work, as_json)


def _end(work: Callable[[], Answer], as_json: bool) -> None:
    raise typer.Exit(answer_of(work, as_json, _TYPED.get()))


if __name__ == "__main__":
    sys.exit(main())
