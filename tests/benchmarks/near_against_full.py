# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""How far near-field presses are from full ones, all over an organ, and what each costs.

    python tests/benchmarks/near_against_full.py SCENE --out FOLDER [--points 50] [--tool NAME] [--workers N]

Contacts are spread over everything that the scene's tool may press (farthest points: edges and corners come first),
whatever the scene's reach; each is pressed at both fidelities, to the same depths.  Records are kept in FOLDER, so that
the same command goes on where it was stopped.  Errors are at every depth, of the full normal force there.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path

import numpy as np

from palpate.author.organ_stage import mesh_organ
from palpate.author.press_executor import press_executor
from palpate.author.press_jobs import PressJob, PressOutcome, run_jobs
from palpate.author.sampling import farthest_points, reach_samples
from palpate.author.scene import load_scene
from palpate.author.scene_tables import Reach
from palpate.author.store import Store
from palpate.author.tool_stage import shape_of

SHARES = (0.25, 0.5, 0.75, 1.0)
"""Depths, of the deepest."""


def rows(scene_path: Path, out: Path, points: int, name: str | None, workers: int | None) -> list[dict]:
    scene = load_scene(scene_path)
    tool = next(tool for tool in scene.tool if name in (None, tool.name))
    store = Store(out)
    mesh = mesh_organ(scene, store)
    shape, depth_max = shape_of(scene, tool), scene.depth_max(tool)
    samples = reach_samples(mesh, Reach(), shape, depth_max)
    chosen = samples.points[farthest_points(samples, points)]
    depths = tuple(depth_max * share for share in SHARES)
    jobs = [
        PressJob(tuple(map(float, point)), shape, depths, fidelity)
        for point in chosen
        for fidelity in ("near_field", "full")
    ]
    begun, ended = time.time(), []

    def done(outcome: PressOutcome) -> None:
        ended.append(outcome)
        print(f"{len(ended)}/{len(jobs)} {time.time() - begun:.0f} s", file=sys.stderr, flush=True)

    with press_executor(workers) as executor:
        outcomes = run_jobs(mesh, jobs, store, executor, done)
    return [_row(*pair) for pair in zip(outcomes[::2], outcomes[1::2], strict=True)]


def _row(near: PressOutcome, full: PressOutcome) -> dict:
    row = {
        "point": near.job.contact_point,
        "near": near.values["reason"] or "converged",
        "full": full.values["reason"] or "converged",
        "estimate": near.values.get("estimate"),
        "ended_as": near.values["fidelity"] if near.converged else None,
        "tried": near.values.get("tried", []),
        "near_cpu": near.values["cpu_seconds"],
        "full_cpu": full.values["cpu_seconds"],
    }
    if near.converged and full.converged:
        normal = full.arrays["normal"]
        a, b = near.arrays["force_vector"][1:], full.arrays["force_vector"][1:]
        scale = b @ normal
        miss = a - b
        aside = miss - (miss @ normal)[:, None] * normal
        row["normal_error"] = (np.abs(miss @ normal) / scale).tolist()
        row["lateral_error"] = (np.linalg.norm(aside, axis=1) / scale).tolist()
    return row


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--points", type=int, default=50)
    parser.add_argument("--tool")
    parser.add_argument("--workers", type=int)
    arguments = parser.parse_args()
    found = rows(arguments.scene, arguments.out, arguments.points, arguments.tool, arguments.workers)
    (arguments.out / "near_against_full.json").write_text(json.dumps(found, indent=1))
    both = [row for row in found if "normal_error" in row]
    print(f"{len(both)} of {len(found)} presses converged at both fidelities")
    for row in found:
        if row not in both:
            print(f"  {np.round(row['point'], 4)}: near {row['near']}; full {row['full']}")
    for name in ("normal_error", "lateral_error"):
        deepest = np.array([row[name][-1] for row in both])
        worst = np.array([max(row[name]) for row in both])
        p50, p95 = 100 * np.percentile(deepest, [50, 95])
        print(
            f"{name}: deepest p50 {p50:.2f} %, p95 {p95:.2f} %, worst of all depths {100 * worst.max():.2f} %"
        )
    full_in_the_end = sum(row["ended_as"] == "full" for row in both)
    print(f"near-field presses that gave way to full: {full_in_the_end}")
    known = [row for row in both if row["estimate"]]
    most = max(max(row["normal_error"][-1], row["lateral_error"][-1]) / row["estimate"] for row in known)
    print(f"error over its own estimate, at the deepest: at most {most:.2f}")
    near, full = (sum(row[key] for row in both) for key in ("near_cpu", "full_cpu"))
    print(f"CPU seconds, meshing and far fields included: near {near:.0f}, full {full:.0f}")


if __name__ == "__main__":
    main()
