# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Curves of the worst held-out points as a picture: FEM and rendered, normal and lateral."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from palpate.author.report.numbers import asked, percent
from palpate.author.report.palette import FEM, INK, MARK, QUIET, RENDERED

__all__ = ["curve_picture"]


COLUMNS = 5
"""Presses in a row (count)."""


def curve_picture(path: Path, tool: dict[str, Any], noticeable: float) -> None:
    """Writes the curves of `tool`, one entry of the report's tools, to `path`; around FEM what nobody notices."""
    worst = [tool["held_out"][index] for index in tool["worst"]]
    columns = min(COLUMNS, len(worst))
    bands = -(-len(worst) // columns)
    figure = Figure(
        figsize=(2.6 * columns + 0.8, 4.6 * bands + 0.9), dpi=130, facecolor="white", layout="constrained"
    )
    grid = figure.subplots(2 * bands, columns, sharex=True, squeeze=False, height_ratios=[3, 2] * bands)
    for index, row in enumerate(worst):
        band, column = divmod(index, columns)
        depth = 1e3 * np.array(row["depth"])
        above, below = grid[2 * band, column], grid[2 * band + 1, column]
        above.set_title(f"no. {row['number']}: {percent(row['force_error_max'])}", fontsize=10, color=INK)
        fem = np.array(row["curves"]["fem"]["normal"])
        above.fill_between(
            depth, (1 - noticeable) * fem, (1 + noticeable) * fem, color=MARK, alpha=0.16, lw=0,
            label=f"within {asked(noticeable)} of finite elements",
        )  # fmt: skip
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
    for band in range(bands):
        grid[2 * band, 0].set_ylabel("normal force, N", fontsize=9)
        grid[2 * band + 1, 0].set_ylabel("lateral push, mN", fontsize=9)
        for column in range(columns):
            if band * columns + column >= len(worst):
                grid[2 * band, column].set_visible(False)
                grid[2 * band + 1, column].set_visible(False)
    legends = [axes.get_legend_handles_labels() for axes in (grid[0, 0], grid[1, 0])]
    handles, names = ([*a, *b] for a, b in zip(*legends, strict=True))
    figure.legend(handles, names, fontsize=8, frameon=False, loc="outside lower center", ncols=4)
    figure.suptitle(
        f"{tool['name']}: the worst held-out presses, by normal-force error", fontsize=11, color=INK
    )
    figure.savefig(path)
