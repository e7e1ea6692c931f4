# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A pressed patch as plain arrays, for people and programs that want to look at it.

    F = I + sum_a u_a (x) grad N_a at the element's centre,   J = det F

Contact pressure is known at the faces' quadrature points; a node shows the mean of those around it, each weighted by
area and by L_a^2 (corner a) or 4 L_a L_b (edge ab), which are positive where quadratic shape functions are not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.fem_offline.contact import SIX_POINT_RULE, ContactSurface
from palpate.fem_offline.quadratic_space import (
    CENTRE_RULE,
    FACE_EDGES,
    quadratic_space,
    shape_gradients_barycentric,
)
from palpate.fem_offline.site import Site

__all__ = ["DeformedPatch", "deformation_gradients", "deformed_patch", "nodal_pressure"]


@dataclass(frozen=True)
class DeformedPatch:
    """The refined patch around a contact, pressed.

    Attributes:
        nodes: (N, 3) m at rest; corners and mid-edges.
        tets: (T, 10) quadratic tetrahedra, ordered as in VTK.
        label: (T,) region of each tetrahedron.
        faces: (B, 6) quadratic triangles of the organ's own surface, outward.
        displacement: (N, 3) m.
        volume_ratio: (T,) J at the centre of each tetrahedron.
        pressure: (N,) Pa of contact; 0 where nothing touches.
    """

    nodes: np.ndarray
    tets: np.ndarray
    label: np.ndarray
    faces: np.ndarray
    displacement: np.ndarray
    volume_ratio: np.ndarray
    pressure: np.ndarray


def deformed_patch(site: Site, u: np.ndarray, traction: np.ndarray) -> DeformedPatch:
    """The site's patch at displacements u (N, 3) m under contact traction (B, Q, 3) Pa.

    At `full` fidelity u goes on beyond the patch, whose nodes come first; the rest is left out.
    """
    space = quadratic_space(site.patch.points, site.patch.tets)  # numbered as the body's
    count = space.node_count
    F = deformation_gradients(space.corner_gradients, u[space.elements])
    return DeformedPatch(
        space.nodes,
        space.elements,
        site.patch.label.astype(np.int32),
        space.face_nodes(site.patch.outer_faces),
        u[:count].copy(),
        np.linalg.det(F),
        nodal_pressure(site.surface, traction, count),
    )


def deformation_gradients(corner_gradients: np.ndarray, u: np.ndarray) -> np.ndarray:
    """(T, 3, 3); F at the centres, corner_gradients (T, 4, 3) 1/m and u (T, 10, 3) m of each tetrahedron."""
    rule = shape_gradients_barycentric(CENTRE_RULE)[0]
    gradients = np.einsum("ai,tij->taj", rule, corner_gradients)
    return np.eye(3) + np.einsum("tai,taj->tij", u, gradients)


def nodal_pressure(surface: ContactSurface, traction: np.ndarray, node_count: int) -> np.ndarray:
    """(N,) Pa; |traction| (B, Q, 3) Pa carried from the quadrature points to the nodes."""
    L = SIX_POINT_RULE
    share = np.concatenate([L**2, np.stack([4.0 * L[:, a] * L[:, b] for a, b in FACE_EDGES], axis=1)], axis=1)
    weight = surface.weight[:, :, None] * share  # (B, Q, 6)
    pressure = np.linalg.norm(traction, axis=2)
    total, carried = np.zeros(node_count), np.zeros(node_count)
    np.add.at(total, surface.faces, weight.sum(axis=1))
    np.add.at(carried, surface.faces, np.einsum("bqa,bq->ba", weight, pressure))
    return np.divide(carried, total, out=np.zeros(node_count), where=total > 0.0)
