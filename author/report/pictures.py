# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of the report, for papers and for machines without a browser.

The organ is rendered by VTK off screen in a process of its own (render.py): where OpenGL is missing VTK may end the
process instead of raising, and then the report says so and goes on.  Titles, scales and labels are matplotlib's.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from palpate.author.report.gather import Sources
from palpate.author.report.maps import QUANTITIES, ReachMap
from palpate.author.report.numbers import percent
from palpate.author.report.palette import ERRORS, FEM, INK, MARK, NODE, ORGAN, QUIET, REACH, RENDERED, VALUES
from palpate.author.report.render import Balls, Mesh, RenderFailure, View, render
from palpate.author.report.viewpoint import viewpoints

__all__ = ["pictures"]

BALL = 0.011
"""Radius of a held-out ball over the size of what is shown."""
LABELS = 14
"""Largest count of held-out points that are labelled with their error; more would cover the organ."""
STIFFNESS_LEVEL = 2
"""Depth of the stiffness map: this index of ReachMap.depths (60 % of depth_max)."""

NAMES = ("organ.png", "error_map.png", "stiffness_map.png", "worst_curves.png")


def pictures(
    folder: Path, sources: Sources, maps: list[ReachMap], report: dict[str, Any]
) -> tuple[list[dict[str, str]], list[str]]:
    """Draws into `folder`.

    The first tool's pictures have the plain names, those of others end in their name.

    Returns:
        rows {file, caption} of what was drawn, and sentences about what was not.
    """
    made: list[dict[str, str]] = []
    notes: list[str] = []
    for old in folder.glob("*.png"):
        old.unlink()
    for index, (field, reach, tool) in enumerate(zip(sources.fields, maps, report["tools"], strict=True)):
        files = [
            folder / (name if index == 0 else name.replace(".png", f"_{tool['name']}.png")) for name in NAMES
        ]
        try:
            images = _rendered(reach, tool, field.nodes.position)
        except RenderFailure as failure:
            notes.append(
                f"{', '.join(path.name for path in files[:3])} could not be drawn on this machine: {failure} "
                "`palpate doctor` names the system packages that are missing."
            )
        else:
            made += _composed(files, images, reach, tool)
        if tool["worst"]:
            _worst_curves(files[3], tool)
            made.append(
                {"file": files[3].name, "caption": f"{tool['name']}: curves of the worst held-out points"}
            )
    return made, notes


def _rendered(reach: ReachMap, tool: dict[str, Any], nodes: np.ndarray) -> list[Any]:
    """Images of organ, errors and stiffness, for each viewpoint."""
    everything = np.concatenate([reach.vertices, reach.rest_vertices])
    size = float(np.linalg.norm(np.ptp(everything, axis=0)))
    close = float(np.linalg.norm(np.ptp(reach.vertices, axis=0))) if len(reach.vertices) else size
    held = [row for row in tool["held_out"] if row["force_error_max"] is not None]
    places = np.array([row["contact_point"] for row in held]).reshape(-1, 3)
    errors = np.array([row["force_error_max"] for row in held])
    rest = Mesh(reach.rest_vertices, reach.rest_triangles, ORGAN)
    bare = Mesh(reach.vertices, reach.triangles, REACH)
    stiff = Mesh(reach.vertices, reach.triangles, VALUES, reach.values["stiffness"][STIFFNESS_LEVEL])
    shown = reach.vertices if len(reach.vertices) else everything
    views = []
    for eye, up in viewpoints(reach):
        whole = (eye, up, everything)
        near = (eye, up, shown)
        views += [
            View(*whole, [rest, bare], [Balls(nodes, 0.005 * size, NODE), Balls(places, 0.008 * size, MARK)]),
            View(*near, [rest, bare], [Balls(places, 1.6 * BALL * close, ERRORS, errors, _error_top(tool))]),
            View(*near, [rest, stiff], []),
        ]
    return render(views)


def _error_top(tool: dict[str, Any]) -> float:
    found = [row["force_error_max"] for row in tool["held_out"] if row["force_error_max"] is not None]
    return max([2 * (tool["validation"] or {}).get("tolerance", 0.0), *found, 1e-6])


def _composed(
    files: list[Path], images: list[Any], reach: ReachMap, tool: dict[str, Any]
) -> list[dict[str, str]]:
    name, nodes = tool["name"], tool["nodes"]
    held = [row for row in tool["held_out"] if row["force_error_max"] is not None]
    depth = 1e3 * reach.depths[STIFFNESS_LEVEL]
    stiffness = reach.values["stiffness"][STIFFNESS_LEVEL]
    captions = [
        f"{name}: the reach (lighter), {nodes['count']} nodes (small) and {len(held)} held-out points (large)",
        f"{name}: largest normal-force error at each of {len(held)} held-out points",
        f"{name}: {QUANTITIES['stiffness'][0].lower()} at {depth:.2g} mm, {QUANTITIES['stiffness'][1]}",
    ]
    _compose(files[0], captions[0], images[0::3])
    labels = [percent(row["force_error_max"], 2) for row in held] if len(held) <= LABELS else None
    _compose(
        files[1], captions[1], images[1::3], (ERRORS, 0.0, 100 * _error_top(tool), "error, %"), labels,
        100 * tool["validation"]["tolerance"] if tool["validation"] else None,
    )  # fmt: skip
    low, high = (float(stiffness.min()), float(stiffness.max())) if stiffness.size else (0.0, 1.0)
    _compose(files[2], captions[2], images[2::3], (VALUES, low, high, QUANTITIES["stiffness"][1]))
    return [{"file": path.name, "caption": text} for path, text in zip(files, captions, strict=False)]


def _compose(
    path: Path,
    title: str,
    images: list[Any],
    scale: tuple[str, float, float, str] | None = None,
    labels: list[str] | None = None,
    mark: float | None = None,
) -> None:
    """Images side by side under a title, a colour scale beside them, labels at the balls that can be seen."""
    figure = Figure(figsize=(9.6 if len(images) == 1 else 15.0, 6.9), dpi=150, facecolor="white")
    right = 0.88 if scale else 1.0
    for k, image in enumerate(images):
        axes = figure.add_axes((k * right / len(images), 0.0, right / len(images), 0.92))
        axes.imshow(image.pixels)
        axes.axis("off")
        for (x, y), seen, text in zip(image.places, image.seen, labels or [], strict=False):
            if seen:
                axes.annotate(
                    text, (x, y), xytext=(9, 7), textcoords="offset points", fontsize=9, color=INK,
                    bbox={"boxstyle": "round,pad=0.18", "fc": "white", "ec": "none", "alpha": 0.75},
                )  # fmt: skip
    if scale:
        colours, low, high, unit = scale
        bar = figure.add_axes((0.9, 0.2, 0.018, 0.52))
        shades = matplotlib.cm.ScalarMappable(Normalize(low, high), colours)
        drawn = figure.colorbar(shades, cax=bar)
        drawn.outline.set_visible(False)  # type: ignore[operator]
        bar.set_title(unit, fontsize=10, color=INK, pad=10)
        bar.tick_params(labelsize=9, colors=INK, length=2)
        if mark is not None and low <= mark <= high:
            bar.axhline(mark, color=MARK, linewidth=1.6)
            bar.annotate(
                "asked", (0.0, mark), xycoords=("axes fraction", "data"), xytext=(-5, 0),
                textcoords="offset points", ha="right", va="center", fontsize=9, color=MARK,
            )  # fmt: skip
    figure.text(0.03, 0.955, title, fontsize=12.5, color=INK, va="center")
    figure.savefig(path)


def _worst_curves(path: Path, tool: dict[str, Any]) -> None:
    """The page's curves of the worst points, on paper."""
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
            axes.plot(
                depth, row["curves"]["rendered"][part], line, color=RENDERED, lw=1.6, label="rendered" + word
            )
            axes.plot(
                depth, row["curves"]["fem"][part], marker, color=FEM, mfc="none", ms=4.5, mew=1.1,
                label="finite elements" + word,
            )  # fmt: skip
            axes.spines[["top", "right"]].set_visible(False)
            axes.tick_params(labelsize=8.5, colors=INK)
            axes.axhline(0, color=QUIET, lw=0.5)
        below.set_xlabel("depth, mm", fontsize=9)
    grid[0, 0].set_ylabel("normal force, N", fontsize=9)
    grid[1, 0].set_ylabel("lateral push, N", fontsize=9)
    grid[0, 0].legend(fontsize=8, frameon=False)
    handles, names = grid[1, 0].get_legend_handles_labels()
    figure.legend(handles, names, fontsize=8, frameon=False, loc="outside lower center", ncols=4)
    figure.suptitle(
        f"{tool['name']}: the worst held-out points, by normal-force error", fontsize=11, color=INK
    )
    figure.savefig(path)
