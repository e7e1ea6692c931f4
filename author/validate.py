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
from palpate.author.errors import InputError, InputProblem
from palpate.author.held_out import held_out_jobs, judgement
from palpate.author.place import Sphere
from palpate.author.press_executor import fitting_workers, press_executor
from palpate.author.press_jobs import run_jobs
from palpate.author.progress import Progress, SilentProgress
from palpate.author.sampling import held_out_points
from palpate.author.store import Store
from palpate.author.tool_work import TRUTH, ladder

__all__ = ["validate"]


def validate(
    asset: Path,
    points: int,
    seed: int,
    tool: str | None = None,
    progress: Progress | None = None,
    within: Sphere | None = None,
    drag: int = 0,
) -> dict[str, Any]:
    """Held-out errors of one tool (the first when none is named) at freshly drawn points.

    Args:
        within: points are drawn there only.
        drag: presses after which the tool is dragged both ways as well (count).

    Raises:
        InputError: the asset has no such tool, was not made by `palpate author`, or has nothing to press `within`.
    """
    from palpate.fields.cook import cook
    from palpate.runtime import Field

    progress = progress or SilentProgress()
    authored = authored_tool(asset, tool)
    field, samples, mesh = authored.field, authored.samples, authored.mesh
    if within:
        samples = replace(samples, allowed=samples.allowed & within.contains(samples.points))
        if not samples.allowed.any():
            what = "holds no surface that the tool may press"
            raise InputError(
                InputProblem(str(asset), "--within", within, what, "a ball that meets the reach")
            )
    chosen = held_out_points(samples, points, seed)
    jobs = held_out_jobs(
        samples.points[chosen],
        authored.shape,
        ladder(field.depth_max),
        authored.friction,
        TRUTH,
        seed,
        drag,
    )
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
    judged = judgement(Field.open(cook(field)), field.tool.offset, outcomes, [], tolerance)
    judged = {
        "tool": field.tool.name,
        "seed": seed,
        "within": within.model_dump() if within else None,
        **judged,
    }
    name = f"{field.tool.name}-seed{seed}-{points}"
    if within:
        name += "-within-" + "_".join(f"{1e3 * x:.1f}" for x in (*within.center, within.radius)) + "mm"
    path = folder / "validation" / f"{name}.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(judged))
    return {**judged, "record": str(path)}
