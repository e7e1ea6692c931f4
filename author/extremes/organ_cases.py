# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Extremes on a scene's own organ: one place in its reach, its first tool, and what can be said of any organ.

Stiffness times f gives force times f; lengths times s give force times s^2; a press agrees with a finer one; friction
adds little to a press and takes nothing from it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from palpate.author.extremes.block_press import pressed
from palpate.author.extremes.case import Case, Refused, Wrong, close_to, not_above
from palpate.author.extremes.rubbing_cases import NEXT_TO_NOTHING
from palpate.author.organ_stage import OrganMesh, mesh_organ
from palpate.author.scene import Scene
from palpate.author.store import Store
from palpate.author.tool_members import members_of
from palpate.author.tool_stage import shape_of, solid_tool
from palpate.fem_offline.organ import Organ
from palpate.fem_offline.tool import Sphere, Tool

__all__ = ["organ_cases"]

MOST_STUCK = 1.0986
"""Largest force over that without friction: ln 3, at nu = 0 (rubbing_cases.py)."""


@dataclass(frozen=True)
class Subject:
    """A scene's organ, and where and with what it is pressed.

    Attributes:
        work: folder that keeps surface and mesh.
    """

    scene: Scene
    work: Path

    @cached_property
    def mesh(self) -> OrganMesh:
        return mesh_organ(self.scene, Store(self.work))

    @cached_property
    def organ(self) -> Organ:
        return self.mesh.organ

    @cached_property
    def place(self) -> np.ndarray:
        """(3,) m; of the surface that may be touched, the point nearest to its middle."""
        x = self.mesh.vertices[self.mesh.triangles].mean(axis=1)
        free = self.mesh.reachable(x) & ~self.mesh.supported(x)
        if self.scene.reach.is_given:
            free &= self.scene.reach.contains(x)
        if not free.any():
            raise Refused("the reach holds no surface that can move")
        x = x[free]
        return x[np.argmin(np.linalg.norm(x - x.mean(axis=0), axis=1))]

    @cached_property
    def tool(self) -> Tool:
        scene, tool = next(iter(members_of(self.scene, self.scene.tool[0])))
        return solid_tool(shape_of(scene, tool))

    @property
    def depth(self) -> float:
        """m; a fifth of the deepest press."""
        return 0.2 * self.scene.depth_max(self.scene.tool[0])

    def force(self, organ: Organ | None = None, tool: Tool | None = None, depth: float = 0.0, **how) -> float:
        how = {"place": self.place, "patch": 20e-3, **how}
        record = pressed(organ or self.organ, tool or self.tool, [depth or self.depth], **how)
        return float(record.force[-1])

    @cached_property
    def usual(self) -> float:
        return self.force()


def organ_cases(scene: Scene, work: Path) -> Iterator[Case]:
    s = Subject(scene, work)
    if scene.organ.capsule is None:
        for modulus in (10.0, 1e10):
            yield Case(
                "stiffness",
                f"{modulus:g} Pa on this organ",
                lambda E=modulus: _stiffness(s, E),
                modulus == 10.0,
            )
        for factor in (0.1, 10.0):
            yield Case("organ_size", f"this organ times {factor:g}", lambda f=factor: _size(s, f))
    for share in (0.1, 0.4, 0.9, 1.5):
        value = f"{100 * share:g} % of the thickness here"
        yield Case("depth", value, lambda x=share: _depth(s, x), share == 1.5)
    for radius in (1e-4, 1e-3):
        yield Case("tool", f"ball of {1e3 * radius:g} mm on this organ", lambda r=radius: _ball(s, r))
    for friction in (0.0, 10.0):
        value = f"{friction:g} on this organ, by finite elements"
        yield Case("friction", value, lambda mu=friction: _friction(s, mu))


def _stiffness(s: Subject, modulus: float) -> str:
    factor = modulus / s.organ.material[0].youngs_modulus
    before, elastic = s.organ.scale, s.organ.elastic
    scaled = replace(
        s.organ,
        scale=lambda x: factor * (np.ones(len(x)) if before is None else before(x)),
        elastic=None if elastic is None else lambda x: factor * elastic(x),
        hash=f"{s.organ.hash} stiffness {factor}",
    )
    return close_to("force against the stiffness", s.force(scaled) / s.usual, factor, 1e-4)


def _size(s: Subject, factor: float) -> str:
    organ, at = s.organ, s.organ.label_at
    if organ.elastic is not None or organ.scale is not None or not isinstance(s.tool, Sphere):
        raise Refused(
            "elastic supports, paint and tools that are no balls have no simple similarity; not scaled"
        )

    def project(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        points, normals = organ.project(x / factor)
        return factor * points, normals

    scaled = replace(
        organ,
        points=factor * organ.points,
        held=lambda x: organ.held(x / factor),
        project=project,
        label_at=None if at is None else lambda x: at(x / factor),
        hash=f"{organ.hash} size {factor}",
    )
    force = s.force(
        scaled, Sphere(factor * s.tool.radius), factor * s.depth, place=factor * s.place, patch=factor * 20e-3
    )
    return close_to("force over length squared", force / factor**2, s.usual, 0.01)


def _depth(s: Subject, share: float) -> str:
    points, normals = s.organ.project(s.place[None])
    thickness = s.organ.thickness(points[0], normals[0])
    ladder = share * thickness * (np.arange(1, 4) / 3 if share < 1.0 else np.ones(1))
    how = {"place": s.place, "patch": 20e-3}
    ours = pressed(s.organ, s.tool, ladder, **how, refinement=0.8)
    fine = pressed(s.organ, s.tool, ladder, **how, refinement=1.1)
    return close_to(
        "force against a fresh press on a finer mesh", float(ours.force[-1]), float(fine.force[-1]), 0.03
    )


def _ball(s: Subject, radius: float) -> str:
    forces = [s.force(tool=Sphere(radius), depth=0.1 * radius, refinement=r) for r in (1.0, 1.3)]
    return close_to("force against a fresh press on a finer mesh", *forces, 0.03)


def _friction(s: Subject, friction: float) -> str:
    ratio = s.force(friction=friction or NEXT_TO_NOTHING) / s.usual
    if not friction:
        return close_to(f"force at {NEXT_TO_NOTHING:g} against the press without any", ratio, 1.0, 1e-2)
    if ratio < 1.0 - 1e-2:
        raise Wrong(f"friction made the press softer, {ratio:.4f} times")
    return not_above("force over that without friction", ratio, MOST_STUCK + 1e-2)
