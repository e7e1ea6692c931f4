# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""`palpate tradeoff`: its options, and what it says."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from palpate.author.arguments import ready_scene
from palpate.author.console import Answer
from palpate.author.errors import InputError, InputProblem
from palpate.author.units import QuantityError, quantity

__all__ = ["tradeoff"]

SceneFile = Annotated[Path, typer.Argument(metavar="SCENE", help="scene file (TOML)")]


def tradeoff(
    scene: SceneFile,
    out: Annotated[
        Path, typer.Option("--out", metavar="DIR", help="where presses, tables, picture and page go")
    ],
    budget: Annotated[
        str, typer.Option("--budget", metavar="TIME", help='of the sweep, such as "30 min"; "none": no limit')
    ] = "30 min",
    tool: Annotated[str, typer.Option("--tool", metavar="NAME", help="the scene's first when absent")] = "",
    held_out: Annotated[
        int | None,
        typer.Option("--held-out", min=2, metavar="N", help="presses that judge; the scene's, at least 8"),
    ] = None,
    confirm_seeds: Annotated[
        int,
        typer.Option(
            "--confirm-seeds",
            min=0,
            metavar="N",
            help="then judges the recommended setting by fresh presses of N seeds; the budget does not count there",
        ),
    ] = 0,
    confirm_points: Annotated[
        int | None,
        typer.Option(
            "--confirm-points", min=1, metavar="N", help="presses of each such seed; the scene's held_out"
        ),
    ] = None,
    write_scene: Annotated[
        Path | None,
        typer.Option("--write-scene", metavar="FILE.toml", help="the scene with the recommended setting"),
    ] = None,
    workers: Annotated[
        int | None, typer.Option("--workers", min=1, metavar="N", help="processes that press; one a core")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="one JSON object on stdout, everything else on stderr")
    ] = False,
) -> None:
    """Weigh speed against accuracy on a scene: which settings nothing beats, and which one to take."""
    from palpate.author.command_line import end

    def work() -> Answer:
        seconds = _seconds(budget)
        ready = ready_scene(scene)
        from palpate.author.progress import ConsoleProgress
        from palpate.author.tradeoff import tradeoff as weighed

        with ConsoleProgress() as progress:
            result = weighed(
                ready, out, tool, budget=seconds, held_out=held_out, workers=workers,
                confirm_seeds=confirm_seeds, confirm_points=confirm_points, write_scene=write_scene, progress=progress,
            )  # fmt: skip
        return Answer(result, _lines(result), 0 if _good(result) else 1)

    end(work, as_json)


def _seconds(text: str) -> float | None:
    if text == "none":
        return None
    try:
        seconds = quantity(float(text) if text.replace(".", "", 1).isdigit() else text, "time")
    except QuantityError as error:
        raise InputError(InputProblem("", "--budget", text, error.what, error.expected)) from None
    if not seconds > 0.0:
        raise InputError(
            InputProblem("", "--budget", text, "is not above 0", 'a time such as "30 min", or "none"')
        )
    return seconds


def _good(result: dict[str, Any]) -> bool:
    """Whether a setting is recommended, and confirmed where that was asked for."""
    confirmed = result["confirmed"]
    return result["recommended"] is not None and (confirmed is None or confirmed["enough"])


def _lines(result: dict[str, Any]) -> list[Any]:
    from palpate.author.tradeoff.groups import short_words

    cells = [
        (
            "row",
            "",
            "setting",
            "CPU s",
            "KiB",
            "tick ns",
            "normal p50/p95/max %",
            "lateral",
            "stuck p95 %",
            "met",
        )
    ]
    shown = sorted({*result["pareto"], *_of_interest(result)}, key=lambda i: result["rows"][i]["cpu_seconds"])
    for i in shown:
        row = result["rows"][i]
        force = "/".join(f"{100 * row['force_error'][part]:.2g}" for part in ("p50", "p95", "max"))
        lateral, stuck = (
            f"{100 * row[k]['p95']:.2g}" if row[k] else "-" for k in ("lateral_error", "stuck_error")
        )
        mark = "take" if i == result["recommended"] else "front" if i in result["pareto"] else ""
        tick = "-" if row["tick_ns"] is None else f"{row['tick_ns']:.0f}"
        cells.append((
            str(i), mark, short_words(row), f"{row['cpu_seconds']:.0f}", f"{row['bytes'] / 1024:.0f}", tick,
            force, lateral, stuck, "yes" if row["met"] else "no",
        ))  # fmt: skip
    lines: list[Any] = [
        _aligned(cells),
        f"{len(result['rows'])} settings; all of them: {result['files']['csv']}",
    ]
    if result["recommended"] is None:
        lines.append(f"no setting meets {100 * result['tolerance']:g} % surely enough")
    else:
        row = result["rows"][result["recommended"]]
        lines.append(
            f"take row {result['recommended']}: {short_words(row)} "
            f"({100 * row['chance']:.0f} % of redrawn held-out presses meet {100 * result['tolerance']:g} %)"
        )
    if result["confirmed"]:
        found = result["confirmed"]
        lines.append(
            f"{found['met']} of {found['seeds']} fresh seeds of {found['points']} presses meet it "
            f"(at least {found['bar']} have to)"
        )
    if result["scene_written"]:
        lines.append(f"scene with it: {result['scene_written']}")
    for item in result["left_out"]:
        what = item.get("knob") or item.get("pressing") or item.get("setting")
        lines.append(f"left out: {what}: {item['reason']}")
    lines += [f"{kind}: {path}" for kind, path in result["files"].items() if kind in ("png", "page")]
    return lines


def _aligned(cells: list[tuple[str, ...]]) -> str:
    """Columns as wide as they are: a terminal may wrap lines, but no cell is broken or cut."""
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in cells
    )


def _of_interest(result: dict[str, Any]) -> list[int]:
    """The recommended row, the scene's own setting, and each other knob by itself at the scene's node count."""
    own = [
        i
        for i, row in enumerate(result["rows"])
        if len(row["changed"]) <= 1 and "nodes" not in row["changed"]
    ]
    return own if result["recommended"] is None else [*own, result["recommended"]]
