# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Where the surface is pressed: well-spread nodes, and held-out points that never become nodes.

Candidates cover the reachable surface evenly.  Farthest points (Gonzalez 1985), which reach the reach's border by
themselves, are where nodes begin (seeds.py); errors choose the rest (sampling_by_error.py).  Held-out points are drawn
by seed from all of it.  Places that no press could vouch for (held by a support, a crease that the tool's reference
point sees from two sides, a ridge that the tool folds over, tissue thinner than 2.5 depths) are left out and counted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from palpate.author.organ_stage import OrganMesh
from palpate.author.scene_tables import Reach
from palpate.author.tool_stage import ToolShape, contact_extent, offset_of

__all__ = [
    "ReachSamples",
    "common_samples",
    "farthest_of",
    "farthest_points",
    "held_out_points",
    "reach_samples",
]

THICKNESS_SHARE = 0.4
"""Deepest press over local thickness: beyond it a press feels the other side, and is refused."""
CANDIDATES = 10
"""Random draws from which each held-out point is chosen."""
CREASE_TOLERANCE = 0.05
"""Allowed |phi - rho| / rho at the tool's reference point before contact, and |phi + d| / depth where it is in the
tissue, d deep."""
RIDGE = np.radians(45.0)
"""Turn of the normal within a contact beyond which the surface is a ridge (fields/DECISIONS.md: on a liver)."""
FAR_SIDE = -0.7
"""Cosine between normals below which a place is on the other side of the tissue."""


@dataclass(frozen=True)
class ReachSamples:
    """Points on the smooth surface that a tool may press.

    Attributes:
        points: (n, 3) m.  normals: (n, 3).  spacing: m, between neighbours.
        allowed: (n,) bool; False where no press can vouch for itself.
        left_out: reason -> count.
    """

    points: np.ndarray
    normals: np.ndarray
    spacing: float
    allowed: np.ndarray
    left_out: dict[str, int]

    def beyond(self, mesh: OrganMesh):
        """Membership for the field: (n, 3) m -> (n,) m, <= 0 within reach, metres beyond elsewhere."""
        tree = cKDTree(self.points)

        def distance(points: np.ndarray) -> np.ndarray:
            foot, _ = mesh.distance.project(points)
            return tree.query(foot)[0] - self.spacing

        return distance


def reach_samples(
    mesh: OrganMesh, reach: Reach, tool: ToolShape, depth_max: float, spacing: float = 1.0e-3
) -> ReachSamples:
    """Cover the reachable surface.

    Args:
        tool: and how it is held.
        depth_max: m.
        spacing: m, about; coarser on large reaches so that there are at most some 60,000 points.
    """
    offset, contact = offset_of(tool), contact_extent(tool, depth_max)
    corners = mesh.vertices[mesh.triangles]
    area = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1).max()
    near = reach.contains(mesh.vertices)[mesh.triangles].any(axis=1)
    centre_near = reach.contains(corners.mean(axis=1))
    chosen = np.flatnonzero(near | centre_near)
    if len(chosen) == 0:  # a reach smaller than a triangle
        chosen = np.flatnonzero(area > 0)
    total = float(area[chosen].sum())
    spacing = max(min(spacing, longest), np.sqrt(total / 60_000))
    points = _spread_over(corners[chosen], area[chosen], spacing)
    points, normals = mesh.distance.project(points)
    keep = reach.contains(points) & ~mesh.supported(points) & mesh.reachable(points)
    points, normals = points[keep], normals[keep]
    reasons = {}
    q = points + offset * normals
    crease = (
        np.abs(mesh.distance(q) - offset) > CREASE_TOLERANCE * offset if offset else np.zeros(len(q), bool)
    )
    if offset < depth_max:  # the reference point goes into the tissue
        deepest = offset - depth_max
        there = mesh.distance(points + deepest * normals)
        crease |= np.abs(there - deepest) > CREASE_TOLERANCE * depth_max
    thin = _thickness_below(mesh, points, normals, depth_max / THICKNESS_SHARE)
    ridge = _ridges(mesh, points, normals, contact) & ~crease & ~thin
    held = _beside_support(mesh, points, normals, contact)
    reasons["crease that the tool sees from two sides"] = int(crease.sum())
    reasons[f"ridge that turns over within {1e3 * contact:.1f} mm"] = int(ridge.sum())
    crease |= ridge
    reasons[f"within {1e3 * contact:.1f} mm of a support"] = int((held & ~crease & ~thin).sum())
    reasons[f"thinner than {1e3 * depth_max / THICKNESS_SHARE:.1f} mm"] = int((thin & ~crease).sum())
    return ReachSamples(
        points, normals, spacing, ~(crease | thin | held), {k: v for k, v in reasons.items() if v}
    )


def common_samples(
    mesh: OrganMesh, reach: Reach, shapes: Sequence[ToolShape], depths: Sequence[float]
) -> ReachSamples:
    """Where every one of `shapes` may press, to its own of `depths` (m)."""
    each = [reach_samples(mesh, reach, shape, depth) for shape, depth in zip(shapes, depths, strict=True)]
    allowed = np.logical_and.reduce([samples.allowed for samples in each])
    strictest = min(each, key=lambda samples: int(samples.allowed.sum()))
    return replace(strictest, allowed=allowed)


def _spread_over(corners: np.ndarray, area: np.ndarray, spacing: float) -> np.ndarray:
    """Points in triangles (F, 3, 3), about one for each spacing^2, from a low-discrepancy sequence (R2)."""
    count = np.maximum(1, np.round(area / spacing**2)).astype(int)
    triangle = np.repeat(np.arange(len(corners)), count)
    k = np.arange(len(triangle))
    a = (0.5 + 0.7548776662466927 * k) % 1.0
    b = (0.5 + 0.5698402909980532 * k) % 1.0
    flip = a + b > 1.0
    a, b = np.where(flip, 1.0 - a, a), np.where(flip, 1.0 - b, b)
    x = corners[triangle]
    return x[:, 0] + a[:, None] * (x[:, 1] - x[:, 0]) + b[:, None] * (x[:, 2] - x[:, 0])


def _thickness_below(mesh: OrganMesh, points: np.ndarray, normals: np.ndarray, limit: float) -> np.ndarray:
    """Whether the straight way in, along -normal, leaves the tissue within `limit`."""
    steps = np.linspace(0.15, 1.0, 8) * limit
    inward = points[:, None] - steps[None, :, None] * normals[:, None]
    return (mesh.distance(inward.reshape(-1, 3)).reshape(len(points), -1) > 0.0).any(axis=1)


def _ridges(mesh: OrganMesh, points: np.ndarray, normals: np.ndarray, contact: float) -> np.ndarray:
    """Whether the surface bends away by more than RIDGE within `contact` (m) of a point, also beyond the reach.

    What faces the other way is the far side of thin tissue, which has a limit of its own.
    """
    corners = mesh.vertices[np.unique(mesh.triangles)]
    around = np.concatenate([points, corners])
    facing = np.concatenate([normals, mesh.distance.project(corners)[1]])
    tree = cKDTree(around)
    found = np.zeros(len(points), bool)
    for start in range(0, len(points), 4096):  # some 100 neighbours of each
        part = np.arange(start, min(start + 4096, len(points)))
        near = tree.query_ball_point(points[part], contact)
        one = np.repeat(part, [len(row) for row in near])
        other = np.concatenate(near).astype(int)
        below = np.sum((around[other] - points[one]) * normals[one], axis=1) < 0.0
        cosine = np.sum(facing[other] * normals[one], axis=1)
        found[one[below & (cosine < np.cos(RIDGE)) & (cosine > FAR_SIDE)]] = True
    return found


def _beside_support(mesh: OrganMesh, points: np.ndarray, normals: np.ndarray, contact: float) -> np.ndarray:
    """Whether a contact of this radius (m), and the faces around it, would reach a support, which never gives way."""
    first = np.cross(normals, np.eye(3)[np.argmin(np.abs(normals), axis=1)])
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(normals, first)
    beside = np.zeros(len(points), bool)
    for angle in np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False):
        for radius in (0.5 * contact, 1.3 * contact):
            beside |= mesh.supported(points + radius * (np.cos(angle) * first + np.sin(angle) * second))
    return beside


def farthest_points(samples: ReachSamples, count: int) -> np.ndarray:
    """(count,) indices of allowed samples, well spread; deterministic, each prefix well spread too."""
    allowed = np.flatnonzero(samples.allowed)
    return allowed[farthest_of(samples.points[allowed], count)]


def farthest_of(points: np.ndarray, count: int, first: int | None = None, least: float = 0.0) -> np.ndarray:
    """(count,) indices of `points` (n, 3) m, well spread; fewer where they would be nearer than `least` m.

    Args:
        first: where to begin; at the middle when None.
    """
    if first is None:
        first = int(np.argmin(np.linalg.norm(points - points.mean(axis=0), axis=1)))
    chosen = [first]
    distance = np.linalg.norm(points - points[first], axis=1)
    while len(chosen) < min(count, len(points)) and distance.max() > least:
        chosen.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return np.array(chosen)


def held_out_points(samples: ReachSamples, count: int, seed: int) -> np.ndarray:
    """(count,) indices of allowed samples drawn by seed, kept apart by Mitchell's best candidate (1991).

    Each point is the one of CANDIDATES random draws that lies farthest from the points before it: random, but no
    two of a few points fall on the same spot.
    """
    allowed = np.flatnonzero(samples.allowed)
    points = samples.points[allowed]
    generator = np.random.default_rng(seed)
    count = min(count, len(allowed))
    distance = np.full(len(points), np.inf)
    chosen: list[int] = []
    while len(chosen) < count:
        drawn = generator.integers(len(points), size=CANDIDATES)
        best = int(drawn[np.argmax(distance[drawn])])
        if distance[best] == 0.0:  # every draw was chosen before
            best = int(np.argmax(distance))
        chosen.append(best)
        distance = np.minimum(distance, np.linalg.norm(points - points[best], axis=1))
    return allowed[np.array(chosen, int)]
