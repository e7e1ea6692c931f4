# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A scan as a picture: the map of force with what was found and what is there, and two lines through it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from palpate.author.report.palette import INK, MARK, QUIET, RENDERED, VALUES
from palpate.author.scan_found import Found
from palpate.author.scan_grid import ScanGrid

__all__ = ["scan_picture"]

ACROSS = "#009e73"


def scan_picture(
    path: Path,
    result: dict[str, Any],
    grid: ScanGrid,
    force: np.ndarray,
    found: Found,
    true: Sequence[np.ndarray],
) -> None:
    """Draws `result` of `scan` to the PNG `path`.

    Args:
        force: (n,) N at the grid's points.
        true: (n,) bool for each region of the scene.
    """
    figure = Figure(figsize=(12.5, 5.6), dpi=130, facecolor="white", layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=[1.15, 1.0])
    _map(left, figure, result, grid, force, found, true)
    _lines(right, result, grid, force, found, true)
    figure.suptitle(
        f"{result['tool']} slid {1e3 * result['depth']:.3g} mm deep over {Path(result['asset']).name}: "
        f"up to {100 * result['contrast']:.0f} % more force",
        fontsize=12,
        color=INK,
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path)


def _map(
    axes: Axes,
    figure: Figure,
    result: dict[str, Any],
    grid: ScanGrid,
    force: np.ndarray,
    found: Found,
    true: Sequence[np.ndarray],
) -> None:
    left, right, bottom, top = (1e3 * x for x in grid.extent)
    shown = axes.imshow(
        grid.picture(force), origin="lower", extent=(left, right, bottom, top), cmap=VALUES, aspect="equal"
    )
    bar = figure.colorbar(shown, ax=axes, shrink=0.85)
    bar.set_label("normal force, N", fontsize=9, color=INK)
    bar.ax.tick_params(labelsize=8.5, colors=INK)
    marks = []
    if result["noticeable"]:
        _outline(axes, grid, found.inside, "black", "solid")
        marks.append(Line2D([], [], color="black", lw=1.6, label="found: where force falls off most steeply"))
    for k, mask in enumerate(true):
        if mask.any():
            _outline(axes, grid, mask, MARK, "dashed")
            name = result["regions"][k]["name"]
            marks.append(
                Line2D([], [], color=MARK, lw=1.6, ls="dashed", label=f"truth: {name} lies under it")
            )
    if marks:
        axes.legend(
            handles=marks, loc="upper center", bbox_to_anchor=(0.5, -0.1), fontsize=8.5, frameon=False
        )
    axes.set_xlabel("mm, seen straight on", fontsize=9, color=INK)
    axes.set_ylabel("mm", fontsize=9, color=INK)
    axes.tick_params(labelsize=8.5, colors=INK)


def _outline(axes: Axes, grid: ScanGrid, mask: np.ndarray, colour: str, dashes: str) -> None:
    values = np.nan_to_num(grid.picture(mask.astype(float)), nan=0.0)
    left, right, bottom, top = (1e3 * x for x in grid.extent)
    half = 0.5e3 * grid.step
    x = np.linspace(left + half, right - half, values.shape[1])
    y = np.linspace(bottom + half, top - half, values.shape[0])
    if min(values.shape) >= 2:
        axes.contour(x, y, values, levels=[0.5], colors=[colour], linewidths=1.8, linestyles=[dashes])


def _lines(
    axes: Axes,
    result: dict[str, Any],
    grid: ScanGrid,
    force: np.ndarray,
    found: Found,
    true: Sequence[np.ndarray],
) -> None:
    top = int(np.argmax(found.contrast))
    background, jnd = found.background, result["just_noticeable"]
    axes.axhspan(background * (1 - jnd), background * (1 + jnd), color=QUIET, alpha=0.25, lw=0)
    axes.axhline(background, color=QUIET, lw=0.8)
    for name, index, other, colour in (
        ("left to right", 0, grid.row == grid.row[top], RENDERED),
        ("bottom to top", 1, grid.column == grid.column[top], ACROSS),
    ):
        at = 1e3 * grid.plane[other, index]
        order = np.argsort(at)
        axes.plot(at[order], force[other][order], color=colour, lw=1.6, label=name)
        for mask in true:
            there = 1e3 * grid.plane[other & mask, index]
            if len(there):
                level = background * (1 - 1.6 * jnd) if index == 0 else background * (1 - 2.1 * jnd)
                axes.plot(
                    [there.min(), there.max()], [level, level], color=colour, lw=4, solid_capstyle="butt"
                )
    axes.set_ylim(bottom=min(force.min(), background * (1 - 2.6 * jnd)))
    axes.set_xlabel("along the line through the largest force, mm", fontsize=9, color=INK)
    axes.set_ylabel("normal force, N", fontsize=9, color=INK)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=8.5, colors=INK)
    axes.legend(loc="upper right", fontsize=8.5, frameon=False)
    note = f"grey: less than {100 * jnd:.0f} % from where nothing is felt"
    if any(mask.any() for mask in true):
        note += "; bars: where the region lies"
    axes.set_title(note, fontsize=9, color=INK)
