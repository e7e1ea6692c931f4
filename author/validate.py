# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""`palpate validate`: press an asset anew where it was never pressed, and compare with the runtime.

Everything comes from the asset itself: organ, supports, material, reach and tool from its USD, the runtime's field
cooked from it.
"""

from __future__ import annotations

import json
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

from palpate.author.authored_tool import authored_tool
from palpate.author.cook_asset import refuse_radius
from palpate.author.errors import InputError, InputProblem
from palpate.author.family_work import family_judgement
from palpate.author.held_out import held_out_jobs, judgement, quasi_static
from palpate.author.place import Sphere
from palpate.author.press_executor import fitting_workers, press_executor
from palpate.author.press_jobs import run_jobs
from palpate.author.progress import Progress, SilentProgress
from palpate.author.sampling import held_out_points
from palpate.author.store import Store
from palpate.author.tool_family import FamilyRadius, family_held_out, judged_radii
from palpate.author.tool_work import TRUTH, ladder
from palpate.author.ways_of_touching import judged_ways, ways_held_out, ways_judgement
from palpate.fields.response_field import ResponseField
from palpate.fields.tool_family import depth_between

__all__ = ["validate"]


def validate(
    asset: Path,
    points: int,
    seed: int,
    tool: str | None = None,
    progress: Progress | None = None,
    within: Sphere | None = None,
    drag: int = 0,
    radius: float | None = None,
) -> dict[str, Any]:
    """Held-out errors of one tool (the first when none is named) at freshly drawn points.

    Args:
        within: points are drawn there only.
        drag: presses after which the tool is dragged both ways as well (count).
        radius: m, of a tool family; when None, pressed radii and radii between them in turn.

    Raises:
        InputError: the asset has no such tool or radius, was not made by `palpate author`, or has nothing to press
            `within`.
    """
    from palpate.fields.cook import cook

    progress = progress or SilentProgress()
    authored = authored_tool(asset, tool)
    field, samples, mesh = authored.field, authored.samples, authored.mesh
    refuse_radius(asset, field, radius)
    if within:
        samples = replace(samples, allowed=samples.allowed & within.contains(samples.points))
        if not samples.allowed.any():
            what = "holds no surface that the tool may press"
            raise InputError(
                InputProblem(
                    str(asset), "--within", _millimetres(within), what, "a ball that meets the reach"
                )
            )
    chosen = samples.points[held_out_points(samples, points, seed)]
    friction = authored.friction(chosen)
    radii = _judged(field, radius)
    ways = judged_ways([0.0, *(way.tool.tilt for way in field.ways)])
    if radii:
        jobs = family_held_out(chosen, radii, friction, TRUTH, seed, drag)
    elif field.ways:
        depths = ladder(field.depth_max)
        jobs = ways_held_out(chosen, authored.shape, ways, depths, friction, TRUTH, seed, drag)
    else:
        depths = ladder(field.depth_max)
        jobs = held_out_jobs(chosen, authored.shape, depths, friction, TRUTH, seed, drag)
    folder = asset if asset.is_dir() else asset.parent
    with tempfile.TemporaryDirectory() as scratch:
        work = folder / "work"
        store = Store(work if work.is_dir() else Path(scratch))
        progress.stage("presses", len(jobs))
        count, limited = fitting_workers(len(mesh.tets), {TRUTH})
        if limited:
            progress.say(limited)
        with press_executor(count, progress.say) as executor:
            outcomes = run_jobs(mesh, jobs, store, executor, lambda outcome: progress.advance())
    tolerance = float(authored.scene["accuracy"]["force_tolerance"])
    beyond = samples.beyond(mesh)
    if radii:
        judged = family_judgement(field, radii, outcomes, [], tolerance, beyond)
    elif field.ways:
        judged = ways_judgement(quasi_static(cook(field)), ways, outcomes, [], tolerance, beyond)
    else:
        judged = judgement(quasi_static(cook(field)), field.tool.offset, outcomes, [], tolerance, beyond)
    judged = {
        "tool": field.tool.name,
        "seed": seed,
        "within": within.model_dump() if within else None,
        "radius": radius,
        "dragged": drag,
        **judged,
    }
    name = f"{field.tool.name}-seed{seed}-{points}"
    if radius is not None:
        name += f"-radius-{1e3 * radius:.6g}mm"
    if within:
        name += "-within-" + "_".join(f"{1e3 * x:.1f}" for x in (*within.center, within.radius)) + "mm"
    if drag:
        name += f"-drag-{drag}"
    path = folder / "validation" / f"{name}.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(judged))
    return {**judged, "record": str(path)}


def _millimetres(ball: Sphere) -> str:
    return ",".join(f"{1e3 * x:g} mm" for x in (*ball.center, ball.radius))


def _judged(field: ResponseField, radius: float | None) -> list[FamilyRadius]:
    """Radii of a family that are judged in turn, `radius` (m) alone where given; none where the tool is no family."""
    radii = [member.radius for member in field.family]
    depths = [float(member.nodes.depth_knots[-1]) for member in field.family]
    if radius is None or not radii:
        return judged_radii(radii, depths) if radii else []
    return [FamilyRadius(radius, depth_between(radii, depths, radius), radius in radii)]
