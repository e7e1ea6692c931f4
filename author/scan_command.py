# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""`palpate scan` and `palpate detect`: their options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.author.arguments import existing, lengths, ready_scene
from palpate.author.console import Answer, answer_of
from palpate.author.errors import InputError, InputProblem

__all__ = ["detect", "scan"]

Json = Annotated[bool, typer.Option("--json", help="one JSON object on stdout, everything else on stderr")]


def scan(
    asset: Annotated[Path, typer.Argument(metavar="ASSET", help="asset folder")],
    tool: Annotated[str, typer.Option("--tool", metavar="NAME", help="the first when absent")] = "",
    depth: Annotated[
        str, typer.Option("--depth", metavar="D", help="constant; three quarters of the field's when absent")
    ] = "",
    step: Annotated[str, typer.Option("--step", metavar="L", help="between readings; 1 mm or more")] = "",
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE.png", help="draws the map of force")
    ] = None,
    as_json: Json = False,
) -> None:
    """Slide over an asset at constant depth through the runtime; find what is hidden under its surface by force."""

    def work() -> Answer:
        existing(asset, "an asset folder")
        deep = lengths("--depth", depth, 1)[0] if depth else None
        apart = lengths("--step", step, 1)[0] if step else None
        from palpate.author.scan import scan as scanned
        from palpate.author.scan import scan_lines

        result = scanned(asset, tool or None, deep, apart, out)
        return Answer(result, [scan_lines(result)])

    raise typer.Exit(answer_of(work, as_json))


def detect(
    scene: Annotated[
        Path, typer.Argument(metavar="SCENE", help="scene file (TOML); its regions are left out")
    ],
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="keeps presses, chart and numbers")],
    at: Annotated[
        str,
        typer.Option(
            "--at", metavar="X,Y,Z", help="goes to the surface; the middle of the reach when absent"
        ),
    ] = "",
    tool: Annotated[str, typer.Option("--tool", metavar="NAME", help="the first when absent")] = "",
    depth: Annotated[
        str, typer.Option("--depth", metavar="D", help="of the press; the scene's when absent")
    ] = "",
    under: Annotated[
        str, typer.Option("--under", metavar="L,...", help="from the surface to the nodule's top")
    ] = "2 mm,5 mm,8 mm,11 mm",
    radius: Annotated[str, typer.Option("--radius", metavar="R,...", help="of the nodule")] = "3 mm,5 mm",
    stiffer: Annotated[
        str, typer.Option("--stiffer", metavar="K,...", help="than the organ, so many times")
    ] = "3,13",
    workers: Annotated[
        int | None, typer.Option("--workers", min=1, metavar="N", help="processes that press")
    ] = None,
    as_json: Json = False,
) -> None:
    """Chart which nodules a hand could feel: by depth, size and stiffness, one press each."""

    def work() -> Answer:
        place = lengths("--at", at, 3) if at else None
        deep = lengths("--depth", depth, 1)[0] if depth else None
        tops, radii = lengths("--under", under), lengths("--radius", radius)
        times = _numbers("--stiffer", stiffer)
        for option, values in (
            ("--under", tops),
            ("--radius", radii),
            ("--depth", (deep,) if deep is not None else ()),
        ):
            if not all(value > 0.0 for value in values):
                raise InputError(InputProblem("", option, list(values), "is not above 0", "lengths above 0"))
        ready = ready_scene(scene)
        from palpate.author.detectability import detect_lines, detectability
        from palpate.author.progress import ConsoleProgress

        with ConsoleProgress() as progress:
            result = detectability(
                ready, out, place, tool or None, deep, tops, radii, times, workers, progress
            )
        return Answer(result, [detect_lines(result)], 0 if not result["failed"] else 1)

    raise typer.Exit(answer_of(work, as_json))


def _numbers(option: str, text: str) -> tuple[float, ...]:
    try:
        values = tuple(float(part) for part in text.split(","))
    except ValueError:
        raise InputError(
            InputProblem("", option, text, "holds no number", "numbers separated by commas")
        ) from None
    if not all(value > 1.0 for value in values):
        raise InputError(InputProblem("", option, text, "is not stiffer", "numbers above 1"))
    return values
