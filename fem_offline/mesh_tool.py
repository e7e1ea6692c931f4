# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Any closed triangle mesh as a rigid tool.

A press needs a gap that is a smooth potential: force and energy agree only if the normal is its gradient and the
curvature its Hessian, which the exact distance to triangles does not have at their edges' far side, nor closest points
with interpolated normals anywhere.  So the exact signed distance (signed_distance.py) is sampled on a grid around
the part that can touch and interpolated by cubic B-splines (spline_grid.py).  What that costs is measured where it
matters, on the mesh itself, where the gap should be zero: `SplineGap.rounding`.  A face comes out exact, a sharp edge
rounded over about one grid spacing (and every tool of steel has such an edge), and facets of a finely tessellated
curve are smoothed over.  Beyond the grid the exact distance answers: a shaft that touches there is noticed
(clearance.py), not pressed.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from palpate.fem_offline.errors import ToolError
from palpate.fem_offline.placed_tool import PlacedTool
from palpate.fem_offline.pose import ToolDistance
from palpate.fem_offline.signed_distance import SignedDistance
from palpate.fem_offline.spline_grid import RIM, SplineGrid, spline_grid

__all__ = ["MeshTool", "SplineGap"]

REACH = 20e-3
"""m from the tip to where the gap is a smooth potential: no press goes deeper."""
MARGIN = 2e-3
"""m of free space around the mesh that the grid holds; gaps there hardly matter but to the line search."""
SPACINGS = (1e-3, 0.5e-3, 0.25e-3)
"""m; tried from coarse to fine."""
GOOD = 5e-6
"""m; mean |gap| on the mesh at which a spacing is fine enough: a quarter percent of a 2 mm press."""
GRID_MAX = 3_000_000
"""Grid points; more take longer to sample than the presses that use them."""


@dataclass(frozen=True)
class SplineGap:
    """A mesh's gap as a spline near its tip, exact beyond.

    Attributes:
        exact: signed distance.  grid: its interpolation.  middle: (3,) m of the bounding box.
        rounding: mean, 95th percentile and largest |gap| m on the mesh itself, where it should be 0.
    """

    exact: SignedDistance
    grid: SplineGrid
    middle: np.ndarray
    rounding: tuple[float, float, float]

    @property
    def centre(self) -> np.ndarray:
        return self.middle

    def support(self, direction: np.ndarray) -> float:
        """m; largest direction . y over the mesh."""
        return float(np.max(self.exact.vertices @ direction))

    def distance(self, points: np.ndarray) -> ToolDistance:
        """Gap of points (n, 3) m; beyond the grid its normal points away from the closest point, without curvature."""
        gap, normal = np.empty(len(points)), np.empty((len(points), 3))
        curvature = np.zeros((len(points), 3, 3))
        near = self.grid.holds(points)
        if near.any():
            gap[near], normal[near], curvature[near] = self.grid(points[near])
        far = ~near
        if far.any():
            gap[far] = self.exact(points[far])
            away = points[far] - self.exact.closest(points[far])[0]
            length = np.where(gap[far] != 0.0, gap[far], 1.0)
            normal[far] = away / length[:, None]
        return ToolDistance(gap, normal, curvature)


@dataclass(frozen=True, eq=False, kw_only=True)
class MeshTool(PlacedTool):
    """A closed triangle mesh, faces outward.

    Attributes:
        vertices: (V, 3) m.  triangles: (F, 3).
        spacing: m of the grid; None: the coarsest of SPACINGS that is good enough.
        reach: m from the tip, see REACH.

    Raises:
        ToolError: the mesh is open, inside out, or has no volume.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    spacing: float | None = None
    reach: float = REACH

    def __post_init__(self) -> None:
        # files such as STL repeat a corner in each of its triangles
        vertices, same = np.unique(np.asarray(self.vertices, float), axis=0, return_inverse=True)
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "triangles", same.ravel()[np.asarray(self.triangles, np.int64)])
        _require_solid(self.vertices, self.triangles)

    @property
    def rounding(self) -> tuple[float, float, float]:
        """Mean, 95th percentile and largest |gap| m on the mesh within reach: what the grid rounds off."""
        return self.solid.rounding

    @cached_property
    def _exact(self) -> SignedDistance:
        return SignedDistance(self.vertices, self.triangles)

    @cached_property
    def _tip(self) -> np.ndarray:
        if self.tip is not None:
            return np.array(self.tip, float)
        a = self._turn[2]
        middle = 0.5 * (self.vertices.min(axis=0) + self.vertices.max(axis=0))
        return middle - (float(np.max(self.vertices @ -a)) + float(a @ middle)) * a

    @cached_property
    def solid(self) -> SplineGap:
        low = np.maximum(self.vertices.min(axis=0), self._tip - self.reach)
        high = np.minimum(self.vertices.max(axis=0), self._tip + self.reach)
        if (high <= low).any():
            raise ToolError(
                f"the tip {self._tip} m is more than {self.reach} m from the tool's mesh",
                "tool.tip",
                "a point on the part that touches, in the units of the mesh",
            )
        points = _spread(self.vertices, self.triangles, low, high)
        for spacing in (self.spacing,) if self.spacing else SPACINGS:
            grid = _sampled(self._exact, low, high, spacing)
            off = np.abs(grid(points[grid.holds(points)])[0])
            if off.mean() <= GOOD or _count(low, high, 0.5 * spacing) > GRID_MAX:
                break
        rounding = (float(off.mean()), float(np.percentile(off, 95)), float(off.max()))
        middle = 0.5 * (self.vertices.min(axis=0) + self.vertices.max(axis=0))
        return SplineGap(self._exact, grid, middle, rounding)

    def hash(self) -> str:
        """Hex digest of mesh, axis, reference point and grid; a field is valid for this tool only."""
        text = f"mesh {self._turn[2].tolist()} {self._tip.tolist()} {self.spacing} {self.reach}"
        arrays = self.vertices.tobytes() + self.triangles.tobytes()
        return hashlib.sha256(text.encode() + arrays).hexdigest()


def _count(low: np.ndarray, high: np.ndarray, spacing: float) -> int:
    return int(np.prod(np.ceil((high - low + 2 * MARGIN) / spacing) + 2 * RIM + 2))


def _sampled(exact: SignedDistance, low: np.ndarray, high: np.ndarray, spacing: float) -> SplineGrid:
    origin = low - MARGIN - RIM * spacing
    counts = np.ceil((high - low + 2 * MARGIN) / spacing).astype(int) + 2 * RIM + 2
    axes = [o + spacing * np.arange(n) for o, n in zip(origin, counts, strict=True)]
    samples = exact(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3))
    return spline_grid(samples.reshape(counts), origin, spacing)


def _spread(vertices: np.ndarray, triangles: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """(n, 3) m points spread evenly over the mesh inside a box, the same every time."""
    corners = vertices[triangles]
    area = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    random = np.random.default_rng(0)
    chosen = random.choice(len(triangles), 20_000, p=area / area.sum())
    weights = random.dirichlet([1.0, 1.0, 1.0], len(chosen))
    points = np.einsum("nk,nkj->nj", weights, corners[chosen])
    inside = np.all((points >= low) & (points <= high), axis=1)
    return points[inside] if inside.any() else points


def _require_solid(vertices: np.ndarray, triangles: np.ndarray) -> None:
    expected = (
        "one closed surface whose triangles face outward (repair it, for instance, in Blender or MeshLab)"
    )
    if vertices.ndim != 2 or vertices.shape[1] != 3 or not np.isfinite(vertices).all() or not len(triangles):
        raise ToolError(
            "the tool's mesh has no triangles, or corners that are no numbers", "tool.surface", expected
        )
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    unique, edge = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    # each way along an edge once: 0 where two neighbours agree, 1 at a hole, 2 where they face opposite ways
    balance = np.abs(np.bincount(edge.ravel(), np.where(edges[:, 0] < edges[:, 1], 1.0, -1.0)))
    if balance.any():
        at = 1e3 * vertices[unique[np.argmax(balance)]].mean(axis=0)
        what = "the mesh is open" if balance.max() < 2.0 else "neighbouring triangles face opposite ways"
        raise ToolError(
            f"{what} at {np.count_nonzero(balance)} edges, one of them near "
            f"({at[0]:.2f}, {at[1]:.2f}, {at[2]:.2f}) mm",
            "tool.surface",
            expected,
        )
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    volume = float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0
    if volume <= 0.0:
        raise ToolError(
            f"the mesh is inside out: it encloses {1e9 * volume:.3g} mm3", "tool.surface", expected
        )
