# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""`palpate scan`: feel an asset as a hand would, sliding over its reach at constant depth, and draw the force.

The runtime's own session is moved over a grid (scan_grid.py), row after row and back, at SPEED in ticks of 1 ms with
the field's friction; where a row is interrupted the tool lifts and comes down again.  At each grid point the force on
the hand is read.  What the map says about hidden regions is held against the scene (scan_found.py).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from palpate.author.authored_tool import AuthoredTool, authored_tool
from palpate.author.errors import InputError, InputProblem, PalpateError
from palpate.author.report.verdict import JUST_NOTICEABLE
from palpate.author.scan_found import Found, against_truth, find, shadow
from palpate.author.scan_grid import FEWEST, SQUARES, ScanGrid, scan_grid
from palpate.fem_offline.pose import tilted

__all__ = ["SPEED", "scan", "scan_lines", "slide"]

SPEED, TICK = 20e-3, 1e-3
"""m/s along the surface, s."""
APPROACH = 1e-3
"""m; the tool comes down from so far outside."""
CONTACT = 2
"""palpate_region of a point in contact."""


def scan(
    asset: Path,
    tool: str | None = None,
    depth: float | None = None,
    step: float | None = None,
    picture: Path | None = None,
) -> dict[str, Any]:
    """Scans one tool's reach (the first tool's when none is named).

    Args:
        depth: m; three quarters of the field's when None.
        step: m between rows and readings; see scan_grid.
        picture: PNG that is drawn.

    Returns:
        What `palpate scan --json` prints.

    Raises:
        InputError: no such tool, a depth beyond the field's, a step that leaves nothing, a picture that is none.
        PalpateError: no grid point is in contact.
    """
    from palpate.author.held_out import quasi_static
    from palpate.fields.cook import cook
    from palpate.runtime import Config, Session

    if picture is not None and picture.suffix.lower() != ".png":
        raise InputError(InputProblem("", "--out", str(picture), "is no picture", "a name that ends in .png"))
    authored = authored_tool(asset, tool)
    deepest = float(authored.field.depth_max)
    depth = 0.75 * deepest if depth is None else depth
    if not 0.0 < depth <= deepest:
        what = f"is not within what {authored.field.tool.name} was pressed"
        raise InputError(
            InputProblem(str(asset), "--depth", depth, what, f"above 0, at most {1e3 * deepest:g} mm")
        )
    try:
        grid = scan_grid(authored.mesh, authored.samples, step)
    except ValueError as error:
        raise _unusable_step(asset, step, str(error)) from None
    session = Session(quasi_static(cook(authored.field)), Config())
    responses = slide(session, grid, authored.field.tool.offset, depth, authored.shape.tilt)
    felt = responses["region"] == CONTACT
    if not felt.any():
        raise PalpateError(f"{asset}: the runtime is in contact at none of {len(felt)} grid points")
    grid, responses = _kept(grid, felt), responses[felt]
    normal = responses["normal"]
    force = np.sum(responses["force"] * normal, axis=1)
    aside = np.linalg.norm(responses["force"] - force[:, None] * normal, axis=1)
    found = find(grid, force)
    if not found.inside.any():
        raise _unusable_step(asset, grid.step, f"leaves {len(force)} places, too few to see a border in")
    regions = _regions(authored, grid, found)
    result: dict[str, Any] = {
        "asset": str(asset),
        "tool": authored.field.tool.name,
        "depth": depth,
        "step": grid.step,
        "points": len(force),
        "not_in_contact": int((~felt).sum()),
        "unseen": grid.unseen,
        "force": _spread(force),
        "aside": _spread(aside),
        "background": found.background,
        "contrast": found.peak,
        "just_noticeable": JUST_NOTICEABLE,
        "noticeable": found.peak >= JUST_NOTICEABLE,
        "found": {
            "centre": np.average(grid.points[found.inside], axis=0, weights=grid.area[found.inside]),
            "area": float(grid.area[found.inside].sum()),
        },
        "regions": [row for row, _ in regions],
        "picture": None if picture is None else str(picture),
    }
    if picture is not None:
        from palpate.author.scan_picture import scan_picture

        scan_picture(picture, result, grid, force, found, [true for _, true in regions])
    return result


def slide(session: Any, grid: ScanGrid, offset: float, depth: float, tilt: float) -> np.ndarray:
    """The runtime's response (n,) at each grid point, reached by sliding `depth` (m) deep.

    Args:
        offset: rho of the tool, m.  tilt: rad, how it is held against the surface.
    """
    at = grid.points + (offset - depth) * grid.normals
    away = grid.points + (offset + APPROACH) * grid.normals
    held = Rotation.from_matrix(np.array([tilted(n, tilt) for n in grid.normals])).as_quat()
    stride = SPEED * TICK
    order = np.lexsort((np.where(grid.row % 2, -grid.column, grid.column), grid.row))
    positions, orientations, read = [], [], []
    count, before = 0, -1
    for k in order:
        beside = (
            before >= 0
            and max(abs(grid.row[k] - grid.row[before]), abs(grid.column[k] - grid.column[before])) <= 1
        )
        legs = [at[k]] if beside else ([away[before]] if before >= 0 else []) + [away[k], at[k]]
        here = at[before] if before >= 0 else away[k]
        for leg in legs:
            ticks = max(1, int(np.ceil(np.linalg.norm(leg - here) / stride)))
            share = np.arange(1, ticks + 1)[:, None] / ticks
            positions.append(here + share * (leg - here))
            orientations.append(np.tile(held[k], (ticks, 1)))
            here, count = leg, count + ticks
        read.append(count - 1)
        before = int(k)
    responses = session.tick_batch(np.concatenate(positions), TICK, np.concatenate(orientations))
    inverse = np.empty(len(order), int)
    inverse[order] = np.arange(len(order))
    return responses[np.array(read)[inverse]]


def _unusable_step(asset: Path, step: float | None, what: str) -> InputError:
    expected = f"a length above 0 that makes {2 * FEWEST} to {SQUARES} places"
    return InputError(InputProblem(str(asset), "--step", step, what, expected))


def scan_lines(result: dict[str, Any]) -> str:
    """The answer as people read it."""
    force, share = result["force"], 100.0 * result["contrast"]
    lines = [
        f"{result['tool']}, {1e3 * result['depth']:.2f} mm deep, {result['points']} places "
        f"{1e3 * result['step']:.2f} mm apart",
        f"normal force {force['min']:.4f} to {force['max']:.4f} N, {result['background']:.4f} N where nothing is felt",
        f"{share:.1f} % more at most: "
        + ("noticeable" if result["noticeable"] else "not noticeable")
        + f" ({100 * result['just_noticeable']:.0f} %)",
    ]
    for region in result["regions"]:
        if region["overlap"] is None:
            lines.append(f"{region['name']}: {region['why']}")
            continue
        lines.append(
            f"{region['name']}, {1e3 * region['under']:.1f} mm under the surface: overlap {region['overlap']:.2f}, "
            f"centre {1e3 * region['centre_error']:.2f} mm off, radius {1e3 * region['radius_found']:.2f} mm for "
            f"{1e3 * region['radius_true']:.2f} mm"
        )
    if result["unseen"]:
        lines.append(f"{100 * result['unseen']:.1f} % of the reach faces away and was not scanned")
    return "\n".join(lines + ([result["picture"]] if result["picture"] else []))


def _kept(grid: ScanGrid, mask: np.ndarray) -> ScanGrid:
    from dataclasses import replace

    names = ("column", "row", "points", "normals", "area")
    return replace(grid, **{name: getattr(grid, name)[mask] for name in names})


def _regions(authored: AuthoredTool, grid: ScanGrid, found: Found) -> list[tuple[dict[str, Any], np.ndarray]]:
    """One row for each region of the scene, with its shadow (n,) bool."""
    rows = []
    for k, region in enumerate(authored.mesh.regions, start=1):
        true, under = shadow(authored.mesh, grid, k)
        row: dict[str, Any] = {"name": region.name, "under": under, "overlap": None}
        if under is None:
            row["why"] = "lies under no place that was scanned"
        elif not found.peak >= JUST_NOTICEABLE:
            row["why"] = f"hidden: no force is {100 * JUST_NOTICEABLE:.0f} % above the rest"
        else:
            row |= against_truth(grid, found.inside, true)
        rows.append((row, true))
    return rows


def _spread(values: np.ndarray) -> dict[str, float]:
    return {"min": float(values.min()), "median": float(np.median(values)), "max": float(values.max())}
