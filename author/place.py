# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Places in the organ's own axes: box, sphere, half space, the inside of a closed surface.

A place answers one question, `contains(points)`; its border belongs to it.  Closed surfaces answer by the
generalised winding number (Jacobson, Kavan, Sorkine-Hornung, Robust Inside-Outside Segmentation using
Generalized Winding Numbers, 2013; the fast form of Barill et al., 2018, as in libigl): inside
where it exceeds 1/2.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from palpate.author.scene_types import Direction, Point, Quantity, SurfaceFile, Table, refused

__all__ = ["Box", "HalfSpace", "Place", "Sphere", "closed_surface"]


class Box(Table):
    """An axis-aligned box."""

    min: Point = Field(description="smallest corner, m")
    max: Point = Field(description="largest corner, m")

    @model_validator(mode="after")
    def _has_volume(self) -> Box:
        if not all(low < high for low, high in zip(self.min, self.max, strict=True)):
            raise refused("is an empty box", "min below max in each coordinate")
        return self

    def contains(self, points: np.ndarray) -> np.ndarray:
        return np.all((points >= np.array(self.min)) & (points <= np.array(self.max)), axis=1)

    def bounds(self) -> np.ndarray:
        return np.array([self.min, self.max])


class Sphere(Table):
    """A ball."""

    center: Point = Field(description="centre, m")
    radius: Annotated[float, Quantity("length", above=0)] = Field(description="radius, above 0")

    def contains(self, points: np.ndarray) -> np.ndarray:
        return ((points - np.array(self.center)) ** 2).sum(axis=1) <= self.radius**2

    def bounds(self) -> np.ndarray:
        return np.array(self.center) + np.array([[-self.radius], [self.radius]])


class HalfSpace(Table):
    """All points p with (p - point) . normal <= 0: as on tissue, the normal points out of it."""

    point: Point = Field(description="a point of the bounding plane, m")
    normal: Direction = Field(description="points out of the half space; any length but zero")

    def contains(self, points: np.ndarray) -> np.ndarray:
        return (points - np.array(self.point)) @ np.array(self.normal) <= 0.0

    def bounds(self) -> np.ndarray:
        return np.array([[-np.inf] * 3, [np.inf] * 3])


class Place(Table):
    """A table that says where: at most one of box, sphere, half_space and surface."""

    box: Box | None = Field(default=None, description="{ min = [x, y, z], max = [x, y, z] }, m")
    sphere: Sphere | None = Field(default=None, description="{ center = [x, y, z], radius = r }, m")
    half_space: HalfSpace | None = Field(
        default=None,
        description="{ point = [x, y, z], normal = [x, y, z] }; holds what the normal points away from",
    )
    surface: SurfaceFile | None = Field(
        default=None, description="a closed surface file in m; holds its inside"
    )

    @property
    def is_given(self) -> bool:
        return self._shape is not None or self.surface is not None

    @property
    def _shape(self) -> Box | Sphere | HalfSpace | None:
        return self.box or self.sphere or self.half_space

    def contains(self, points: np.ndarray) -> np.ndarray:
        """(n,) bool for points (n, 3) m in organ axes; everywhere when no place is given.

        Raises ValueError when a surface file cannot be read or is not closed.
        """
        points = np.atleast_2d(np.asarray(points, float))
        if self._shape is not None:
            return self._shape.contains(points)
        if self.surface is None:
            return np.ones(len(points), bool)
        import igl

        vertices, triangles = closed_surface(self.surface)
        return np.abs(igl.fast_winding_number(vertices, triangles, points)) > 0.5

    def bounds(self) -> np.ndarray:
        """(2, 3) m, smallest and largest corner; infinite where the place is."""
        if self._shape is not None:
            return self._shape.bounds()
        if self.surface is None:
            return np.array([[-np.inf] * 3, [np.inf] * 3])
        vertices, _ = closed_surface(self.surface)
        return np.array([vertices.min(axis=0), vertices.max(axis=0)])


@lru_cache(maxsize=8)
def closed_surface(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (n, 3) m and triangles (m, 3) of a closed surface file.

    Raises ValueError when the file cannot be read or its surface has open edges.
    """
    import trimesh

    try:
        mesh = trimesh.load_mesh(path)
    except Exception as error:
        raise ValueError(f"cannot be read as a surface ({error})") from error
    if not isinstance(mesh, trimesh.Trimesh) or len(mesh.faces) == 0:
        raise ValueError("holds no triangles")
    if not mesh.is_watertight:
        raise ValueError("is not a closed surface")
    return np.asarray(mesh.vertices, float), np.asarray(mesh.faces, np.int64)
