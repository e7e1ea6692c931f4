# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Tool families: balls of a few radii pressed at the same places, and a field of any radius between them.

What lies between is made when a field is cooked (fields/tool_family.py): a radius does not change in the hand, so the
tick pays nothing for it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from palpate.author.held_out import held_out_jobs
from palpate.author.press_jobs import PressJob
from palpate.author.tool_stage import ToolShape, reference_of
from palpate.fields.as_cooked import as_cooked
from palpate.fields.band import tool_band
from palpate.fields.build_field import build_field
from palpate.fields.response_field import ResponseField
from palpate.fields.tool_family import depth_between, nodes_of_radius

__all__ = [
    "FamilyRadius",
    "ball",
    "family_held_out",
    "field_of_radius",
    "file_name",
    "judged_radii",
    "radius_of",
]


@dataclass(frozen=True)
class FamilyRadius:
    """A radius at which a family is judged.

    Attributes:
        radius, depth: m; depth that its presses reach.
        pressed: whether nodes were pressed with it; otherwise it lies in the middle between two that were.
    """

    radius: float
    depth: float
    pressed: bool


def ball(radius: float) -> ToolShape:
    """The ball of a radius, m."""
    return ToolShape("sphere", (("radius", float(radius)),))


def radius_of(job: PressJob) -> float:
    """m, of the ball that a job presses."""
    return dict(job.tool.parameters)["radius"]


def file_name(name: str, radius: float) -> str:
    """Of the field of one radius (m) of the family `name`."""
    return f"{name}-{1e3 * radius:.6g}mm.rfield"


def judged_radii(radii: Sequence[float], depths: Sequence[float]) -> list[FamilyRadius]:
    """Radii of held-out presses, in turn: one of the pressed `radii` (m, rising, `depths` m), a middle between two."""
    pressed = [FamilyRadius(radius, depth, True) for radius, depth in zip(radii, depths, strict=True)]
    middles = [float(np.sqrt(a * b)) for a, b in pairwise(radii)]
    between = [FamilyRadius(r, depth_between(radii, depths, r), False) for r in middles]
    count = int(np.lcm(len(pressed), len(between)))
    return [(pressed, between)[k % 2][k // 2 % len((pressed, between)[k % 2])] for k in range(2 * count)]


def family_held_out(
    points: np.ndarray,
    judged: Sequence[FamilyRadius],
    friction: float | np.ndarray,
    fidelity: str,
    seed: int,
    drag: int = 0,
) -> list[PressJob]:
    """Jobs at points (n, 3) m, the radii of `judged` in turn; each pressed and moved as `held_out_jobs` does."""
    from palpate.author.tool_work import ladder

    jobs = {
        own: held_out_jobs(points, ball(own.radius), ladder(own.depth), friction, fidelity, seed, drag)
        for own in dict.fromkeys(judged)
    }
    return [jobs[judged[k % len(judged)]][k] for k in range(len(points))]


def field_of_radius(
    field: ResponseField, radius: float, beyond: Callable[[np.ndarray], np.ndarray], margin: float
) -> ResponseField:
    """The field of a family at `radius` (m).

    Args:
        beyond, margin: the reach as `build_field` takes it.

    Raises:
        FieldError: the radius lies outside the pressed ones.
    """
    nodes = nodes_of_radius(field.family, radius)
    if nodes is field.nodes:
        return field
    reference = reference_of(field.tool.name, ball(radius))
    pressed = [member.radius for member in field.family]
    provenance = {
        **field.provenance,
        "tool": reference.hash,
        "family": {"radius": radius, "pressed": pressed},
    }
    own = build_field(
        nodes,
        field.geometry,
        reference,
        beyond,
        amplitude_spacing=field.amplitudes.spacing,
        margin=margin,
        provenance=provenance,
        band=tool_band([(radius, float(nodes.depth_knots[-1]))]),
    )
    return replace(as_cooked(own), layers=field.layers)
