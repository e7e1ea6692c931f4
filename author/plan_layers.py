# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What effects that are kept in layers of a field add to one tool: bytes of its .rfield, and ns of a tick.

Bytes of textures and transients are known before any work; those of a deformation are the most that its counts allow.
None of them is pressed for: a deformation takes linear solves of the presses that are there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.author.scene import Scene
from palpate.author.scene_tables import Tool
from palpate.author.texture.texture_stage import textures_of
from palpate.author.transients.transient_stage import transients_of

__all__ = ["LayerCost", "layer_costs"]

TRANSIENT = 25.0
"""ns of a tick."""


@dataclass(frozen=True)
class LayerCost:
    """Attributes: bytes; tick_ns, of a sticking tick."""

    bytes: int
    tick_ns: float


def layer_costs(scene: Scene, tool: Tool, masks: int, nodes: int) -> dict[str, LayerCost]:
    """By effect, those that the scene asks for; nothing for a transient that this tool does not have.

    Args:
        masks: bytes of a texture's masks, which are as large as four amplitude channels.
        nodes: of the tool (count).
    """
    made = {
        "texture": lambda: _texture(scene, masks),
        "transient": lambda: _transient(scene, tool),
        "deformation": lambda: LayerCost(_deformation_bytes(scene, tool, nodes), 0.0),
    }
    return {effect: made[effect]() for effect in scene.effects if effect in made}


def _texture(scene: Scene, masks: int) -> LayerCost:
    """Header and groups of four waves."""
    made = textures_of(scene)
    assert made is not None
    waves = made[0].waves
    groups, masked = sum(-(-len(w.phase) // 4) for w in waves), any(w.mask >= 0 for w in waves)
    # tests/benchmarks/layer_ticks.py
    return LayerCost(
        160 + 160 * groups + (masks if masked else 0), 17.0 + 10.0 * groups + (12.0 if masked else 0.0)
    )


def _transient(scene: Scene, tool: Tool) -> LayerCost:
    made = transients_of(scene, tool)
    return LayerCost(len(made[0]), TRANSIENT) if made else LayerCost(0, 0.0)


def _deformation_bytes(scene: Scene, tool: Tool, nodes: int) -> int:
    """With as many shared tables as there may be."""
    from palpate.author.deformation_stage import gap_counts
    from palpate.author.tool_stage import shape_of
    from palpate.author.tool_work import LADDER_STEPS
    from palpate.fields.deformation_fit import RADIAL_KNOTS, RANK_LIMITS
    from palpate.fields.deformation_layout import HEADER_DTYPE, layer_size

    h = np.zeros((), HEADER_DTYPE)
    h["rank"], h["node_count"] = RANK_LIMITS, nodes
    h["radial_count"], h["depth_count"] = RADIAL_KNOTS, LADDER_STEPS + 1
    h["gap_count"] = gap_counts(shape_of(scene, tool), scene.depth_max(tool))
    return layer_size(h)
