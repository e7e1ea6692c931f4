# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Whether a scene's materials stay stable in the stretches that its presses use.

Measured under a ball of radius R, 0.8 R deep in a neo-Hookean block: principal stretches from 0.55 to 1.32.  With
s = depth / R that is 1 - 0.56 s and 1 + 0.40 s; a margin on top gives MILD.  Edges and tips strain more than any
depth says, so tools that have them are held to the whole range that `fem_offline.material_check` scans.
"""

from __future__ import annotations

from collections.abc import Iterator

from palpate.author.errors import InputError
from palpate.author.scene import Scene
from palpate.author.scene_tables import Material
from palpate.author.solid import solid_of
from palpate.author.tool_members import members_of

__all__ = ["refuse_unstable_materials", "stretch_range"]

MILD = (0.7, 0.6)
"""Shares of s by which the smallest stretch may lie below one, and the largest above it."""
WHOLE = (0.3, 2.0)
ALWAYS_STABLE = ("linear", "neo_hookean")


def stretch_range(scene: Scene) -> tuple[float, float]:
    """Smallest and largest principal stretch that a material of the scene has to bear."""
    low, high = 1.0, 1.0
    for tool in scene.tool:
        if tool.shape in ("sphere", "capsule") and tool.radius:
            s = max(own.depth_max(one) / one.radius[0] for own, one in members_of(scene, tool) if one.radius)
            low = min(low, max(WHOLE[0], 1.0 - MILD[0] * s))
            high = max(high, min(WHOLE[1], 1.0 + MILD[1] * s))
        else:
            low, high = WHOLE
    return low, high


def refuse_unstable_materials(scene: Scene) -> None:
    """Raises InputError with every material that softens or loses ellipticity within the scene's stretches."""
    asked = [(key, material) for key, material in _materials(scene) if material.model not in ALWAYS_STABLE]
    if not asked:
        return
    from palpate.fem_offline.material_check import stability

    low, high = stretch_range(scene)
    problems = []
    for key, material in asked:
        found = stability(solid_of(material), stretch_max=high, stretch_min=low)
        if not found.stable:
            what = f"is not stable where it is used: {found.sentence}"
            expected = f"constants that are stable at principal stretches from {low:.2g} to {high:.2g}"
            problems.append(scene.problem(key, None, what, expected))
    if problems:
        raise InputError(problems)


def _materials(scene: Scene) -> Iterator[tuple[str, Material]]:
    yield "organ.material", scene.organ.material
    for i, region in enumerate(scene.organ.region):
        yield f"organ.region[{i}].material", region.material
    if scene.organ.capsule is not None:
        yield "organ.capsule.material", scene.organ.capsule.material
