# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Where on the organ a ray of the mouse points, and where a tool is that presses there."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from palpate.author.view.viewed import ViewedTool
from palpate.fields.response_field import ToolReference
from palpate.runtime import Region

__all__ = ["Place", "Surface", "held", "on_field"]


@dataclass(frozen=True)
class Place:
    """Attributes: point: (3,) m, on the organ's surface.  normal: (3,) unit, outward."""

    point: np.ndarray
    normal: np.ndarray


class Surface:
    """The triangles that are shown, to be hit by rays.  vertices: (V, 3) m; triangles: (F, 3), outward."""

    def __init__(self, vertices: np.ndarray, triangles: np.ndarray):
        import pyvista

        a, b, c = (vertices[triangles[:, k]] for k in range(3))
        normal = np.cross(b - a, c - a)
        self._normals = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
        self._mesh = pyvista.PolyData.from_regular_faces(np.asarray(vertices, float), triangles)
        self._far = 2.0 * float(np.linalg.norm(np.ptp(vertices, axis=0)))
        self._middle = vertices.mean(axis=0)

    def hit(self, origin: np.ndarray, direction: np.ndarray) -> Place | None:
        """The first triangle that the ray from `origin` (3,) m along `direction` (3,) meets from outside."""
        along = direction / np.linalg.norm(direction)
        end = origin + (np.linalg.norm(origin - self._middle) + self._far) * along
        points, cells = self._mesh.ray_trace(origin, end)
        for point, cell in zip(points, cells, strict=True):
            if self._normals[cell] @ along < 0:
                return Place(np.array(point, float), self._normals[cell])
        return None


def on_field(tool: ViewedTool, place: Place) -> Place:
    """`place` on the surface that the tool's field itself knows; as it is where the field knows nothing."""
    rho = tool.offset()
    q = place.point + rho * place.normal
    at = tool.runtime.sample(q)[0]
    if at["region"] not in (Region.FREE, Region.CONTACT) or not at["normal"].any():
        return place
    n = at["normal"].copy()
    return Place(q - (rho - at["depth"]) * n, n)


def held(tool: ToolReference, normal: np.ndarray, tilt: float | None = None) -> np.ndarray:
    """(4,) x y z w; how the tool is held against a surface with this normal, at its own tilt or at `tilt` rad."""
    from scipy.spatial.transform import Rotation

    leaning = tool if tilt is None else replace(tool, tilt=tilt)
    return Rotation.from_matrix(leaning.held_against(normal)).as_quat()
