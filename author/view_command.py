# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The command `palpate view`: its options and its answer."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from palpate.author.console import Answer, answer_of

__all__ = ["view"]


def view(
    asset: Annotated[Path, typer.Argument(metavar="ASSET", help="asset folder, or an .rfield")],
    tool: Annotated[
        str, typer.Option("--tool", metavar="NAME", help="the first tool; others on the page")
    ] = "",
    port: Annotated[int, typer.Option("--port", min=0, max=65535, help="0: any free one")] = 8080,
    host: Annotated[
        str, typer.Option("--host", help="0.0.0.0 lets other machines in; nothing protects it")
    ] = "127.0.0.1",
    no_browser: Annotated[bool, typer.Option("--no-browser", help="print the address only")] = False,
    seconds: Annotated[
        float | None, typer.Option("--seconds", min=0, help="end by itself; Ctrl-C otherwise")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="one JSON object on stdout, everything else on stderr")
    ] = False,
) -> None:
    """Feel an asset with the mouse, in a browser."""

    def work() -> Answer:
        from palpate.author.view import view as viewed

        result = viewed(asset, tool=tool, host=host, port=port, browser=not no_browser, seconds=seconds)
        return Answer(result, [_line(result)], 0 if result["met"] else 1)

    raise typer.Exit(answer_of(work, as_json))


def _line(result: dict[str, Any]) -> str:
    priority = "a real-time" if result["real_time"] else "an ordinary"
    return (
        f"{result['ticks']} ticks at {result['rate']:.0f} Hz with {priority} priority, {result['missed']} missed "
        f"({100 * result['missed_share']:.3f} %, allowed {100 * result['missed_allowed']:.0f} %); longest "
        f"{1e3 * result['longest_tick']:.2f} ms; largest force {result['force_max']:.3f} N"
    )
