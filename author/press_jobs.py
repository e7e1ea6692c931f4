# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Presses as jobs: each one described by plain values, kept by their hash, run in worker processes.

A worker is a fresh process (spawned, never forked) with one BLAS thread and a Warp kernel cache of its own.  It
keeps the organ it works on, and far fields go through the store, so that another tool re-uses them.
"""

from __future__ import annotations

import atexit
import multiprocessing
import os
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, ProcessPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.console import plain
from palpate.author.mechanics import mechanics_version
from palpate.author.organ_stage import OrganMesh
from palpate.author.scene_types import digest
from palpate.author.store import Store
from palpate.author.tool_stage import ToolShape, solid_tool
from palpate.fem_offline.pose import tangents

__all__ = [
    "PressJob",
    "PressOutcome",
    "mechanics_version",
    "press_executor",
    "run_here",
    "run_jobs",
]

LATERAL_STEPS = 4
"""Equilibria of an explicit sticking move."""


@dataclass(frozen=True)
class PressJob:
    """One press.

    Attributes:
        contact_point: (3,) m.
        tool: and how it is held.
        depths: (K - 1,) m, rising, without 0.
        fidelity: "near_field" or "full".
        moves: tangential sticking moves: depth index -> how far, as a share of the reachable stretch mu f / k
            in a direction at `angle` from the first tangent.
        friction: mu, for the reachable stretch and for dragging.
        lateral: (2,) m or None; an explicit move at the last depth instead (along the tangents).
        drag: depths (m, rising) at which the tool is dragged both ways along the first tangent.
        shape: keep the deformed patch at the deepest state as well (arrays named "shape_...").
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

    def key(self, mesh: OrganMesh) -> str:
        asked = {**asdict(self), "tool": self.tool.hash}
        return digest({"organ": mesh.hash, "job": asked, "mechanics": mechanics_version()})


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


_LAST: dict[str, Any] = {}
"""The organ that this process works on: unpacking and its stiffness pattern cost seconds."""


def _organ(mesh: OrganMesh):
    if _LAST.get("hash") != mesh.hash:
        _LAST.clear()
        _LAST.update(hash=mesh.hash, organ=mesh.organ)
    return _LAST["organ"]


def solve(
    mesh: OrganMesh, job: PressJob, folder: str, progress: Callable[[float], None] = lambda depth: None
) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Press once and keep the record; runs in a worker.  A press that cannot be meshed is a record too.

    Args:
        progress: called with each depth (m) that is reached.
    """
    from palpate.fem_offline.deformed import deformed_patch
    from palpate.fem_offline.far_field import FarField
    from palpate.fem_offline.patch import PatchError
    from palpate.fem_offline.press import press
    from palpate.fem_offline.site import open_site, patch_size

    begun, cpu = time.perf_counter(), time.process_time()
    store = Store(Path(folder))

    def far_field(key: str, make: Callable[[], FarField]) -> FarField:
        arrays, _ = store.kept("far_field", key, lambda: (asdict(make()), {}))
        return FarField(**arrays)

    tool, tilt = solid_tool(job.tool), job.tool.tilt
    deepest: dict[str, Any] = {}
    try:
        size = patch_size(tool, job.depths[-1], refinement=job.refinement, tilt=tilt)
        site = open_site(_organ(mesh), np.array(job.contact_point), tool, size, job.fidelity, far_field, tilt)
        record = press(
            site,
            tool,
            np.array(job.depths),
            moves=_moves(job),
            progress=progress,
            watch=lambda depth, found: deepest.update(depth=depth, found=found),
        )
    except (PatchError, ArithmeticError) as error:
        arrays: dict[str, np.ndarray] = {"depth": np.zeros(1), "force_vector": np.zeros((1, 3))}
        values: dict[str, Any] = {"converged": False, "reason": str(error), "lateral": [], "unknowns": 0}
    else:
        fields = {name: getattr(record, name) for name in record.__dataclass_fields__}
        ladders, fields["sliding"] = fields.pop("lateral"), None
        arrays = {name: v for name, v in fields.items() if isinstance(v, np.ndarray)}
        values = {name: v for name, v in fields.items() if not isinstance(v, np.ndarray)}
        values["lateral"] = [
            {name: np.asarray(v).tolist() for name, v in asdict(ladder).items()} for ladder in ladders
        ]
        values["patch"] = {"tets": len(site.patch.tets), "quality": site.patch.quality}
        if job.drag:
            values["drag"] = _dragged(site, tool, job, progress)
        if job.shape and deepest:
            found = deepest["found"]
            shown = deformed_patch(site, found.u, found.contact.traction)
            arrays |= {f"shape_{name}": getattr(shown, name) for name in shown.__dataclass_fields__}
            values["shape_depth"] = deepest["depth"]
    values["seconds"] = time.perf_counter() - begun
    values["cpu_seconds"] = time.process_time() - cpu
    store.write("press", job.key(mesh), arrays, values)
    return arrays, values


def _dragged(site: Any, tool: Any, job: PressJob, progress: Callable[[float], None]) -> dict[str, Any]:
    """`fem_offline.dragging.DragRecord` along its one direction, JSON-clean: None where a drag found nothing."""
    from palpate.fem_offline.dragging import drag

    found = drag(site, tool, job.drag, job.friction, progress=progress)
    paths = [
        {
            "depth": path.depth,
            "direction": path.direction,
            "way": path.way,
            "force_vector": path.force_vector,
            "energy_error": path.energy_error,
            "steady": path.steady,
        }
        for path in found.paths
    ]
    return plain(
        {
            "depth": found.depth,
            "direction": found.directions[0],
            "given": found.friction,
            "friction": found.effective[:, 0],
            "one_way": found.one_way[:, 0],
            "amontons": found.amontons,
            "spread": found.spread,
            "converged": found.converged,
            "reason": found.reason,
            "paths": paths,
        }
    )


def _moves(job: PressJob):
    """Translations for `press`: a function of the state's normal, force and sticking stiffness at a depth index."""
    from palpate.fem_offline.press import PressState

    chosen = {index: (share, angle) for index, share, angle in job.moves}

    def moves(index: int, state: PressState) -> np.ndarray | None:
        frame = tangents(state.normal)
        if job.lateral is not None:
            if index != len(job.depths) - 1:
                return None
            share = np.arange(1, LATERAL_STEPS + 1) / LATERAL_STEPS
            return share[:, None] * (np.array(job.lateral) @ frame)
        if index not in chosen:
            return None
        share, angle = chosen[index]
        direction = np.cos(angle) * frame[0] + np.sin(angle) * frame[1]
        stiffness = float(direction @ state.sticking_stiffness @ direction)
        if not stiffness > 0.0:
            return None
        return (share * job.friction * float(state.force @ state.normal) / stiffness * direction)[None]

    return moves


def _follow_parent(parent: int) -> None:
    """End this process when the one that started it is gone, however it went."""
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)


def _start_worker(slots, parent: int) -> None:
    atexit.register(_LAST.clear)  # search trees that outlive the interpreter make their library complain
    threading.Thread(target=_follow_parent, args=(parent,), daemon=True).start()
    slot = slots.get()
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "palpate" / f"warp-{slot}"
    os.environ["PALPATE_WARP_CACHE"] = str(cache)
    os.dup2(2, 1)  # solvers print; standard output belongs to the answer


@contextmanager
def press_executor(workers: int | None = None) -> Iterator[Executor]:
    """Processes for presses, one for each core by default."""
    count = workers or (
        len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    )
    context = multiprocessing.get_context("spawn")
    manager = context.Manager()
    slots = manager.Queue()
    for slot in range(count):
        slots.put(slot)
    threads = {name: os.environ.get(name) for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS")}
    os.environ.update(dict.fromkeys(threads, "1"))
    executor = ProcessPoolExecutor(
        count, mp_context=context, initializer=_start_worker, initargs=(slots, os.getpid())
    )
    try:
        yield executor
    except BaseException:
        for process in list(getattr(executor, "_processes", {}).values()):
            process.terminate()  # kept records are whole: they are renamed into place
        executor.shutdown(wait=False, cancel_futures=True)
        raise
    else:
        executor.shutdown()
    finally:
        manager.shutdown()
        for name, value in threads.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def run_here(
    mesh: OrganMesh, job: PressJob, store: Store, progress: Callable[[float], None] = lambda depth: None
) -> PressOutcome:
    """The outcome of one job, solved in this process unless it is kept; `progress` as in `solve`."""
    key = job.key(mesh)
    kept = store.read("press", key)
    if kept is not None:
        return PressOutcome(job, key, *kept, fresh=False)
    atexit.register(_LAST.clear)  # see _start_worker
    return PressOutcome(job, key, *solve(mesh, job, str(store.folder), progress))


def run_jobs(
    mesh: OrganMesh,
    jobs: Sequence[PressJob],
    store: Store,
    executor: Executor,
    done: Callable[[PressOutcome], None] = lambda outcome: None,
) -> list[PressOutcome]:
    """Outcomes of all jobs, in their order; kept ones are not solved again.

    Args:
        done: called as each one ends.

    Raises:
        PalpateError: the store cannot be written.  BrokenProcessPool: a worker died.
    """
    outcomes: list[PressOutcome | None] = [None] * len(jobs)
    waiting = {}
    for i, job in enumerate(jobs):
        key = job.key(mesh)
        kept = store.read("press", key)
        if kept is not None:
            outcomes[i] = PressOutcome(job, key, *kept, fresh=False)
            done(outcomes[i])  # type: ignore[arg-type]
        else:
            waiting[executor.submit(solve, mesh, job, str(store.folder))] = i
    while waiting:
        finished, _ = wait(waiting, return_when=FIRST_COMPLETED)
        for future in finished:
            i = waiting.pop(future)
            arrays, values = future.result()
            outcomes[i] = PressOutcome(jobs[i], jobs[i].key(mesh), arrays, values)
            done(outcomes[i])  # type: ignore[arg-type]
    return [outcome for outcome in outcomes if outcome is not None]
