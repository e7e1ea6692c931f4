# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A picture from rendered images: title, marks where they are seen, a colour scale beside."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from textwrap import fill

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, Normalize
from matplotlib.figure import Figure

from palpate.author.report.palette import INK, MARK
from palpate.author.report.projection import WINDOW, View

__all__ = ["Marks", "Scale", "compose"]


@dataclass(frozen=True)
class Marks:
    """Marks at places (n, 3) m; a colour, "none" for hollow ones, or a colour scale's name for values (n,)."""

    places: np.ndarray
    name: str
    symbol: str
    size: float
    colour: str
    values: np.ndarray | None = None
    labels: list[str] | None = None


@dataclass(frozen=True)
class Scale:
    """A colour scale (or its name) from `low` to `high`; `mark`: a value to mark on it, and what to write beside."""

    colours: str | Colormap
    low: float
    high: float
    unit: str
    mark: tuple[float, str] | None = None


def compose(
    path: Path,
    title: str,
    views: list[View],
    images: list[np.ndarray],
    marks: list[Marks],
    scale: Scale | None = None,
    note: str = "",
) -> None:
    """Writes the picture; views stand side by side.  `note` stands under the title, with a count of marks that no
    view shows."""
    wide = len(views)
    figure = Figure(
        figsize=(9.6 if wide == 1 else 15.0, 6.9 if wide == 1 else 6.2), dpi=150, facecolor="white"
    )
    right = 0.86 if scale else 1.0
    shown = [np.zeros(len(group.places), bool) for group in marks]
    for k, (view, image) in enumerate(zip(views, images, strict=True)):
        axes = figure.add_axes((k * right / wide, 0.0, right / wide, 0.9))
        axes.imshow(image, extent=(0, WINDOW[0], WINDOW[1], 0))
        axes.axis("off")
        for group, ever in zip(marks, shown, strict=True):
            pixels, seen = view.project(group.places)
            ever |= seen
            _mark(axes, group, pixels, seen, scale)
        axes.set(xlim=(0, WINDOW[0]), ylim=(WINDOW[1], 0))
        if k == 0 and len(marks) > 1:
            axes.legend(loc="upper left", fontsize=9.5, frameon=False, labelcolor=INK, handletextpad=0.4)
    if scale:
        _scale(figure, scale)
    figure.text(0.03, 0.965, title, fontsize=12.5, color=INK, va="center")
    hidden = sum(int(np.sum(~ever)) for ever in shown)
    if hidden:
        note += (
            f"{' ' if note else ''}{hidden} mark{'s are' if hidden > 1 else ' is'} out of sight from here."
        )
    figure.text(0.03, 0.945, fill(note, 125 if wide == 1 else 200), fontsize=9.5, color=INK, va="top")
    figure.savefig(path)


def _mark(axes, group: Marks, pixels: np.ndarray, seen: np.ndarray, scale: Scale | None) -> None:
    x, y = pixels[seen].T
    colour: dict = {"facecolors": group.colour}
    if group.values is not None and scale is not None:
        shades = colormaps[scale.colours](Normalize(scale.low, scale.high)(group.values[seen]))
        colour = {"facecolors": shades}
    dark = group.values is None and group.colour in (INK, MARK)
    edge, width = ("white", 0.7) if dark else (INK, 1.1)
    axes.scatter(
        x, y, s=group.size, marker=group.symbol, edgecolors=edge, linewidths=width, label=group.name, **colour
    )
    if group.labels:
        _label(axes, pixels[seen], [text for text, there in zip(group.labels, seen, strict=True) if there])


def _label(axes, places: np.ndarray, labels: list[str]) -> None:
    """Labels beside their marks, each on the first of four sides where it covers no other label or mark."""
    taken = [(x - 12.0, y - 12.0, x + 12.0, y + 12.0) for x, y in places]
    for (x, y), text in zip(places, labels, strict=True):
        width, height = 13.0 * len(text) + 8.0, 32.0
        sides = [(x + 14, y - 32), (x + 14, y + 2), (x - 14 - width, y - 32), (x - 14 - width, y + 2)]
        boxes = [(left, top, left + width, top + height) for left, top in sides]
        box = next((one for one in boxes if not any(_overlap(one, other) for other in taken)), boxes[0])
        taken.append(box)
        axes.text(
            0.5 * (box[0] + box[2]), 0.5 * (box[1] + box[3]), text, fontsize=9.5, color=INK, ha="center", va="center",
            bbox={"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.8},
        )  # fmt: skip


def _overlap(a: tuple[float, ...], b: tuple[float, ...]) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def _scale(figure: Figure, scale: Scale) -> None:
    bar = figure.add_axes((0.91, 0.2, 0.02, 0.5))
    drawn = figure.colorbar(ScalarMappable(Normalize(scale.low, scale.high), scale.colours), cax=bar)
    drawn.outline.set_visible(False)  # type: ignore[operator]
    bar.set_title(scale.unit, fontsize=10, color=INK, pad=10)
    bar.tick_params(labelsize=9, colors=INK, length=2)
    if scale.mark is not None:
        value, words = scale.mark
        bar.axhline(value, color="white", linewidth=1.6)
        bar.annotate(
            words, (0.0, value), xycoords=("axes fraction", "data"), xytext=(-6, 0),
            textcoords="offset points", ha="right", va="center", fontsize=9, color=MARK,
        )  # fmt: skip
