# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Ways of touching: one tool pressed at several tilts, its responses blended by the runtime (Hayward, eq. 8-9).

The runtime knows how far a tool leans, not which way.  Nodes are pressed leaning both ways along the first tangent
(fem_offline/pose.py) and hold the mean (ways_work.py); held-out presses lean one way or the other, so their errors hold
what the direction costs.

A tool that is pressed upright and then tilted feels less than one that came down tilted, where the tilted way stores
more energy: the runtime's energy rule lets the surface yield rather than energy rise.  Tissue does not; what is left of
its force is judged too (`turned_force_share`), and stated beside the errors.

Between two ways the touching plane's distance from the reference point, rho, is taken to be linear in the cosine of the
tilt.  That is exact while a ball at the tool's end touches, its centre on the axis; the edge of a flat end goes with
the sine, and is missed (`touching_error`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from palpate.author.errors import InputError
from palpate.author.held_out import (
    APPROACH,
    Beyond,
    held_out_jobs,
    judgement_of,
    percentiles,
    press_judgements,
)
from palpate.author.press_jobs import PressJob, PressOutcome
from palpate.author.scene import Scene
from palpate.author.scene_tables import Tool
from palpate.author.tool_stage import ToolShape, heading_matters, offset_of
from palpate.fem_offline.pose import tilted
from palpate.runtime import Config, Field, Session

__all__ = ["HeldWay", "judged_ways", "refuse_not_round", "touching_error", "ways_held_out", "ways_judgement"]

STEPS = 200
"""Ticks in which a tool comes down upright, and in which it is tilted there (count)."""


@dataclass(frozen=True)
class HeldWay:
    """How the tool of a held-out press is held.

    Attributes:
        tilt: rad; negative leans away from the first tangent.
        pressed: whether nodes were pressed so; otherwise it lies in the middle between two tilts.
    """

    tilt: float
    pressed: bool


def judged_ways(tilts: Sequence[float]) -> list[HeldWay]:
    """Ways of held-out presses, in turn: each of `tilts` (rad, rising from 0) and the middles between, both leans."""
    leaning = []
    for low, high in pairwise(tilts):
        leaning += [HeldWay(0.5 * (low + high), False), HeldWay(high, True)]
    return [HeldWay(0.0, True), *leaning, *(replace(way, tilt=-way.tilt) for way in reversed(leaning))]


def ways_held_out(
    points: np.ndarray,
    tool: ToolShape,
    judged: Sequence[HeldWay],
    depths: np.ndarray,
    friction: float | np.ndarray,
    fidelity: str,
    seed: int,
    drag: int = 0,
) -> list[PressJob]:
    """Jobs at points (n, 3) m; the ways of `judged` in turn, each pressed and moved as `held_out_jobs` does."""
    jobs = {
        way: held_out_jobs(points, replace(tool, tilt=way.tilt), depths, friction, fidelity, seed, drag)
        for way in judged
    }
    return [jobs[judged[k % len(judged)]][k] for k in range(len(points))]


def refuse_not_round(scene: Scene, tool: Tool, upright: ToolShape) -> None:
    """Raises InputError where turning the upright tool about its axis changes how it presses."""
    if heading_matters(upright):
        key = f"tool[{scene.tool.index(tool)}].tilt"
        what = f"asks for several tilts of {tool.name}, which is not round about its axis"
        expected = "one tilt, or a tool that is round about its axis with its point there"
        raise InputError(scene.problem(key, None, what, expected))


def touching_error(tool: ToolShape, tilts: Sequence[float]) -> float:
    """m; how far the field's touching plane is off, at worst, between neighbouring `tilts` (rad)."""
    worst = 0.0
    for low, high in pairwise(tilts):
        between = np.linspace(low, high, 17)
        rho = np.array([offset_of(replace(tool, tilt=float(tilt))) for tilt in between])
        share = (np.cos(low) - np.cos(between)) / (np.cos(low) - np.cos(high))
        worst = max(worst, float(np.abs((1.0 - share) * rho[0] + share * rho[-1] - rho).max()))
    return worst


def ways_judgement(
    field: Field,
    judged: Sequence[HeldWay],
    outcomes: Sequence[PressOutcome],
    near: Sequence[PressOutcome],
    tolerance: float,
    beyond: Beyond | None = None,
) -> dict[str, Any]:
    """As `held_out.judgement`, each press rendered as its tool was held; and the errors by way under "ways".

    The tolerance is met where each way by itself meets it.
    """
    rows: list[dict[str, Any]] = []
    for outcome in outcomes:
        offset = offset_of(outcome.job.tool)
        (row,) = press_judgements(field, offset, [outcome], beyond)
        turned = _turned(field, offset, outcome) if row["depth"] else None
        rows.append({"tilt": outcome.job.tool.tilt, "turned_force_share": turned, **row})
    whole = judgement_of(rows, outcomes, near, tolerance)
    by_way, met = [], []
    for way in sorted(judged, key=lambda way: (way.tilt < 0.0, abs(way.tilt))):
        found = [row for row in rows if row["tilt"] == way.tilt]
        if not found:
            continue
        own = judgement_of(found, outcomes, [], tolerance)
        met.append(own["met"])
        by_way.append(
            {
                "tilt": way.tilt,
                "pressed": way.pressed,
                "points": len(found),
                **{
                    key: own[key]
                    for key in ("force_error", "lateral_error", "stuck_error", "slid_error", "met")
                },
                "normal_force_share": percentiles(_shares(found)),
                "turned_force_share": percentiles([row["turned_force_share"] for row in found]),
            }
        )
    return {**whole, "met": bool(whole["met"] and all(met)), "ways": by_way}


def _turned(field: Field, offset: float, outcome: PressOutcome) -> float:
    """Rendered over FEM normal force at the deepest state, when the tool came down upright and tilted there.

    offset: rho of the tool as it was pressed, m.
    """
    a, tilt = outcome.arrays, outcome.job.tool.tilt
    c, n = a["contact_point"], a["normal"]
    deepest = c + (offset - a["depth"][-1]) * n
    path = np.linspace(deepest + (a["depth"][-1] + APPROACH) * n, deepest, STEPS)
    turns = np.stack([tilted(n, share * tilt) for share in np.linspace(0.0, 1.0, STEPS)])
    held = Rotation.from_matrix(turns).as_quat()
    session = Session(field, Config(friction_coefficient=0.0))
    session.tick_batch(path, orientations=np.tile(held[0], (STEPS, 1)))
    force = session.tick_batch(np.tile(deepest, (STEPS, 1)), orientations=held)["force"][-1]
    return float(force @ n / (a["force_vector"][-1] @ n))


def _shares(rows: Sequence[dict[str, Any]]) -> list[float]:
    """Rendered over FEM normal force at the deepest state, of each press."""
    found = []
    for row in rows:
        if row["depth"]:
            n = np.array(row["normal"])
            found.append(
                float(np.array(row["rendered_force"][-1]) @ n / (np.array(row["fem_force"][-1]) @ n))
            )
    return found
