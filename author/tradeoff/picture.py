# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The trade-off as one picture: authoring time against error, tick time against error."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.report.palette import INK, MARK
from palpate.author.tradeoff.front import worst_error
from palpate.author.tradeoff.groups import family_of, look_of, short_words

__all__ = ["picture", "step_of"]


def picture(result: dict[str, Any], path: Path) -> None:
    """Writes a PNG of `result` (as `palpate tradeoff --json` prints it) to `path`."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    rows = result["rows"]
    figure = Figure(figsize=(13.0, 6.8), dpi=130, layout="constrained")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=(1.25, 1.0))
    looks = look_of(list(dict.fromkeys(family_of(row) for row in rows)))
    for axes, speed in ((left, _minutes), (right, _tick)):
        for family, (colour, mark, _) in looks.items():
            shown = [row for row in rows if family_of(row) == family and speed(row) is not None]
            if not shown:
                continue
            axes.scatter(
                [speed(row) for row in shown],
                [100.0 * worst_error(row) for row in shown],
                s=[26.0 + 1.2e-4 * row["bytes"] for row in shown],
                marker=mark,
                facecolor=[(colour, 0.85 if row["offered"] else 0.0) for row in shown],
                edgecolor=colour,
                linewidth=1.2,
                label=family,
                zorder=3,
            )
        front = step_of([rows[i] for i in result["pareto"]], speed)
        if len(front):
            axes.plot(
                front[:, 0],
                front[:, 1],
                color=INK,
                lw=1.3,
                zorder=2,
                label="nothing is both faster and nearer",
            )
        axes.axhline(100.0 * result["tolerance"], color=MARK, ls="--", lw=1.3, zorder=1)
        axes.set_yscale("log")
        axes.grid(True, which="both", color="#eeeeea", lw=0.8, zorder=0)
        axes.spines[["top", "right"]].set_visible(False)
        if result["recommended"] is not None:
            best = rows[result["recommended"]]
            x, y = speed(best), 100.0 * worst_error(best)
            axes.scatter([x], [y], s=330, facecolor="none", edgecolor=MARK, linewidth=2.0, zorder=4)
            if axes is left:
                axes.set_title(f"recommended: {short_words(best)}", color=MARK, fontsize=10, loc="left")
    left.set_xscale("log")
    left.set_ylim(top=1.5 * max(left.get_ylim()[1], 100.0 * result["tolerance"]))
    left.set_xlabel("authoring, CPU minutes of that setting alone", color=INK)
    left.set_ylabel("worst of normal, lateral and stuck force error, p95, %", color=INK)
    right.set_xlabel(
        "tick in contact, median ns (the slower of sticking and sliding)\n"
        "area: bytes; hollow: not rendered by the runtime, so without a tick",
        color=INK,
    )
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    left.xaxis.set_major_locator(LogLocator(base=10, subs=(1.0, 2.0, 5.0)))
    left.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    left.xaxis.set_minor_formatter(NullFormatter())
    left.yaxis.set_major_locator(LogLocator(base=10, subs=(1.0, 2.0, 5.0)))
    left.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{y:g}"))
    left.yaxis.set_minor_formatter(NullFormatter())
    ticks = [row["tick_ns"] for row in rows if row["tick_ns"] is not None]
    if ticks:
        right.set_xlim(0.0, 1.25 * max(ticks))
    left.text(
        0.99, 100.0 * result["tolerance"], f"asked: {100.0 * result['tolerance']:g} %", color=MARK, fontsize=10,
        transform=left.get_yaxis_transform(), va="bottom", ha="right",
    )  # fmt: skip
    handles, names = left.get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=7, fontsize=9, frameon=False)
    truth = result["truth"]
    figure.suptitle(
        f"{result['scene']}, {result['tool']}: speed against accuracy, {len(rows)} settings, "
        f"{truth['presses']} held-out presses ({truth['fidelity']}, {1e3 * truth['mesh_size']:.3g} mm)",
        color=INK, fontsize=12,
    )  # fmt: skip
    part = path.with_suffix(".part.png")
    figure.savefig(part)
    os.replace(part, path)


def step_of(rows: list[dict[str, Any]], speed: Any) -> np.ndarray:
    """(n, 2) points, rising in speed's measure and falling in error (%), that no other of `rows` is better than."""
    kept: list[tuple[float, float]] = []
    for x, y in sorted((speed(row), 100.0 * worst_error(row)) for row in rows if speed(row) is not None):
        if not kept or y < kept[-1][1]:
            kept.append((x, y))
    return np.array(kept)


def _minutes(row: dict[str, Any]) -> float:
    return row["cpu_seconds"] / 60.0


def _tick(row: dict[str, Any]) -> float | None:
    return row["tick_ns"]
