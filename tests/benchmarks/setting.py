# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Where benchmarks press: a scene's organ, contacts spread over its reach, and presses one after the other.

A sequence of presses runs in a fresh worker that has compiled its kernels on another organ, with far fields in a
folder of its own.  So the first press pays what an organ costs once (its search trees, its factor, the Green's
functions around the contact), and later ones what a press costs.  Modes are put together anew by each press, as at a
new contact.
"""

from __future__ import annotations

import shutil
import statistics
import tempfile
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.mechanics import mechanics_version
from palpate.author.organ_parts import organ_parts, rough_summary
from palpate.author.organ_stage import OrganMesh, mesh_organ
from palpate.author.plan import planned_mesh_size
from palpate.author.press_executor import press_executor
from palpate.author.press_jobs import PressJob
from palpate.author.press_solve import solve
from palpate.author.sampling import farthest_points, reach_samples
from palpate.author.scene import Scene
from palpate.author.scene_tables import Support
from palpate.author.scene_types import digest
from palpate.author.store import Result, Store
from palpate.author.tool_stage import ToolShape, shape_of
from palpate.author.tool_work import ladder
from palpate.fem_offline.block import block
from palpate.fem_offline.organ import boundary_faces

__all__ = ["Setting", "clean", "middle", "press_cpu", "say_of", "warm_up"]

CONTACTS = 32
"""Contacts of a setting; each prefix is well spread too."""


@dataclass
class Setting:
    """A scene's organ and what presses it.

    Attributes:
        scene: of which the first tool presses.
        store: meshes and finished measurements.
        say: gets a sentence now and then.
    """

    scene: Scene
    store: Store
    say: Callable[[str], None] = lambda sentence: None

    @cached_property
    def mesh(self) -> OrganMesh:
        return mesh_organ(self.scene, self.store)

    @cached_property
    def mesh_size(self) -> float:
        """m."""
        return planned_mesh_size(self.scene, rough_summary(organ_parts(self.scene))[0])

    def meshed(self, size: float) -> OrganMesh:
        """The same organ with tetrahedra of another size (m)."""
        organ = self.scene.organ.model_copy(update={"mesh_size": size})
        return mesh_organ(self.scene.model_copy(update={"organ": organ}), self.store)

    @property
    def tool(self) -> ToolShape:
        return shape_of(self.scene, self.scene.tool[0])

    @property
    def depth_max(self) -> float:
        """m; one tool radius, where the tool has one and the tissue is thick enough for the scene."""
        return (
            self.scene.tool[0].radius[0]
            if self.scene.tool[0].radius
            else self.scene.depth_max(self.scene.tool[0])
        )

    @cached_property
    def contacts(self) -> np.ndarray:
        """(n, 3) m."""
        samples = reach_samples(self.mesh, self.scene.reach, self.tool, self.depth_max)
        return samples.points[farthest_points(samples, CONTACTS)]

    def job(self, contact: np.ndarray, fidelity: str = "near_field", **other: Any) -> PressJob:
        """A ladder of ten depths to `depth_max`."""
        depths = tuple(map(float, ladder(self.depth_max)))
        job = PressJob(tuple(map(float, contact)), self.tool, depths, fidelity)
        return replace(job, **other)

    def sequence(self, name: str, mesh: OrganMesh, jobs: Sequence[PressJob]) -> list[dict[str, Any]]:
        """Values of press records (press_solve.py) with the normal forces (N), one after the other in one worker."""

        def make() -> dict[str, Any]:
            found = []
            with self.far_fields() as folder, press_executor(1) as executor:
                warm_up(executor, mesh, jobs[0])
                for count, job in enumerate(jobs, start=1):
                    shutil.rmtree(folder / "FarModes", ignore_errors=True)
                    found.append(clean(executor.submit(solve, mesh, job, str(folder)).result()))
                    self.say(f"{name}: {count}/{len(jobs)}, {say_of(found[-1])}")
            return {"presses": found}

        return self.kept(name, [job.key(mesh) for job in jobs], make)["presses"]

    def kept(self, name: str, what: Any, make: Callable[[], dict[str, Any]]) -> dict[str, Any]:
        """A finished measurement of this mechanics, or a new one."""
        key = digest({"name": name, "what": what, "mechanics": mechanics_version(), "version": 1})
        return self.store.kept("benchmark", key, lambda: ({}, make()))[1]

    def far_fields(self) -> Folder:
        """A folder for far fields, gone afterwards."""
        self.store.folder.mkdir(parents=True, exist_ok=True)
        return Folder(self.store.folder)


class Folder(tempfile.TemporaryDirectory):
    """A temporary folder as a Path."""

    def __init__(self, under: Path) -> None:
        super().__init__(prefix="far-fields-", dir=under)

    def __enter__(self) -> Path:
        return Path(super().__enter__())


def warm_up(executor: Executor, mesh: OrganMesh, job: PressJob, workers: int = 1) -> None:
    """Press a small block of the organ's tissue: workers start, kernels are compiled."""
    found = block((0.03, 0.03, 0.015), (4, 4, 2))
    faces = boundary_faces(found.tets)
    base = Support(box={"min": (-1.0, -1.0, -1.0), "max": (1.0, 1.0, -0.0149)})
    small = OrganMesh(
        found.points, faces, found.points, found.tets, "block", mesh.material, (base,), (), {}, "warm-up", mesh.capsule
    )  # fmt: skip
    shallow = replace(
        job, contact_point=(0.0, 0.0, 0.0), depths=(0.2 * job.depths[-1],), fidelity="near_field"
    )
    with tempfile.TemporaryDirectory() as folder:
        for future in [executor.submit(solve, small, shallow, folder) for _ in range(workers)]:
            future.result()


def clean(result: Result) -> dict[str, Any]:
    """A press record's values, with its normal forces."""
    arrays, values = result
    kept = {name: value for name, value in values.items() if name not in ("lateral", "drag")}
    if "normal" in arrays:
        kept["force"] = (arrays["force_vector"] @ arrays["normal"]).tolist()
    return kept


def press_cpu(press: dict[str, Any]) -> float:
    """CPU seconds of a press, without unpacking the organ."""
    return sum(seconds for stage, seconds in press["stages"].items() if stage != "organ")


def say_of(press: dict[str, Any]) -> str:
    tried = "".join(f", after {t['fidelity']} at {1e3 * t['radius']:.0f} mm" for t in press.get("tried", []))
    why = "" if press["converged"] else f", not converged: {press['reason']}"
    return f"{press.get('fidelity', '-')}{tried}, {press_cpu(press):.1f} CPU s{why}"


def middle(values: Iterable[float]) -> float:
    """Median; NaN of nothing."""
    found = list(values)
    return statistics.median(found) if found else float("nan")
