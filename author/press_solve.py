# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a worker does with a press job: open the site, climb the ladder, drag, and hand back plain arrays.

Nothing is kept here but far fields, in a folder that may be the run's own or the worker's: a far field that cannot be
kept is made again another time, and the press goes on.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.console import plain
from palpate.author.errors import PalpateError
from palpate.author.mechanics import mechanics_version
from palpate.author.memory import peak_memory, restart_peak_memory
from palpate.author.organ_stage import OrganMesh
from palpate.author.press_jobs import PressJob
from palpate.author.scene_types import digest
from palpate.author.store import Result, Store
from palpate.author.tool_stage import solid_tool
from palpate.fem_offline.far_modes import FarModes
from palpate.fem_offline.pose import tangents

__all__ = ["forget_organ", "solve"]

VOUCHED = 0.02
"""Far-field error (fraction of force) above which a near-field press is not taken."""
LATERAL_STEPS = 4
"""Equilibria of an explicit sticking move."""


_LAST: dict[str, Any] = {}
"""The organ that this process works on: unpacking and its stiffness pattern cost seconds."""
_LAST_LOCK = threading.Lock()
"""Presses of one process may run in threads (batch_executor.py)."""


def forget_organ() -> None:
    """Lets go of the last organ: its search trees must not outlive the interpreter."""
    _LAST.clear()


def solve(
    mesh: OrganMesh, job: PressJob, folder: str, progress: Callable[[float], None] = lambda depth: None
) -> Result:
    """Press once.  A press that cannot be meshed is a record too.

    Args:
        folder: of the Store that keeps far fields.
        progress: called with each depth (m) that is reached.

    Returns:
        Arrays of `fem_offline.press.PressRecord`, and its scalars, JSON-clean, with

            lateral: sticking moves.  patch: its size and quality.
            fidelity: what vouches for the record; tried: what was pressed before, with its estimate.
            estimate: worst far-field error of any depth (fraction of force); None where nothing tells.
            seconds, cpu_seconds: wall and CPU time.
            stages: CPU seconds by stage: organ (unpacked on first use), patch, far_field, ladder, drag.
            far_field_kept: nothing was solved on the whole organ for it; None where no far field was asked for.
            peak_memory: bytes; the largest resident set of the process during this press (memory.py).
    """
    from palpate.fem_offline.deformed import deformed_patch
    from palpate.fem_offline.patch import PatchError

    begun, cpu = time.perf_counter(), _cpu_time()
    restart_peak_memory()
    clock, far_fields = _StageClock(), _FarFields(Store(Path(folder)))
    try:
        with clock("organ"):
            organ = _organ(mesh)
        done = _press_until_vouched(organ, job, far_fields, clock, progress)
    except (PatchError, ArithmeticError) as error:
        arrays: dict[str, np.ndarray] = {"depth": np.zeros(1), "force_vector": np.zeros((1, 3))}
        values: dict[str, Any] = {"converged": False, "reason": str(error), "lateral": [], "unknowns": 0}
    else:
        record, site = done.record, done.site
        fields = {name: getattr(record, name) for name in record.__dataclass_fields__}
        ladders, fields["sliding"] = fields.pop("lateral"), None
        arrays = {name: v for name, v in fields.items() if isinstance(v, np.ndarray)}
        values = {name: v for name, v in fields.items() if not isinstance(v, np.ndarray)}
        values["lateral"] = [
            {name: np.asarray(v).tolist() for name, v in asdict(ladder).items()} for ladder in ladders
        ]
        values["patch"] = {"tets": len(site.patch.tets), "quality": site.patch.quality}
        values["tried"] = done.tried
        worst = record.far_field_error.max()
        values["estimate"] = float(worst) if np.isfinite(worst) else None
        if job.drag:
            with clock("drag"):
                values["drag"] = _dragged(site, solid_tool(job.tool), job, progress)
        if job.shape and done.deepest is not None:
            depth, found = done.deepest
            shown = deformed_patch(site, found.u, found.contact.traction)
            arrays |= {f"shape_{name}": getattr(shown, name) for name in shown.__dataclass_fields__}
            values["shape_depth"] = depth
        if done.surface is not None:
            arrays |= done.surface.arrays()
    clock.moves("patch", "far_field", far_fields.cpu_seconds)
    values["seconds"] = time.perf_counter() - begun
    values["cpu_seconds"] = _cpu_time() - cpu
    values["stages"] = clock.seconds
    values["far_field_kept"] = far_fields.kept
    values["peak_memory"] = peak_memory()
    return arrays, values


@dataclass(frozen=True)
class _Pressed:
    site: Any
    record: Any
    deepest: tuple[float, Any] | None
    tried: list[dict[str, Any]]
    surface: Any


def _press_until_vouched(
    organ: Any, job: PressJob, far_fields: _FarFields, clock: _StageClock, progress: Callable[[float], None]
) -> _Pressed:
    """Press as asked; a near field that cannot vouch for VOUCHED gives way to full."""
    from palpate.fem_offline.press import press
    from palpate.fem_offline.site import open_site, patch_size

    tool, tilt = solid_tool(job.tool), job.tool.tilt
    radius = {} if job.patch_radius is None else {"radius": job.patch_radius}
    size = patch_size(tool, job.depths[-1], refinement=job.refinement, tilt=tilt, **radius)
    tried: list[dict[str, Any]] = []
    while True:
        fidelity = "full" if tried else job.fidelity
        deepest: dict[str, Any] = {}
        with clock("patch"):
            site = open_site(organ, np.array(job.contact_point), tool, size, fidelity, far_fields, tilt)
        surface = _surface(organ, site, job) if job.surface else None

        def watch(depth: float, found: Any, seen: dict[str, Any] = deepest, surface: Any = surface) -> None:
            seen.update(depth=depth, found=found)
            if surface is not None:
                surface.watch(depth, found)

        with clock("ladder"):
            record = press(
                site,
                tool,
                np.array(job.depths),
                moves=_moves(job),
                progress=progress,
                watch=watch,
                stiffness=job.stiffness,
            )
        worst = float(record.far_field_error.max())
        if fidelity != "near_field" or not worst > VOUCHED:
            last = (deepest["depth"], deepest["found"]) if deepest else None
            return _Pressed(site, record, last, tried, surface)
        tried.append({"fidelity": fidelity, "estimate": worst})


def _surface(organ: Any, site: Any, job: PressJob) -> Any:
    from palpate.fem_offline.surface_displacement import SurfaceDisplacement

    return SurfaceDisplacement(organ, site, len(job.depths))


def _cpu_time() -> float:
    """s of this process; of this thread where others press beside it (their common launches are in none's)."""
    alone = threading.current_thread() is threading.main_thread()
    return time.process_time() if alone else time.thread_time()


def _organ(mesh: OrganMesh):
    with _LAST_LOCK:
        if _LAST.get("hash") != mesh.hash:
            _LAST.clear()
            _LAST.update(hash=mesh.hash, organ=mesh.organ)
        return _LAST["organ"]


class _StageClock:
    """CPU seconds of this process by stage."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextmanager
    def __call__(self, stage: str) -> Iterator[None]:
        begun = _cpu_time()
        try:
            yield
        finally:
            self.seconds[stage] = self.seconds.get(stage, 0.0) + _cpu_time() - begun

    def moves(self, giver: str, taker: str, seconds: float) -> None:
        """`seconds` of what `giver` took were the work of `taker`."""
        self.seconds[giver] = self.seconds.get(giver, 0.0) - seconds
        self.seconds[taker] = seconds


class _FarFields:
    """Far fields through a store: what they cost (CPU seconds), and whether the whole organ was left alone.

    They are kept by organ and mechanics, as presses are: other code may make others.

    Attributes:
        kept: None where no far field was asked for; False where one was made that takes the whole organ.
    """

    def __init__(self, store: Store) -> None:
        self.store = store
        self.cpu_seconds = 0.0
        self.kept: bool | None = None
        self._making = 0

    def __call__(self, kind: type, key: str, make: Callable[[], Any]) -> Any:
        key = digest({"far_field": key, "mechanics": mechanics_version()})
        begun = _cpu_time()
        self._making += 1  # making one may ask for others, whose time is in its own
        try:
            self.kept = self.kept is not False
            found = self.store.read(kind.__name__, key)
            if found is not None:
                return kind(**found[0])
            made = make()
            self.kept = self.kept and kind is FarModes  # which are put together from kept ones
            with suppress(PalpateError):
                self.store.write(kind.__name__, key, asdict(made), {})
            return made
        finally:
            self._making -= 1
            if not self._making:
                self.cpu_seconds += _cpu_time() - begun


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
