# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a tool of several tilts asks for: the upright one's places, every tilt pressed there, one field of all ways.

A tilt is pressed in both leans along the first tangent, and their mean is the node's: the runtime knows how far a tool
leans and not which way, and the mean is right to first order in how unlike the tissue is from side to side.  It also
hardly depends on which tangent is the first one, so that a reach may hold places where that jumps.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.field_stage import REACH_MARGIN, band_of_tool, coarsest_field
from palpate.author.held_out import quasi_static
from palpate.author.organ_stage import OrganMesh
from palpate.author.press_jobs import PressJob
from palpate.author.scene import Scene
from palpate.author.scene_tables import Tool
from palpate.author.shared_places import SharedPlaces
from palpate.author.tool_members import members_of
from palpate.author.tool_stage import shape_of
from palpate.author.tool_work import TRUTH, ladder
from palpate.author.ways_of_touching import (
    judged_ways,
    refuse_not_round,
    touching_error,
    ways_held_out,
    ways_judgement,
)
from palpate.fields.as_cooked import as_cooked
from palpate.fields.build_field import build_field
from palpate.fields.response_field import ContactGeometry, ResponseField

__all__ = ["WaysWork"]


class WaysWork(SharedPlaces):
    """A tool of several tilts; as a `ToolWork` it is upright.  Its members: upright, then each tilt in both leans."""

    def __init__(self, scene: Scene, mesh: OrganMesh, tool: Tool) -> None:
        tilts = tool.tilt or ()
        leans = [0.0, *(sign * tilt for tilt in tilts[1:] for sign in (1.0, -1.0))]
        members = members_of(scene, tool, leans)
        groups = [[0], *([2 * k + 1, 2 * k + 2] for k in range(len(tilts) - 1))]
        upright = shape_of(*members[0])
        refuse_not_round(scene, tool, upright)
        self._judged_ways = judged_ways(tilts)
        self._touching_error = touching_error(upright, tilts)
        told = lambda i: f"tilted by {np.degrees(leans[i]):.4g} deg"  # noqa: E731
        super().__init__(scene, mesh, tool, members, 0, told, groups)

    def _held_out(self, points: np.ndarray) -> list[PressJob]:
        depths, friction = ladder(self.depth_max), self._friction(points)
        return ways_held_out(points, self.shape, self._judged_ways, depths, friction, TRUTH, self.seed)

    def fit(self, geometry: ContactGeometry) -> ResponseField:
        """The field of the upright tool with its further ways."""
        (upright, nodes), *tilted = self._nodes(geometry)
        provenance = self._provenance(self._whole, self._named)
        provenance["ways"] = {
            "tilts": list(self._named.tilt or ()),
            "lean": "both ways along the first tangent, their mean",
            "touching_error": self._touching_error,
        }
        if self.failures:
            provenance["failed_presses"] = self.failures
        field = coarsest_field(
            lambda spacing: build_field(
                nodes,
                geometry,
                upright,
                self.samples.beyond(self._mesh),
                amplitude_spacing=spacing,
                margin=REACH_MARGIN,
                provenance=provenance,
                tilted=tilted,
                band=band_of_tool(self._whole, self._named),
            )
        )
        return as_cooked(field)

    def _judged(self, field: ResponseField, row: dict[str, Any]) -> dict[str, Any]:
        judged = ways_judgement(
            quasi_static(Path(row["rfield"]).read_bytes()),
            self._judged_ways,
            self._outcomes(self.held_jobs),
            self._outcomes(self.near_jobs),
            self._whole.accuracy.force_tolerance,
        )
        return {**judged, "touching_error": self._touching_error}
