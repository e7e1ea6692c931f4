# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""One tool of an asset, with all that is needed to press it anew; from its USD alone."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.errors import InputError, InputProblem
from palpate.author.organ_stage import OrganMesh
from palpate.author.painted_friction import friction_at
from palpate.author.sampling import ReachSamples, common_samples
from palpate.author.scene_tables import Capsule, Material, Reach, Region, Support
from palpate.author.tool_stage import ToolShape, shape_of_reference
from palpate.fields.organ_geometry import OrganGeometry
from palpate.fields.response_field import FamilyMember, ResponseField

__all__ = ["AuthoredTool", "authored_tool"]


@dataclass(frozen=True)
class AuthoredTool:
    """A tool's field and the organ that it was pressed into.

    Attributes:
        scene: the part of the scene that the field was made from.
        shape: the tool; of a family the ball whose field this is.
        samples: where it may be pressed, with every radius of a family and in every way of touching.
    """

    field: ResponseField
    scene: dict[str, Any]
    mesh: OrganMesh
    shape: ToolShape
    samples: ReachSamples

    def friction(self, points: np.ndarray) -> np.ndarray:
        """Coulomb coefficient (n,) at points (n, 3) m; 0 without the effect."""
        scene = self.scene
        at = friction_at(scene["effects"], scene["tool"].get("friction"), self.mesh, points)
        return np.zeros(len(points)) if at is None else at


def authored_tool(asset: Path, tool: str | None = None) -> AuthoredTool:
    """One tool of an asset, the first when none is named.

    Raises:
        InputError: the asset has no such tool, or was not made by `palpate author`.
    """
    from palpate.fields.usd_read import read_field, read_organ, tools

    names = tools(asset)
    if tool is not None and tool not in names:
        raise InputError(
            InputProblem(str(asset), "tool", tool, "is not in this asset", "one of " + ", ".join(names))
        )
    field = read_field(asset, tool or names[0])
    if "scene" not in field.provenance:
        raise InputError(InputProblem(str(asset), "provenance", None, "names no scene", "an authored asset"))
    scene = field.provenance["scene"]
    mesh = _mesh(read_organ(asset), field)
    members = field.family or (FamilyMember(field.tool, field.nodes), *field.ways)
    samples = common_samples(
        mesh,
        Reach.model_validate(scene["reach"]),
        [shape_of_reference(member.tool) for member in members],
        [float(member.nodes.depth_knots[-1]) for member in members],
    )
    return AuthoredTool(field, scene, mesh, shape_of_reference(field.tool), samples)


def _mesh(organ: OrganGeometry, field: ResponseField) -> OrganMesh:
    """The organ as it was pressed."""
    scene = field.provenance["scene"]
    return OrganMesh(
        organ.vertices,
        organ.triangles,
        organ.tet_points,
        organ.tet_indices,
        organ.name,
        Material.model_validate(scene["material"]),
        tuple(Support.model_validate(support) for support in scene["support"]),
        tuple(Region.model_validate(region) for region in scene["region"]),
        organ.provenance,
        field.provenance["organ"],
        Capsule.model_validate(scene["capsule"]) if scene.get("capsule") else None,
        organ.paint,
    )
