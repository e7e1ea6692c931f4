# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The organ's surface file as the scene names it, before any repair."""

from __future__ import annotations

import numpy as np

from palpate.author.errors import InputError
from palpate.author.organ_check import OrganSummary
from palpate.author.scene import Scene
from palpate.fem_offline.errors import SurfaceError
from palpate.fem_offline.surface_parts import SurfacePart, is_closed, load_surface, merged

__all__ = ["organ_parts", "rough_summary"]


def organ_parts(scene: Scene) -> list[SurfacePart]:
    """The parts of the scene's surface file, m.  Raises InputError that names the scene's key."""
    try:
        return load_surface(scene.organ.surface, scene.organ.units or "m")
    except SurfaceError as error:
        raise InputError(
            scene.problem("organ.surface", str(scene.organ.surface), error.what, error.expected)
        ) from error


def rough_summary(parts: list[SurfacePart]) -> tuple[OrganSummary, str]:
    """The organ as far as it is known before repair, and what it was taken from.

    A closed surface is taken as it is; anything else as its convex hull, whose area and volume are estimates.
    """
    vertices, triangles = merged(parts)
    if is_closed(triangles):
        return OrganSummary(vertices, triangles), "the closed surface"
    import trimesh

    hull = trimesh.convex.convex_hull(vertices)
    summary = OrganSummary(np.asarray(hull.vertices), np.asarray(hull.faces))
    return summary, "the convex hull of a surface that needs repair"
