# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rigid tools as signed distances g(x), positive outside the tool.

A tool has a reference point (the one whose position the response field is a function of) and, for each direction, an
offset: how far it reaches that way from the reference point (the support function of the solid).  Held against
tissue with outward normal n and rotation Q it touches a plane when its reference point is

    rho = offset_along(-Q^T n)

above it, and depth = rho - phi(reference point), phi the organ's signed distance.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from palpate.fem_offline.footprint import Footprint
from palpate.fem_offline.mesh_tool import MeshTool
from palpate.fem_offline.pose import Pose, ToolDistance, tangents, tilted
from palpate.fem_offline.round_tools import Capsule, Cone, Cylinder, FlatPunch
from palpate.fem_offline.sphere import Sphere

__all__ = [
    "Capsule",
    "Cone",
    "Cylinder",
    "FlatPunch",
    "Footprint",
    "MeshTool",
    "Pose",
    "Sphere",
    "Tool",
    "ToolDistance",
    "tangents",
    "tilted",
]


class Tool(Protocol):
    """What a press needs to know of a tool."""

    def distance(self, points: np.ndarray, pose: Pose) -> ToolDistance:
        """Gap of points (n, 3) m, with its gradient and Hessian, in the organ's frame."""
        ...

    def offset_along(self, direction: np.ndarray) -> float:
        """m that the tool reaches from its reference point in a unit direction (3,) of its own frame."""
        ...

    def contact_size(self, depth: float, rotation: np.ndarray | None = None) -> float:
        """m; radius of the contact, or half its width where it is long.

        Args:
            depth: m.
            rotation: (3, 3) of the tool against a plane with normal e_z; None: upright.
        """
        ...

    def contact_extent(self, depth: float, rotation: np.ndarray | None = None) -> float:
        """m; radius around the contact point that contains the contact, rotation as in `contact_size`."""
        ...

    def footprint(self, depth: float, rotation: np.ndarray | None = None) -> Footprint:
        """Both, and where in the plane the contact is widest; depth and rotation as in `contact_size`."""
        ...

    def hash(self) -> str:
        """Hex digest of geometry, axis and reference point; a field is valid for this tool only."""
        ...
