# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The members of a scene's tool, each as a tool of its own: the radii of a family, or the tilts that it is held at.

Each radius of a family presses to the scene's depth or to the share of itself that this version presses
(capabilities.py), whichever is less.
"""

from __future__ import annotations

from collections.abc import Sequence

from palpate.author.capabilities import CAPABILITIES
from palpate.author.scene import Scene
from palpate.author.scene_tables import Tool

__all__ = ["is_family", "is_tilted", "members_of", "one_radius"]


def is_family(tool: Tool) -> bool:
    """Whether a scene's tool has several radii."""
    return tool.radius is not None and len(tool.radius) > 1


def is_tilted(tool: Tool) -> bool:
    """Whether a scene's tool is held in several ways."""
    return tool.tilt is not None and len(tool.tilt) > 1


def members_of(scene: Scene, tool: Tool, tilts: Sequence[float] | None = None) -> list[tuple[Scene, Tool]]:
    """Each radius or tilt (rad; the tool's own when None) as a tool, in a scene whose depth is what it presses to.

    The tool itself where it has one of either.
    """
    if is_tilted(tool):
        held = tool.tilt or () if tilts is None else tilts
        return [_with(scene, tool, tool.model_copy(update={"tilt": (tilt,)})) for tilt in held]
    if not is_family(tool):
        return [(scene, tool)]
    deepest, share = scene.depth_max(tool), CAPABILITIES["depth over tool radius"]
    return [one_radius(scene, tool, radius, min(deepest, share * radius)) for radius in tool.radius or ()]


def one_radius(scene: Scene, tool: Tool, radius: float, depth: float | None = None) -> tuple[Scene, Tool]:
    """The scene with one radius (m) of a tool, pressed to `depth` (m), the scene's own when None; and that tool."""
    if depth is not None:
        reach = scene.reach.model_copy(update={"depth_max": depth})
        scene = scene.model_copy(update={"reach": reach})
    return _with(scene, tool, tool.model_copy(update={"radius": (radius,)}))


def _with(scene: Scene, tool: Tool, own: Tool) -> tuple[Scene, Tool]:
    """The scene with `own` in the place of `tool`, and `own`."""
    tools = tuple(own if other is tool else other for other in scene.tool)
    return scene.model_copy(update={"tool": tools}), own
