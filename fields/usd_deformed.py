# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A pressed surface in USD, to look at: one Mesh as it stands, with its displacement; the tool beside it.

/press
    Surface      Mesh; points are deformed, primvars:displacement leads from rest to there (rest = points - it)
    Tool         Mesh, where the tool's geometry is given

Needs no schema of this project: any viewer shows it.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Sdf

from palpate.fields.usd_layer import author, child, json_text, new_layer, replace_file

__all__ = ["write_deformed"]

TOOL_COLOUR = (0.35, 0.37, 0.40)
"""Linear RGB."""


def write_deformed(
    path: Path,
    rest: np.ndarray,
    triangles: np.ndarray,
    displacement: np.ndarray,
    scalars: Mapping[str, tuple[np.ndarray, str]],
    colour: np.ndarray,
    about: dict[str, Any],
    tool: tuple[np.ndarray, np.ndarray] | None = None,
) -> None:
    """Write one layer (.usda, .usdc or .usd), whole or not at all.

    Args:
        rest: (N, 3) m.  triangles: (F, 3), counter-clockwise from outside.  displacement: (N, 3) m.
        scalars: name -> ((N,) values, unit); primvars of that name.
        colour: (N, 3) linear RGB.
        about: JSON-clean facts, kept as the root's customData.
        tool: vertices (V, 3) m in the organ's axes and triangles (G, 3).

    Raises:
        OSError: the file cannot be written.  FieldError: `about` is not JSON-clean.
    """
    layer, root = new_layer("press", comment="A pressed surface, made by palpate press")
    root.SetInfo("customData", {"palpate": json_text(about, "press")})
    moved = rest + displacement
    surface = _mesh(root, "Surface", moved, triangles)
    author(surface, "normals", "normal3f[]", _normals(moved, triangles), interpolation="vertex")
    unit = {"customData": {"unit": "m"}, "interpolation": "vertex"}
    author(surface, "primvars:displacement", "vector3d[]", displacement, **unit)
    for name, (values, unit_name) in scalars.items():
        facts = {"customData": {"unit": unit_name}, "interpolation": "vertex"}
        author(surface, f"primvars:{name}", "float[]", values, **facts)
    author(surface, "primvars:displayColor", "color3f[]", colour, interpolation="vertex")
    if tool is not None:
        prim = _mesh(root, "Tool", *tool)
        author(prim, "normals", "normal3f[]", _normals(*tool), interpolation="vertex")
        author(prim, "primvars:displayColor", "color3f[]", [TOOL_COLOUR], interpolation="constant")
    replace_file(layer, path)


def _mesh(root: Sdf.PrimSpec, name: str, points: np.ndarray, triangles: np.ndarray) -> Sdf.PrimSpec:
    prim = child(root, name, "Mesh")
    author(prim, "points", "point3f[]", points)
    author(prim, "extent", "float3[]", np.array([points.min(axis=0), points.max(axis=0)]))
    author(prim, "faceVertexCounts", "int[]", np.full(len(triangles), 3))
    author(prim, "faceVertexIndices", "int[]", triangles.reshape(-1))
    author(prim, "subdivisionScheme", "token", "none", uniform=True)
    author(prim, "orientation", "token", "rightHanded", uniform=True)
    return prim


def _normals(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(N, 3) unit normals, faces weighted by area; e_z where a vertex has no area around it."""
    x = points[triangles]
    across = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    normal = np.zeros_like(points)
    np.add.at(normal, triangles.ravel(), np.repeat(across, 3, axis=0))
    length = np.linalg.norm(normal, axis=1)
    normal[length == 0.0] = (0.0, 0.0, 1.0)
    return normal / np.where(length == 0.0, 1.0, length)[:, None]
