# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What only the organ's surface can tell about a scene: units, and places that hold nothing."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from palpate.author.errors import InputError
from palpate.author.paint import REACHED, SurfacePaint
from palpate.author.place import Place
from palpate.author.scene import Scene

__all__ = ["OrganSummary", "check_against_organ"]

LARGEST_ORGAN = 3.0
"""m, longest side of the bounding box."""
SMALLEST_ORGAN = 1e-3
"""m, longest side of the bounding box."""
USUAL_ORGAN = (5e-3, 1.0)
"""m; a size that makes another unit believable."""

CAPSULE_SHARE = 0.2
"""Thickest capsule over the mesh size and the tools' radii: it is a membrane, whose bending stiffness is left out."""

Problem = tuple[str, Any, str, str]


@dataclass(frozen=True)
class OrganSummary:
    """The organ's closed surface in its own axes.

    Attributes: vertices (n, 3) m; triangles (m, 3), normals pointing out of the tissue.
    """

    vertices: np.ndarray
    triangles: np.ndarray

    @property
    def bounds(self) -> np.ndarray:
        """(2, 3) m."""
        return np.array([self.vertices.min(axis=0), self.vertices.max(axis=0)])

    @property
    def size(self) -> np.ndarray:
        """(3,) m, sides of the bounding box."""
        return self.bounds[1] - self.bounds[0]

    @property
    def volume(self) -> float:
        """m^3, by the divergence theorem."""
        a, b, c = (self.vertices[self.triangles[:, i]] for i in range(3))
        return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)

    @property
    def area(self) -> float:
        """m^2."""
        return float(self._areas.sum())

    @cached_property
    def surface_points(self) -> np.ndarray:
        """(n + 20000, 3) m: the vertices, and points spread evenly over the surface (fixed seed)."""
        generator = np.random.default_rng(0)
        chosen = generator.choice(len(self.triangles), 20_000, p=self._areas / self._areas.sum())
        u, v = np.sqrt(generator.random(20_000)), generator.random(20_000)
        weights = np.stack([1.0 - u, u * (1.0 - v), u * v], axis=1)
        inner = np.einsum("ij,ijk->ik", weights, self.vertices[self.triangles[chosen]])
        return np.vstack([self.vertices, inner])

    @cached_property
    def _areas(self) -> np.ndarray:
        a, b, c = (self.vertices[self.triangles[:, i]] for i in range(3))
        return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0

    def share_within(self, place: Place, paint: SurfacePaint | None = None) -> float:
        """Share of the surface's area that lies in `place`, and where `paint` lets a tool touch, to about 1 %."""
        points = self.surface_points[len(self.vertices) :]
        inside = place.contains(points)
        if paint is not None and "reach" in paint.values:
            inside = inside & (paint.at(points)["reach"] >= REACHED)
        return float(inside.mean())


def check_against_organ(scene: Scene, organ: OrganSummary) -> None:
    """Raises InputError with everything in `scene` that does not fit `organ`.

    An organ that is too large or too small makes the rest meaningless and is told alone.
    """
    found = list(_size(scene, organ)) or [*_tools(scene, organ), *_places(scene, organ)]
    if found:
        raise InputError(scene.problem(key, value, what, expected) for key, value, what, expected in found)


def _size(scene: Scene, organ: OrganSummary) -> Iterator[Problem]:
    longest = float(organ.size.max())
    if SMALLEST_ORGAN <= longest <= LARGEST_ORGAN:
        return
    stated = scene.organ.units or "m"
    raw = longest / scene.organ.metres_per_unit
    believable = {
        unit: raw * metres
        for unit, metres in (("m", 1.0), ("cm", 1e-2), ("mm", 1e-3))
        if unit != stated and USUAL_ORGAN[0] <= raw * metres <= USUAL_ORGAN[1]
    }
    # of two units that fit, the one nearest to a hand's breadth
    best = min(believable, key=lambda unit: abs(np.log(believable[unit] / 0.15)), default=None)
    taken = {"mm": "millimetres", "cm": "centimetres", "m": "metres"}
    guess = f"; {taken[best]} taken for {taken[stated]}?" if best else ""
    expected = (
        f'"{best}", which makes it {believable[best]:.3g} m'
        if best
        else f"an organ between {SMALLEST_ORGAN} and {LARGEST_ORGAN} m"
    )
    yield "organ.units", stated, f"makes an organ of {longest:.3g} m{guess}", expected


def _tools(scene: Scene, organ: OrganSummary) -> Iterator[Problem]:
    longest = float(organ.size.max())
    for i, tool in enumerate(scene.tool):
        if tool.radius and 2.0 * tool.radius[-1] > longest:
            what = (
                f"makes a tool {2.0 * tool.radius[-1]:.3g} m across, larger than the organ of {longest:.3g} m"
            )
            yield f"tool[{i}].radius", tool.radius[-1], what, f"a radius (m) well below {longest / 2:.3g}"
    if scene.organ.capsule is not None:
        lengths = [scene.organ.mesh_size, *(tool.radius[0] for tool in scene.tool if tool.radius)]
        limit = CAPSULE_SHARE * min((length for length in lengths if length is not None), default=longest)
        if scene.organ.capsule.thickness > limit:
            what = "is no thin skin beside the mesh and the tools: a capsule stretches but does not bend"
            expected = (
                f"at most {limit:.3g} m, a fifth of the mesh size and of each tool's radius; or a region"
            )
            yield "organ.capsule.thickness", scene.organ.capsule.thickness, what, expected
    if scene.reach.depth_max is not None and scene.reach.depth_max > float(organ.size.min()):
        what = f"goes through the organ, which is {organ.size.min():.3g} m thick"
        yield "reach.depth_max", scene.reach.depth_max, what, "a depth (m) well below it"
    if scene.organ.mesh_size is not None and scene.organ.mesh_size > float(organ.size.min()):
        what = f"is larger than the organ, which is {organ.size.min():.3g} m thick"
        yield "organ.mesh_size", scene.organ.mesh_size, what, "tetrahedra (m) well below it"


def _places(scene: Scene, organ: OrganSummary) -> Iterator[Problem]:
    low, high = (tuple(round(float(x), 6) for x in corner) for corner in organ.bounds)
    near = f"a place that meets the organ, which lies between {low} and {high} (m)"
    fixed = np.zeros(len(organ.surface_points), bool)
    for i, support in enumerate(scene.organ.support):
        held = yield from _held(f"organ.support[{i}]", support, organ, "holds nothing of the organ", near)
        fixed |= held
    if fixed.all():
        yield "organ.support", None, "holds the whole surface, so that nothing can be pressed", "a part of it"
    for i, region in enumerate(scene.organ.region):
        try:
            outside = not _meets(region, organ)
        except ValueError as error:
            yield f"organ.region[{i}].surface", str(region.surface), str(error), "a closed surface in m"
            continue
        if outside:
            yield f"organ.region[{i}]", region.name, "lies outside the organ", near
    reached = yield from _held("reach", scene.reach, organ, "contains none of the organ's surface", near)
    if reached.any() and not fixed.all() and not (reached & ~fixed).any():
        yield "reach", None, "contains only what the supports hold", "surface that can move"


def _held(key: str, place: Place, organ: OrganSummary, what: str, near: str):
    """Which of the surface points lie in `place`; yields a problem when none does."""
    try:
        held = place.contains(organ.surface_points)
    except ValueError as error:
        yield f"{key}.surface", str(place.surface), str(error), "a closed surface in m"
        return np.zeros(len(organ.surface_points), bool)
    if not held.any():
        yield key, None, what, near
    return held


def _meets(place: Place, organ: OrganSummary) -> bool:
    """Whether `place` and the organ's inside share a point: at the surface, or on a 24^3 grid over both."""
    if place.contains(organ.surface_points).any():
        return True
    low = np.maximum(organ.bounds[0], place.bounds()[0])
    high = np.minimum(organ.bounds[1], place.bounds()[1])
    if np.any(low > high):
        return False
    import igl

    steps = (np.arange(24) + 0.5) / 24
    grid = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    points = low + grid * (high - low)
    points = points[place.contains(points)]
    if len(points) == 0:
        return False
    winding = igl.fast_winding_number(organ.vertices, organ.triangles.astype(np.int64), points)
    return bool(np.any(np.abs(winding) > 0.5))
