# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""From a scene to an organ that can be pressed: repaired surface, tetrahedra, regions, supports.

Surface and tetrahedra are kept by the hash of the surface file and the settings: fTetWild is not deterministic, so
the first mesh stays the mesh.
"""

from __future__ import annotations

import hashlib
from dataclasses import asdict, dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from palpate.author.errors import InputError
from palpate.author.material_range import refuse_unstable_materials
from palpate.author.organ_check import OrganSummary, check_against_organ
from palpate.author.organ_parts import organ_parts
from palpate.author.paint import REACHED, read_paint
from palpate.author.plan import planned_mesh_size
from palpate.author.scene import Scene
from palpate.author.scene_tables import Capsule, Material, Region, Support
from palpate.author.scene_types import digest
from palpate.author.solid import material_values, skin_of, solid_of
from palpate.author.store import Store
from palpate.fem_offline.errors import MeshError, SurfaceError
from palpate.fem_offline.organ import Organ
from palpate.fem_offline.signed_distance import SignedDistance
from palpate.fem_offline.surface import OrganSurface, repair_surface
from palpate.fem_offline.tetrahedra import tetrahedralise
from palpate.fields.organ_geometry import OrganGeometry
from palpate.fields.organ_geometry import Support as GeometrySupport

__all__ = ["OrganMesh", "mesh_organ"]


@dataclass(frozen=True)
class OrganMesh:
    """An organ's surface and tetrahedra with what the scene says about them; picklable.

    Attributes:
        vertices (V, 3) m, triangles (F, 3): the smooth closed surface.
        points (P, 3) m, tets (T, 4): tetrahedra, positive.
        material, supports, regions, capsule: the scene's tables.
        report: surface and mesh reports, JSON-clean.
        hash: hex digest of mesh, materials, painted stiffness, capsule and supports; every press depends on it.
        paint: painted scalars by kind (paint.py), (V,) at the vertices.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    points: np.ndarray
    tets: np.ndarray
    name: str
    material: Material
    supports: tuple[Support, ...]
    regions: tuple[Region, ...]
    report: dict[str, Any]
    hash: str
    capsule: Capsule | None = None
    paint: dict[str, np.ndarray] = field(default_factory=dict)

    def painted(self, kind: str, points: np.ndarray) -> np.ndarray | None:
        """(n, 3) m -> (n,) at the closest points of the surface; None where nothing of that kind is painted."""
        if kind not in self.paint:
            return None
        _, triangle, weight = self.distance.closest(points)
        return np.sum(weight * self.paint[kind][self.triangles[triangle]], axis=1)

    def _stiffness_scale(self, points: np.ndarray) -> np.ndarray:
        scale = self.painted("stiffness_scale", points)
        assert scale is not None
        return scale

    def reachable(self, points: np.ndarray) -> np.ndarray:
        """(n, 3) m -> (n,) bool; where the paint lets a tool touch, everywhere without paint."""
        painted = self.painted("reach", points)
        return np.ones(len(points), bool) if painted is None else painted >= REACHED

    def held(self, points: np.ndarray) -> np.ndarray:
        """(n, 3) m -> (n,) bool; inside a fixed support."""
        inside = np.zeros(len(points), bool)
        for support in self.supports:
            inside |= (support.kind == "fixed") & support.contains(points)
        return inside

    def spring(self, points: np.ndarray) -> np.ndarray:
        """(n, 3) m -> (n,) Pa/m; of elastic supports, added up where they overlap."""
        stiffness = np.zeros(len(points))
        for support in self.supports:
            if support.kind == "elastic":
                stiffness += support.stiffness * support.contains(points)
        return stiffness

    def supported(self, points: np.ndarray) -> np.ndarray:
        """(n, 3) m -> (n,) bool; inside a support of any kind, where no tool is let."""
        return self.held(points) | (self.spring(points) > 0.0)

    def label_at(self, points: np.ndarray) -> np.ndarray:
        """(n, 3) m -> (n,) int; 0: the organ's tissue, k: the scene's k-th region; later regions win."""
        label = np.zeros(len(points), int)
        for k, region in enumerate(self.regions, start=1):
            label[region.contains(points)] = k
        return label

    @cached_property
    def distance(self) -> SignedDistance:
        return SignedDistance(self.vertices, self.triangles)

    @cached_property
    def organ(self) -> Organ:
        """The mechanics' view."""
        materials = [self.material, *(region.material for region in self.regions)]
        return Organ(
            self.points,
            self.tets.astype(np.int64),
            {k: solid_of(material) for k, material in enumerate(materials)},
            self.label_at(self.points[self.tets].mean(axis=1)),
            self.held,
            self.distance.project,
            self.hash,
            self.label_at if self.regions else None,
            elastic=self.spring if any(s.kind == "elastic" for s in self.supports) else None,
            capsule=None if self.capsule is None else skin_of(self.capsule),
            scale=self._stiffness_scale if "stiffness_scale" in self.paint else None,
        )

    def geometry(self, reach: np.ndarray) -> OrganGeometry:
        """The asset's view; reach (F,) bool of surface triangles that a tool may touch."""
        organ = self.organ
        supports = []
        for i, support in enumerate(self.supports):
            inside = support.contains(self.points)
            mine = organ.faces[inside[organ.faces].all(axis=1)]
            shown = np.flatnonzero(support.contains(self.vertices)[self.triangles].all(axis=1))
            supports.append(
                GeometrySupport(
                    f"support_{i}",
                    np.unique(mine).astype(np.int32),
                    shown.astype(np.int32),
                    support.kind,
                    support.stiffness or 0.0,
                )
            )
        return OrganGeometry(
            name=self.name,
            vertices=self.vertices,
            triangles=self.triangles.astype(np.int32),
            tet_points=self.points,
            tet_indices=self.tets.astype(np.int32),
            supports=tuple(supports),
            region_names=("tissue", *(region.name for region in self.regions)),
            region_label=organ.label.astype(np.int32),
            reach_triangles=np.flatnonzero(reach).astype(np.int32),
            material=material_values(self.material) | self._capsule_values,
            region_materials={region.name: material_values(region.material) for region in self.regions},
            provenance={"surface": self.report["surface"], "mesh": self.report["mesh"]},
            paint=self.paint,
        )

    @property
    def _capsule_values(self) -> dict[str, Any]:
        if self.capsule is None:
            return {}
        material = material_values(self.capsule.material)
        return {"capsule": {"thickness": self.capsule.thickness, "material": material}}

    def __getstate__(self) -> dict[str, Any]:
        return {k: v for k, v in self.__dict__.items() if k not in ("distance", "organ")}


def mesh_organ(scene: Scene, store: Store) -> OrganMesh:
    """Repair and tetrahedralise the scene's organ, or take what is kept.

    Raises:
        InputError: the surface, its size, the mesh size, a support or the reach does not fit.
    """
    table = scene.organ
    refuse_unstable_materials(scene)
    size = planned_mesh_size(scene, _surface_summary(scene))
    surface_key = digest(
        {
            "file": hashlib.sha256(table.surface.read_bytes()).hexdigest(),
            "units": table.units or "m",
            "repair": table.repair,
            "version": 6,
        }
    )
    paint = read_paint(scene)
    try:
        arrays, surface_report = store.kept("surface", surface_key, lambda: _repair(scene))
        vertices, triangles = arrays["vertices"], arrays["triangles"]
        check_against_organ(scene, OrganSummary(vertices, triangles))
        taken = hashlib.sha256(vertices.tobytes() + triangles.tobytes()).hexdigest()
        mesh_key = digest({"surface": taken, "mesh_size": size, "version": 2})
        tets, mesh_report = store.kept(
            "mesh", mesh_key, lambda: _tetrahedralise(vertices, triangles, surface_report, size)
        )
    except SurfaceError as error:
        key = "organ.repair" if table.repair == "none" else "organ.surface"
        what = f"does not do for {table.surface.name}: {error.what}"
        raise InputError(scene.problem(key, table.repair, what, error.expected)) from error
    except MeshError as error:
        key = "organ.mesh_size" if "mesh_size" in f"{error.where}" else "organ.surface"
        raise InputError(scene.problem(key, None, error.what, error.expected)) from error
    painted = {} if paint is None else paint.at(vertices)
    scale = painted.get("stiffness_scale")
    identity = digest(
        {
            **({} if scale is None else {"stiffness_scale": hashlib.sha256(scale.tobytes()).hexdigest()}),
            "points": hashlib.sha256(tets["points"].tobytes() + tets["tets"].tobytes()).hexdigest(),
            "surface": taken,
            "material": table.material.hash_inputs(),
            "supports": [support.hash_inputs() for support in table.support],
            "regions": [region.hash_inputs() for region in table.region],
            "capsule": table.capsule.hash_inputs() if table.capsule else None,
        }
    )
    mesh = OrganMesh(
        vertices,
        triangles,
        tets["points"],
        tets["tets"],
        scene.name,
        table.material,
        table.support,
        table.region,
        {"surface": surface_report, "mesh": mesh_report},
        identity,
        table.capsule,
        painted,
    )
    _refuse_idle_supports(scene, mesh)
    return mesh


def _surface_summary(scene: Scene) -> OrganSummary:
    from palpate.author.organ_parts import rough_summary

    summary, _ = rough_summary(organ_parts(scene))
    check_against_organ(scene, summary)
    return summary


def _repair(scene: Scene):
    surface = repair_surface(organ_parts(scene), scene.organ.repair)
    report = {k: _clean(v) for k, v in asdict(surface.report).items()}
    return {"vertices": surface.vertices, "triangles": surface.triangles}, report


def _tetrahedralise(vertices: np.ndarray, triangles: np.ndarray, report: dict[str, Any], size: float):
    from palpate.fem_offline.surface import SurfaceReport

    surface = OrganSurface(vertices, triangles, SurfaceReport(**report))
    mesh = tetrahedralise(surface, size)
    values = {k: _clean(v) for k, v in asdict(mesh.report).items()}
    values["tets"] = len(mesh.tets)
    return {"points": mesh.points, "tets": mesh.tets}, values


def _refuse_idle_supports(scene: Scene, mesh: OrganMesh) -> None:
    faces = mesh.organ.faces
    problems = []
    for i, support in enumerate(mesh.supports):
        inside = support.contains(mesh.points)
        if not inside[faces].all(axis=1).any():
            key = f"organ.support[{i}]"
            what = "holds no whole triangle of the organ's surface"
            problems.append(scene.problem(key, None, what, "a place that covers part of the surface"))
    if problems:
        raise InputError(problems)


def _clean(value: Any) -> Any:
    if isinstance(value, (tuple, list)):
        return [_clean(v) for v in value]
    if isinstance(value, dict):
        return {k: _clean(v) for k, v in value.items()}
    return value.item() if isinstance(value, np.generic) else value
