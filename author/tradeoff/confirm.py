# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Is the recommended setting good elsewhere?  Fresh held-out presses of many seeds."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from palpate.author.held_out import held_out_jobs
from palpate.author.painted_friction import friction_at
from palpate.author.sampling import held_out_points
from palpate.author.tool_work import TRUTH, ladder
from palpate.author.tradeoff.front import SURE
from palpate.author.tradeoff.presses import Presses
from palpate.author.tradeoff.rows import judged_again, press_errors
from palpate.author.tradeoff.sweep import Sweep

__all__ = ["FIRST_SEED", "confirmed"]

FIRST_SEED = 1001
"""Away from the seeds that scenes have."""


def confirmed(sweep: Sweep, row: dict[str, Any], seeds: int, points: int) -> dict[str, Any]:
    """Presses `points` places for each of `seeds` seeds, on the scene's own mesh.

    Places that the sweep has pressed, as nodes or held out, are not drawn.

    Returns:
        seeds (count), points (of each), met (count), bar (count), by_seed: [{seed, met, force_error, lateral_error,
        stuck_error}], and the same three errors of all presses together.
    """
    from palpate.runtime import Field

    scene, work = sweep.scene, sweep.work
    mesh, _ = sweep.organ(sweep.base.pressing.mesh_size)
    tolerance = scene.accuracy.force_tolerance
    seen = np.array([outcome.job.contact_point for outcome in (*sweep.judge.held, *sweep.nodes)], float)
    samples = work.samples
    fresh = samples.allowed & ~np.isclose(samples.points[:, None], seen[None], atol=1e-9).all(axis=2).any(
        axis=1
    )
    free = replace(samples, allowed=fresh)
    drawn = [held_out_points(free, points, FIRST_SEED + k) for k in range(seeds)]
    depths, jobs = ladder(work.depth_max), []
    for k, chosen in enumerate(drawn):
        places = samples.points[chosen]
        friction = friction_at(scene.effects, sweep.tool.friction, mesh, places)
        jobs += held_out_jobs(
            places, work.shape, depths, 0.0 if friction is None else friction, TRUTH, FIRST_SEED + k
        )
    with sweep.executor() as executor:
        presses = Presses(sweep.out / "work", executor, sweep.progress, None, sweep.solver)
        told = f"fresh held-out presses, {seeds} seeds"
        outcomes = presses.press("held-out", mesh, jobs, told)
    field = Field.open(sweep.judge.field(row))
    errors = press_errors(field, work.reference.offset, outcomes)
    by_seed, at = [], 0
    for k, chosen in enumerate(drawn):
        own = judged_again(errors[at : at + len(chosen)], tolerance)
        by_seed.append({"seed": FIRST_SEED + k, **own})
        at += len(chosen)
    met = sum(one["met"] for one in by_seed)
    together = judged_again(errors, tolerance)
    bar = int(np.ceil(SURE * seeds - 1e-9))
    return {
        **together, "seeds": seeds, "points": points, "met": met, "bar": bar, "enough": met >= bar, "by_seed": by_seed
    }  # fmt: skip
