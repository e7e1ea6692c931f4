# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The organ's surface around a contact: what the tool must not touch.

A contact is solved on faces near the contact point, where the mesh is fine.  A shaft that is laid onto the tissue, or
an organ that closes around the tool, touches elsewhere; nothing there would push back, and the force would be too
small without a sign of it.  So each recorded state is looked at: the patch's other faces where they have moved to, the
surface outside the patch at rest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.fem_offline.organ import Organ
from palpate.fem_offline.patch import Patch
from palpate.fem_offline.quadratic_space import face_shape
from palpate.fem_offline.tool import Pose, Tool

__all__ = ["Stray", "Surroundings", "surroundings"]

_STEPS = 4
_SAMPLES = (
    np.array([(i, j, _STEPS - i - j) for i in range(_STEPS + 1) for j in range(_STEPS + 1 - i)]) / _STEPS
)
"""(15, 3) barycentric; a quarter of an edge apart."""


@dataclass(frozen=True)
class Stray:
    """Where a tool is deepest in its surroundings.

    Attributes:
        gap: m, negative inside the tool.  point: (3,) m.
    """

    gap: float
    point: np.ndarray


@dataclass(frozen=True)
class Surroundings:
    """Surface that must not be touched.

    Attributes:
        near_faces: (B, 6) quadratic faces of the patch.  nodes: (N, 3) m, the patch's at rest.
        far_faces: (C, 3, 3) m; corners of the organ's faces outside the patch.
    """

    near_faces: np.ndarray
    nodes: np.ndarray
    far_faces: np.ndarray

    def deepest(self, tool: Tool, pose: Pose, u: np.ndarray) -> Stray:
        """Where the tool is deepest in the surroundings, u (>= N, 3) m of the nodes; gap inf where nothing is near."""
        moved = self.nodes + u[: len(self.nodes)]
        corners = np.concatenate([moved[self.near_faces[:, :3]], self.far_faces])
        middle = corners.mean(axis=1)
        reach = 1.5 * np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1, initial=0.0)
        close = tool.distance(middle, pose).gap < reach if len(middle) else np.zeros(0, bool)
        near, far = np.split(close, [len(self.near_faces)])
        points = np.concatenate(
            [
                np.einsum("qa,bai->bqi", face_shape(_SAMPLES), moved[self.near_faces[near]]).reshape(-1, 3),
                np.einsum("qa,bai->bqi", _SAMPLES, self.far_faces[far]).reshape(-1, 3),
            ]
        )
        if not len(points):
            return Stray(np.inf, np.full(3, np.nan))
        gap = tool.distance(points, pose).gap
        at = int(np.argmin(gap))
        return Stray(float(gap[at]), points[at])


def surroundings(organ: Organ, patch: Patch, near_faces: np.ndarray, nodes: np.ndarray) -> Surroundings:
    """Of a patch whose faces near_faces (B, 6) on nodes (N, 3) m may not touch."""
    return Surroundings(near_faces, nodes, organ.points[organ.faces_of(~patch.carved)])
