# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""One press as a picture: what the tool felt at each depth, and how far it may be believed.

Marks are the states that were solved; the lines between them only join them.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palpate.author.report.palette import FEM, INK, MARK, QUIET, RENDERED

__all__ = ["press_picture"]

ACROSS = "#009e73"
Panel = Callable[[Axes, dict[str, Any]], None]


def press_picture(path: Path, result: dict[str, Any]) -> None:
    """Draws `result`, what `palpate press --json` prints, to the PNG `path`."""
    panels: list[Panel] = [_energy, _area, _push]
    panels += [_sideways] if result["lateral"] else []
    panels += [_dragging] if result.get("drag") else []
    size = (max(11.0, 3.3 * len(panels)), 7.4)
    figure = Figure(figsize=size, dpi=130, facecolor="white", layout="constrained")
    above, below = figure.subfigures(2, 1, height_ratios=[1.2, 1.0])
    left, right = above.subplots(1, 2, width_ratios=[1.9, 1.0])
    _force(left, result)
    _facts(right, result)
    for panel, axes in zip(panels, below.subplots(1, len(panels)), strict=True):
        panel(axes, result)
    x, y, z = (f"{1e3 * v:.1f}" for v in result["contact_point"])
    title = f"{result['tool']['name']} pressed into {result['scene']} at ({x}, {y}, {z}) mm"
    figure.suptitle(title, fontsize=12, color=INK)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path)


def _plain(axes: Axes, x: str, y: str) -> None:
    axes.set_xlabel(x, fontsize=9, color=INK)
    axes.set_ylabel(y, fontsize=9, color=INK)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=8.5, colors=INK)
    axes.axhline(0.0, color=QUIET, lw=0.5, zorder=0)


def _depth_axis(axes: Axes, result: dict[str, Any], y: str) -> np.ndarray:
    """Depths in mm; the axis reaches to the depth that was asked for."""
    _plain(axes, "depth, mm", y)
    axes.set_xlim(0.0, 1.04e3 * result["depth_asked"])
    if not result["converged"]:
        axes.axvspan(1e3 * result["depth"][-1], 1.04e3 * result["depth_asked"], color=MARK, alpha=0.10, lw=0)
    return 1e3 * np.asarray(result["depth"])


def _in_unit(values: np.ndarray, unit: str) -> tuple[np.ndarray, str]:
    """Values and their unit, with m- or u- where the largest would otherwise start with 0.0."""
    top = float(np.nanmax(np.abs(values), initial=0.0))
    for factor, prefix in ((1.0, ""), (1e3, "m"), (1e6, "u")):
        if top * factor >= 0.1:
            return values * factor, prefix.replace("u", "µ") + unit
    return values, unit


def _force(axes: Axes, result: dict[str, Any]) -> None:
    force, unit = _in_unit(np.asarray(result["force"]), "N")
    depth = _depth_axis(axes, result, f"normal force, {unit}")
    axes.plot(depth, force, "-o", color=RENDERED, ms=5, lw=1.4, clip_on=False)
    axes.set_ylim(bottom=0.0)
    axes.annotate(
        f"{force[-1]:.3g} {unit}", (depth[-1], force[-1]), (-8, 2), textcoords="offset points",
        ha="right", fontsize=9, color=INK,
    )  # fmt: skip
    axes.set_title(
        "force on the tool along the surface's outward normal", fontsize=9.5, color=INK, loc="left"
    )


def _energy(axes: Axes, result: dict[str, Any]) -> None:
    energy, unit = _in_unit(np.asarray(result["energy"]), "J")
    depth = _depth_axis(axes, result, f"stored energy, {unit}")
    axes.plot(depth, energy, "-o", color=FEM, ms=4, lw=1.2)
    axes.set_ylim(bottom=0.0)
    axes.set_title("elastic energy in the tissue", fontsize=9.5, color=INK, loc="left")


def _area(axes: Axes, result: dict[str, Any]) -> None:
    depth = _depth_axis(axes, result, "contact area, mm²")
    axes.plot(depth, 1e6 * np.asarray(result["area"]), "-o", color=FEM, ms=4, lw=1.2)
    axes.set_ylim(bottom=0.0)
    axes.set_title("surface in contact (at rest)", fontsize=9.5, color=INK, loc="left")


def _push(axes: Axes, result: dict[str, Any]) -> None:
    force = np.asarray(result["force_vector"])
    along, unit = _in_unit(force @ np.asarray(result["tangents"]).T, "N")
    depth = _depth_axis(axes, result, f"lateral reaction, {unit}")
    for k, (colour, line, mark) in enumerate(((RENDERED, "-", "o"), (ACROSS, "--", "s"))):
        t = ", ".join(f"{v:.2f}" for v in result["tangents"][k])
        axes.plot(depth, along[:, k], line, marker=mark, color=colour, ms=4, lw=1.2, label=f"along ({t})")
    axes.legend(fontsize=8, frameon=False)
    title, top = "force along the surface, no friction", float(np.max(result["force"]))
    if top > 0.0:
        share = np.max(np.linalg.norm(force @ np.asarray(result["tangents"]).T, axis=1)) / top
        title += f":\nat most {100 * share:.2g} % of the normal force"
    axes.set_title(title, fontsize=9.5, color=INK, loc="left")


def _sideways(axes: Axes, result: dict[str, Any]) -> None:
    ladder = result["lateral"][-1]
    moves = np.asarray(ladder["deflection"])
    distance = 1e3 * np.linalg.norm(moves, axis=1)
    direction = moves[-1] / np.linalg.norm(moves[-1])
    normal = np.asarray(result["normal"])
    force = np.asarray(ladder["force_vector"])
    parts = np.column_stack([force @ direction, force @ np.cross(normal, direction)])
    parts, unit = _in_unit(parts, "N")
    _plain(axes, "sideways, mm", f"force on the tool, {unit}")
    axes.plot(distance, parts[:, 0], "-o", color=RENDERED, ms=4, lw=1.2, label="along the move")
    axes.plot(distance, parts[:, 1], "--s", color=ACROSS, ms=4, lw=1.2, label="across it")
    axes.legend(fontsize=8, frameon=False)
    axes.set_xlim(left=0.0)
    axes.set_title(
        f"stuck at {1e3 * ladder['depth']:.2f} mm and moved aside", fontsize=9.5, color=INK, loc="left"
    )


def _dragging(axes: Axes, result: dict[str, Any]) -> None:
    drag = result["drag"]
    _depth_axis(axes, result, "friction coefficient")
    depth = 1e3 * np.asarray(drag["depth"])
    one_way = np.asarray(drag["one_way"], float)
    axes.axhline(drag["given"], color=QUIET, lw=1.2, ls=":", label="given at each point")
    for k, (mark, word) in enumerate((("^", "one way"), ("v", "the other way"))):
        axes.plot(depth, one_way[:, k], mark, color=ACROSS, ms=5, mfc="none", label=word)
    axes.plot(
        depth, np.asarray(drag["friction"], float), "-o", color=RENDERED, ms=4, lw=1.2, label="both ways"
    )
    axes.legend(fontsize=8, frameon=False, loc="lower right")
    axes.set_ylim(bottom=0.0)
    law = "Amontons' law holds" if drag["amontons"] else "Amontons' law does NOT hold"
    title = drag["reason"] or f"dragged: {law},\nspread over depth {100 * drag['spread']:.2g} %"
    axes.set_title(title, fontsize=9.5, color=INK, loc="left")


def _facts(axes: Axes, result: dict[str, Any]) -> None:
    """What was pressed with what, and what stands behind the numbers."""
    axes.set_axis_off()
    tool, material = result["tool"], result["material"]
    rows = [
        ("tool", f"{tool['shape'].replace('_', ' ')}, {_parameters(tool['parameters'])}"),
        (
            "material",
            f"{material['model'].replace('_', '-')}, {1e-3 * material['shear_modulus']:.3g} kPa in shear",
        ),
        ("fidelity", f"{result['fidelity']}, {result['unknowns']} unknowns"),
        ("", ""),
        ("state", "converged" if result["converged"] else "NOT converged"),
        ("depth", f"{1e3 * result['depth'][-1]:.2f} of {1e3 * result['depth_asked']:.2f} mm"),
        ("residual", f"{result['residual']:.0e} of the force"),
        ("reaction error", f"{np.max(result['reaction_error']):.0e} of the force"),
        ("work - energy", f"{100 * result['work_mismatch']:.2f} % of the energy"),
        ("gap error", f"{1e6 * np.max(result['penetration']):.1f} µm"),
        ("time", f"{result['seconds']:.0f} s"),
    ]
    y = 0.97
    for name, text in rows:
        colour = MARK if text == "NOT converged" else INK
        axes.text(0.0, y, name, fontsize=9, color=QUIET, transform=axes.transAxes, va="top")
        axes.text(0.34, y, text, fontsize=9, color=colour, transform=axes.transAxes, va="top")
        y -= 0.083 if name or text else 0.035
    if result["reason"]:
        axes.text(
            0.0, y, result["reason"], fontsize=8, color=MARK, transform=axes.transAxes, va="top", wrap=True
        )


def _parameters(parameters: dict[str, Any]) -> str:
    """Lengths in mm, angles in degrees."""
    said = []
    for name, value in parameters.items():
        if name.endswith("angle"):
            said.append(f"{name.replace('_', ' ')} {np.degrees(value):.3g}°")
        elif isinstance(value, float):
            said.append(f"{name.replace('_', ' ')} {1e3 * value:.3g} mm")
    return ", ".join(said)
