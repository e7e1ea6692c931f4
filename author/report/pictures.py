# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of the report, for papers and for machines without a browser.

Surfaces are VTK's (render.py); marks, titles, scales and labels are matplotlib's, so that colours of marks are exact
and not shaded.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.report.composition import Marks, Scale, compose
from palpate.author.report.curve_picture import curve_picture
from palpate.author.report.device_map import DeviceMap
from palpate.author.report.device_picture import compose_device, device_caption, device_views
from palpate.author.report.gather import Sources
from palpate.author.report.maps import QUANTITIES, ReachMap
from palpate.author.report.numbers import asked, percent
from palpate.author.report.palette import ERRORS, MARK, NODE, ORGAN, REACH, VALUES
from palpate.author.report.projection import Mesh, View
from palpate.author.report.render import RenderFailure, render
from palpate.author.report.viewpoint import viewpoints

__all__ = ["NAMES", "pictures"]

NAMES = ("organ.png", "error_map.png", "stiffness_map.png", "worst_curves.png")
LABELS = 16
"""Largest count of held-out points that are labelled with their error; more would cover the organ."""
STIFFNESS_LEVEL = 2
"""Depth of the stiffness map: this index of ReachMap.depths (60 % of depth_max)."""


def pictures(
    folder: Path,
    sources: Sources,
    maps: list[ReachMap],
    report: dict[str, Any],
    device_maps: list[DeviceMap] | None = None,
) -> tuple[list[dict[str, str]], list[str]]:
    """Draws into `folder`; pictures of an earlier report go.

    The first tool's pictures have the plain names, those of others end in their name.  `device_maps`: one per field
    where the sources have a device.

    Returns:
        rows {file, caption} of what was drawn, and sentences about what was not.
    """
    made: list[dict[str, str]] = []
    notes: list[str] = []
    for old in folder.glob("*.png"):
        old.unlink()
    for index, (reach, tool) in enumerate(zip(maps, report["tools"], strict=True)):
        suffix = "" if index == 0 else f"_{tool['name']}"
        files = [folder / f"{Path(name).stem}{suffix}.png" for name in NAMES]
        try:
            views = _views(reach)
            held = device_views(reach, device_maps[index]) if device_maps else []
            images = render([*views, *held])
        except RenderFailure as failure:
            names = ", ".join(path.name for path in files[:3])
            notes.append(
                f"{names} could not be drawn on this machine: {failure} "
                "palpate doctor names the system packages that are missing."
            )
        else:
            made += _maps(files, views, images[: len(views)], reach, tool)
            if device_maps and sources.device:
                path = folder / f"device_map{suffix}.png"
                compose_device(
                    path, tool["name"], reach, device_maps[index], sources.device, held, images[len(views) :]
                )
                tool["device"]["picture"] = path.name
                what = f"{device_caption(tool['name'], sources.device)}: where it would hum"
                made.append({"file": path.name, "caption": what})
        if tool["worst"]:
            curve_picture(files[3], tool)
            made.append(
                {"file": files[3].name, "caption": f"{tool['name']}: curves of the worst held-out points"}
            )
    return made, notes


def _views(reach: ReachMap) -> list[View]:
    """Of the organ, the bare reach and its stiffness, from each viewpoint."""
    everything = np.concatenate([reach.vertices, reach.rest_vertices])
    shown = reach.vertices if len(reach.vertices) else everything
    rest = Mesh(reach.rest_vertices, reach.rest_triangles, ORGAN)
    bare = Mesh(reach.vertices, reach.triangles, REACH)
    stiff = Mesh(reach.vertices, reach.triangles, VALUES, reach.values["stiffness"][STIFFNESS_LEVEL])
    views = []
    for eye, up in viewpoints(reach):
        views.append(View(eye, up, everything, 1.1, [rest, bare]))
        views.append(View(eye, up, shown, 1.45, [rest, bare]))
        views.append(View(eye, up, shown, 1.45, [rest, stiff]))
    return views


def _maps(
    files: list[Path], views: list[View], images: list[np.ndarray], reach: ReachMap, tool: dict[str, Any]
) -> list[dict[str, str]]:
    name = tool["name"]
    held = [row for row in tool["held_out"] if row["force_error_max"] is not None]
    places = np.array([row["contact_point"] for row in held]).reshape(-1, 3)
    errors = np.array([row["force_error_max"] for row in held], float)
    tolerance = (tool["validation"] or {}).get("tolerance")
    top = 100 * max([2 * (tolerance or 0.0), *errors, 1e-6])
    depth = 1e3 * reach.depths[STIFFNESS_LEVEL]
    stiffness = reach.values["stiffness"][STIFFNESS_LEVEL]
    low, high = (float(stiffness.min()), float(stiffness.max())) if stiffness.size else (0.0, 1.0)
    what, unit = QUANTITIES["stiffness"]
    captions = [
        f"{name}: the reach (lighter), nodes and held-out points",
        f"{name}: largest normal-force error at each of {len(held)} held-out points",
        f"{name}: {what[0].lower() + what[1:]}, at {depth:.2g} mm depth",
    ]
    labels = [percent(error, 2) for error in errors] if len(held) <= LABELS else None
    marks = [*_nodes(tool), Marks(places, "held-out points", "o", 90.0, MARK)]
    balls = Marks(places, "held-out points", "o", 150.0, ERRORS, 100 * errors, labels)
    compose(files[0], captions[0], views[0::3], images[0::3], [group for group in marks if len(group.places)])
    if held:
        mark = None if tolerance is None else (100 * tolerance, f"asked\n{asked(tolerance)}")
        scale = Scale(ERRORS, 0.0, top, "error, %", mark)
        compose(files[1], captions[1], views[1::3], images[1::3], [balls], scale)
    compose(files[2], captions[2], views[2::3], images[2::3], [], Scale(VALUES, low, high, unit))
    drawn = zip(files, captions, (True, bool(held), True), strict=False)
    return [{"file": path.name, "caption": text} for path, text, there in drawn if there]


def _nodes(tool: dict[str, Any]) -> list[Marks]:
    """Nodes by kind; those that are not known to full depth are hollow."""
    marks = []
    for kind, name, symbol in (
        ("pressed", "nodes", "o"),
        ("extrapolated", "nodes, extrapolated below the depth reached", "D"),
        ("derived", "nodes, derived, not pressed", "s"),
    ):
        places = [row["position"] for row in tool["nodes"]["rows"] if row["kind"] == kind]
        if places:
            colour = NODE if kind == "pressed" else "none"
            marks.append(Marks(np.array(places), name, symbol, 20.0 if kind == "pressed" else 30.0, colour))
    return marks
