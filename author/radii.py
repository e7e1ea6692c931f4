# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The radii of a scene's tool: one, or a family's, each as a tool of its own.

Each radius of a family presses to the scene's depth or to the share of itself that this version presses
(capabilities.py), whichever is less.
"""

from __future__ import annotations

from palpate.author.capabilities import CAPABILITIES
from palpate.author.scene import Scene
from palpate.author.scene_tables import Tool

__all__ = ["is_family", "members_of", "one_radius"]


def is_family(tool: Tool) -> bool:
    """Whether a scene's tool has several radii."""
    return tool.radius is not None and len(tool.radius) > 1


def members_of(scene: Scene, tool: Tool) -> list[tuple[Scene, Tool]]:
    """Each radius as a tool of its own, in a scene whose depth is what it presses to; itself where it is no family."""
    if not is_family(tool):
        return [(scene, tool)]
    deepest, share = scene.depth_max(tool), CAPABILITIES["depth over tool radius"]
    return [one_radius(scene, tool, radius, min(deepest, share * radius)) for radius in tool.radius or ()]


def one_radius(scene: Scene, tool: Tool, radius: float, depth: float | None = None) -> tuple[Scene, Tool]:
    """The scene with one radius (m) of a tool, pressed to `depth` (m), the scene's own when None; and that tool."""
    own = tool.model_copy(update={"radius": (radius,)})
    tools = tuple(own if other is tool else other for other in scene.tool)
    reach = scene.reach if depth is None else scene.reach.model_copy(update={"depth_max": depth})
    return scene.model_copy(update={"tool": tools, "reach": reach}), own
