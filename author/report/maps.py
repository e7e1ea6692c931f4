# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What the field says over the reach, at a few depths: colours for the figures.

At a surface vertex v the tool's reference point goes from c + rho n to c + (rho - d) n, c being the foot point of
the field's own contact geometry, so that the depth is d exactly although the mesh shown may be coarser.

    normal force f . n,    lateral push |f - (f . n) n|,    stiffness d(f . n)/dd (central difference),
    stiffness k of the friction spring, coefficient mu of friction

Triangles where the field is not stored are shown plain, not coloured.  An asset's reach is told triangle by triangle
from places sampled on it, and now and then misses one in its midst: a triangle whose three neighbours all belong to
the reach is drawn with them, if the field is stored there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh

from palpate.fields.foot_points import foot_points, vertex_normals
from palpate.fields.interpolation import evaluate
from palpate.fields.organ_geometry import OrganGeometry
from palpate.fields.response_field import ResponseField

__all__ = ["QUANTITIES", "ReachMap", "decimated", "reach_map"]

QUANTITIES = {
    "stiffness": ("Stiffness, d(force)/d(depth)", "N/m"),
    "normal_force": ("Normal force", "N"),
    "lateral_push": ("Lateral push, without friction", "N"),
    "friction_coefficient": ("Coefficient of friction", "1"),
    "sticking_stiffness": ("Stiffness of the friction spring", "N/m"),
}
"""Name and unit of each map."""

LEVELS = 5
"""Depths shown (count), evenly spaced up to depth_max."""
TRIANGLES = 16_000
"""Triangles shown for the reach, and again for the rest (count); more make the page slow on a laptop."""
STEP = 0.02
"""Step of the stiffness difference over depth_max."""


@dataclass(frozen=True)
class ReachMap:
    """The reach as a mesh with values, and the rest of the organ as a mesh.

    Attributes:
        vertices: (V, 3) m.  triangles: (F, 3).  normals: (V, 3) outward, as the field has them.
        feet: (V, 3) m; the foot points c, on the surface that the field itself knows.
        depths: (L,) m.
        values: by name in QUANTITIES, (L, V) in its unit.
        rest_vertices: (W, 3) m.  rest_triangles: (G, 3).
        unstored_share: share of the reach's area where the field stores nothing.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    normals: np.ndarray
    feet: np.ndarray
    depths: np.ndarray
    values: dict[str, np.ndarray]
    rest_vertices: np.ndarray
    rest_triangles: np.ndarray
    unstored_share: float

    @property
    def area(self) -> float:
        """m2, of the reach that is stored, as it is drawn."""
        return (
            float(trimesh.triangles.area(self.vertices[self.triangles]).sum()) if len(self.triangles) else 0.0
        )


def reach_map(organ: OrganGeometry, field: ResponseField, triangle_limit: int = TRIANGLES) -> ReachMap:
    """Maps of `field` over the reach of `organ`."""
    marked = np.zeros(len(organ.triangles), bool)
    marked[organ.reach_triangles] = True
    marked |= _enclosed(organ.triangles, marked)
    mesh = _compact(organ.vertices, organ.triangles[marked])
    vertices, triangles = _fine(*decimated(*mesh, triangle_limit), field.amplitudes.spacing, triangle_limit)
    rest = decimated(*_compact(organ.vertices, organ.triangles[~marked]), triangle_limit)

    guess = vertex_normals(vertices, triangles)
    rho, depth_max = field.tool.offset, field.depth_max
    foot, n, valid = foot_points(field, vertices, guess)
    depths = depth_max * np.arange(1, LEVELS + 1) / LEVELS
    values = {name: np.zeros((LEVELS, len(vertices))) for name in QUANTITIES}
    for level, d in enumerate(depths):
        at, less, more = (
            evaluate(field, foot + (rho - d - h) * n) for h in (0.0, -STEP * depth_max, STEP * depth_max)
        )
        normal_force = np.sum(at.force * n, axis=1)
        slope = np.sum((more.force - less.force) * n, axis=1) / (2 * STEP * depth_max)
        values["normal_force"][level] = normal_force
        values["stiffness"][level] = slope
        values["lateral_push"][level] = np.linalg.norm(at.force - normal_force[:, None] * n, axis=1)
        values["sticking_stiffness"][level] = at.friction_stiffness
        values["friction_coefficient"][level] = at.friction_coefficient
        valid &= at.valid & less.valid & more.valid

    stored = valid[triangles].all(axis=1)
    area = trimesh.triangles.area(vertices[triangles]) if len(triangles) else np.zeros(0)
    used, shown = np.unique(triangles[stored], return_inverse=True)
    rest_vertices = np.concatenate([rest[0], vertices])
    rest_triangles = np.concatenate([rest[1], triangles[~stored] + len(rest[0])])
    return ReachMap(
        vertices[used],
        shown.reshape(-1, 3),
        n[used],
        foot[used],
        depths,
        {name: value[:, used] for name, value in values.items()},
        *_compact(rest_vertices, rest_triangles),
        float(area[~stored].sum() / area.sum()) if area.sum() > 0 else 0.0,
    )


def _enclosed(triangles: np.ndarray, marked: np.ndarray) -> np.ndarray:
    """(F,) bool; triangles all of whose neighbours, and there are three, are marked (F,)."""
    around = np.zeros(len(triangles), int)
    one, other = trimesh.graph.face_adjacency(faces=triangles).T if len(triangles) else np.zeros((2, 0), int)
    np.add.at(around, one, marked[other])
    np.add.at(around, other, marked[one])
    return around == 3


def decimated(vertices: np.ndarray, triangles: np.ndarray, limit: int) -> tuple[np.ndarray, np.ndarray]:
    """The mesh with about `limit` triangles at most; its border stays where it is, so that parts fit together."""
    if len(triangles) <= limit:
        return vertices, triangles
    import pyvista

    mesh = pyvista.PolyData.from_regular_faces(vertices, triangles)
    small = mesh.decimate_pro(
        1.0 - limit / len(triangles), preserve_topology=True, boundary_vertex_deletion=False
    )
    return np.asarray(small.points, float), np.asarray(small.regular_faces)


def _fine(
    vertices: np.ndarray, triangles: np.ndarray, edge: float, limit: int
) -> tuple[np.ndarray, np.ndarray]:
    """Splits triangles until edges are at most `edge` m, or as short as `limit` triangles allow."""
    if not len(triangles):
        return vertices, triangles
    area = float(trimesh.triangles.area(vertices[triangles]).sum())
    edge = max(edge, float(np.sqrt(8.0 * area / limit)))
    corners = vertices[triangles]
    if np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max() <= edge:
        return vertices, triangles
    split = trimesh.remesh.subdivide_to_size(vertices, triangles, edge, max_iter=20)
    return np.asarray(split[0]), np.asarray(split[1])


def _compact(vertices: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    used, index = np.unique(triangles, return_inverse=True)
    return vertices[used], index.reshape(-1, 3)
