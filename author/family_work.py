# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a tool family asks for: one tool's places, every radius pressed at them, held-out presses at radii between too.

The largest radius chooses the places.  It is pressed deepest and its contact is widest, so it feels whatever a smaller
one feels, and more of what lies below and beside; a smaller one feels the same organ through a narrower window.
Held-out presses of every radius judge whether that was enough.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.field_stage import REACH_MARGIN, coarsest_field
from palpate.author.held_out import Beyond, judgement_of, percentiles, press_judgements, quasi_static
from palpate.author.organ_stage import OrganMesh
from palpate.author.press_jobs import PressJob, PressOutcome
from palpate.author.scene import Scene
from palpate.author.scene_tables import Tool
from palpate.author.shared_places import SharedPlaces
from palpate.author.tool_family import (
    FamilyRadius,
    family_held_out,
    field_of_radius,
    file_name,
    judged_radii,
    radius_of,
)
from palpate.author.tool_members import members_of
from palpate.author.tool_work import TRUTH, cooked
from palpate.fields.as_cooked import as_cooked
from palpate.fields.band import tool_band
from palpate.fields.build_field import build_field
from palpate.fields.response_field import ContactGeometry, FamilyMember, ResponseField

__all__ = ["FamilyWork", "family_judgement"]


class FamilyWork(SharedPlaces):
    """A tool of several radii; as a `ToolWork` it is its largest."""

    def __init__(self, scene: Scene, mesh: OrganMesh, tool: Tool) -> None:
        members = members_of(scene, tool)
        radii = tool.radius or ()
        self._radii = judged_radii(radii, [own.depth_max(member) for own, member in members])
        told = lambda i: f"radius {1e3 * radii[i]:.4g} mm"  # noqa: E731
        super().__init__(scene, mesh, tool, members, len(members) - 1, told)

    def _held_out(self, points: np.ndarray) -> list[PressJob]:
        return family_held_out(points, self._radii, self._friction(points), TRUTH, self.seed)

    def fit(self, geometry: ContactGeometry) -> ResponseField:
        """The field of the largest radius, with the node curves of all."""
        members = [FamilyMember(reference, nodes) for reference, nodes in self._nodes(geometry)]
        largest = members[-1]
        failed = {"failed_presses": self.failures} if self.failures else {}
        field = coarsest_field(
            lambda spacing: build_field(
                largest.nodes,
                geometry,
                largest.tool,
                self._beyond,
                amplitude_spacing=spacing,
                margin=REACH_MARGIN,
                provenance=self._provenance(self._whole, self._named) | failed,
                band=tool_band([(largest.tool.offset, float(largest.nodes.depth_knots[-1]))]),
            )
        )
        return replace(as_cooked(field), family=tuple(members))

    @property
    def _beyond(self) -> Beyond:
        return self.samples.beyond(self._mesh)

    def cook(self, out: Path, field: ResponseField) -> dict[str, Any]:
        """Writes a field of each pressed radius; the row is of the largest, with all under "radii"."""
        rows = []
        for member in field.family:
            own = field_of_radius(field, member.radius, self._beyond, REACH_MARGIN)
            row = cooked(out / file_name(field.tool.name, member.radius), own)
            rows.append({"radius": member.radius, "depth_max": own.depth_max, **row})
        return {
            **{key: rows[-1][key] for key in ("name", "rfield", "bytes", "representation")},
            "nodes": field.nodes.node_count,
            "radii": rows,
        }

    def _judged(self, field: ResponseField, row: dict[str, Any]) -> dict[str, Any]:
        return family_judgement(
            field,
            self._radii,
            self._outcomes(self.held_jobs),
            self._outcomes(self.near_jobs),
            self._whole.accuracy.force_tolerance,
            self._beyond,
        )


def family_judgement(
    field: ResponseField,
    radii: Sequence[FamilyRadius],
    outcomes: Sequence[PressOutcome],
    near: Sequence[PressOutcome],
    tolerance: float,
    beyond: Beyond,
) -> dict[str, Any]:
    """As `held_out.judgement`, each press by the field of its radius; and the errors by radius under "family".

    The tolerance is met where pressed radii and radii between, each by themselves, meet it.
    """
    from palpate.fields.cook import cook

    rows: list[dict[str, Any]] = [{} for _ in outcomes]
    own: dict[FamilyRadius, list[dict[str, Any]]] = {}
    for judged in dict.fromkeys(radii):
        at = [i for i, outcome in enumerate(outcomes) if radius_of(outcome.job) == judged.radius]
        if not at:
            continue
        rendered = quasi_static(cook(field_of_radius(field, judged.radius, beyond, REACH_MARGIN)))
        own[judged] = press_judgements(rendered, judged.radius, [outcomes[i] for i in at], beyond)
        for i, row in zip(at, own[judged], strict=True):
            rows[i] = {"radius": judged.radius, "radius_pressed": judged.pressed, **row}
    whole = judgement_of(rows, outcomes, near, tolerance)
    parts = {
        name: judgement_of([row for row in rows if row["radius_pressed"] == pressed], outcomes, [], tolerance)
        for name, pressed in (("pressed", True), ("between", False))
    }
    by_radius = [
        {
            "radius": one.radius,
            "depth": one.depth,
            "pressed": one.pressed,
            "points": len(found),
            "force_error": percentiles([error for row in found for error in row["force_error"]]),
        }
        for one, found in sorted(own.items(), key=lambda item: item[0].radius)
    ]
    family = {
        **{name: {key: part[key] for key in _PART} for name, part in parts.items()},
        "radii": by_radius,
    }
    met = all(part["met"] for part in parts.values() if part["points"])
    return {**whole, "met": bool(whole["met"] and met), "family": family}


_PART = ("points", "failed", "force_error", "lateral_error", "stuck_error", "slid_error", "met")
