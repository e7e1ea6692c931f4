# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What the effect `deformation` can do of a scene's tools: its tables are functions of distance from the contact."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from palpate.author.scene_tables import Tool

__all__ = ["deformation_problems"]


def deformation_problems(key: str, tool: Tool) -> Iterator[tuple[str, Any, str, str]]:
    """What this version's deformation cannot do of a scene's tool."""
    round_tool = "a round tool, held upright, of one radius"
    if tool.radius is not None and len(tool.radius) > 1:
        yield f"{key}.radius", list(tool.radius), "the effect deformation of a tool family", round_tool
    if tool.shape == "mesh":
        yield f"{key}.shape", tool.shape, "the effect deformation of a mesh tool", round_tool
    if tool.tilt is not None and any(tool.tilt):
        yield f"{key}.tilt", list(tool.tilt), "the effect deformation of a tilted tool", round_tool
    if tool.axis is not None and tool.axis[2] < 1.0 - 1e-9:
        yield f"{key}.axis", list(tool.axis), "the effect deformation of a tool that lies", round_tool
