# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Curves of the worst held-out points as a picture: FEM and rendered, normal and lateral."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from palpate.author.report.numbers import percent
from palpate.author.report.palette import FEM, INK, QUIET, RENDERED

__all__ = ["curve_picture"]


def curve_picture(path: Path, tool: dict[str, Any]) -> None:
    """Writes the curves of `tool`, one entry of the report's tools, to `path`."""
    worst = [tool["held_out"][index] for index in tool["worst"]]
    figure = Figure(figsize=(3.1 * len(worst) + 0.6, 5.4), dpi=150, facecolor="white", layout="constrained")
    grid = figure.subplots(2, len(worst), sharex=True, squeeze=False, height_ratios=[3, 2])
    for column, row in enumerate(worst):
        depth = 1e3 * np.array(row["depth"])
        above, below = grid[0, column], grid[1, column]
        above.set_title(f"no. {row['number']}: {percent(row['force_error_max'])}", fontsize=10, color=INK)
        for axes, part, line, marker, word in (
            (above, "normal", "-", "o", ""),
            (below, "along", "-", "o", ", along the push"),
            (below, "across", ":", "x", ", across it"),
        ):
            scale = 1.0 if part == "normal" else 1e3
            said, fem = (scale * np.array(row["curves"][source][part]) for source in ("rendered", "fem"))
            axes.plot(depth, said, line, color=RENDERED, lw=1.6, label="rendered" + word)
            axes.plot(
                depth, fem, marker, color=FEM, mfc="none", ms=4.5, mew=1.1, label="finite elements" + word
            )
            axes.spines[["top", "right"]].set_visible(False)
            axes.tick_params(labelsize=8.5, colors=INK)
            axes.axhline(0, color=QUIET, lw=0.5)
        below.set_xlabel("depth, mm", fontsize=9)
        below.set_xlim(0, 1.04e3 * tool["field"]["depth_max"])
    grid[0, 0].set_ylabel("normal force, N", fontsize=9)
    grid[1, 0].set_ylabel("lateral push, mN", fontsize=9)
    grid[0, 0].legend(fontsize=8, frameon=False)
    handles, names = grid[1, 0].get_legend_handles_labels()
    figure.legend(handles, names, fontsize=8, frameon=False, loc="outside lower center", ncols=4)
    figure.suptitle(
        f"{tool['name']}: the worst held-out points, by normal-force error", fontsize=11, color=INK
    )
    figure.savefig(path)
