# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""`palpate report`: the page of an asset anew, from what is kept; nothing is pressed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from palpate.author.console import Answer, answer_of
from palpate.author.errors import InputError, InputProblem

__all__ = ["asset_report", "report"]


def report(
    asset: Annotated[Path, typer.Argument(metavar="ASSET", help="asset folder")],
    bench: Annotated[
        bool, typer.Option("--bench", help="time the tick of each tool here, ten seconds each, and keep it")
    ] = False,
    verification: Annotated[
        Path | None,
        typer.Option("--verification", metavar="FILE.json", help="what palpate verify --json printed; kept"),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="one JSON object on stdout, everything else on stderr")
    ] = False,
) -> None:
    """Write an asset's report anew from what is kept; nothing is pressed."""
    raise typer.Exit(answer_of(lambda: asset_report(asset, bench, verification), as_json))


def asset_report(asset: Path, bench: bool = False, verification: Path | None = None) -> Answer:
    """Writes <asset>/report/ (report/__init__.py).

    Args:
        bench: time the tick on each tool's cooked field first.
        verification: a file with what `palpate verify --json` printed.

    Returns:
        report (path of the page), bytes, verdict {state, line}, tools [{name, state, sentence}], pictures, notes; exit
        code 1 where a stated tolerance is not met.

    Raises:
        InputError: there is no asset, its summary is damaged, or `verification` is something else.
    """
    from palpate.author.arguments import existing
    from palpate.author.report import write_report
    from palpate.author.report.records import keep_ticks, keep_verification
    from palpate.fields.usd_read import tools

    folder = existing(asset, "an asset folder")
    folder = folder if folder.is_dir() else folder.parent
    summary = _summary(folder)
    names = tools(folder)
    if verification is not None:
        keep_verification(folder, verification)
    for name in names if bench else ():
        keep_ticks(folder, name)
    page = write_report(folder, summary)
    twin = json.loads(page.with_name("report.json").read_text(encoding="utf-8"))
    verdict = {key: twin["verdict"][key] for key in ("state", "line")}
    result = {
        "report": str(page),
        "bytes": page.stat().st_size,
        "verdict": verdict,
        "tools": [{"name": tool["name"], **tool["verdict"]} for tool in twin["tools"]],
        "pictures": [picture["file"] for picture in twin["pictures"]],
        "notes": twin["notes"],
    }
    lines = [f"{page}: {result['bytes'] / 2**20:.1f} MiB, works offline", verdict["line"], *twin["notes"]]
    return Answer(result, ["\n".join(lines)], 1 if verdict["state"] == "missed" else 0)


def _summary(folder: Path) -> dict[str, Any]:
    """What `palpate author` said; empty where nobody kept it."""
    path = folder / "summary.json"
    if not path.is_file():
        return {}
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        found = None
        what = f"is no JSON ({error})"
    else:
        what = "is no JSON object"
    if not isinstance(found, dict):
        expected = "what palpate author wrote; without the file the report shows what the asset itself holds"
        raise InputError(InputProblem(str(path), "", None, what, expected))
    return found
