# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The interactive page: the same two panels, and a table of all rows; one file that loads nothing."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jinja2
import plotly.graph_objects as go
from markupsafe import Markup
from plotly.offline import get_plotlyjs
from plotly.subplots import make_subplots

from palpate.author.report.numbers import ABSENT, asked, percent, significant
from palpate.author.report.palette import INK, MARK
from palpate.author.tradeoff.front import worst_error
from palpate.author.tradeoff.groups import NAMES, family_of, look_of, short_words, words_of
from palpate.author.tradeoff.picture import step_of

__all__ = ["page"]

_HERE = Path(__file__).parent


def page(result: dict[str, Any]) -> str:
    """The page of `result` (as `palpate tradeoff --json` prints it) as text."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_HERE),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    rows = [_told(i, row, result) for i, row in enumerate(result["rows"])]
    best = None if result["recommended"] is None else rows[result["recommended"]]
    return environment.get_template("page.html").render(
        result=result,
        rows=rows,
        best=best,
        tolerance=asked(result["tolerance"]),
        knobs=list(NAMES.values()),
        truth_minutes=significant(result["truth"]["cpu_seconds"] / 60.0),
        mesh=f"{1e3 * result['truth']['mesh_size']:.3g} mm",
        style=Markup((_HERE.parent / "report" / "style.css").read_text(encoding="utf-8")),
        script=Markup((_HERE / "page.js").read_text(encoding="utf-8")),
        plotly=Markup(get_plotlyjs()),
        figure=_script_json(figure(result).to_json()),
        families=list(dict.fromkeys(row["family"] for row in rows)),
    )


def figure(result: dict[str, Any]) -> go.Figure:
    """Authoring time against error, and tick against error; one legend entry for both."""
    rows, drawn = result["rows"], make_subplots(cols=2, shared_yaxes=True, horizontal_spacing=0.04)
    speeds = (lambda row: row["cpu_seconds"] / 60.0, lambda row: row["tick_ns"])
    for family, (colour, _, mark) in look_of(list(dict.fromkeys(map(family_of, rows)))).items():
        for column, speed in enumerate(speeds, 1):
            shown = [i for i, row in enumerate(rows) if family_of(row) == family and speed(row) is not None]
            if not shown and column == 2:
                continue
            drawn.add_scatter(
                x=[speed(rows[i]) for i in shown],
                y=[100.0 * worst_error(rows[i]) for i in shown],
                mode="markers",
                name=family,
                legendgroup=family,
                showlegend=column == 1,
                customdata=shown,
                text=[_hover(rows[i], i, result) for i in shown],
                hovertemplate="%{text}<extra></extra>",
                marker={
                    "symbol": [mark if rows[i]["offered"] else f"{mark}-open" for i in shown],
                    "color": colour,
                    "size": [8.0 + 2e-5 * rows[i]["bytes"] for i in shown],
                    "line": {"width": 1.2, "color": colour},
                },
                row=1,
                col=column,
            )
    for column, speed in enumerate(speeds, 1):
        front = step_of([rows[i] for i in result["pareto"]], speed)
        if len(front):
            drawn.add_scatter(
                x=front[:, 0], y=front[:, 1], mode="lines", name="Pareto front", legendgroup="front",
                showlegend=column == 1, hoverinfo="skip", line={"color": INK, "width": 1.5}, row=1, col=column,
            )  # fmt: skip
        if result["recommended"] is not None:
            best = rows[result["recommended"]]
            drawn.add_scatter(
                x=[speed(best)], y=[100.0 * worst_error(best)], mode="markers", name="recommended",
                legendgroup="recommended", showlegend=column == 1, hoverinfo="skip",
                marker={"symbol": "circle-open", "size": 24, "color": MARK, "line": {"width": 2.5}}, row=1, col=column,
            )  # fmt: skip
        drawn.add_hline(
            y=100.0 * result["tolerance"],
            line={"color": MARK, "width": 1.4, "dash": "dash"},
            row=1,
            col=column,
        )
    rungs = [m * 10.0**e for e in range(-3, 5) for m in (1, 2, 5)]
    told = {"tickvals": rungs, "ticktext": [f"{rung:g}" for rung in rungs]}
    drawn.update_yaxes(type="log", **told)
    drawn.update_yaxes(title_text="worst of normal, lateral, stuck force error, p95, %", col=1)
    drawn.update_xaxes(type="log", **told, title_text="authoring, CPU minutes of that setting alone", col=1)
    drawn.update_xaxes(title_text="tick in contact, median ns", rangemode="tozero", col=2)
    drawn.update_layout(
        template="plotly_white",
        height=560,
        margin={"l": 62, "r": 16, "t": 16, "b": 56},
        paper_bgcolor="rgba(0,0,0,0)",
        plot_bgcolor="rgba(0,0,0,0)",
        font={"family": "system-ui, sans-serif", "size": 12, "color": INK},
        legend={"orientation": "h", "y": -0.14, "yanchor": "top", "x": 0},
        hoverlabel={"align": "left", "bgcolor": "white"},
    )
    return drawn


def _hover(row: dict[str, Any], i: int, result: dict[str, Any]) -> str:
    setting = ", ".join(words_of(knob, value) for knob, value in row["setting"].items())
    marks = [name for name, on in _marks(i, result).items() if on]
    errors = "<br>".join(
        f"{name}: {_three(row[kind])}"
        for name, kind in (("normal", "force_error"), ("lateral", "lateral_error"), ("stuck", "stuck_error"))
    )
    return (
        f"<b>row {i}: {short_words(row)}</b>{' (' + ', '.join(marks) + ')' if marks else ''}<br>{setting}<br>"
        f"{significant(row['cpu_seconds'] / 60.0)} CPU min, {row['bytes'] / 1024:.0f} KiB, tick {_tick(row)}<br>"
        f"p50 / p95 / max of<br>{errors}"
    )


def _three(error: dict[str, float] | None) -> str:
    return ABSENT if error is None else " / ".join(percent(error[part]) for part in ("p50", "p95", "max"))


def _tick(row: dict[str, Any]) -> str:
    return ABSENT if row["tick_ns"] is None else f"{row['tick_ns']:.0f} ns"


def _marks(i: int, result: dict[str, Any]) -> dict[str, bool]:
    return {
        "recommended": i == result["recommended"],
        "Pareto front": i in result["pareto"],
        "not offered by the runtime": not result["rows"][i]["offered"],
    }


def _told(i: int, row: dict[str, Any], result: dict[str, Any]) -> dict[str, Any]:
    """A row as the table has it: text to read and numbers to sort by."""
    marks = _marks(i, result)
    cells = [(words_of(knob, value), value) for knob, value in row["setting"].items()]
    cells += [
        (significant(row["cpu_seconds"] / 60.0), row["cpu_seconds"]),
        (f"{row['bytes'] / 1024:.0f}", row["bytes"]),
        ("" if row["tick_ns"] is None else f"{row['tick_ns']:.0f}", row["tick_ns"] or 1e9),
    ]
    for kind in ("force_error", "lateral_error", "stuck_error"):
        cells.append((_three(row[kind]), row[kind]["p95"] if row[kind] else 1e9))
    cells.append((f"{100 * row['chance']:.0f} %", row["chance"]))
    return {
        "index": i,
        "family": family_of(row),
        "cells": cells,
        "short": short_words(row),
        "met": row["met"],
        "marks": marks,
        "note": ", ".join(name for name, on in marks.items() if on),
        "minutes": significant(row["cpu_seconds"] / 60.0),
        "tick": _tick(row),
        "kib": f"{row['bytes'] / 1024:.0f} KiB",
        "errors": {kind: _three(row[kind]) for kind in ("force_error", "lateral_error", "stuck_error")},
        "chance": f"{100 * row['chance']:.0f} %",
    }


def _script_json(text: str) -> Markup:
    """JSON that may stand inside a script element."""
    json.loads(text)
    return Markup(text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e"))
