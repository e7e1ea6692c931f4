# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""When a press must be refused because of how the tool lies to the organ, in words that a person can act on."""

from __future__ import annotations

import numpy as np

from palpate.fem_offline.site import Site
from palpate.fem_offline.tool import Pose, Tool

__all__ = ["why_not_placed", "why_stray"]

TOUCH = 0.02
"""Share of the depth that the tool may reach into tissue which does not push back: its force is of second order."""
EARLY = 0.02
"""Share of the deepest depth by which contact may begin before depth 0, where the stored energy is taken to be 0."""


def why_not_placed(site: Site, tool: Tool, depth_max: float) -> str:
    """Why the press cannot begin, or "": at depth 0 the tool is already in the tissue.

    A flat face over a hollow, or a shaft laid over a ridge, touches before the reference point's depth says so.
    """
    x = site.surface.rest.reshape(-1, 3)
    gap = tool.distance(x, site.pose(tool, 0.0)).gap
    at = int(np.argmin(gap))
    if gap[at] >= -EARLY * depth_max:
        return ""
    away = 1e3 * np.linalg.norm(x[at] - site.contact_point)
    return (
        f"the tool is {-1e3 * gap[at]:.2f} mm in the tissue before the press begins, {away:.1f} mm from the contact "
        "point: the surface rises around it; a smaller tool, another tilt or a flatter place"
    )


def why_stray(site: Site, tool: Tool, depth: float, u: np.ndarray, pose: Pose | None = None) -> str:
    """Why a state u (N, 3) m does not count, or "": the tool touches where no contact is solved.

    `pose` is where a tool at `depth` (m) was dragged to; None: pressed straight in.
    """
    pose = pose or site.pose(tool, depth)
    stray = site.surroundings.deepest(tool, pose, u)
    if stray.gap >= -TOUCH * depth:
        return ""
    away = 1e3 * np.linalg.norm(stray.point - pose.position)
    return (
        f"the tool touches the tissue {away:.1f} mm from its reference point, beyond the contact that is solved, "
        f"{depth * 1e3:.2f} mm deep: less depth, less tilt, or a longer or slimmer tip"
    )
