# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Morphological opening of a solid: what a ball of radius r, rolling inside, can reach.

    opened = { phi_e <= r },    phi_e the signed distance of the eroded solid { phi <= -r }

Membranes thinner than 2 r (ligaments that an alpha wrap turns into fins) go, convex edges get the radius r,
and the rest stays where it was.  (Serra, Image Analysis and Mathematical Morphology, 1982.)

Both level sets are evaluated on a grid, exactly in a narrow band around them.  Smooth parts come out exact to
second order in the grid's spacing; sharp ridges of the eroded solid are cut by up to one spacing, so sharp
convex edges retreat a little farther than their rounding asks.
"""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from palpate.fem_offline.errors import SurfaceError
from palpate.fem_offline.signed_distance import SignedDistance

__all__ = ["opened"]

_COARSENING = 4
"""Grid points of the narrow band's search grid are this many times farther apart."""


def opened(
    vertices: np.ndarray, triangles: np.ndarray, radius: float, spacing: float
) -> tuple[np.ndarray, np.ndarray]:
    """The opened solid's surface, outward: vertices (V, 3) m, triangles (F, 3); may have several pieces.

    vertices (V, 3) m, triangles (F, 3) closed and outward; radius, spacing (of the grid) m.
    """
    margin = radius + 3 * spacing
    origin = vertices.min(axis=0) - margin
    counts = np.ceil((np.ptp(vertices, axis=0) + 2 * margin) / (spacing * _COARSENING)).astype(int)
    counts = counts * _COARSENING + 1
    eroded = _level_set(SignedDistance(vertices, triangles), -radius, origin, spacing, counts)
    if not len(eroded[1]):
        raise SurfaceError(
            f"nothing of the solid is thicker than {2e3 * radius:.3g} mm",
            "surface repair",
            "a smaller opening radius, or a solid rather than a membrane",
        )
    return _level_set(SignedDistance(*eroded), radius, origin, spacing, counts)


def _level_set(phi, level: float, origin: np.ndarray, spacing: float, counts: np.ndarray):
    """The surface { phi = level }, oriented towards larger phi: vertices (V, 3) m, triangles (F, 3)."""
    import pyvista

    axes = [o + spacing * np.arange(n) for o, n in zip(origin, counts, strict=True)]
    coarse_axes = [a[::_COARSENING] for a in axes]
    coarse = phi(np.stack(np.meshgrid(*coarse_axes, indexing="ij"), axis=-1).reshape(-1, 3))
    coarse = coarse.reshape([len(a) for a in coarse_axes])
    # phi changes by at most the distance walked, so a coarse cell far from the level cannot hold it.
    values = ndimage.zoom(coarse, counts / np.array(coarse.shape), order=1, grid_mode=False)
    reach = np.sqrt(3) * spacing * (_COARSENING + 1)
    near = np.argwhere(np.abs(values - level) < reach)
    values[tuple(near.T)] = phi(origin + spacing * near)
    grid = pyvista.ImageData(dimensions=counts, spacing=[spacing] * 3, origin=origin)
    contour = grid.contour([level], scalars=values.ravel(order="F"), method="flying_edges")
    if contour.n_points == 0:
        return np.zeros((0, 3)), np.zeros((0, 3), np.int32)
    surface = contour.triangulate().clean(tolerance=1e-6)
    vertices = np.array(surface.points, float)
    triangles = np.array(surface.faces.reshape(-1, 4)[:, 1:], np.int32)
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    if np.einsum("ij,ij->", a, np.cross(b, c)) < 0.0:
        triangles = triangles[:, ::-1]
    return vertices, np.ascontiguousarray(triangles)
