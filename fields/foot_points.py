# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""From the vertices of a mesh that is shown to the surface that a field itself knows.

A tool whose reference point is at c + (rho - d) n, c being the foot point of a vertex in the field's own contact
geometry, is d deep exactly, although the mesh shown may be coarser.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from palpate.fields.interpolation import evaluate
from palpate.fields.response_field import ResponseField

__all__ = ["FootPoints", "foot_points", "vertex_normals"]


class FootPoints(NamedTuple):
    """Of V vertices."""

    position: np.ndarray  # (V, 3) m
    normal: np.ndarray  # (V, 3) outward
    known: np.ndarray  # (V,) bool; elsewhere position and normal are the mesh's own


def foot_points(field: ResponseField, vertices: np.ndarray, normals: np.ndarray) -> FootPoints:
    """Args: vertices: (V, 3) m; normals: (V, 3) outward, the mesh's own."""
    rho = field.tool.offset
    start = vertices + rho * normals
    touching = evaluate(field, start)
    n = np.where(touching.valid[:, None], touching.normal, normals)
    phi = np.where(touching.valid, rho - touching.depth, rho)
    return FootPoints(start - phi[:, None] * n, n, touching.valid)


def vertex_normals(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(V, 3) unit normals, the triangles' weighted by area; +z at vertices that no triangle uses."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    face = np.cross(b - a, c - a)
    normal = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(normal, triangles[:, k], face)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return np.where(length > 0, normal / np.where(length > 0, length, 1.0), (0.0, 0.0, 1.0))
