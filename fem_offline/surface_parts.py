# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Reading surface files: every part with its place in the scene graph applied, in metres."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from palpate.fem_offline.errors import SurfaceError

__all__ = ["METRES", "SurfacePart", "components", "is_closed", "load_surface", "merged"]

METRES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}
"""Metres in one unit of the file."""

SIZE_RANGE = (5e-3, 2.0)
"""m; an organ's longest side outside this range is a wrong unit, not an organ."""


@dataclass(frozen=True)
class SurfacePart:
    """One mesh of a file.

    Attributes:
        name: its name in the file.
        vertices: (V, 3) m.
        triangles: (F, 3) int32.
    """

    name: str
    vertices: np.ndarray
    triangles: np.ndarray


def load_surface(path: str | Path, units: str = "m") -> list[SurfacePart]:
    """All triangle meshes of a file that trimesh reads (OBJ, STL, PLY, GLB, ...), transforms applied, in
    metres.

    Raises:
        SurfaceError: no such file, unknown unit or format, no triangles, numbers that are not finite, or a
            size that no organ has (a wrong unit).
    """
    import trimesh

    path = Path(path)
    if units not in METRES:
        raise SurfaceError(f"unknown unit {units!r}", "organ.units", ", ".join(METRES))
    if not path.is_file():
        raise SurfaceError("there is no such surface file", str(path), "a mesh file")
    try:
        scene = trimesh.load_scene(path, process=False)
    except Exception as error:  # readers raise whatever their format's code raises
        raise SurfaceError(
            f"cannot be read as a mesh ({error})", path.name, "OBJ, STL, PLY, GLB or another mesh format"
        ) from error
    parts = []
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        mesh = scene.geometry[name]
        if not isinstance(mesh, trimesh.Trimesh) or not len(mesh.faces):
            continue
        vertices = trimesh.transform_points(mesh.vertices, transform) * METRES[units]
        triangles = np.array(mesh.faces, np.int32)
        if np.linalg.det(transform[:3, :3]) < 0.0:
            triangles = triangles[:, ::-1]
        if not np.isfinite(vertices).all():
            raise SurfaceError("has vertices that are not finite numbers", f"{path.name}, part {node}")
        parts.append(SurfacePart(str(node), vertices, np.ascontiguousarray(triangles)))
    if not parts:
        raise SurfaceError("holds no triangles", path.name, "a triangle mesh")
    _refuse_wrong_unit(parts, path.name, units)
    return parts


def merged(parts: Sequence[SurfacePart], weld: float = 1e-7) -> tuple[np.ndarray, np.ndarray]:
    """One triangle soup: vertices closer than `weld` (relative to the longest side) become one, triangles
    of no area go.  (V, 3) m, (F, 3) int32."""
    counts = np.cumsum([0] + [len(part.vertices) for part in parts])
    vertices = np.concatenate([part.vertices for part in parts])
    triangles = np.concatenate([part.triangles + n for part, n in zip(parts, counts[:-1], strict=True)])
    grid = np.round((vertices - vertices.min(axis=0)) / (weld * np.ptp(vertices, axis=0).max())).astype(
        np.int64
    )
    _, first, index = np.unique(grid, axis=0, return_index=True, return_inverse=True)
    triangles = index.ravel()[triangles]
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    used, compact = np.unique(triangles, return_inverse=True)
    return vertices[first][used], compact.reshape(-1, 3).astype(np.int32)


def is_closed(triangles: np.ndarray) -> bool:
    """Every edge belongs to exactly two triangles, which run along it in opposite directions."""
    directed = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(
        np.int64
    )
    count = int(triangles.max()) + 1
    forward = directed[:, 0] * count + directed[:, 1]
    backward = directed[:, 1] * count + directed[:, 0]
    return len(np.unique(forward)) == len(forward) and bool(np.isin(forward, backward).all())


def components(triangles: np.ndarray) -> list[np.ndarray]:
    """Indices of the cells (F, 3) or (T, 4) of each piece connected by vertices, most cells first."""
    count = int(triangles.max()) + 1
    i, j = triangles[:, :-1].ravel(), triangles[:, 1:].ravel()
    graph = sparse.coo_matrix((np.ones(len(i)), (i, j)), shape=(count, count))
    label = connected_components(graph, directed=False)[1][triangles[:, 0]]
    pieces = [np.flatnonzero(label == k) for k in np.unique(label)]
    return sorted(pieces, key=len, reverse=True)


def _refuse_wrong_unit(parts: list[SurfacePart], name: str, units: str) -> None:
    points = np.concatenate([part.vertices for part in parts])
    size = float(np.ptp(points, axis=0).max())
    if SIZE_RANGE[0] <= size <= SIZE_RANGE[1]:
        return
    fitting = [u for u, metres in METRES.items() if 0.02 <= size / METRES[units] * metres <= 0.5]
    hint = " or ".join(f'units = "{u}"' for u in fitting)
    raise SurfaceError(
        f"the organ's longest side would be {size:.4g} m with units = {units!r}",
        name,
        (hint + ", " if hint else "") + f"between {SIZE_RANGE[0]:g} and {SIZE_RANGE[1]:g} m",
    )
