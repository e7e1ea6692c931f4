# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A small asset to look at and to feel: an ellipsoid whose response is known exactly, with two balls."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import trimesh
from known_deformation import known_deformation
from known_organ import KnownOrgan, field_of

from palpate.fields.cook import write_rfield
from palpate.fields.deformation_layout import deformation_bytes
from palpate.fields.organ_geometry import OrganGeometry, Support
from palpate.fields.usd_write import add_tool, write_asset

ORGAN = KnownOrgan()
TOOLS = ("ball", "stiffer")
STIFFER = 2.0
"""The second tool's curves over the first one's."""


def write_two_tools(folder: Path) -> Path:
    """Writes the asset with its cooked fields into `folder`; the first tool's says how the surface moves."""
    field = field_of(ORGAN, 14)
    field = replace(field, layers={"deformation": deformation_bytes(known_deformation())})
    write_asset(folder, _geometry(), field)
    curves = replace(field.energy_curves, coefficients=STIFFER * field.energy_curves.coefficients)
    nodes = replace(
        field.nodes,
        stored_energy=STIFFER * field.nodes.stored_energy,
        normal_force=STIFFER * field.nodes.normal_force,
        lateral_gradient=STIFFER * field.nodes.lateral_gradient,
    )
    other = replace(
        field,
        tool=replace(field.tool, name=TOOLS[1], hash="cd" * 32),
        energy_curves=curves,
        nodes=nodes,
        layers={},
    )
    add_tool(folder, other)
    for one in (field, other):
        write_rfield(one, folder / f"{one.tool.name}.rfield")
    return folder


def _geometry() -> OrganGeometry:
    ball = trimesh.creation.icosphere(subdivisions=3)
    vertices, triangles = np.asarray(ball.vertices) * ORGAN.semi_axes, np.asarray(ball.faces, np.int32)
    points = np.concatenate([vertices, [[0.0, 0.0, 0.0]]])
    tets = np.concatenate([np.full((len(triangles), 1), len(vertices), np.int32), triangles], axis=1)
    centre = vertices[triangles].mean(axis=1)
    reach = (np.linalg.norm(centre[:, :2], axis=1) < 20e-3) & (centre[:, 2] > 0)
    held = np.flatnonzero(points[:, 2] < -0.02).astype(np.int32)
    return OrganGeometry(
        "ellipsoid", vertices, triangles, points, tets, (Support("below", held),), ("tissue",),
        np.zeros(len(tets), np.int32), np.flatnonzero(reach).astype(np.int32),
        {"model": "neo_hookean", "youngs_modulus": 5.4e3, "poissons_ratio": 0.48},
    )  # fmt: skip
