# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""From presses to the effect `deformation`: how the surface moves, fitted on node presses and judged on held-out ones.

    error = |u(runtime's formula) - u(FEM)| / depth

at surface points that lie evenly (one in each cell of a twentieth of the distance judged), at every depth.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from palpate.author.press_jobs import PressOutcome
from palpate.author.tool_stage import ToolShape, contact_extent, solid_tool
from palpate.fem_offline.pose import Pose, tangents
from palpate.fem_offline.site import patch_size
from palpate.fields.deformation import Deformation, ToolGap, contact_of, deform
from palpate.fields.deformation_fit import SurfacePress, fit_deformation
from palpate.fields.deformation_layout import deformation_bytes, read_deformation
from palpate.fields.response_field import ResponseField

__all__ = ["gap_counts", "judged_deformation", "surface_press", "tool_gap", "with_deformation"]

WITHIN = 3.0
"""Errors are judged within so many tool radii of the contact."""
BEYOND_PATCH = 2.0
"""Radius within which the surface moves, over that of the patch that presses refine."""
GAP_STEPS = 48
"""Of the tool's signed distance, along the contact's extent."""


def tool_gap(shape: ToolShape, depth: float) -> ToolGap:
    """The tool's signed distance where tissue `depth` (m) deep may be."""
    tool, step = solid_tool(shape), contact_extent(shape, depth) / GAP_STEPS
    heights, distances = gap_counts(shape, depth)
    height, across = step * np.arange(-2, heights - 2), step * np.arange(distances)
    grid = np.stack(np.meshgrid(height, across, indexing="ij"), axis=-1)
    offset = tool.offset_along(
        np.array([0.0, 0.0, -1.0])
    )  # the lowest point lies so far below the reference point
    points = np.stack([grid[..., 1], np.zeros_like(grid[..., 1]), grid[..., 0] - offset], axis=-1)
    gap = tool.distance(points.reshape(-1, 3), Pose.upright(np.zeros(3))).gap
    return ToolGap(step, gap.reshape(grid.shape[:2]))


def gap_counts(shape: ToolShape, depth: float) -> tuple[int, int]:
    """Heights and distances of `tool_gap`."""
    step = contact_extent(shape, depth) / GAP_STEPS
    return int(np.ceil(1.5 * depth / step)) + 4, int(np.ceil(1.6 * GAP_STEPS))


def surface_press(outcome: PressOutcome, count: int) -> SurfacePress | None:
    """What a press says of the surface; None where it did not reach all `count` depths."""
    a = outcome.arrays
    if len(a["depth"]) != count + 1 or "surface_displacement" not in a:
        return None
    stuck = np.einsum("svxk,ky->svxy", a["surface_stuck"].astype(float), tangents(a["normal"]))
    return SurfacePress(
        a["contact_point"], a["normal"], a["depth"], a["surface_point"], a["surface_displacement"],
        a["surface_stuck_depth"], stuck,
    )  # fmt: skip


def with_deformation(
    field: ResponseField,
    shape: ToolShape,
    depths: Sequence[float],
    nodes: Sequence[PressOutcome],
    held_out: Sequence[PressOutcome],
) -> tuple[ResponseField, dict[str, Any]]:
    """`field` with the layer, and what was found.

    Args:
        depths: m; of the presses' ladders.
        nodes, held_out: what builds it and what judges it.
    """
    known = [press for press in (surface_press(one, len(depths)) for one in nodes) if press is not None]
    extent = contact_extent(shape, depths[-1])
    radius = BEYOND_PATCH * patch_size(solid_tool(shape), depths[-1]).radius
    made = fit_deformation(known, extent, radius, tool_gap(shape, depths[-1]))
    model = read_deformation(deformation_bytes(made))  # the numbers that the runtime reads
    judges = [press for press in (surface_press(one, len(depths)) for one in held_out) if press is not None]
    within = WITHIN * (dict(shape.parameters).get("radius") or extent)
    error = judged_deformation(field, model, judges, within)
    stored = {name: value for name, value in error.items() if isinstance(value, float)}
    data = deformation_bytes(replace(model, error=stored))
    found = {
        "error": error,
        "bytes": len(data),
        "nodes": len(known),
        "ranks": list(model.ranks),
        "radius": radius,
    }
    return replace(field, layers={**field.layers, "deformation": data}), found


def judged_deformation(
    field: ResponseField, model: Deformation, presses: Sequence[SurfacePress], within: float
) -> dict[str, Any]:
    """Errors of a deformation on presses that did not build it; empty without any.

    Returns:
        p50, p95, max: shares of the depth, within `within` (m) of the contact.  p50_m, p95_m, max_m: lengths.
        beyond_p95, beyond_max: shares of the depth farther away, on all of the surface that the presses know.
        still_p95: share of the depth that the surface moves there at all within `within`, for comparison.
    """
    shares, metres, beyond, still = [], [], [], []
    for press in presses:
        away = np.linalg.norm(press.point - press.contact_point, axis=1)
        cells = np.floor(press.point / (0.05 * within)).astype(int)
        some = np.unique(cells, axis=0, return_index=True)[1]
        near = away[some] < within
        for k, depth in enumerate(press.depth[1:].tolist(), 1):
            q = press.contact_point + (field.tool.offset - depth) * press.normal
            c, n, d, tip, axis = contact_of(field, q)
            u = deform(model, press.point[some], c, n, d, tip=tip, axis=axis)
            fem = press.displacement[k][some]
            miss = np.linalg.norm(u - fem, axis=1)
            metres.append(miss[near])
            shares.append(miss[near] / depth)
            beyond.append(miss[~near] / depth)
            still.append(np.linalg.norm(fem[near], axis=1) / depth)
    if not shares:
        return {}
    share, metre, far = np.concatenate(shares), np.concatenate(metres), np.concatenate(beyond)
    return {
        "within": within,
        "p50": float(np.percentile(share, 50)),
        "p95": float(np.percentile(share, 95)),
        "max": float(share.max()),
        "p50_m": float(np.percentile(metre, 50)),
        "p95_m": float(np.percentile(metre, 95)),
        "max_m": float(metre.max()),
        "beyond_p95": float(np.percentile(far, 95)) if len(far) else 0.0,
        "beyond_max": float(far.max(initial=0.0)),
        "still_p95": float(np.percentile(np.concatenate(still), 95)),
    }
