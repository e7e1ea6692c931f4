# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""From press outcomes to a response field: the seam where the mechanics' arrays become the field's."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from palpate.author.organ_stage import OrganMesh
from palpate.author.painted_friction import friction_at
from palpate.author.press_jobs import PressOutcome
from palpate.author.sampling import ReachSamples
from palpate.author.scene import Scene
from palpate.author.scene_tables import Tool
from palpate.author.tool_members import members_of
from palpate.author.tool_stage import offset_of, reference_of, shape_of
from palpate.fem_offline.pose import tangents
from palpate.fields.as_cooked import as_cooked, rounded_geometry
from palpate.fields.band import tool_band
from palpate.fields.build_field import build_field
from palpate.fields.contact_geometry import contact_geometry
from palpate.fields.knots import knots_by_error
from palpate.fields.node_fit import LateralLadder, PressArrays, fit_nodes, uniform_knots, why_unusable
from palpate.fields.response_field import ContactGeometry, ResponseField

__all__ = [
    "band_of",
    "band_of_tool",
    "coarsest_field",
    "contact_geometry_of",
    "field_of",
    "field_unrounded",
    "is_fine_enough",
    "knots_of",
    "press_arrays",
    "shallowest_of",
]

SMALL_MOVE = 1e-4
"""m; the linear sticking stiffness is handed on as two moves this long."""
GEOMETRY_SPACINGS = (2e-3, 1.5e-3)
"""m; the first that keeps the signed distance within GEOMETRY_ERROR is taken, or the last."""
GEOMETRY_ERROR = 0.005
"""Of the least depth_max, at p99: 4 % of a force that goes with d^1.5 at 20 % of the depth; a hundredth has that."""
SPACING_IN_DEPTHS = 0.5
"""Coarsest geometry over the least depth_max; with 2 mm a family from 2.4 mm of depth on missed its 1 % (curvature)."""
AMPLITUDE_SPACINGS = (5e-3, 4e-3, 3e-3)
"""m; the first whose lattice loses at most REPRESENTATION_ERROR is taken, or the one that loses least."""
REPRESENTATION_ERROR = 0.007
"""Fraction of force at p95, between the kriged curves and the field: a fifth of the usual tolerance."""
SHARE_STEP = (0.9, 1.3)
"""Of the share of friction that is felt, from one depth that has it to the next: a ball's grows by some 15 %."""
REACH_MARGIN = 18.75e-3
"""m beyond the reach in which amplitudes fall to zero, and so geometry must be known."""


def band_of_tool(scene: Scene, tool: Tool) -> np.ndarray:
    """(2,) m of phi that a tool needs, in all its radii and tilts."""
    held = ((offset_of(shape_of(own, one)), own.depth_max(one)) for own, one in members_of(scene, tool))
    return tool_band(held)


def band_of(scene: Scene) -> tuple[float, float]:
    """(low, high) m of phi that all tools of the scene need."""
    low, high = zip(*(band_of_tool(scene, tool) for tool in scene.tool), strict=True)
    return min(low), max(high)


def contact_geometry_of(scene: Scene, mesh: OrganMesh, samples: ReachSamples) -> ContactGeometry:
    """The contact geometry that all tools of the scene share, rounded as their files will hold it."""
    low, high = band_of(scene)
    around = REACH_MARGIN + max(abs(low), abs(high)) + 5e-3
    bounds = np.stack([samples.points.min(axis=0) - around, samples.points.max(axis=0) + around])
    beyond = samples.beyond(mesh)
    shallowest = min(shallowest_of(scene, tool) for tool in scene.tool)
    *coarser, finest = GEOMETRY_SPACINGS
    for spacing in [*(one for one in coarser if one <= SPACING_IN_DEPTHS * shallowest), finest]:
        geometry = contact_geometry(
            mesh.distance, beyond, bounds, (low, high), spacing=spacing, reach_margin=REACH_MARGIN
        )
        if is_fine_enough(geometry, shallowest):
            break
    return rounded_geometry(geometry)


def shallowest_of(scene: Scene, tool: Tool) -> float:
    """m; the least depth_max of a tool's radii and tilts."""
    return min(own.depth_max(one) for own, one in members_of(scene, tool))


def is_fine_enough(geometry: ContactGeometry, shallowest: float) -> bool:
    """Whether a contact geometry serves a tool whose least depth_max is `shallowest` (m), or could not be finer."""
    spacing = geometry.signed_distance.spacing
    if spacing <= GEOMETRY_SPACINGS[-1]:
        return True
    return spacing <= SPACING_IN_DEPTHS * shallowest and geometry.error_p99 <= GEOMETRY_ERROR * shallowest


def _arrays(outcome: PressOutcome, friction: float | None) -> PressArrays:
    a = outcome.arrays
    normal, force = a["normal"], a["force_vector"]
    ladders = []
    if friction is not None:
        frame = tangents(normal)
        for k in range(1, len(a["depth"])):
            stiffness = a["sticking_stiffness"][k]
            if np.isnan(stiffness).any():
                continue
            s = SMALL_MOVE * frame
            change = -s @ stiffness
            work = -(s @ force[k]) + 0.5 * np.einsum("mi,ij,mj->m", s, stiffness, s)
            ladders.append(LateralLadder(float(a["depth"][k]), s, change, work))
    return PressArrays(
        a["contact_point"],
        normal,
        a["depth"],
        force,
        a["energy"],
        tuple(ladders),
        _felt_friction(a, friction) if friction else 0.0,
        outcome.key,
    )


def _felt_friction(arrays: dict[str, np.ndarray], friction: float) -> float | np.ndarray:
    """What a sliding tool feels of the coefficient at every point of its contact: rows (depth m, coefficient).

    Shares are taken down to the first depth at which one leaps: there the contact is about to fold, under an edge say,
    and what is so to first order in the coefficient is no longer so at any that matters.
    """
    depth, share = arrays["depth"], arrays["friction_share"]
    known = (depth > 0.0) & np.isfinite(share)
    depth, share = depth[known], share[known]
    ratio = share / np.concatenate([[1.0], share[:-1]])
    smooth = np.logical_and.accumulate((ratio >= SHARE_STEP[0]) & (ratio <= SHARE_STEP[1]))
    return np.stack([depth[smooth], friction * share[smooth]], axis=1) if smooth.any() else friction


def press_arrays(
    scene: Scene, tool: Tool, outcome: PressOutcome, mesh: OrganMesh | None = None
) -> tuple[PressArrays | None, str]:
    """A press as the field takes it, None where it cannot become a node; and what went wrong with it, in words.

    Args:
        mesh: the organ, whose paint may give the friction.
    """
    at = friction_at(scene.effects, tool.friction, mesh, np.array([outcome.job.contact_point]))
    friction = None if at is None else float(at[0])
    if len(outcome.arrays["depth"]) < 2:
        return None, outcome.values["reason"]
    press = _arrays(outcome, friction)
    why = why_unusable(press, scene.depth_max(tool))
    return (None if why else press), why or outcome.values["reason"]


def knots_of(scene: Scene, tool: Tool, presses: Sequence[PressArrays] | None = None) -> np.ndarray:
    """(K,) m, depths of the node curves: as many as the scene says, else what `presses` need, or a usual number before
    there are any.
    """
    depth_max = scene.depth_max(tool)
    if isinstance(scene.accuracy.knots, int):
        return uniform_knots(depth_max, scene.accuracy.knots)
    return uniform_knots(depth_max) if presses is None else knots_by_error(presses, depth_max)


def coarsest_field(build: Callable[[float], ResponseField]) -> ResponseField:
    """The field that `build` makes of an amplitude spacing (m), with the coarsest that represents it."""
    made = []
    for spacing in AMPLITUDE_SPACINGS:
        field = build(spacing)
        made.append(field)
        if _lost(field) <= REPRESENTATION_ERROR:
            return field
    return min(made, key=_lost)


def _lost(field: ResponseField) -> float:
    """The largest of its ways' errors between kriging and lattice, fraction of force at p95."""
    lost = [value for name, value in field.representation.items() if name.endswith("site_force_p95")]
    return max(lost, default=0.0)


def field_of(
    scene: Scene,
    tool: Tool,
    mesh: OrganMesh,
    samples: ReachSamples,
    geometry: ContactGeometry,
    outcomes: Sequence[PressOutcome],
    provenance: dict[str, Any],
) -> tuple[ResponseField, list[dict[str, Any]]]:
    """The field of one tool, and the presses that could not become nodes, each with its reason."""
    field, failures = field_unrounded(scene, tool, mesh, samples, geometry, outcomes, provenance)
    return as_cooked(field), failures


def field_unrounded(
    scene: Scene,
    tool: Tool,
    mesh: OrganMesh,
    samples: ReachSamples,
    geometry: ContactGeometry,
    outcomes: Sequence[PressOutcome],
    provenance: dict[str, Any],
) -> tuple[ResponseField, list[dict[str, Any]]]:
    """As `field_of`, before amplitudes and curves are rounded to what a file holds."""
    usable, failures = [], []
    for outcome in outcomes:
        press, reason = press_arrays(scene, tool, outcome, mesh)
        if press is not None:
            usable.append(press)
        if reason:
            point = list(outcome.job.contact_point)
            failures.append(
                {"tool": tool.name, "contact_point": point, "reason": reason, "hash": outcome.key}
            )
    if failures:
        provenance = {**provenance, "failed_presses": failures}
    reference = reference_of(tool.name, shape_of(scene, tool))
    nodes = fit_nodes(usable, knots_of(scene, tool, usable), reference.offset, geometry)
    field = coarsest_field(
        lambda spacing: build_field(
            nodes,
            geometry,
            reference,
            samples.beyond(mesh),
            amplitude_spacing=spacing,
            margin=REACH_MARGIN,
            provenance=provenance,
            band=band_of_tool(scene, tool),
        )
    )
    return field, failures
