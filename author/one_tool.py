# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""One tool of a scene, added to an asset that holds others, or put in its own place there.

What does not depend on the tool is the asset's: organ, reach and contact geometry.  Whether they are the scene's is
found out before anything is pressed.  The other tools' files are not touched.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from palpate.author.errors import InputError, InputProblem
from palpate.author.field_stage import band_of_tool, is_fine_enough, shallowest_of
from palpate.author.scene import Scene
from palpate.author.scene_tables import Tool
from palpate.fields.organ_geometry import OrganGeometry, organ_hash
from palpate.fields.response_field import ContactGeometry
from palpate.fields.usd_read import interface_path, read_contact, read_field, stored_hashes, tools

__all__ = ["asset_geometry", "chosen_tools", "with_other_tools"]

SLACK = 1e-9
"""m; by which bands are compared."""


def chosen_tools(scene: Scene, name: str) -> list[Tool]:
    """The scene's tool of that name; all of them where it is empty.  Raises InputError."""
    chosen = [tool for tool in scene.tool if name in ("", tool.name)]
    if not chosen:
        known = "one of " + ", ".join(tool.name for tool in scene.tool)
        raise InputError(InputProblem("", "--tool", name, "is no tool of this scene", known))
    return chosen


def asset_geometry(scene: Scene, tool: Tool, organ: OrganGeometry, folder: Path) -> ContactGeometry | None:
    """The contact geometry of the asset in `folder`, when `tool` can be added to it; None where there is no asset.

    Raises:
        InputError: the asset is of another organ, material, mesh, support, region or reach (of its first tool), or is
            not known as deep, as far out or as finely as the tool needs.
    """
    if not any(not path.name.startswith(".") for path in folder.glob("*.usda")):
        return None
    interface = interface_path(folder)
    everything = (
        "--out with another folder, or the whole scene again without --tool: what was pressed is kept"
    )
    if interface.stem != organ.name or stored_hashes(interface)[0] != organ_hash(organ):
        what = "holds an asset whose organ, material, mesh, supports, regions or reach are not this scene's"
        raise InputError(InputProblem(str(interface), "--tool", tool.name, what, everything))
    for other in tools(interface):  # what cannot be read must not be found out after hours of presses
        if other != tool.name:
            read_field(interface, other)
    geometry = read_contact(interface)
    low, high = band_of_tool(scene, tool)
    if low < geometry.band[0] - SLACK or high > geometry.band[1] + SLACK:
        known, needed = (_millimetres(*band) for band in (geometry.band, (low, high)))
        what = f"needs the organ's distance known {needed} from the surface; this asset knows it {known}"
        raise InputError(InputProblem(str(interface), "--tool", tool.name, what, everything))
    shallowest = shallowest_of(scene, tool)
    if not is_fine_enough(geometry, shallowest):
        spacing, error = geometry.signed_distance.spacing, geometry.error_p99
        what = (
            f"presses {1e3 * shallowest:.1f} mm deep, for which this asset's contact geometry is too coarse: every "
            f"{1e3 * spacing:.1f} mm, off by {1e6 * error:.0f} um at the 99th percentile"
        )
        raise InputError(InputProblem(str(interface), "--tool", tool.name, what, everything))
    return geometry


def _millimetres(low: float, high: float) -> str:
    return f"from {1e3 * low:.1f} to {1e3 * high:.1f} mm"


def with_other_tools(summary: dict[str, Any], folder: Path, names: Sequence[str]) -> dict[str, Any]:
    """`summary` with what the folder's last summary said of the other tools; times and versions are of this run.

    Args:
        names: of the asset's tools.  Those that no summary speaks of are listed under "not_judged", and no tolerance
            is said to be met then.
    """
    before: dict[str, Any] = {}
    with suppress(OSError, ValueError):
        before = json.loads((folder / "summary.json").read_text())
    rows = {row["name"]: row for row in (*before.get("tools", []), *summary["tools"]) if row["name"] in names}
    new = {row["name"] for row in summary["tools"]}
    kept = [failure for failure in before.get("failures", []) if failure["tool"] not in new]
    not_judged = [name for name in names if name not in rows]
    return {
        **summary,
        "tools": list(rows.values()),
        "not_judged": not_judged,
        "tolerance_met": not not_judged and all(row["met"] for row in rows.values()),
        "failures": [*(failure for failure in kept if failure["tool"] in names), *summary["failures"]],
    }
