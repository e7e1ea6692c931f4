# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""`palpate validate`: press an asset anew where it was never pressed, and compare with the runtime.

Everything comes from the asset itself: organ, supports, material, reach and tool from its USD, the runtime's field
cooked from it.
"""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import Any

from palpate.author.errors import InputError, InputProblem
from palpate.author.held_out import held_out_jobs, judgement
from palpate.author.organ_stage import OrganMesh
from palpate.author.press_executor import fitting_workers, press_executor
from palpate.author.press_jobs import run_jobs
from palpate.author.progress import Progress, SilentProgress
from palpate.author.sampling import held_out_points, reach_samples
from palpate.author.scene_tables import Capsule, Material, Reach, Region, Support
from palpate.author.store import Store
from palpate.author.tool_stage import shape_of_reference
from palpate.author.tool_work import TRUTH, ladder
from palpate.fields.organ_geometry import OrganGeometry
from palpate.fields.response_field import ResponseField

__all__ = ["mesh_of_asset", "validate"]


def mesh_of_asset(organ: OrganGeometry, field: ResponseField) -> OrganMesh:
    """The organ as it was pressed, from an asset."""
    scene = field.provenance["scene"]
    return OrganMesh(
        organ.vertices,
        organ.triangles,
        organ.tet_points,
        organ.tet_indices,
        organ.name,
        Material.model_validate(scene["material"]),
        tuple(Support.model_validate(support) for support in scene["support"]),
        tuple(Region.model_validate(region) for region in scene["region"]),
        organ.provenance,
        field.provenance["organ"],
        Capsule.model_validate(scene["capsule"]) if scene.get("capsule") else None,
    )


def validate(
    asset: Path, points: int, seed: int, tool: str | None = None, progress: Progress | None = None
) -> dict[str, Any]:
    """Held-out errors of one tool (the first when none is named) at freshly drawn points.

    Raises:
        InputError: the asset has no such tool, or was not made by `palpate author`.
    """
    from palpate.fields.cook import cook
    from palpate.fields.usd_read import read_field, read_organ, tools
    from palpate.runtime import Field

    progress = progress or SilentProgress()
    names = tools(asset)
    if tool is not None and tool not in names:
        raise InputError(
            InputProblem(str(asset), "tool", tool, "is not in this asset", "one of " + ", ".join(names))
        )
    field = read_field(asset, tool or names[0])
    if "scene" not in field.provenance:
        raise InputError(InputProblem(str(asset), "provenance", None, "names no scene", "an authored asset"))
    scene = field.provenance["scene"]
    mesh = mesh_of_asset(read_organ(asset), field)
    reach = Reach.model_validate(scene["reach"])
    shape = shape_of_reference(field.tool)
    samples = reach_samples(mesh, reach, shape, field.depth_max)
    chosen = held_out_points(samples, points, seed)
    friction = (scene["tool"].get("friction") or 0.0) if "friction" in scene["effects"] else 0.0
    jobs = held_out_jobs(
        samples.points[chosen],
        shape,
        ladder(field.depth_max),
        friction,
        TRUTH,
        seed,
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
    tolerance = float(scene["accuracy"]["force_tolerance"])
    judged = judgement(Field.open(cook(field)), field.tool.offset, outcomes, [], tolerance)
    judged = {"tool": field.tool.name, "seed": seed, **judged}
    path = folder / "validation" / f"{field.tool.name}-seed{seed}-{points}.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(judged))
    return {**judged, "record": str(path)}
