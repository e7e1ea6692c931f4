# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What one tool asks for: its places, its presses, its field, its judgement."""

from __future__ import annotations

import json
import platform
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.effort import node_count, region_nodes, seed_count
from palpate.author.errors import InputError
from palpate.author.field_stage import field_of, knots_of, press_arrays
from palpate.author.held_out import held_out_jobs, judgement, quasi_static
from palpate.author.mechanics import mechanics_version
from palpate.author.node_rounds import NodeRounds
from palpate.author.organ_stage import OrganMesh
from palpate.author.painted_friction import friction_at
from palpate.author.press_jobs import PressJob, PressOutcome
from palpate.author.sampling import ReachSamples, held_out_points, reach_samples
from palpate.author.sampling_by_error import SamplingByError
from palpate.author.scene import Scene
from palpate.author.scene_tables import Tool
from palpate.author.scene_types import digest
from palpate.author.seeds import above_regions, places_of
from palpate.author.tool_stage import ToolShape, contact_extent, heading_matters, reference_of, shape_of
from palpate.fields.response_field import ContactGeometry, ResponseField

__all__ = ["TRUTH", "ToolWork", "cooked", "ladder", "versions"]

LADDER_STEPS = 10
"""Depths of a normal ladder, evenly spaced: a step of 0.1 R at depth R."""
APART = 0.5
"""Least distance between nodes, in contact radii."""
NEAR_CHECKS = 2
"""Held-out points pressed at near_field fidelity as well, so that the far field's own error is known."""
HASH_BEGINNING = 16
"""Hex digits by which a summary names a press (count)."""
TRUTH = "full"
"""Fidelity of held-out presses."""


def ladder(depth_max: float) -> np.ndarray:
    """(LADDER_STEPS,) m."""
    return depth_max * np.arange(1, LADDER_STEPS + 1) / LADDER_STEPS


class ToolWork:
    """One tool of a scene.  `samples`: where it may press, found when None."""

    def __init__(
        self, scene: Scene, mesh: OrganMesh, tool: Tool, samples: ReachSamples | None = None
    ) -> None:
        self.tool, self._scene, self._mesh = tool, scene, mesh
        self.shape = shape_of(scene, tool)
        self.reference = reference_of(tool.name, self.shape)
        self.depth_max = scene.depth_max(tool)
        self.seed = scene.accuracy.seed
        self.samples = samples or reach_samples(mesh, scene.reach, self.shape, self.depth_max)
        if not self.samples.allowed.any():
            why = "; ".join(f"{count} places: {reason}" for reason, count in self.samples.left_out.items())
            raise InputError(
                scene.problem("reach", None, f"has no place that {tool.name} can press ({why or 'nothing there'})",
                              "free, thick enough surface of the organ, outside its supports")
            )  # fmt: skip
        _refuse_jumping_heading(scene, tool, self.shape, self.samples)
        area = len(self.samples.points) * self.samples.spacing**2
        count = scene.accuracy.nodes or node_count(area, scene.accuracy.force_tolerance)
        self.seeds = seed_count(count)
        self.most = scene.accuracy.nodes or count + region_nodes(len(mesh.regions))
        self._held = held_out_points(self.samples, scene.accuracy.held_out, self.seed)
        if len(self._held) == np.count_nonzero(self.samples.allowed):
            what = f"leaves {tool.name} no place for a node: the reach has {len(self._held)} places, all held out"
            expected = "fewer, or a larger reach"
            raise InputError(scene.problem("accuracy.held_out", scene.accuracy.held_out, what, expected))
        held = self.samples.points[self._held]
        self._surface = "deformation" in scene.effects
        self._deformation: dict[str, Any] = {}
        self.held_jobs = [replace(job, surface=self._surface) for job in self._held_out(held)]
        near = self.held_jobs[:NEAR_CHECKS] if scene.accuracy.fidelity == "near_field" else []
        self.near_jobs = [
            PressJob(job.contact_point, job.tool, job.depths, "near_field", stiffness=job.stiffness)
            for job in near
        ]
        self.failures: list[dict[str, Any]] = []
        self._checks: dict[PressJob, PressOutcome] = {}

    def begin(
        self, geometry: Callable[[], ContactGeometry], width: int, out_of_time: Callable[[], bool]
    ) -> list[PressJob]:
        """The presses to begin with: seeds, then what judges, which keeps everybody busy while the seeds are read.

        Args:
            geometry: makes it; called while the seeds are pressed.
            width: presses that are chosen at once (count).
            out_of_time: whether the time budget is spent.
        """
        scene, offset = self._scene, self.reference.offset
        places = places_of(self.samples, self._held)
        contact = contact_extent(self.shape, self.depth_max)
        even = places.even[: self.seeds]
        seeds = [*even, *above_regions(self._mesh, places, contact)]
        self._even = len(even)

        def sampling() -> SamplingByError:
            terrain = places.terrain(geometry(), offset - 0.5 * self.depth_max)
            tolerance = 0.0 if scene.accuracy.nodes else scene.accuracy.force_tolerance
            return SamplingByError(terrain, geometry(), offset, tolerance, self.most, APART * contact)

        self.rounds = NodeRounds(
            seeds[: self.most],
            lambda i: self._job(places.position[i], scene.accuracy.fidelity),
            lambda outcome: press_arrays(scene, self.tool, outcome, self._mesh)[0],
            sampling,
            knots_of(scene, self.tool),
            width,
            out_of_time,
        )
        return [*self.rounds.seeds(), *self.held_jobs, *self.near_jobs]

    def arrived(self, outcome: PressOutcome) -> None:
        self._checks[outcome.job] = outcome
        self.rounds.arrived(outcome)

    def more(self) -> list[PressJob]:
        """Presses that what has arrived asks for."""
        return self.rounds.more()

    @property
    def presses_at_most(self) -> int:
        """Of nodes and of what judges."""
        return self.most + len(self.held_jobs) + len(self.near_jobs)

    def _friction(self, points: np.ndarray) -> np.ndarray:
        """(n,) at points (n, 3) m."""
        at = friction_at(self._scene.effects, self.tool.friction, self._mesh, points)
        return np.zeros(len(points)) if at is None else at

    def _held_out(self, points: np.ndarray) -> list[PressJob]:
        return held_out_jobs(
            points, self.shape, ladder(self.depth_max), self._friction(points), TRUTH, self.seed
        )

    def _job(self, point: np.ndarray, fidelity: str) -> PressJob:
        depths = tuple(map(float, ladder(self.depth_max)))
        return PressJob(
            tuple(map(float, point)),
            self.shape,
            depths,
            fidelity,
            refinement=self._scene.accuracy.patch_refinement or 1.0,
            patch_radius=self._scene.accuracy.patch_radius,
            surface=self._surface,
            stiffness="friction" in self._scene.effects,
        )

    @property
    def node_origins(self) -> dict[str, list[str]]:
        """Beginnings of the nodes' press hashes, by why they were pressed (report/node_origins.py)."""
        first, *later = self.rounds.batches
        parts = {
            "seed": first[: self._even],
            "region": first[self._even :],
            "error": [i for b in later for i in b],
        }
        return {
            why: [self.rounds.key(i)[:HASH_BEGINNING] for i in places]
            for why, places in parts.items()
            if places
        }

    @property
    def node_outcomes(self) -> list[PressOutcome]:
        return self.rounds.outcomes

    def fit(self, geometry: ContactGeometry) -> ResponseField:
        field, self.failures = field_of(
            self._scene,
            self.tool,
            self._mesh,
            self.samples,
            geometry,
            self.node_outcomes,
            self._provenance(self._scene, self.tool),
        )
        if self._surface:
            from palpate.author.deformation_stage import with_deformation

            depths = ladder(self.depth_max).tolist()
            held = self._outcomes(self.held_jobs)
            field, found = with_deformation(field, self.shape, depths, self.node_outcomes, held)
            self._deformation = {"deformation_error": found.pop("error"), "deformation": found}
        return field

    def _provenance(self, scene: Scene, tool: Tool) -> dict[str, Any]:
        return {
            "scene": {
                "hash": digest(scene.hash_inputs()),
                "name": scene.name,
                "effects": list(scene.effects),
                "support": [s.model_dump(mode="json", exclude_none=True) for s in scene.organ.support],
                "region": [r.model_dump(mode="json", exclude_none=True) for r in scene.organ.region],
                "reach": scene.reach.model_dump(mode="json", exclude_none=True),
                "material": scene.organ.material.model_dump(mode="json", exclude_none=True),
                "paint": scene.organ.paint and scene.organ.paint.model_dump(exclude_none=True),
                "capsule": scene.organ.capsule
                and scene.organ.capsule.model_dump(mode="json", exclude_none=True),
                "tool": tool.model_dump(mode="json", exclude_none=True),
                "accuracy": scene.accuracy.model_dump(mode="json", exclude_none=True),
            },
            "organ": self._mesh.hash,
            "tool": self.reference.hash,
            "presses": {
                "mechanics": mechanics_version(),
                "fidelity": scene.accuracy.fidelity,
                "depths": LADDER_STEPS,
            },
            "sampling": self.rounds.sampling.report(),
            "seed": self.seed,
            "versions": versions(),
        }

    def cook(self, out: Path, field: ResponseField) -> dict[str, Any]:
        """Writes what the runtime reads; the tool's row of the summary."""
        row = cooked(out / f"{field.tool.name}.rfield", field)
        return {**row, "nodes": field.nodes.node_count, **self._deformation}

    def validate(self, out: Path, field: ResponseField, row: dict[str, Any]) -> dict[str, Any]:
        """Judges what `cook` wrote and said in `row`."""
        judged = {"tool": self.tool.name, "seed": self.seed, **self._judged(field, row), **self._deformation}
        path = out / "validation" / f"{self.tool.name}.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(judged))
        return judged

    def _judged(self, field: ResponseField, row: dict[str, Any]) -> dict[str, Any]:
        return judgement(
            quasi_static(Path(row["rfield"]).read_bytes()),
            field.tool.offset,
            self._outcomes(self.held_jobs),
            self._outcomes(self.near_jobs),
            self._scene.accuracy.force_tolerance,
        )

    def _outcomes(self, jobs: Sequence[PressJob]) -> list[PressOutcome]:
        return [self._checks[job] for job in jobs]


def cooked(path: Path, field: ResponseField) -> dict[str, Any]:
    """Writes `field` to `path`; what a summary says of it."""
    from palpate.fields.cook import write_rfield

    write_rfield(field, path)
    size = path.stat().st_size
    return {
        "name": field.tool.name,
        "rfield": str(path),
        "bytes": size,
        "representation": field.representation,
    }


def _refuse_jumping_heading(scene: Scene, tool: Tool, shape: ToolShape, samples: ReachSamples) -> None:
    """A tool that is not round has a heading, which `tangents` can only give smoothly over part of a surface."""
    leaning = np.unique(np.argmin(np.abs(samples.normals[samples.allowed]), axis=1))
    if heading_matters(shape) and len(leaning) > 1:
        key = f"tool[{scene.tool.index(tool)}]"
        what = "is not round about the surface's normal, and its heading would jump within the reach"
        expected = "a smaller or flatter reach, a round tool held upright, or single presses (palpate press)"
        raise InputError(scene.problem(key, tool.name, what, expected))


@lru_cache
def versions() -> dict[str, str]:
    """Of what made an asset."""
    names = ("palpate", "numpy", "scipy", "warp-lang", "usd-core", "pytetwild", "mmgpy", "pymeshlab")
    return {**{name: metadata.version(name) for name in names}, "python": platform.python_version()}
