# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""`palpate validate --apart`: what a field of one contact gets wrong when two tools touch at once.

One contact stands in the middle of the reach, the other one where the reach is as far away as asked.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.authored_tool import authored_tool
from palpate.author.errors import InputError, InputProblem, PalpateError
from palpate.author.progress import Progress, SilentProgress
from palpate.author.sampling import ReachSamples
from palpate.author.tool_stage import solid_tool

__all__ = ["RECORD", "two_contacts"]

RECORD = "{tool}-two_contacts.json"
"""In the asset's folder `validation`."""
NEAR_ENOUGH = 0.1
"""Share by which the distance may differ from the one that was asked for."""


def two_contacts(
    asset: Path,
    apart: Sequence[float],
    seed: int = 1,
    tool: str | None = None,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Presses one tool (the first when none is named) at two places at once, and at each of them alone.

    Args:
        apart: m between the contacts, one measurement each.
        seed: draws the direction from one contact to the other.

    Returns:
        JSON-clean: depths (m), and for each distance both contact points (m), normal_error and lateral_error
        (fractions of the normal force with both pressed; rows: tools, columns: depths).

    Raises:
        InputError: the reach is smaller than a distance, or the contacts would overlap.
        PalpateError: finite elements did not converge.
    """
    from palpate.fem_offline.equilibrium import EquilibriumError
    from palpate.fem_offline.patch import PatchError
    from palpate.fem_offline.site import patch_size
    from palpate.fem_offline.two_contacts import press_two

    progress = progress or SilentProgress()
    authored = authored_tool(asset, tool)
    depths = authored.field.depth_max * np.array([0.5, 1.0])
    solid = solid_tool(authored.shape)
    size = patch_size(solid, float(depths[-1]), tilt=authored.shape.tilt)
    if authored.shape.tilt:
        what = "is held tilted, and two contacts are pressed upright only"
        raise InputError(InputProblem(str(asset), "tool", authored.field.tool.name, what, "an upright tool"))
    pairs = [_pair(authored.samples, distance, 2.0 * size.extent, seed, asset) for distance in apart]
    progress.stage("two contacts", len(pairs))
    organ, rows = authored.mesh.organ, []
    for distance, points in zip(apart, pairs, strict=True):
        try:
            found = press_two(organ, points, solid, depths, size)
        except (EquilibriumError, PatchError, ArithmeticError) as error:
            raise PalpateError(f"two contacts {1e3 * distance:g} mm apart: {error}") from error
        rows.append(
            {
                "asked": distance,
                "distance": found.distance,
                "contact_points": found.contact_point.tolist(),
                "together": found.together.tolist(),
                "alone": found.alone.tolist(),
                "normal_error": found.normal_error.tolist(),
                "lateral_error": found.lateral_error.tolist(),
                "reaction_error": found.reaction_error,
            }
        )
        progress.advance()
    result = {
        "tool": authored.field.tool.name,
        "tool_hash": authored.field.tool.hash,
        "organ": authored.field.provenance["organ"],
        "seed": seed,
        "depth": depths.tolist(),
        "pairs": rows,
    }
    folder = asset if asset.is_dir() else asset.parent
    path = folder / "validation" / RECORD.format(tool=result["tool"])
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(result))
    _show(folder, progress)
    return {**result, "record": str(path)}


def _show(folder: Path, progress: Progress) -> None:
    """Write the asset's report anew, with what was found; it is kept beside the asset whether or not that succeeds."""
    from palpate.author.report import write_report

    try:
        write_report(folder, json.loads((folder / "summary.json").read_text()))
    except (OSError, ValueError) as error:
        progress.say(f"the report does not show it: {error}")


def _pair(samples: ReachSamples, distance: float, least: float, seed: int, asset: Path) -> np.ndarray:
    """(2, 3) m; places that may be pressed, `distance` (m) apart."""
    points = samples.points[samples.allowed]
    first = points[np.argmin(np.linalg.norm(points - points.mean(axis=0), axis=1))]
    away = np.linalg.norm(points - first, axis=1)
    miss = np.where(away > least, np.abs(away - distance), np.inf)
    problem = f"{1e3 * distance:g} mm"
    if distance <= least:
        what, expected = "is so near that the contacts overlap", f"more than {1e3 * least:.1f} mm"
        raise InputError(InputProblem(str(asset), "--apart", problem, what, expected))
    if miss.min() > NEAR_ENOUGH * distance:
        what, expected = "is more than the reach holds", f"at most {1e3 * away.max():.0f} mm"
        raise InputError(InputProblem(str(asset), "--apart", problem, what, expected))
    near = np.flatnonzero(miss <= max(samples.spacing, miss.min()))
    return np.stack([first, points[np.random.default_rng(seed).choice(near)]])
