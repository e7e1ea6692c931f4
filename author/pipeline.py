# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The main job: repair, tetrahedralise, press, fit, write, cook, validate, report."""

from __future__ import annotations

import json
import platform
import resource
import time
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import AbstractContextManager, ExitStack
from importlib import metadata
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.batch_executor import (
    PRESSES_A_CORE,
    batch_executor,
    device_named,
    threads_by_process,
)
from palpate.author.effort import node_count
from palpate.author.errors import InputError
from palpate.author.field_stage import contact_geometry_of, field_of
from palpate.author.held_out import held_out_jobs, judgement
from palpate.author.mechanics import mechanics_version
from palpate.author.one_tool import asset_geometry, chosen_tools, with_other_tools
from palpate.author.organ_stage import OrganMesh, mesh_organ
from palpate.author.press_executor import core_count, fitting_workers, press_executor
from palpate.author.press_jobs import PressJob, PressOutcome, run_jobs
from palpate.author.press_rate import PressRate
from palpate.author.progress import Progress, SilentProgress
from palpate.author.sampling import ReachSamples, farthest_points, held_out_points, reach_samples
from palpate.author.scene import Scene
from palpate.author.scene_tables import Tool
from palpate.author.scene_types import digest
from palpate.author.store import Store
from palpate.author.tool_stage import ToolShape, heading_matters, reference_of, shape_of
from palpate.fields.organ_geometry import OrganGeometry

__all__ = ["author", "ladder", "node_jobs"]

LADDER_STEPS = 10
"""Depths of a normal ladder, evenly spaced: a step of 0.1 R at depth R."""
NEAR_CHECKS = 2
"""Held-out points pressed at near_field fidelity as well, so that the far field's own error is known."""
TRUTH = "full"
"""Fidelity of held-out presses."""


def ladder(depth_max: float) -> np.ndarray:
    """(LADDER_STEPS,) m."""
    return depth_max * np.arange(1, LADDER_STEPS + 1) / LADDER_STEPS


def node_jobs(points: np.ndarray, tool: ToolShape, depth_max: float, fidelity: str) -> list[PressJob]:
    depths = tuple(map(float, ladder(depth_max)))
    return [PressJob(tuple(map(float, point)), tool, depths, fidelity) for point in points]


def author(
    scene: Scene,
    out: Path,
    progress: Progress | None = None,
    workers: int | None = None,
    scheduler: str = "",
    device: str = "",
    batch: int | None = None,
    tool: str = "",
) -> dict[str, Any]:
    """Make the asset of a scene in the folder `out`.

    Args:
        tool: name of the only one to add to the asset or to replace there; all when empty.
        workers: processes that press; one for each core when absent.  Fewer where memory does not hold them.
        scheduler: address of a Dask scheduler, whose workers press instead.
        device: evaluates the elements of many presses together; `workers` is then one for each four cores when absent.
        batch: presses at once with a device; two for each core when absent.  Fewer where memory does not hold them.

    Returns:
        What `palpate author --json` prints.

    Raises:
        InputError: the scene does not fit its organ, there is no such device or tool, or the asset that the tool
            should go into is another organ's.
        Interrupted: by Ctrl-C while pressing; says how many presses are kept.
    """
    begun = time.perf_counter()
    progress = progress or SilentProgress()
    out = Path(out)
    store = Store(out / "work")
    store.sweep()
    stages = _Stages(progress)
    chosen = chosen_tools(scene, tool)
    if device:
        device_named(device)

    with ExitStack() as stack:
        executor: Executor | None = None
        if scheduler:
            stages.begin("cluster")  # before any work: it may not be there
            executor = stack.enter_context(_cluster(scheduler, progress))
        stages.begin("surface and tetrahedra")
        mesh = mesh_organ(scene, store)
        tools = [_ToolWork(scene, mesh, tool) for tool in chosen]
        samples = _reach(scene, mesh, tools)
        organ = _organ(mesh, samples)
        geometry = asset_geometry(scene, chosen[0], organ, out) if tool else None
        jobs = [job for work in tools for job in work.jobs]
        stages.begin("presses", len(jobs))
        if executor is None:
            executor = stack.enter_context(_here(mesh, jobs, progress, workers, device, batch))
        pressed = _pressed(mesh, jobs, store, executor, progress)
    outcomes = iter(pressed)
    for work in tools:
        work.take(outcomes)

    stages.begin("contact geometry and response field")
    if geometry is None:
        geometry = contact_geometry_of(scene, mesh, samples)
    fields = [work.fit(scene, mesh, geometry) for work in tools]

    stages.begin("asset")
    asset = _write(out, organ, fields, replace=not tool)
    results = [_cooked(out, field) for field in fields]

    stages.begin("validation")
    for work, result in zip(tools, results, strict=True):
        judged = work.validate(scene, out, result["rfield"])
        result.update(
            presses=len(work.node_outcomes) + len(judged["presses"]),
            failed=len(work.failures) + judged["failed"],
            held_out=len(judged["presses"]),
            force_error=judged["force_error"],
            lateral_error=judged["lateral_error"],
            stuck_error=judged["stuck_error"],
            far_field_error=judged["far_field_error"],
            met=judged["met"],
        )

    stages.begin("report")
    usage = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    summary: dict[str, Any] = {
        "asset": str(asset),
        "tools": results,
        "tolerance_met": all(result["met"] for result in results),
        "organ": mesh.report,
        "failures": [failure for work in tools for failure in work.failures],
        "left_out": samples.left_out,
        "damaged_records": store.damaged,
        "seed": scene.accuracy.seed,
        "versions": _versions(),
        "hashes": {"organ": mesh.hash, "scene": digest(scene.hash_inputs())},
        "press_memory": max(outcome.values.get("peak_memory", 0) for outcome in pressed),
        "peak_memory": max(use.ru_maxrss for use in usage) * 1024,
    }
    stages.end()
    summary["stages"] = stages.rows
    summary["seconds"] = time.perf_counter() - begun
    summary["cpu_seconds"] = sum(use.ru_utime + use.ru_stime for use in usage)
    from palpate.author.report import write_report
    from palpate.fields.usd_read import tools as asset_tools

    if tool:
        summary = with_other_tools(summary, out, asset_tools(out))
    summary["report"] = str(write_report(out, summary))
    (out / "summary.json").write_text(json.dumps(summary, indent=1))
    return summary


def _cluster(address: str, progress: Progress) -> AbstractContextManager[Executor]:
    from palpate.author.cluster import cluster_executor

    return cluster_executor(address, progress.say)


def _here(
    mesh: OrganMesh,
    jobs: list[PressJob],
    progress: Progress,
    workers: int | None,
    device: str,
    batch: int | None,
) -> AbstractContextManager[Executor]:
    """This machine's processes, as many as memory holds."""
    asked = (batch or PRESSES_A_CORE * core_count()) if device else workers
    count, limited = fitting_workers(len(mesh.tets), {job.fidelity for job in jobs}, asked)
    if limited:
        progress.say(limited)
    if device:
        return batch_executor(device, threads_by_process(count, workers), progress.say)
    return press_executor(count, progress.say)


def _pressed(
    mesh: OrganMesh, jobs: list[PressJob], store: Store, executor: Any, progress: Progress
) -> list[PressOutcome]:
    rate = PressRate(jobs, lambda: executor.workers)

    def done(outcome: PressOutcome) -> None:
        rate.arrived(outcome)
        progress.advance(1, rate.note, rate.left)

    return run_jobs(mesh, jobs, store, executor, done)


class _Stages:
    """Names and times of the stages."""

    def __init__(self, progress: Progress) -> None:
        self.progress = progress
        self.rows: list[dict[str, Any]] = []
        self._begun = time.perf_counter()
        self._name = ""

    def begin(self, name: str, total: int | None = None) -> None:
        self.end()
        self._name, self._begun = name, time.perf_counter()
        self.progress.stage(name, total)

    def end(self) -> None:
        if self._name:
            self.rows.append({"name": self._name, "seconds": time.perf_counter() - self._begun})
        self._name = ""


class _ToolWork:
    """What one tool asks for: its places, its presses, its field, its judgement."""

    def __init__(self, scene: Scene, mesh: OrganMesh, tool: Tool) -> None:
        self.tool = tool
        self.shape = shape_of(scene, tool)
        self.reference = reference_of(tool.name, self.shape)
        self.depth_max = scene.depth_max(tool)
        self.seed = scene.accuracy.seed
        self.samples: ReachSamples = reach_samples(mesh, scene.reach, self.shape, self.depth_max)
        if not self.samples.allowed.any():
            why = "; ".join(f"{count} places: {reason}" for reason, count in self.samples.left_out.items())
            raise InputError(
                scene.problem("reach", None, f"has no place that {tool.name} can press ({why or 'nothing there'})",
                              "free, thick enough surface of the organ, outside its supports")
            )  # fmt: skip
        _refuse_jumping_heading(scene, tool, self.shape, self.samples)
        area = len(self.samples.points) * self.samples.spacing**2
        count = node_count(area, scene.accuracy.force_tolerance)
        held = held_out_points(self.samples, scene.accuracy.held_out, self.seed)
        nodes = farthest_points(self.samples, count)
        friction = (tool.friction or 0.0) if "friction" in scene.effects else 0.0
        shape, depths = self.shape, ladder(self.depth_max)
        points = self.samples.points
        self.node_jobs = node_jobs(points[nodes], shape, self.depth_max, scene.accuracy.fidelity)
        self.held_jobs = held_out_jobs(points[held], shape, depths, friction, TRUTH, self.seed)
        self.near_jobs = (
            node_jobs(points[held[:NEAR_CHECKS]], shape, self.depth_max, "near_field")
            if scene.accuracy.fidelity == "near_field"
            else []
        )
        self.failures: list[dict[str, Any]] = []

    @property
    def jobs(self) -> list[PressJob]:
        """Longest first, so that no core waits at the end."""
        return [*self.held_jobs, *self.node_jobs, *self.near_jobs]

    def take(self, outcomes: Iterator[PressOutcome]) -> None:
        """The outcomes of `jobs`, in their order."""
        self.held_outcomes = list(islice(outcomes, len(self.held_jobs)))
        self.node_outcomes = list(islice(outcomes, len(self.node_jobs)))
        self.near_outcomes = list(islice(outcomes, len(self.near_jobs)))

    def fit(self, scene: Scene, mesh: OrganMesh, geometry: Any) -> Any:
        provenance = {
            "scene": {
                "hash": digest(scene.hash_inputs()),
                "name": scene.name,
                "effects": list(scene.effects),
                "support": [s.model_dump(mode="json", exclude_none=True) for s in scene.organ.support],
                "region": [r.model_dump(mode="json", exclude_none=True) for r in scene.organ.region],
                "reach": scene.reach.model_dump(mode="json", exclude_none=True),
                "material": scene.organ.material.model_dump(mode="json", exclude_none=True),
                "capsule": scene.organ.capsule
                and scene.organ.capsule.model_dump(mode="json", exclude_none=True),
                "tool": self.tool.model_dump(mode="json", exclude_none=True),
                "accuracy": scene.accuracy.model_dump(mode="json", exclude_none=True),
            },
            "organ": mesh.hash,
            "tool": self.reference.hash,
            "presses": {
                "mechanics": mechanics_version(),
                "fidelity": scene.accuracy.fidelity,
                "depths": LADDER_STEPS,
            },
            "seed": self.seed,
            "versions": _versions(),
        }
        field, self.failures = field_of(
            scene, self.tool, mesh, self.samples, geometry, self.node_outcomes, provenance
        )
        return field

    def validate(self, scene: Scene, out: Path, rfield: str) -> dict[str, Any]:
        from palpate.runtime import Field

        judged = judgement(
            Field.open(rfield),
            self.reference.offset,
            self.held_outcomes,
            self.near_outcomes,
            scene.accuracy.force_tolerance,
        )
        judged = {"tool": self.tool.name, "seed": self.seed, **judged}
        path = out / "validation" / f"{self.tool.name}.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(judged))
        return judged


def _refuse_jumping_heading(scene: Scene, tool: Tool, shape: ToolShape, samples: ReachSamples) -> None:
    """A tool that is not round has a heading, which `tangents` can only give smoothly over part of a surface."""
    leaning = np.unique(np.argmin(np.abs(samples.normals[samples.allowed]), axis=1))
    if heading_matters(shape) and len(leaning) > 1:
        key = f"tool[{scene.tool.index(tool)}]"
        what = "is not round about the surface's normal, and its heading would jump within the reach"
        expected = "a smaller or flatter reach, a round tool held upright, or single presses (palpate press)"
        raise InputError(scene.problem(key, tool.name, what, expected))


def _reach(scene: Scene, mesh: OrganMesh, tools: list[_ToolWork]) -> ReachSamples:
    """What the scene's first tool reaches, whether it is pressed or not: the asset's geometry is made for that."""
    first = scene.tool[0]
    known = [work.samples for work in tools if work.tool is first]
    return (
        known[0]
        if known
        else reach_samples(mesh, scene.reach, shape_of(scene, first), scene.depth_max(first))
    )


def _organ(mesh: OrganMesh, samples: ReachSamples) -> OrganGeometry:
    centres = mesh.vertices[mesh.triangles].mean(axis=1)
    return mesh.geometry(samples.beyond(mesh)(centres) <= 0.0)


def _write(out: Path, organ: OrganGeometry, fields: list[Any], replace: bool) -> Path:
    """Args: replace: whatever asset is there; otherwise the fields are added to it."""
    from palpate.fields.usd_write import write_asset

    asset = out
    for field in fields:
        asset = write_asset(out, organ, field, replace=replace and field is fields[0])
    return asset


def _cooked(out: Path, field: Any) -> dict[str, Any]:
    from palpate.fields.cook import write_rfield

    path = out / f"{field.tool.name}.rfield"
    write_rfield(field, path)
    return {
        "name": field.tool.name,
        "rfield": str(path),
        "bytes": path.stat().st_size,
        "nodes": field.nodes.node_count,
        "representation": field.representation,
    }


def _versions() -> dict[str, str]:
    names = ("palpate", "numpy", "scipy", "warp-lang", "usd-core", "pytetwild", "mmgpy", "pymeshlab")
    return {**{name: metadata.version(name) for name in names}, "python": platform.python_version()}
