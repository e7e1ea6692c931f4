# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of the report, for papers and for machines without a browser.

Surfaces are VTK's (render.py); marks, titles, scales and labels are matplotlib's, so that colours of marks are exact
and not shaded.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.report.composition import Marks, Scale, compose
from palpate.author.report.curve_picture import curve_picture
from palpate.author.report.device_picture import compose_device, device_caption, device_views
from palpate.author.report.estimate import DEVIATIONS
from palpate.author.report.gather import Sources
from palpate.author.report.maps import QUANTITIES, ReachMap
from palpate.author.report.numbers import asked, percent
from palpate.author.report.on_reach import OnReach
from palpate.author.report.organ_figure import error_top, varies
from palpate.author.report.palette import ERRORS, MARK, NODES, ORGAN, REACH, VALUES
from palpate.author.report.projection import Mesh, View
from palpate.author.report.render import RenderFailure, render
from palpate.author.report.texture_part import draw_texture
from palpate.author.report.transient_part import draw_transient
from palpate.author.report.viewpoint import viewpoints

__all__ = ["pictures"]

LABELS = 16
"""Largest count of held-out points that are labelled with their error; more would cover the organ."""
STIFFNESS_LEVEL = 2
"""Depth of the stiffness map: this index of ReachMap.depths (60 % of depth_max)."""


def pictures(
    folder: Path, sources: Sources, reaches: list[OnReach], report: dict[str, Any]
) -> tuple[list[dict[str, str]], list[str]]:
    """Draws into `folder`; pictures of an earlier report go.

    The first tool's pictures have the plain names, those of others end in their name.

    Returns:
        rows {file, tool, caption} of what was drawn, and sentences about what was not.
    """
    made: list[dict[str, str]] = []
    notes: list[str] = []
    for old in [*folder.glob("*.png"), *folder.glob("*.wav")]:
        old.unlink()
    for index, (reach, tool) in enumerate(zip(reaches, report["tools"], strict=True)):
        suffix = "" if index == 0 else f"_{tool['name']}"
        drawn = _surfaces(reach, tool)
        held = device_views(reach.map, reach.device) if reach.device else []
        files = {one.name: folder / f"{one.name}{suffix}.png" for one in drawn}
        try:
            images = render([*(view for one in drawn for view in one.views), *held])
        except RenderFailure as failure:
            names = ", ".join(path.name for path in files.values())
            notes.append(
                f"{names} could not be drawn on this machine: {failure} "
                "palpate doctor names the system packages that are missing."
            )
        else:
            for one in drawn:
                mine, images = images[: len(one.views)], images[len(one.views) :]
                compose(files[one.name], one.caption, one.views, mine, one.marks, one.scale, one.note)
                row = {
                    "file": files[one.name].name,
                    "tool": tool["name"],
                    "caption": ". ".join(filter(None, (one.caption, one.note))),
                }
                made.append(row)
            if reach.device and sources.device:
                path = folder / f"device_map{suffix}.png"
                compose_device(path, tool["name"], reach.map, reach.device, sources.device, held, images)
                tool["device"]["picture"] = path.name
                what = f"{device_caption(tool['name'], sources.device)}: where it would hum"
                made.append({"file": path.name, "tool": tool["name"], "caption": what})
        if tool["texture"]:
            made += draw_texture(folder, sources.fields[index], tool["texture"], suffix)
        if tool["transient"]:
            made += draw_transient(folder, sources.fields[index], tool["transient"], suffix)
        if tool["worst"]:
            path = folder / f"worst_curves{suffix}.png"
            curve_picture(path, tool, report["just_noticeable_difference"])
            caption = f"{tool['name']}: curves of the worst held-out points"
            made.append({"file": path.name, "tool": tool["name"], "caption": caption})
    return made, notes


@dataclass(frozen=True)
class _Surface:
    """One picture of the organ from each viewpoint."""

    name: str
    caption: str
    views: list[View]
    marks: list[Marks]
    scale: Scale | None = None
    note: str = ""


def _surfaces(on_reach: OnReach, tool: dict[str, Any]) -> list[_Surface]:
    """Nodes, stiffness, friction where it differs from place to place, and errors."""
    reach, name = on_reach.map, tool["name"]
    held = [row for row in tool["held_out"] if row["force_error_max"] is not None]
    places = np.array([row["contact_point"] for row in held]).reshape(-1, 3)
    marks = [*_nodes(tool), Marks(places, "held-out presses", "o", 90.0, MARK)]
    bare = Mesh(reach.vertices, reach.triangles, REACH)
    everything = np.concatenate([reach.vertices, reach.rest_vertices])
    where = f"{name}: the reach (lighter), nodes by why they are there, and held-out presses"
    out = [
        _Surface("organ", where, _views(reach, bare, everything, 1.1), [g for g in marks if len(g.places)]),
        _map(reach, name, "stiffness", STIFFNESS_LEVEL, 1e3),
    ]
    if varies(reach.values["friction_coefficient"]):
        out.append(_map(reach, name, "friction_coefficient", -1, 1e3))
    if held or on_reach.error is not None:
        out.append(_errors(on_reach, tool, held, places, bare))
    return out


def _map(reach: ReachMap, tool: str, quantity: str, level: int, millimetres: float) -> _Surface:
    what, unit = QUANTITIES[quantity]
    values = reach.values[quantity][level]
    low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 1.0)
    caption = f"{tool}: {what[0].lower() + what[1:]}, at {millimetres * reach.depths[level]:.2g} mm depth"
    mesh = Mesh(reach.vertices, reach.triangles, VALUES, values)
    name = {"stiffness": "stiffness_map", "friction_coefficient": "friction_map"}[quantity]
    return _Surface(
        name, caption, _views(reach, mesh), [], Scale(VALUES, low, high, "" if unit == "1" else unit)
    )


def _errors(
    on_reach: OnReach, tool: dict[str, Any], held: list[dict[str, Any]], places: np.ndarray, bare: Mesh
) -> _Surface:
    """Measured errors as balls on the estimated ones, in the same colours."""
    reach, name = on_reach.map, tool["name"]
    errors = np.array([row["force_error_max"] for row in held], float)
    tolerance = (tool["validation"] or {}).get("tolerance")
    top = error_top(on_reach, tool)
    labels = [percent(error, 2) for error in errors] if len(held) <= LABELS else None
    marks = [Marks(places, "held-out presses", "o", 150.0, ERRORS, 100 * errors, labels)] if held else []
    mark = None if tolerance is None else (100 * tolerance, f"asked\n{asked(tolerance)}")
    measured = f"Balls: largest measured at each of {len(held)} held-out presses."
    mesh, parts = bare, [measured] if held else []
    if on_reach.error is not None:
        mesh = Mesh(reach.vertices, reach.triangles, ERRORS, 100 * on_reach.error, (0.0, top))
        parts.append(f"Surface: estimated from the nodes, {DEVIATIONS:g} standard deviations.")
    title = f"{name}: error of the normal force"
    scale = Scale(ERRORS, 0.0, top, "error, %", mark)
    return _Surface("error_map", title, _views(reach, mesh), marks, scale, " ".join(parts))


def _views(reach: ReachMap, mesh: Mesh, shown: np.ndarray | None = None, margin: float = 1.45) -> list[View]:
    """`mesh` on the organ from each viewpoint; the reach in the middle where `shown` (n, 3) m says nothing else."""
    if shown is None:
        shown = reach.vertices if len(reach.vertices) else reach.rest_vertices
    rest = Mesh(reach.rest_vertices, reach.rest_triangles, ORGAN)
    return [View(eye, up, shown, margin, [rest, mesh]) for eye, up in viewpoints(reach)]


def _nodes(tool: dict[str, Any]) -> list[Marks]:
    """Nodes by why they are there; those that are not known to full depth have a symbol of their own."""
    marks = []
    for kind, words, symbol in (
        ("pressed", "", "o"),
        ("extrapolated", ", stopped early", "D"),
        ("derived", ", not pressed", "s"),
    ):
        for why, told in (
            ("seed", "spread evenly"),
            ("region", "above a region"),
            ("error", "chosen by error"),
            ("unknown", ""),
        ):
            places = [r["position"] for r in tool["nodes"]["rows"] if (r["kind"], r["why"]) == (kind, why)]
            if places:
                name = f"nodes{', ' if told else ''}{told}{words}"
                marks.append(
                    Marks(np.array(places), name, symbol, 26.0 if kind == "pressed" else 34.0, NODES[why])
                )
    return marks
