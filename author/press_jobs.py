# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Presses as jobs: each one described by plain values, kept by the hash of all that it depends on.

Any `concurrent.futures.Executor` solves them (press_executor.py: processes; cluster.py: Dask).  A record comes back
through its future and is written here, by one process, whole or not at all: whatever ends a run, what it has
finished is kept and only the presses in flight are lost.
"""

from __future__ import annotations

import atexit
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, wait
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from palpate.author.errors import Interrupted, PalpateError
from palpate.author.mechanics import mechanics_version, module_meaning
from palpate.author.organ_stage import OrganMesh
from palpate.author.scene_types import digest
from palpate.author.store import Result, Store
from palpate.author.tool_stage import ToolShape

__all__ = ["PressJob", "PressOutcome", "kept_key", "mechanics_version", "run_here", "run_jobs"]


@dataclass(frozen=True)
class PressJob:
    """One press.

    Attributes:
        contact_point: (3,) m.
        tool: and how it is held.
        depths: (K - 1,) m, rising, without 0.
        fidelity: "linear", "near_field" or "full".
        moves: tangential sticking moves: depth index -> how far, as a share of the reachable stretch mu f / k
            in a direction at `angle` from the first tangent.
        friction: mu, for the reachable stretch and for dragging.
        lateral: (2,) m or None; an explicit move at the last depth instead (along the tangents).
        drag: depths (m, rising) at which the tool is dragged both ways along the first tangent.
        shape: keep the deformed patch at the deepest state as well (arrays named "shape_...").
        refinement: divides the edges of the patch's tetrahedra.
        patch_radius: m, of the patch; the mechanics' own when None, which leaves the key as it is without.
        surface: keep how the organ's surface moves, and how it follows a stuck tool (arrays named "surface_...").
        stiffness: find the sticking stiffness and the friction felt; sticking moves and drags need it.
    """

    contact_point: tuple[float, float, float]
    tool: ToolShape
    depths: tuple[float, ...]
    fidelity: str
    moves: tuple[tuple[int, float, float], ...] = ()
    friction: float = 0.0
    lateral: tuple[float, float] | None = None
    refinement: float = 1.0
    drag: tuple[float, ...] = ()
    shape: bool = False
    patch_radius: float | None = None
    surface: bool = False
    stiffness: bool = True

    def key(self, mesh: OrganMesh) -> str:
        asked = {**asdict(self), "tool": self.tool.hash}
        if self.patch_radius is None:
            del asked["patch_radius"]
        if self.stiffness:
            del asked["stiffness"]
        if not asked.pop("surface"):  # what no scene asked for is in no key
            return digest({"organ": mesh.hash, "job": asked, "mechanics": mechanics_version()})
        asked["surface"] = module_meaning("surface_displacement")
        return digest({"organ": mesh.hash, "job": asked, "mechanics": mechanics_version()})


def kept_key(mesh: OrganMesh, job: PressJob, store: Store) -> str:
    """Of the record that serves a job: its own, or one that has a stiffness beside all that it asks for."""
    key = job.key(mesh)
    if job.stiffness or store.path("press", key).exists():
        return key
    more = replace(job, stiffness=True).key(mesh)
    return more if store.path("press", more).exists() else key


@dataclass(frozen=True)
class PressOutcome:
    """A press record as plain arrays, with what was asked.

    Attributes:
        arrays: fields of `fem_offline.press.PressRecord` (depth, force_vector, moment, energy, ...).
        values: scalars of the record, JSON-clean; lateral ladders as lists under "lateral".
        key: the job's hash.  fresh: False when it was kept from an earlier run.
    """

    job: PressJob
    key: str
    arrays: dict[str, np.ndarray]
    values: dict[str, Any]
    fresh: bool = field(default=True)

    @property
    def converged(self) -> bool:
        return bool(self.values["converged"])


Solver = Callable[[OrganMesh, PressJob, str], Result]
"""`press_solve.solve` or another that gives records of the same kind."""


def run_here(
    mesh: OrganMesh, job: PressJob, store: Store, progress: Callable[[float], None] = lambda depth: None
) -> PressOutcome:
    """The outcome of one job, solved in this process unless it is kept.

    Args:
        progress: called with each depth (m) that is reached.
    """
    from palpate.author.press_solve import forget_organ, solve

    key = kept_key(mesh, job, store)
    kept = store.read("press", key)
    if kept is not None:
        return PressOutcome(job, key, *kept, fresh=False)
    key = job.key(mesh)
    atexit.register(forget_organ)
    arrays, values = solve(mesh, job, str(store.folder), progress)
    store.write("press", key, arrays, values)
    return PressOutcome(job, key, arrays, values)


def run_jobs(
    mesh: OrganMesh,
    jobs: Sequence[PressJob],
    store: Store,
    executor: Executor,
    done: Callable[[PressOutcome], None] = lambda outcome: None,
    solver: Solver | None = None,
    more: Callable[[], Sequence[PressJob]] = lambda: (),
) -> list[PressOutcome]:
    """Outcomes of all jobs, in their order; kept ones are not solved again.

    Args:
        executor: gets `submit(solver, mesh, job, folder)`, longest job first as they stand in `jobs`.
        done: called as each one ends, after it is kept.
        more: further jobs, behind those there are; asked for when the first are under way, and when some have ended.

    Raises:
        PalpateError: the store cannot be written, or the executor's workers are lost.
        Interrupted: by Ctrl-C; says how many of the jobs are kept.
    """
    if solver is None:
        from palpate.author.press_solve import solve as solver
    jobs, keys = list(jobs), []
    outcomes: list[PressOutcome | None] = []
    waiting: dict[Future[Result], int] = {}

    def finish(i: int, result: Result, fresh: bool) -> None:
        if fresh:
            store.write("press", keys[i], *result)
        outcomes[i] = PressOutcome(jobs[i], keys[i], *result, fresh=fresh)

    def begin() -> None:
        """Takes up the jobs that nobody has taken up yet."""
        fresh = range(len(outcomes), len(jobs))
        outcomes.extend([None] * len(fresh))
        keys.extend(kept_key(mesh, jobs[i], store) for i in fresh)
        for i in fresh:
            kept = store.read("press", keys[i])
            if kept is not None:
                finish(i, kept, fresh=False)
                done(outcomes[i])  # type: ignore[arg-type]
        for i in fresh:
            if outcomes[i] is None:
                keys[i] = jobs[i].key(mesh)
                waiting[executor.submit(solver, mesh, jobs[i], str(store.folder))] = i

    try:
        begin()
        while (further := list(more())) or waiting:
            if further:
                jobs += further
                begin()
                continue
            for future in wait(waiting, return_when=FIRST_COMPLETED)[0]:
                i = waiting.pop(future)
                finish(i, _result(future), fresh=True)
                done(outcomes[i])  # type: ignore[arg-type]
    except BaseException as error:
        with suppress(PalpateError):  # the disk may be what is wrong
            for future, i in waiting.items():
                if future.done() and not future.cancelled() and future.exception() is None:
                    finish(i, future.result(), fresh=True)
        if not isinstance(error, KeyboardInterrupt):
            raise
        kept_count = sum(outcome is not None for outcome in outcomes)
        raise Interrupted(f"Interrupted: {kept_count} of {len(jobs)} presses are kept.") from None
    return [outcome for outcome in outcomes if outcome is not None]


def _result(future: Future[Result]) -> Result:
    try:
        return future.result()
    except CancelledError as error:
        raise PalpateError("the presses were cancelled; what was finished before is still there") from error
