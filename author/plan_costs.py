# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What each effect, tool and region adds to a plan: presses, minutes, bytes and nanoseconds of a tick.

Time.  Seeds and held-out presses are always pressed; further nodes until the error is small or the budget is spent:

    CPU = start + mesh + w far + sum_tools ( n c_near + h c_full + fit )        n: nodes and near checks, h: held out
    n   = seeds + min(expected - seeds, (0.9 budget - start - mesh) w / c_near - what is pressed anyway)

Bytes of an .rfield over the area A of the reach, 1.5 mm geometry and 4 mm amplitudes in strides of 4 channels (the
energy's three, and friction's three in a second stride), fitted to files of 7, 10 and 291 cm2 (87, 103 and 993 kB
beside estimates of 90, 100 and 995).  Nanoseconds: a sticking tick on a 2.5 GHz core; friction's share is what a field
of the liver takes longer than without its curves, in turns on one core (200 and 218 ns, 206 and 227 ns sliding).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from palpate.author.effort import (
    BUDGET_TO_PRESS,
    REGION_EXPECTED,
    REGION_SEEDS,
    STARTING,
    expected_nodes,
    far_field_seconds,
    fitting_seconds,
    meshing_seconds,
    node_count,
    press_seconds,
    region_nodes,
    seed_count,
)
from palpate.author.plan_layers import layer_costs
from palpate.author.scene import Scene
from palpate.author.scene_tables import Tool

__all__ = ["added_by", "rfield_bytes", "tool_row", "with_time"]

GEOMETRY = 38e3, 1.36e7
"""Bytes, (a, b) in a + b A over A m2: index, contact geometry, curves, provenance."""
STRIDE = 15e3, 9.1e6
"""Bytes of four amplitude channels, likewise."""
TICK = {"response": 120.0, "friction": 20.0}
"""ns."""
MOVES = 0.25
"""Share of a held-out full press that its two sticking moves take; an upper estimate, two of twelve equilibria, each
solved from a state far from it."""
NEAR_CHECKS = 2
"""Held-out places pressed at near_field too (tool_work.py)."""


def rfield_bytes(area: float, effects: Sequence[str]) -> dict[str, int]:
    """Bytes by effect over `area` m2 of reach; of one way of touching."""
    geometry, stride = (round(a + b * area) for a, b in (GEOMETRY, STRIDE))
    known = {"response": geometry + stride, "friction": stride}
    return {effect: known[effect] for effect in effects if effect in known}


def tool_row(scene: Scene, tool: Tool, area: float, tets: int) -> dict[str, Any]:
    """Counts and rates of one tool; `with_time` says how many nodes and seconds come of them."""
    asked = scene.accuracy.nodes
    most = asked or node_count(area, scene.accuracy.force_tolerance)
    regions, held = len(scene.organ.region), scene.accuracy.held_out
    # of a family each radius is pressed at every node, of several tilts each but upright in both leans
    members = len(tool.radius or (0,)) * (2 * len(tool.tilt or (0,)) - 1)
    ways = len(tool.tilt or (0,))
    sizes = rfield_bytes(area, scene.effects)
    expected = asked or expected_nodes(most) + REGION_EXPECTED * regions
    layers = layer_costs(scene, tool, round(STRIDE[0] + STRIDE[1] * area), expected)
    return {
        "name": tool.name,
        "shape": tool.shape,
        "radius": list(tool.radius or ()),
        "depth_max": scene.depth_max(tool),
        "friction": tool.friction if "friction" in scene.effects else None,
        "seeds": seed_count(most) + REGION_SEEDS * regions,
        "expected": expected,
        "nodes": asked or most + region_nodes(regions),
        "members": members,
        "held_out": held,
        "checks": min(NEAR_CHECKS, held) if scene.accuracy.fidelity == "near_field" else 0,
        "node_seconds": members * press_seconds(scene.accuracy.fidelity, tets),
        "held_out_seconds": press_seconds("full", tets),
        "fitting_seconds": fitting_seconds(area),
        "layers": {effect: {"bytes": cost.bytes, "tick_ns": cost.tick_ns} for effect, cost in layers.items()},
        "bytes": ways * sum(sizes.values()) + sum(cost.bytes for cost in layers.values()),
        "tick_ns": sum(TICK[effect] for effect in sizes) + sum(cost.tick_ns for cost in layers.values()),
    }


def with_time(
    tools: list[dict[str, Any]], tets: int, workers: int, budget: float | None
) -> tuple[float, float]:
    """CPU and wall seconds of everything; each tool gets `pressed` nodes, `presses` and `cpu_seconds`.

    Args:
        budget: of the scene, s.
    """
    setup = STARTING + meshing_seconds(tets)
    each = STARTING + far_field_seconds(tets)  # of a worker, all at once
    always = sum(_pressing(row, min(row["seeds"], row["nodes"])) for row in tools)
    wanted = sum(_pressing(row, min(row["expected"], row["nodes"])) for row in tools)
    share = 1.0
    if budget is not None and wanted > always:
        free = (BUDGET_TO_PRESS * budget - setup - each) * workers - always
        share = min(1.0, max(0.0, free / (wanted - always)))
    for row in tools:
        low, high = (min(row[key], row["nodes"]) for key in ("seeds", "expected"))
        row["pressed"] = low + round(share * (high - low))
        row["presses"] = row["members"] * row["pressed"] + row["held_out"]
        row["cpu_seconds"] = _pressing(row, row["pressed"]) + row["fitting_seconds"]
    presses = sum(row["cpu_seconds"] - row["fitting_seconds"] for row in tools)
    fitting = sum(row["fitting_seconds"] for row in tools)
    return setup + workers * each + presses + fitting, setup + each + presses / workers + fitting


def _pressing(row: dict[str, Any], nodes: int) -> float:
    """CPU seconds of a tool's presses."""
    near = row["node_seconds"] * (nodes + row["checks"] / row["members"])
    return near + row["held_out"] * row["held_out_seconds"]


def added_by(
    scene: Scene, chosen: Sequence[Tool], tools: Sequence[dict[str, Any]], area: float
) -> dict[str, list[dict[str, Any]]]:
    """What each effect, tool and region adds: name, presses, cpu_seconds, bytes, tick_ns.

    Args:
        chosen, tools: tools of the scene, and their rows after `with_time`.

    Rows are not disjoint: an effect's are the sum over tools, a tool's over effects.  An effect's tick is that of the
    tool in which it takes longest.  What a deformation takes of the presses' time has not been measured, and is None.
    """
    sizes = rfield_bytes(area, scene.effects)
    ways = sum(len(tool.tilt or (0,)) for tool in chosen)
    held = sum(row["held_out"] * row["held_out_seconds"] for row in tools)
    moves = MOVES * held if "friction" in scene.effects else 0.0
    effects = []
    for effect in scene.effects:
        layers = [row["layers"][effect] for row in tools if effect in row["layers"]]
        known = effect in sizes
        seconds = {"response": sum(row["cpu_seconds"] for row in tools) - moves, "friction": moves}
        effects.append(
            {
                "name": effect,
                "presses": sum(row["presses"] for row in tools) if effect == "response" else 0,
                "cpu_seconds": seconds.get(effect, None if effect == "deformation" else 0.0),
                "bytes": ways * sizes[effect] if known else sum(layer["bytes"] for layer in layers),
                "tick_ns": TICK[effect] if known else max(layer["tick_ns"] for layer in layers),
            }
        )
    keys = ("name", "presses", "cpu_seconds", "bytes", "tick_ns")
    regions = [
        {
            "name": region.name,
            "presses": sum(row["members"] * min(REGION_EXPECTED, row["pressed"]) for row in tools),
            "cpu_seconds": sum(row["node_seconds"] * min(REGION_EXPECTED, row["pressed"]) for row in tools),
            "bytes": 0,  # amplitudes are spread by area, not by nodes
            "tick_ns": 0.0,
        }
        for region in scene.organ.region
    ]
    return {
        "effects": effects,
        "tools": [{key: row[key] for key in keys} for row in tools],
        "regions": regions,
    }
