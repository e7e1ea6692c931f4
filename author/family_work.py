# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a tool family asks for: one tool's places, every radius pressed at them, held-out presses at radii between too.

The largest radius chooses the places.  It is pressed deepest and its contact is widest, so it feels whatever a smaller
one feels, and more of what lies below and beside; a smaller one feels the same organ through a narrower window.
Held-out presses of every radius judge whether that was enough.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.field_stage import REACH_MARGIN, knots_of, press_arrays
from palpate.author.held_out import judgement_of, percentiles, press_judgements
from palpate.author.organ_stage import OrganMesh
from palpate.author.press_jobs import PressJob, PressOutcome
from palpate.author.radii import is_family, members_of
from palpate.author.scene import Scene
from palpate.author.scene_tables import Tool
from palpate.author.tool_family import (
    FamilyRadius,
    common_samples,
    family_held_out,
    field_of_radius,
    file_name,
    judged_radii,
    radius_of,
)
from palpate.author.tool_stage import reference_of, shape_of
from palpate.author.tool_work import TRUTH, ToolWork, cooked, ladder
from palpate.fields.as_cooked import as_cooked
from palpate.fields.build_field import build_field
from palpate.fields.node_fit import fit_nodes
from palpate.fields.response_field import ContactGeometry, FamilyMember, ResponseField

__all__ = ["FamilyWork", "family_judgement", "work_of"]

Reach = Callable[[np.ndarray], np.ndarray]


def work_of(scene: Scene, mesh: OrganMesh, tool: Tool) -> ToolWork:
    """What a scene's tool asks for, whether it has one radius or several."""
    return FamilyWork(scene, mesh, tool) if is_family(tool) else ToolWork(scene, mesh, tool)


class FamilyWork(ToolWork):
    """A tool of several radii; as a `ToolWork` it is its largest."""

    def __init__(self, scene: Scene, mesh: OrganMesh, tool: Tool) -> None:
        self._whole, self._family = scene, tool
        self._members = members_of(scene, tool)
        self._shapes = [shape_of(*member) for member in self._members]
        self._depths = [own.depth_max(member) for own, member in self._members]
        self._radii = judged_radii(tool.radius or (), self._depths)
        self._beside: dict[PressJob, PressOutcome | None] = {}
        samples = common_samples(mesh, scene.reach, self._shapes, self._depths)
        super().__init__(self._members[-1][0], mesh, self._members[-1][1], samples)

    def _held_out(self, points: np.ndarray) -> list[PressJob]:
        return family_held_out(points, self._radii, self._friction(points), TRUTH, self.seed)

    @property
    def presses_at_most(self) -> int:
        return super().presses_at_most + (len(self._members) - 1) * self.most

    def begin(
        self, geometry: Callable[[], ContactGeometry], width: int, out_of_time: Callable[[], bool]
    ) -> list[PressJob]:
        first = super().begin(geometry, width, out_of_time)
        seeds = first[: len(first) - len(self.held_jobs) - len(self.near_jobs)]
        return [*seeds, *self._others(seeds), *first[len(seeds) :]]

    def more(self) -> list[PressJob]:
        jobs = super().more()
        return [*jobs, *self._others(jobs)]

    def _others(self, jobs: Sequence[PressJob]) -> list[PressJob]:
        """The other radii at the places of `jobs`."""
        others = [self._at(job.contact_point, i) for job in jobs for i in range(len(self._members) - 1)]
        self._beside.update(dict.fromkeys(others))
        return others

    def _at(self, point: tuple[float, float, float], i: int) -> PressJob:
        depths = tuple(map(float, ladder(self._depths[i])))
        return PressJob(point, self._shapes[i], depths, self._whole.accuracy.fidelity)

    def arrived(self, outcome: PressOutcome) -> None:
        super().arrived(outcome)
        if outcome.job in self._beside:
            self._beside[outcome.job] = outcome

    @property
    def node_outcomes(self) -> list[PressOutcome]:
        return [*self.rounds.outcomes, *(outcome for outcome in self._beside.values() if outcome is not None)]

    def fit(self, geometry: ContactGeometry) -> ResponseField:
        """The field of the largest radius, with the node curves of all; a node needs every radius."""
        usable: list[list[Any]] = [[] for _ in self._members]
        for outcome in self.rounds.outcomes:
            beside = [
                self._beside[self._at(outcome.job.contact_point, i)] for i in range(len(self._members) - 1)
            ]
            outcomes = [*beside, outcome]
            read = [
                press_arrays(*member, one, self._mesh)
                for member, one in zip(self._members, outcomes, strict=True)
            ]
            for (_, reason), one in zip(read, outcomes, strict=True):
                if reason:
                    point = list(one.job.contact_point)
                    reason = f"radius {1e3 * radius_of(one.job):.4g} mm: {reason}"
                    self.failures.append(
                        {"tool": self.tool.name, "contact_point": point, "reason": reason, "hash": one.key}
                    )
            if all(press is not None for press, _ in read):
                for presses, (press, _) in zip(usable, read, strict=True):
                    presses.append(press)
        members = []
        for member, shape, presses in zip(self._members, self._shapes, usable, strict=True):
            reference = reference_of(self.tool.name, shape)
            nodes = fit_nodes(presses, knots_of(*member), reference.offset, geometry)
            members.append(FamilyMember(reference, nodes))
        largest = members[-1]
        failed = {"failed_presses": self.failures} if self.failures else {}
        field = build_field(
            largest.nodes,
            geometry,
            largest.tool,
            self._beyond,
            margin=REACH_MARGIN,
            provenance=self._provenance(self._whole, self._family) | failed,
        )
        return replace(as_cooked(field), family=tuple(members))

    @property
    def _beyond(self) -> Reach:
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
    beyond: Reach,
) -> dict[str, Any]:
    """As `held_out.judgement`, each press by the field of its radius; and the errors by radius under "family".

    The tolerance is met where pressed radii and radii between, each by themselves, meet it.
    """
    from palpate.fields.cook import cook
    from palpate.runtime import Field

    rows: list[dict[str, Any]] = [{} for _ in outcomes]
    own: dict[FamilyRadius, list[dict[str, Any]]] = {}
    for judged in dict.fromkeys(radii):
        at = [i for i, outcome in enumerate(outcomes) if radius_of(outcome.job) == judged.radius]
        if not at:
            continue
        rendered = Field.open(cook(field_of_radius(field, judged.radius, beyond, REACH_MARGIN)))
        own[judged] = press_judgements(rendered, judged.radius, [outcomes[i] for i in at])
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
