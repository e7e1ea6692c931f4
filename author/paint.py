# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Scalars painted on the vertices of the surface file: what they mean, read and checked before any work.

    friction           the Coulomb coefficient itself, 0 to 2; no tool states one beside it
    reach              1 where a tool may touch, 0 where not; the border is at REACHED
    texture_amplitude  times the heights of textures, 0 to 1
    stiffness_scale    times the stiffness of the material below, through the whole thickness: tissue has the scale of
                       the surface point that is closest to it; the capsule is not scaled

A PLY keeps them as vertex properties, a GLB as custom attributes, whose names glTF begins with "_".  Repair moves and
makes vertices: a painted value at any point is that at the closest point of the file's own surface, interpolated
between the corners of its triangle.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from palpate.author.errors import InputError, InputProblem
from palpate.author.scene import Scene
from palpate.author.scene_problems import did_you_mean
from palpate.fem_offline.signed_distance import SignedDistance

__all__ = ["REACHED", "SurfacePaint", "read_paint"]

REACHED = 0.5
"""Least painted reach where a tool may touch."""
RANGES = {"friction": (0.0, 2.0), "reach": (0.0, 1.0), "stiffness_scale": (1e-3, 1e3),
          "texture_amplitude": (0.0, 1.0)}  # fmt: skip
"""Least and largest value of each kind."""
WELD = 1e-7
"""Vertices nearer than this, relative to the longest side, are one place (as surface repair welds them)."""
AGREE = 1e-3
"""Share of the larger value by which two values at one place may differ: both are roundings of one."""


@dataclass(frozen=True)
class SurfacePaint:
    """Painted values on the surface as the file has it.

    Attributes: vertices (V, 3) m; triangles (F, 3); values: by kind, (V,).
    """

    vertices: np.ndarray
    triangles: np.ndarray
    values: dict[str, np.ndarray]

    def at(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """By kind, (n,) at the closest points of the surface to (n, 3) m."""
        _, triangle, weight = SignedDistance(self.vertices, self.triangles).closest(points)
        corner = self.triangles[triangle]
        return {kind: np.sum(weight * value[corner], axis=1) for kind, value in self.values.items()}


def read_paint(scene: Scene) -> SurfacePaint | None:
    """The paint that the scene's [organ.paint] names; None where it names none.

    Raises:
        InputError: with everything that is wrong in it: a name that is missing, values that are not finite or out of
            range, more than one value a vertex, two values at one place.
    """
    table = scene.organ.paint
    if table is None:
        return None
    named = {kind: name for kind in RANGES if (name := getattr(table, kind)) is not None}
    parts = list(_parts(scene))
    vertices = np.concatenate([part.vertices for part in parts])
    starts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    triangles = np.concatenate([part.triangles + s for part, s in zip(parts, starts[:-1], strict=True)])
    problems, values = [], {}
    for kind, name in named.items():
        found = _painted(scene, kind, name, parts)
        if isinstance(found, InputProblem):
            problems.append(found)
        else:
            values[kind] = found
            problems += _contradictions(scene, kind, name, vertices, found)
    if problems:
        raise InputError(problems)
    return SurfacePaint(vertices, triangles, values)


@dataclass(frozen=True)
class _Part:
    name: str
    vertices: np.ndarray
    triangles: np.ndarray
    attributes: dict[str, Any]


def _parts(scene: Scene) -> Iterator[_Part]:
    """As `load_surface` reads them, with their vertex attributes."""
    import trimesh

    loaded = trimesh.load_scene(scene.organ.surface, process=False)
    for node in loaded.graph.nodes_geometry:
        transform, name = loaded.graph[node]
        mesh = loaded.geometry[name]
        if not isinstance(mesh, trimesh.Trimesh) or not len(mesh.faces):
            continue
        vertices = trimesh.transform_points(mesh.vertices, transform) * scene.organ.metres_per_unit
        raw = mesh.metadata.get("_ply_raw", {}).get("vertex", {})
        data = raw.get("data", {})
        ply = {key: data[key] for key in raw.get("properties", {}) if key not in ("x", "y", "z")}
        yield _Part(str(node), vertices, np.array(mesh.faces, np.int64), {**ply, **mesh.vertex_attributes})


def _painted(scene: Scene, kind: str, name: str, parts: list[_Part]) -> np.ndarray | InputProblem:
    """(V,) over all parts."""
    key, file = f"organ.paint.{kind}", scene.organ.surface.name
    found = []
    for part in parts:
        value = part.attributes.get(name, part.attributes.get(f"_{name}"))
        if value is None:
            there = sorted({known.removeprefix("_") for other in parts for known in other.attributes})
            if any(name in (known, known.removeprefix("_")) for other in parts for known in other.attributes):
                what = f'is painted on other parts of {file}, but not on "{part.name}"'
                return scene.problem(
                    key, name, what, "every part painted, with a neutral value where nothing is"
                )
            what = f"is no scalar per vertex of {file}{did_you_mean(name, there)}"
            expected = (
                f"one of {', '.join(there)}" if there else "a PLY or GLB that holds it; this file holds none"
            )
            return scene.problem(key, name, what, expected)
        value = np.asarray(value)
        if value.dtype.kind not in "biuf":
            return scene.problem(key, name, f"is no number per vertex of {file}", "one number a vertex")
        value = value.astype(float)
        if value.size != len(part.vertices):
            what = f'has {value.size} values on part "{part.name}" of {file}, which has {len(part.vertices)} vertices'
            return scene.problem(key, name, what, "one number a vertex")
        found.append(value.reshape(-1))
    return np.concatenate(found)


def _contradictions(
    scene: Scene, kind: str, name: str, vertices: np.ndarray, values: np.ndarray
) -> Iterator[InputProblem]:
    key, (low, high) = f"organ.paint.{kind}", RANGES[kind]
    wrong = ~np.isfinite(values) | (values < low) | (values > high)
    if wrong.any():
        worst = int(np.flatnonzero(wrong)[0])
        here = _millimetres(vertices[worst])
        what = f"is {values[worst]:g} at ({here}) mm, and wrong at {wrong.sum()} vertices in all"
        yield scene.problem(key, name, what, f"{low:g} to {high:g}")
        return
    if kind == "reach" and not (values >= REACHED).any():
        yield scene.problem(key, name, "lets no tool touch anything", f"{REACHED:g} or more somewhere")
    grid = np.round((vertices - vertices.min(axis=0)) / (WELD * np.ptp(vertices, axis=0).max())).astype(
        np.int64
    )
    _, place = np.unique(grid, axis=0, return_inverse=True)
    place = place.reshape(-1)
    least, most = np.full(place.max() + 1, np.inf), np.full(place.max() + 1, -np.inf)
    np.minimum.at(least, place, values)
    np.maximum.at(most, place, values)
    apart = most - least > AGREE * np.maximum(np.abs(most), np.abs(least))
    if apart.any():
        one = int(np.flatnonzero(apart)[0])
        here = _millimetres(vertices[np.flatnonzero(place == one)[0]])
        what = f"is both {least[one]:g} and {most[one]:g} at ({here}) mm, and at {apart.sum()} such places in all"
        yield scene.problem(key, name, what, "one value at one place")


def _millimetres(point: np.ndarray) -> str:
    return ", ".join(f"{1e3 * x:.1f}" for x in point)
