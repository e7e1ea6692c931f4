# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Where the first nodes are: spread over the reach, and above what the scene says is different.

A scene knows its regions, so none has to be found: each gets seeds where it is nearest to the surface and around there.
What a scene does not name (a thin edge, a fold) is found when a node lies where it changes force or the lateral
reaction.  No place is farther than `gap` (sampling_by_error.py) from a node: what changes force only within a circle
of that radius may be missed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.author.organ_stage import OrganMesh
from palpate.author.sampling import ReachSamples, farthest_of
from palpate.author.sampling_by_error import COARSE, Terrain
from palpate.fields.response_field import ContactGeometry
from palpate.fields.surface_curvature import shape_operator

__all__ = ["Places", "above_regions", "places_of"]

FELT = 3.0
"""A region is felt down to so many contact radii below the surface."""
AROUND = 6
"""Seeds above each region (count), if they are a contact radius apart."""
STEPS = 16


@dataclass(frozen=True)
class Places:
    """Where a node may be, before its curvature is known; as `Terrain` otherwise."""

    position: np.ndarray
    normal: np.ndarray
    even: np.ndarray

    def terrain(self, geometry: ContactGeometry, reference: float) -> Terrain:
        """`reference`: m, height of the tool's reference point above the surface halfway down."""
        shape = shape_operator(geometry, self.position + reference * self.normal)
        return Terrain(self.position, self.normal, shape, self.even)


def places_of(samples: ReachSamples, held_out: np.ndarray) -> Places:
    """Places that may become nodes; the samples `held_out` (n,) never do."""
    free = np.setdiff1d(np.flatnonzero(samples.allowed), held_out)
    position = samples.points[free]
    return Places(position, samples.normals[free], farthest_of(position, COARSE))


def above_regions(mesh: OrganMesh, places: Places, contact: float) -> list[int]:
    """Seeds above the organ's regions: for each its shallowest place, then places spread over where it is felt."""
    depth = np.linspace(0.0, FELT * contact, STEPS)
    position, normal = places.position[places.even], places.normal[places.even]
    inward = position[:, None] - depth[None, :, None] * normal[:, None]
    label = mesh.label_at(inward.reshape(-1, 3)).reshape(len(position), STEPS)
    seeds: list[int] = []
    for region in range(1, len(mesh.regions) + 1):
        within = label == region
        felt = np.flatnonzero(within.any(axis=1))
        if len(felt) == 0:
            continue
        first = np.argmax(within[felt], axis=1)
        shallow = np.flatnonzero(first == first.min())
        middle = position[felt[shallow]].mean(axis=0)
        start = shallow[np.argmin(np.linalg.norm(position[felt[shallow]] - middle, axis=1))]
        chosen = farthest_of(position[felt], AROUND, int(start), contact)
        seeds += places.even[felt[chosen]].tolist()
    return seeds
