# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The main job: repair, tetrahedralise, press, fit, write, cook, validate, report."""

from __future__ import annotations

import json
import resource
import time
from collections.abc import Callable
from concurrent.futures import Executor
from contextlib import AbstractContextManager, ExitStack
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any

from palpate.author.batch_executor import (
    PRESSES_A_CORE,
    batch_executor,
    device_named,
    threads_by_process,
)
from palpate.author.errors import InputError
from palpate.author.family_work import FamilyWork
from palpate.author.field_stage import contact_geometry_of
from palpate.author.haptic_device import scene_device
from palpate.author.one_tool import asset_geometry, chosen_tools, with_other_tools
from palpate.author.organ_stage import OrganMesh, mesh_organ
from palpate.author.plan import fidelities_of
from palpate.author.press_executor import core_count, fitting_workers, press_executor
from palpate.author.press_jobs import PressJob, PressOutcome, run_jobs
from palpate.author.press_rate import PressRate
from palpate.author.progress import Progress, SilentProgress
from palpate.author.sampling import ReachSamples, reach_samples
from palpate.author.scene import Scene
from palpate.author.scene_tables import Tool
from palpate.author.scene_types import digest
from palpate.author.store import Store
from palpate.author.texture.texture_stage import textures_of, with_texture
from palpate.author.tool_members import is_family, is_tilted
from palpate.author.tool_stage import shape_of
from palpate.author.tool_work import ToolWork, versions
from palpate.author.transients.transient_stage import transients_of, with_transient
from palpate.author.ways_work import WaysWork
from palpate.fields.organ_geometry import OrganGeometry
from palpate.fields.response_field import ContactGeometry, ResponseField

__all__ = ["author"]

FITTING = 0.1
"""Share of the time budget that is left for fitting, writing and judging."""


def author(
    scene: Scene,
    out: Path,
    progress: Progress | None = None,
    workers: int | None = None,
    scheduler: str = "",
    device: str = "",
    batch: int | None = None,
    tool: str = "",
    per_vertex: bool = False,
) -> dict[str, Any]:
    """Make the asset of a scene in the folder `out`.

    Args:
        tool: name of the only one to add to the asset or to replace there; all when empty.
        workers: processes that press; one for each core when absent.  Fewer where memory does not hold them.
        scheduler: address of a Dask scheduler, whose workers press instead.
        per_vertex: the asset carries each tool's curves at the vertices of its surface too.
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
    textures_of(scene)
    for one in chosen:
        transients_of(scene, one)  # what cannot be stored must not be found out after hours of presses
    if device:
        device_named(device)

    with ExitStack() as stack:
        executor: Executor | None = None
        if scheduler:
            stages.begin("cluster")  # before any work: it may not be there
            executor = stack.enter_context(_cluster(scheduler, progress))
        stages.begin("surface and tetrahedra")
        mesh = mesh_organ(scene, store)
        tools = [_work(scene, mesh, tool) for tool in chosen]
        samples = _reach(scene, mesh, tools)
        organ = _organ(mesh, samples)
        known = asset_geometry(scene, chosen[0], organ, out) if tool else None
        geometry = cache(
            lambda: known or contact_geometry_of(scene, mesh, samples)
        )  # while first presses run
        if executor is None:
            executor = stack.enter_context(_here(mesh, scene, progress, workers, device, batch))
        budget = scene.accuracy.time_budget
        until = None if budget is None else begun + (1.0 - FITTING) * budget
        pressed = _pressed(mesh, tools, geometry, store, executor, stages, until)

    stages.begin("response field")
    fitted = [
        _with_layers(scene, one, work.fit(geometry()), mesh) for one, work in zip(chosen, tools, strict=True)
    ]
    fields = [field for field, _ in fitted]

    stages.begin("asset")
    asset = _write(out, organ, fields, not tool, per_vertex)
    results = [work.cook(out, field) | told for work, (field, told) in zip(tools, fitted, strict=True)]

    stages.begin("validation")
    for work, field, result in zip(tools, fields, results, strict=True):
        judged = work.validate(out, field, result)
        result.update(
            presses=len(work.node_outcomes) + len(judged["presses"]),
            failed=len(work.failures) + judged["failed"],
            held_out=len(judged["presses"]),
            force_error=judged["force_error"],
            lateral_error=judged["lateral_error"],
            stuck_error=judged["stuck_error"],
            far_field_error=judged["far_field_error"],
            met=judged["met"],
            **{key: judged[key] for key in ("family", "ways") if key in judged},
            sampling=work.rounds.sampling.report(),
            node_origins=work.node_origins,
        )

    stages.end()
    usage = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    summary: dict[str, Any] = {
        "asset": str(asset),
        "tools": results,
        "tolerance_met": all(result["met"] for result in results),
        "organ": mesh.report,
        "failures": [failure for work in tools for failure in work.failures],
        "left_out": samples.left_out,
        "reach": {
            "places": len(samples.points),
            "pressable": int(samples.allowed.sum()),
            "spacing": samples.spacing,
        },
        "damaged_records": store.damaged,
        "seed": scene.accuracy.seed,
        "versions": versions(),
        "hashes": {"organ": mesh.hash, "scene": digest(scene.hash_inputs())},
        "press_memory": max(outcome.values.get("peak_memory", 0) for outcome in pressed),
        "peak_memory": max(use.ru_maxrss for use in usage) * 1024,
    }
    summary["stages"] = stages.rows
    summary["seconds"] = time.perf_counter() - begun
    summary["cpu_seconds"] = sum(use.ru_utime + use.ru_stime for use in usage)
    from palpate.author.report import write_report
    from palpate.fields.usd_read import tools as asset_tools

    summary |= _device_of(scene)
    if tool:
        summary = with_other_tools(summary, out, asset_tools(out))
    stages.begin("report")
    summary["report"] = str(write_report(out, summary))
    stages.end()
    (out / "summary.json").write_text(json.dumps(summary, indent=1))
    return summary


def _with_layers(
    scene: Scene, tool: Tool, field: ResponseField, mesh: OrganMesh
) -> tuple[ResponseField, dict[str, Any]]:
    """`field` with what plays on top of its response and what its surface is like; what a summary says of each."""
    field, played = with_transient(scene, tool, field)
    field, felt = with_texture(scene, field, mesh)
    return field, {name: told for name, told in (("transient", played), ("texture", felt)) if told}


def _device_of(scene: Scene) -> dict[str, Any]:
    """The scene's device, for the report; why it is not judged where nobody knows its damping."""
    try:
        device = scene_device(scene)
    except InputError as error:
        return {"device": None, "device_unknown": str(error)}
    return {} if device is None else {"device": asdict(device)}


def _cluster(address: str, progress: Progress) -> AbstractContextManager[Executor]:
    from palpate.author.cluster import cluster_executor

    return cluster_executor(address, progress.say)


def _here(
    mesh: OrganMesh, scene: Scene, progress: Progress, workers: int | None, device: str, batch: int | None
) -> AbstractContextManager[Executor]:
    """This machine's processes, as many as memory holds."""
    asked = (batch or PRESSES_A_CORE * core_count()) if device else workers
    count, limited = fitting_workers(len(mesh.tets), fidelities_of(scene), asked)
    if limited:
        progress.say(limited)
    if device:
        return batch_executor(device, threads_by_process(count, workers), progress.say)
    return press_executor(count, progress.say)


def _pressed(
    mesh: OrganMesh,
    tools: list[ToolWork],
    geometry: Callable[[], ContactGeometry],
    store: Store,
    executor: Any,
    stages: _Stages,
    until: float | None,
) -> list[PressOutcome]:
    """All presses: seeds, held-out ones, and nodes where the error is largest until it is small or time (s) is up."""
    progress = stages.progress
    asked = {"organ": mesh.hash, "tools": [work.shape.hash for work in tools]}
    width = _kept_width(store, digest(asked), max(1, executor.workers))
    out_of_time: Callable[[], bool] = lambda: until is not None and time.perf_counter() > until  # noqa: E731
    first = [job for work in tools for job in work.begin(geometry, width, out_of_time)]
    stages.begin("presses", sum(work.presses_at_most for work in tools))
    rate = PressRate(first, lambda: executor.workers)

    def done(outcome: PressOutcome) -> None:
        rate.arrived(outcome)
        for work in tools:
            work.arrived(outcome)
        notes = [rate.note, *(work.rounds.sampling.note for work in tools)]
        if until is not None:
            notes.append(f"{max(0.0, until - time.perf_counter()) / 60.0:.1f} min of the budget left")
        progress.advance(1, ", ".join(filter(None, notes)), rate.left)

    def more() -> list[PressJob]:
        jobs = [job for work in tools for job in work.more()]
        rate.asked(jobs)
        return jobs

    return run_jobs(mesh, first, store, executor, done, more=more)


def _kept_width(store: Store, key: str, workers: int) -> int:
    """Presses chosen at once: as many as there were workers at first, so that going on asks for the same presses."""
    _, values = store.kept("batches", key, lambda: ({}, {"width": workers}))
    return int(values["width"])


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


def _work(scene: Scene, mesh: OrganMesh, tool: Tool) -> ToolWork:
    kind = FamilyWork if is_family(tool) else WaysWork if is_tilted(tool) else ToolWork
    return kind(scene, mesh, tool)


def _reach(scene: Scene, mesh: OrganMesh, tools: list[ToolWork]) -> ReachSamples:
    """What the scene's first tool reaches, whether it is pressed or not: the asset's geometry is made for that."""
    first = scene.tool[0]
    known = [work.samples for work in tools if work.tool.name == first.name]
    return (
        known[0]
        if known
        else reach_samples(mesh, scene.reach, shape_of(scene, first), scene.depth_max(first))
    )


def _organ(mesh: OrganMesh, samples: ReachSamples) -> OrganGeometry:
    centres = mesh.vertices[mesh.triangles].mean(axis=1)
    return mesh.geometry(samples.beyond(mesh)(centres) <= 0.0)


def _write(out: Path, organ: OrganGeometry, fields: list[Any], replace: bool, per_vertex: bool) -> Path:
    """Args: replace: whatever asset is there; otherwise the fields are added to it."""
    from palpate.fields.usd_write import write_asset

    asset = out
    for field in fields:
        asset = write_asset(out, organ, field, replace and field is fields[0], per_vertex)
    return asset
