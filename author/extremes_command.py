# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""`palpate extremes [SCENE]`: its options, its progress, its answer."""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.text import Text

from palpate.author.arguments import ready_scene
from palpate.author.console import Answer, table_of

__all__ = ["EXTREMES_OUT", "extremes", "extremes_answer"]

EXTREMES_OUT = Path("out/extremes")
STYLES = {"verified": "green", "refused": "", "wrong": "red"}

SceneOption = Annotated[
    Path | None,
    typer.Argument(metavar="[SCENE]", help="scene file (TOML); blocks and known fields when absent"),
]


def extremes(
    scene: SceneOption = None,
    out: Annotated[
        Path, typer.Option("--out", metavar="DIR", help="keeps cases that are done, tables and picture")
    ] = EXTREMES_OUT,
    quick: Annotated[bool, typer.Option("--quick", help="the cheap cases only: a minute")] = False,
    axis: Annotated[str, typer.Option("--axis", metavar="NAME,...", help="these axes only")] = "",
    as_json: Annotated[
        bool, typer.Option("--json", help="one JSON object on stdout, everything else on stderr")
    ] = False,
) -> None:
    """Drive every axis to its ends: what converges and is verified, what is refused, what is wrong."""
    from palpate.author.console import answer_of

    raise typer.Exit(answer_of(lambda: extremes_answer(scene, out, quick, axis), as_json))


def extremes_answer(
    scene: Path | None, out: Path = EXTREMES_OUT, quick: bool = False, axis: str = ""
) -> Answer:
    """The answer; exit code 1 where a case is wrong.

    Raises:
        InputError: the scene is none, or an axis is not known.
    """
    from palpate.author.errors import InputError, InputProblem
    from palpate.author.extremes.case import Row
    from palpate.author.extremes.table import all_cases, counted, run, written

    ready = None if scene is None else ready_scene(scene)
    cases = [case for case in all_cases(ready, out / "work") if case.quick or not quick]
    if axis:
        known = list(dict.fromkeys(case.axis for case in cases))
        wanted = [name.strip() for name in axis.split(",")]
        for name in wanted:
            if name not in known:
                raise InputError(
                    InputProblem("", "--axis", name, "is no axis of the table", "one of " + ", ".join(known))
                )
        cases = [case for case in cases if case.axis in wanted]
    done = 0

    def told(row: Row) -> None:
        nonlocal done
        done += 1
        print(
            f"{done:4d}/{len(cases)}  {row.outcome:8}  {row.axis}: {row.value}", file=sys.stderr, flush=True
        )

    rows = run(cases, out, "" if ready is None else ready.digest(), told)
    wrong = [row for row in rows if row.outcome == "wrong"]
    result = {
        "rows": [asdict(row) for row in rows],
        "silent_failures": len(wrong),
        "by_axis": counted(rows),
        "files": written(rows, out),
        "cpu_seconds": sum(row.seconds for row in rows),
    }
    shown = table_of("axis", "verified", "refused", "wrong")
    for name, of in counted(rows).items():
        shown.add_row(name, *(Text(str(n), STYLES[outcome] if n else "") for outcome, n in of.items()))
    lines = [f"WRONG  {row.axis}: {row.value}: {row.reason}" for row in wrong]
    verdict = f"{len(rows)} cases, {len(wrong)} silent failures; {result['files']['md']}"
    return Answer(result, [shown, *lines, verdict], 1 if wrong else 0)
