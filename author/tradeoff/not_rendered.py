# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What the runtime does not render, rendered in NumPy for held-out presses, so that its error is known all the same.

Unrounded: the field before its amplitudes become float32, by the NumPy twin of the runtime's response.

Axial: forces themselves interpolated over the surface at the contact point, axis by axis, with barycentric weights of
the three nodes around it, as published (V. Hayward, Physically-based haptic synthesis, 2008, eq. 5 and 6).  The nodes
are few and make no mesh: the triangle is that of a Delaunay triangulation of the nodes seen along the contact's normal,
and outside of all triangles the point goes to the nearest one.

Friction is the runtime's spring, tick by tick: s follows the tool along the surface, shrinks where k rises so that
k s stays, and slips:

    f = response - k s,    |k s| <= mu f_n
"""

from __future__ import annotations

import itertools
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.spatial import Delaunay, QhullError

from palpate.author.held_out import Rendered, line
from palpate.fem_offline.pose import tangents
from palpate.fields.interpolation import evaluate
from palpate.fields.lattice_stencil import sample_lattice
from palpate.fields.response_field import ResponseField
from palpate.fields.surface_curvature import foot_points

__all__ = ["Axial", "Unrounded"]

FACING = 0.5
"""Least cosine between normals of a contact and of a node that may be in its triangle."""


@dataclass(frozen=True)
class _At:
    """At n places: force (n, 3) N without friction, normal (n, 3), normal force (n,) N, k (n,) N/m, mu (n,)."""

    force: np.ndarray
    normal: np.ndarray
    normal_force: np.ndarray
    stiffness: np.ndarray
    friction: np.ndarray


class _Ticked(ABC):
    """Renders legs from what `_at` says of places (n, 3) m."""

    @abstractmethod
    def _at(self, q: np.ndarray) -> _At: ...

    def rendered(self, friction: float | None, legs: Sequence[np.ndarray]) -> Rendered:
        lines = [line(a, b) for a, b in itertools.pairwise(legs)]
        path = np.concatenate([legs[0][None], *lines])
        here = self._at(path)
        mu = here.friction if friction is None else np.full(len(path), friction)
        s, stiffness, pulls = np.zeros(3), 0.0, [np.zeros(3)]
        for i in range(1, len(path)):
            k, most = here.stiffness[i], mu[i] * max(here.normal_force[i], 0.0)
            if not (k > 0.0 and most > 0.0):
                s, stiffness = np.zeros(3), 0.0
                pulls.append(np.zeros(3))
                continue
            if stiffness > 0.0:  # contact begins with s = 0
                s = s + path[i] - path[i - 1]
                s = (s - (s @ here.normal[i]) * here.normal[i]) * min(1.0, stiffness / k)
            s = s * min(1.0, most / max(k * float(np.linalg.norm(s)), 1e-30))
            stiffness = k
            pulls.append(k * s)
        ends = np.cumsum([len(one) for one in lines])
        return Rendered(here.force[ends] - np.array(pulls)[ends], np.zeros(len(ends), int))


class Unrounded(_Ticked):
    """A field with all its digits."""

    def __init__(self, field: ResponseField) -> None:
        self._field = field

    def _at(self, q: np.ndarray) -> _At:
        said = evaluate(self._field, q)
        return _At(
            said.force, said.normal, said.normal_force, said.friction_stiffness, said.friction_coefficient
        )


class Axial(_Ticked):
    """Forces of a field's nodes, interpolated as published."""

    def __init__(self, field: ResponseField) -> None:
        self._field, nodes = field, field.nodes
        columns = np.concatenate(
            [
                nodes.normal_force[..., None],
                nodes.lateral_gradient,
                nodes.friction_stiffness[..., None],
                nodes.friction_coefficient[..., None],
            ],
            axis=2,
        )
        self._curves = PchipInterpolator(nodes.depth_knots, columns, axis=1)

    @staticmethod
    def stored_bytes(field: ResponseField) -> int:
        """What such a file would hold: three axes, k and mu of each node at each knot, its place, and the geometry."""
        count, knots = field.nodes.normal_force.shape
        geometry = field.geometry.signed_distance
        return 4 * (count * (5 * knots + 6) + geometry.block_index.size) + 2 * geometry.coefficients.size

    def _at(self, q: np.ndarray) -> _At:
        phi = sample_lattice(self._field.geometry.signed_distance, q).value[:, 0]
        depth = self._field.tool.offset - phi
        said, normals = np.zeros((len(q), 6)), np.zeros((len(q), 3))
        touching = np.flatnonzero(depth > 0.0)
        if len(touching):
            surface, normals[touching] = foot_points(self._field.geometry, q[touching])
            for i, place in zip(touching, surface, strict=True):
                index, weight = self._triangle(place, normals[i])
                curves = self._curves(min(depth[i], self._field.depth_max))
                said[i] = weight @ curves[index]
        aside = said[:, 1:4] - np.sum(said[:, 1:4] * normals, axis=1, keepdims=True) * normals
        return _At(said[:, :1] * normals - aside, normals, said[:, 0], said[:, 4], said[:, 5])

    def _triangle(self, surface: np.ndarray, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Nodes (at most 3) and their weights at a place of the surface."""
        nodes = self._field.nodes
        facing = np.flatnonzero(nodes.normal @ normal > FACING)
        flat = (nodes.position[facing] - surface) @ tangents(normal).T
        try:
            triangles = Delaunay(flat).simplices
        except (QhullError, ValueError):  # fewer than three, or all on a line
            nearest = int(np.argmin(np.linalg.norm(nodes.position - surface, axis=1)))
            return np.array([nearest]), np.ones(1)
        corners = flat[triangles]
        edges = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=2)
        two = np.linalg.solve(edges, -corners[:, 0, :, None])[..., 0]
        weight = np.concatenate([1.0 - two.sum(axis=1, keepdims=True), two], axis=1)
        best = int(np.argmax(weight.min(axis=1)))  # the one that holds the place, or misses it by least
        kept = np.clip(weight[best], 0.0, None)
        return facing[triangles[best]], kept / kept.sum()
