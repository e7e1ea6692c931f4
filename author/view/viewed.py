# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What the live view shows and feels: an organ, and tools with their cooked fields and maps.

From an asset's folder everything is known.  An .rfield alone knows the organ's surface near its reach, and no nodes
and no held-out presses.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from palpate.author.errors import InputError, InputProblem
from palpate.author.report.held_out_rows import held_out_rows
from palpate.author.report.maps import QUANTITIES, ReachMap, reach_map
from palpate.fields.organ_geometry import OrganGeometry
from palpate.fields.response_field import ResponseField, ToolReference
from palpate.runtime import Field

__all__ = ["HELD_OUT_ERROR", "MAPS", "ViewedOrgan", "ViewedTool", "viewed"]

HELD_OUT_ERROR = "held_out_error"
MAPS = {
    **QUANTITIES,
    "friction": ("Friction coefficient", ""),
    HELD_OUT_ERROR: ("Largest error of the nearest held-out press", "%"),
}
"""Name and unit of each map over the reach."""


@dataclass(frozen=True)
class ViewedTool:
    """One cooked field.

    Attributes:
        name: of the variant; of a family's member with its radius.
        field: as USD or the .rfield hold it.
        runtime: the same, opened by the runtime.
        organ: what it presses.
        held_out: rows of validation/<tool>.json, as the report has them.
    """

    name: str
    field: ResponseField
    runtime: Field
    organ: OrganGeometry
    held_out: list[dict[str, Any]] = field(default_factory=list)

    @cached_property
    def reach(self) -> ReachMap:
        """Takes seconds."""
        return reach_map(self.organ, self.field)

    def map_values(self, key: str, level: int) -> np.ndarray:
        """(V,) of the map `key` of MAPS at reach.depths[level], at the vertices of `reach`."""
        if key in self.reach.values:
            return self.reach.values[key][level]
        if key == HELD_OUT_ERROR:
            return self._error_of_nearest_press()
        q = self.reach.feet + (self.offset() - self.reach.depths[level]) * self.reach.normals
        return self.runtime.sample(q)["friction_coefficient"]

    def _error_of_nearest_press(self) -> np.ndarray:
        """(V,) %, of the normal force at any depth; nothing where nothing was judged."""
        judged = [row for row in self.held_out if row["force_error_max"] is not None]
        if not judged:
            return np.zeros(len(self.reach.feet))
        nearest = cKDTree([row["contact_point"] for row in judged]).query(self.reach.feet)[1]
        return 100.0 * np.array([row["force_error_max"] for row in judged])[nearest]

    def offset(self, cosine: float = 1.0) -> float:
        """rho, m, held so that the tool's axis has this cosine with the normal; between ways as the runtime blends."""
        info = self.runtime.info
        if info.way_count == 1:
            return info.tool_offset
        return float(np.interp(cosine, info.way_cosine[::-1], info.way_offset[::-1]))

    @property
    def tilt_max(self) -> float:
        """rad; 0 where the field knows one way of touching."""
        info = self.runtime.info
        return float(np.arccos(np.clip(info.way_cosine[-1], -1.0, 1.0))) if info.way_count > 1 else 0.0


@dataclass(frozen=True)
class ViewedOrgan:
    """Attributes: path: as the user gave it; tools: by name, at least one."""

    path: Path
    organ: OrganGeometry
    tools: dict[str, ViewedTool]


def viewed(path: Path) -> ViewedOrgan:
    """`path`: an asset folder, its interface layer, or an .rfield.

    Raises:
        InputError: no such file, or a tool that was not cooked.  FieldError or RuntimeFailure: it is damaged.
    """
    if not path.exists():
        raise InputError(InputProblem(str(path), "", None, "does not exist", "an asset folder or an .rfield"))
    return _of_rfield(path) if path.is_file() and path.suffix == ".rfield" else _of_asset(path)


def _of_rfield(path: Path) -> ViewedOrgan:
    from palpate.author.report.known_surface import known_surface
    from palpate.fields.rfield_read import read_rfield

    runtime = Field.open(path)  # proves the file
    known = read_rfield(path)
    organ = known_surface(known)
    name = known.tool.name
    return ViewedOrgan(path, organ, {name: ViewedTool(name, known, runtime, organ)})


def _of_asset(path: Path) -> ViewedOrgan:
    from palpate.author.tool_family import file_name
    from palpate.fields.rfield_read import read_rfield
    from palpate.fields.usd_read import read_field, read_organ, tools

    folder = path if path.is_dir() else path.parent
    organ = read_organ(path)
    found: dict[str, ViewedTool] = {}
    problems: list[InputProblem] = []

    def opened(file: Path, tool: ToolReference) -> Field | None:
        """The cooked field, where it is there and of this tool."""
        again = f"palpate cook {folder}"
        if not file.is_file():
            problems.append(InputProblem(str(file), "", None, "does not exist", f"a cooked field: {again}"))
            return None
        runtime = Field.open(file)
        if runtime.info.tool_hash != tool.hash:
            what = "was cooked for another tool than the asset's of that name"
            problems.append(InputProblem(str(file), "", None, what, again))
            return None
        return runtime

    for name in tools(path):
        known = read_field(path, name)
        rows = _held_out(folder / "validation" / f"{name}.json")
        if not known.family:
            if runtime := opened(folder / f"{name}.rfield", known.tool):
                found[name] = ViewedTool(name, known, runtime, organ, rows)
            continue
        for one in known.family:
            file, shown = folder / file_name(name, one.radius), f"{name}, {1e3 * one.radius:.4g} mm"
            if runtime := opened(file, one.tool):
                own = [row for row in rows if row["radius"] and np.isclose(row["radius"], one.radius)]
                cooked = replace(read_rfield(file), tool=one.tool, nodes=one.nodes)
                found[shown] = ViewedTool(shown, cooked, runtime, organ, own)
    if problems:
        raise InputError(problems)
    return ViewedOrgan(path, organ, found)


def _held_out(path: Path) -> list[dict[str, Any]]:
    if not path.is_file():
        return []
    return held_out_rows(json.loads(path.read_text(encoding="utf-8")))
