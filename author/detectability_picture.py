# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Which nodules are felt, as a picture: a panel a stiffness, a line a radius, and the just-noticeable difference."""

from __future__ import annotations

from pathlib import Path
from textwrap import fill
from typing import Any

from matplotlib.figure import Figure

from palpate.author.report.palette import INK, QUIET, RENDERED

__all__ = ["detectability_picture"]

COLOURS = (RENDERED, "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
MARKS = "osD^vP"
LEAST = 0.1
"""Percent; smaller contrasts are drawn there, as arrows would be."""


def detectability_picture(path: Path, result: dict[str, Any]) -> None:
    """Draws `result` of `detectability` to the PNG `path`."""
    stiffer = sorted({cell["stiffer"] for cell in result["cells"]})
    radii = sorted({cell["radius"] for cell in result["cells"]})
    figure = Figure(
        figsize=(max(7.5, 4.6 * len(stiffer) + 1.2), 5.4), dpi=130, facecolor="white", layout="constrained"
    )
    jnd = 100.0 * result["just_noticeable"]
    stopped = [cell for cell in result["cells"] if cell["contrast"] is None and cell.get("along")]
    panels = figure.subplots(1, len(stiffer), sharex=True, sharey=True, squeeze=False)[0]
    for axes, factor in zip(panels, stiffer, strict=True):
        axes.set_yscale("log")
        for k, radius in enumerate(radii):
            known = [
                (1e3 * cell["under"], max(LEAST, 100.0 * cell["contrast"]))
                for cell in result["cells"]
                if cell["contrast"] is not None and (cell["radius"], cell["stiffer"]) == (radius, factor)
            ]
            if known:
                x, y = zip(*sorted(known), strict=True)
                name = f"radius {1e3 * radius:g} mm"
                axes.plot(x, y, "-" + MARKS[k % 6], color=COLOURS[k % 6], ms=6, lw=1.5, label=name)
            for cell in stopped:
                if (cell["radius"], cell["stiffer"]) == (radius, factor):
                    at = (1e3 * cell["under"], max(LEAST, 100.0 * cell["along"][-1]))
                    axes.plot(*at, MARKS[k % 6], color=COLOURS[k % 6], mfc="white", ms=6)
                    axes.annotate(f"{1e3 * cell['reached']:.2g} mm deep", at, (6, 0), textcoords="offset points",
                                  va="center", fontsize=8, color=INK)  # fmt: skip
        axes.axhspan(LEAST, jnd, color=QUIET, alpha=0.2, lw=0)
        axes.axhline(jnd, color=INK, lw=0.9)
        axes.set_title(
            f"{factor:g} times as stiff ({1e-3 * factor * result['shear_modulus']:.3g} kPa shear modulus)",
            fontsize=9.5,
        )
        axes.set_xlabel("top of the nodule under the surface, mm", fontsize=9, color=INK)
        axes.spines[["top", "right"]].set_visible(False)
        axes.tick_params(labelsize=8.5, colors=INK)
        axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    panels[0].set_ylabel("more force than without it, %", fontsize=9, color=INK)
    panels[0].text(0.02, 0.97 * jnd, f"not noticeable below {jnd:g} %", transform=panels[0].get_yaxis_transform(),
                   va="top", fontsize=8.5, color=INK)  # fmt: skip
    shown = [100.0 * c["along"][-1] for c in result["cells"] if c.get("along")]
    panels[0].set_ylim(
        min([1.0, *(max(LEAST, 0.7 * value) for value in shown)]), max([20.0, *(1.4 * v for v in shown)])
    )
    lines = {
        line.get_label(): line
        for axes in panels
        for line in axes.get_lines()
        if "radius" in str(line.get_label())
    }
    if lines:  # a panel may lack a radius: its presses failed
        panels[-1].legend(handles=list(lines.values()), fontsize=8.5, frameon=False, loc="upper right")
    x, y, z = (f"{1e3 * v:.1f}" for v in result["contact_point"])
    figure.suptitle(
        f"{result['tool']} pressed {1e3 * result['depth']:.3g} mm deep into {result['scene']} at ({x}, {y}, {z}) mm, "
        f"{1e3 * result['force']:.0f} mN without a nodule",
        fontsize=11.5,
        color=INK,
    )
    hollow = " Hollow: a press that stopped before its depth, at its last state." if stopped else ""
    figure.supxlabel(fill(f"Modelled: {result['modelled']}.{hollow}", 110), fontsize=8, color=INK)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path)
