# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The organ's surface as a cooked field knows it, for pictures of a field that has no asset beside it.

The points where the tool's reference point is at first touch, phi = rho, lie in the band of every field; their feet
p - rho grad phi are the organ's surface.  The reach is taken to be where full depth gives a force that is judged;
what lies farther than AROUND from it is left out.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from palpate.author.certify import FORCE_FLOOR
from palpate.fields.interpolation import evaluate
from palpate.fields.lattice import BLOCK_EDGE
from palpate.fields.lattice_stencil import sample_lattice
from palpate.fields.organ_geometry import OrganGeometry
from palpate.fields.response_field import ResponseField

__all__ = ["known_surface"]

AROUND = 10e-3
AT_ONCE = 50_000
"""Points whose distance is looked up together, 3.8 kB each (count)."""
"""m."""


def known_surface(field: ResponseField) -> OrganGeometry:
    """Surface and reach of what `field` was made for; no tetrahedra, supports or materials."""
    touch, triangles = _level(field, field.tool.offset)
    at = evaluate(field, touch)
    rho = field.tool.offset
    feet = touch - rho * at.normal
    deep = evaluate(field, feet + (rho - field.depth_max) * at.normal)
    force = np.where(deep.valid, deep.normal_force, 0.0)
    felt = force >= FORCE_FLOOR * max(float(force.max(initial=0.0)), 1e-300)
    outward = np.cross(*(feet[triangles[:, k]] - feet[triangles[:, 0]] for k in (1, 2)))
    inside_out = np.sum(outward * at.normal[triangles].sum(axis=1), axis=1) < 0
    triangles[inside_out] = triangles[inside_out][:, ::-1]
    if felt.any():
        near = (cKDTree(feet[felt]).query(feet)[0] <= AROUND) & at.valid
        triangles = triangles[near[triangles].all(axis=1)]
    return OrganGeometry(
        name=field.tool.name,
        vertices=feet,
        triangles=triangles.astype(np.int32),
        tet_points=np.zeros((0, 3)),
        tet_indices=np.zeros((0, 4), np.int32),
        supports=(),
        region_names=("tissue",),
        region_label=np.zeros(0, np.int32),
        reach_triangles=np.flatnonzero(felt[triangles].all(axis=1)).astype(np.int32),
        material={},
    )


def _level(field: ResponseField, level: float) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V, 3) m and triangles (F, 3) of phi = level where the lattice is stored."""
    import pyvista

    lattice = field.geometry.signed_distance
    count = BLOCK_EDGE * np.array(lattice.block_index.shape)
    grid = pyvista.ImageData(
        dimensions=tuple(count + 1), spacing=(lattice.spacing,) * 3, origin=tuple(lattice.origin)
    )
    points = np.asarray(grid.points, float)
    parts = np.array_split(points, max(1, len(points) // AT_ONCE))
    samples = [sample_lattice(lattice, part) for part in parts]
    grid["phi"] = np.concatenate([sample.value[:, 0] for sample in samples])
    grid["known"] = np.concatenate([sample.present for sample in samples]).astype(float)
    known = grid.threshold(0.5, scalars="known", all_scalars=True)
    made = known.contour([level], scalars="phi").triangulate()
    return np.asarray(made.points, float), np.asarray(made.regular_faces).copy()
