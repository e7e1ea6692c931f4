# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A response field resampled at the vertices of the organ's surface, for consumers that want one curve a vertex.

At vertex v and knot d the tool's reference point is at c + (rho - d) n (foot_points.py); with the field's U there

    stored energy U,   normal force -grad U . n,   lateral gradient grad U - (grad U . n) n,   friction k and mu

Derived from the field, never read back into it: between vertices it has none of the field's promises, and interpolating
it creates energy where a tool slides.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.fields.foot_points import foot_points, vertex_normals
from palpate.fields.interpolation import evaluate
from palpate.fields.organ_geometry import OrganGeometry
from palpate.fields.response_field import ResponseField

__all__ = ["SurfaceResponse", "surface_response"]


@dataclass(frozen=True)
class SurfaceResponse:
    """V vertices of the organ's surface, K knots.  Everything is zero where `reached` is not.

    Attributes:
        depth_knots: (K,) m, those of the nodes.
        reached: (V,) bool; a vertex of the reach, where the field is stored at every knot.
        stored_energy: (V, K) J.
        normal_force: (V, K) N; on the tool, along the outward normal.
        lateral_gradient: (V, K, 3) N; minus the tangential force on a frictionless tool.
        friction_stiffness: (V, K) N/m.
        friction_coefficient: (V, K).
    """

    depth_knots: np.ndarray
    reached: np.ndarray
    stored_energy: np.ndarray
    normal_force: np.ndarray
    lateral_gradient: np.ndarray
    friction_stiffness: np.ndarray
    friction_coefficient: np.ndarray


def surface_response(organ: OrganGeometry, field: ResponseField) -> SurfaceResponse:
    """The curves of `field` at the vertices of `organ`."""
    knots = field.nodes.depth_knots
    count, rho = len(organ.vertices), field.tool.offset
    reached = np.zeros(count, bool)
    reached[organ.triangles[organ.reach_triangles].ravel()] = True
    at = np.flatnonzero(reached)
    feet = foot_points(field, organ.vertices[at], vertex_normals(organ.vertices, organ.triangles)[at])
    good = feet.known.copy()
    energy, force, stiffness, coefficient = (np.zeros((count, len(knots))) for _ in range(4))
    lateral = np.zeros((count, len(knots), 3))
    for k, depth in enumerate(knots):
        found = evaluate(field, feet.position + (rho - depth) * feet.normal)
        good &= found.valid
        if depth == 0.0:
            continue  # first touch: rounding would leave 1e-20 N
        along = np.sum(found.gradient * feet.normal, axis=1)
        energy[at, k], force[at, k] = found.energy, -along
        lateral[at, k] = found.gradient - along[:, None] * feet.normal
        stiffness[at, k], coefficient[at, k] = found.friction_stiffness, found.friction_coefficient
    reached[at] = good
    for values in (energy, force, lateral, stiffness, coefficient):
        values[~reached] = 0.0
    return SurfaceResponse(knots, reached, energy, force, lateral, stiffness, coefficient)
