# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The table at a glance: outcomes by axis."""

from __future__ import annotations

from pathlib import Path

import numpy as np

__all__ = ["overview"]

COLOURS = {"verified": "#2a7f62", "refused": "#b8b8b0", "wrong": "#c2342b"}
WORDS = {"verified": "converged and verified", "refused": "refused with reason", "wrong": "wrong"}


def overview(by_axis: dict[str, dict[str, int]], path: Path) -> None:
    """Draws the counts of `table.counted` as bars."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    axes = list(by_axis)
    figure = Figure(figsize=(8.5, 1.2 + 0.34 * len(axes)), layout="constrained")
    FigureCanvasAgg(figure)
    ax = figure.subplots()
    left = np.zeros(len(axes))
    for outcome, colour in COLOURS.items():
        count = np.array([by_axis[axis][outcome] for axis in axes])
        total = int(count.sum())
        ax.barh(range(len(axes)), count, left=left, color=colour, label=f"{WORDS[outcome]} ({total})")
        for y, (n, x) in enumerate(zip(count, left, strict=True)):
            if n:
                dark = outcome != "refused"
                ax.text(
                    x + n / 2,
                    y,
                    str(n),
                    ha="center",
                    va="center",
                    color="white" if dark else "black",
                    fontsize=9,
                )
        left += count
    ax.set_yticks(
        range(len(axes)),
        [axis.replace("_", " ").replace("poissons ratio", "Poisson's ratio") for axis in axes],
    )
    ax.invert_yaxis()
    ax.set_xlabel("cases")
    ax.spines[["top", "right"]].set_visible(False)
    figure.suptitle(f"What happens at the ends of every axis: {int(left.sum())} cases", x=0.01, ha="left")
    figure.legend(*ax.get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False)
    figure.savefig(path, dpi=150)
