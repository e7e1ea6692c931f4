# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Presses of a sweep: those of each pressing in a folder of their own, within a budget, never twice.

Jobs are handed out as workers come free, so that a budget that is spent costs no more than the presses in flight.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from palpate.author.effort import PRESS_SECONDS
from palpate.author.organ_stage import OrganMesh
from palpate.author.press_jobs import PressJob, PressOutcome, Solver, kept_key, run_jobs
from palpate.author.progress import Progress
from palpate.author.scene import Scene
from palpate.author.scene_types import digest
from palpate.author.store import Store
from palpate.author.tool_work import ToolWork
from palpate.author.tradeoff.cost import PricedStore
from palpate.author.tradeoff.knobs import PATCH_RADIUS, Pressing
from palpate.fields.response_field import ContactGeometry

__all__ = ["Presses", "jobs_of", "organ_of"]


class Presses:
    """Presses jobs within a budget, and tells how it goes.

    Args:
        folder: holds one folder for each kind of press.
        budget: s from now; None: as long as it takes.
        solver: stands in for finite elements in tests.
    """

    def __init__(
        self,
        folder: Path,
        executor: Any,
        progress: Progress,
        budget: float | None,
        solver: Solver | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._folder, self._executor, self._progress, self._solver = folder, executor, progress, solver
        self._clock, self._until = clock, None if budget is None else clock() + budget
        self._seconds: dict[str, list[float]] = {}
        self.fresh_cpu_seconds = 0.0

    @property
    def out_of_time(self) -> bool:
        return self._until is not None and self._clock() > self._until

    def has(self, seconds: float) -> bool:
        """Whether the budget holds so much more."""
        return self._until is None or self._clock() + seconds <= self._until

    def store(self, name: str) -> Store:
        return Store(self._folder / name)

    def expected(self, jobs: int, fidelity: str) -> float:
        """s that so many presses take: as those that were made here took, else as planned."""
        made = {kind: sum(found) / len(found) for kind, found in self._seconds.items() if found}
        scale = sum(made.values()) / sum(PRESS_SECONDS[kind] for kind in made) if made else 1.0
        each = made.get(fidelity, scale * PRESS_SECONDS[fidelity])
        return jobs * each / max(1, self._executor.workers)

    def press(self, name: str, mesh: OrganMesh, jobs: Sequence[PressJob], told: str) -> list[PressOutcome]:
        """Outcomes of `jobs` in their order, up to the first that the budget did not reach."""
        store, todo, asked, ended = self.store(name), list(jobs), 0, 0
        self._progress.stage(told, len(todo))

        def done(outcome: PressOutcome) -> None:
            nonlocal ended
            ended += 1
            self._arrived(outcome, len(todo) - ended)

        def more() -> list[PressJob]:
            nonlocal asked
            given: list[PressJob] = []
            while asked < len(todo):
                job = todo[asked]
                kept = store.path("press", kept_key(mesh, job, store)).exists()
                if not kept and (asked - ended >= self._executor.workers + 1 or self.out_of_time):
                    break
                given.append(job)
                asked += 1
            return given

        return run_jobs(mesh, [], store, self._executor, done, self._solver, more)

    def choose(
        self, name: str, mesh: OrganMesh, work: ToolWork, geometry: Callable[[], ContactGeometry], told: str
    ) -> list[PressOutcome]:
        """Nodes of the scene's own pressing, in the order in which errors asked for them; fewer out of time."""
        store = self.store(name)
        asked = {"organ": mesh.hash, "tool": work.shape.hash, "nodes": work.most}
        width = {"width": max(1, self._executor.workers)}
        _, kept = store.kept("batches", digest(asked), lambda: ({}, width))
        first = work.begin(geometry, int(kept["width"]), lambda: self.out_of_time)
        seeds = first[: len(first) - len(work.held_jobs) - len(work.near_jobs)]
        self._progress.stage(told, work.most)

        def done(outcome: PressOutcome) -> None:
            work.arrived(outcome)
            self._arrived(outcome, work.most - len(work.node_outcomes))

        run_jobs(mesh, seeds, store, self._executor, done, self._solver, work.more)
        return work.node_outcomes

    def _arrived(self, outcome: PressOutcome, to_go: int) -> None:
        values = outcome.values
        if outcome.fresh:
            self._seconds.setdefault(outcome.job.fidelity, []).append(float(values.get("seconds", 0.0)))
            self.fresh_cpu_seconds += float(values.get("cpu_seconds", 0.0))
        left = self.expected(to_go, outcome.job.fidelity)
        notes = []
        if self._until is not None:
            notes.append(f"{max(0.0, self._until - self._clock()) / 60.0:.1f} min of the budget left")
        self._progress.advance(1, ", ".join(notes), left)


def jobs_of(pressing: Pressing, like: Sequence[PressJob]) -> list[PressJob]:
    """The same places and depths, pressed as `pressing` says."""
    radius = None if pressing.patch_radius == PATCH_RADIUS else pressing.patch_radius
    return [
        replace(
            job,
            fidelity=pressing.fidelity,
            refinement=pressing.patch_refinement,
            patch_radius=radius,
            moves=(),
        )
        for job in like
    ]


def organ_of(scene: Scene, size: float, store: PricedStore) -> tuple[OrganMesh, float]:
    """The scene's organ in tetrahedra of `size` (m), and the CPU seconds that it took, whenever that was."""
    from palpate.author.organ_stage import mesh_organ

    before = store.cpu_seconds
    organ = scene.organ.model_copy(update={"mesh_size": size})
    mesh = mesh_organ(scene.model_copy(update={"organ": organ}), store)
    return mesh, store.cpu_seconds - before
