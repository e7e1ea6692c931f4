# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Many presses: how many a minute on one and two workers, how much memory, and what a second tool costs."""

from __future__ import annotations

import shutil
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

from measured import Measured
from setting import Setting, clean, press_cpu, warm_up

from palpate.author.press_executor import core_count, press_executor
from palpate.author.press_jobs import PressJob, PressOutcome, run_jobs
from palpate.author.store import Store
from palpate.author.tool_stage import ToolShape

__all__ = ["tool", "workers"]

WORKERS = (1, 2)
SIDE = 200
"""Contacts of an organ's side."""
OTHER_TOOLS = (0.6, 1.6)
"""Their radii over the first one's."""


def workers(setting: Setting, contacts: int = 12) -> list[Measured]:
    """The same presses by one and two workers, whose kernels are compiled and whose Green's functions are kept."""
    part = "workers"
    jobs = [setting.job(contact) for contact in setting.contacts[:contacts]]

    def make() -> dict[str, Any]:
        runs = {}
        with setting.far_fields() as folder:
            runs["first"] = _run(setting, jobs, folder, max(WORKERS), "making Green's functions")
            for count in WORKERS:
                runs[str(count)] = _run(setting, jobs, folder, count, f"{count} at work")
        return runs

    runs = setting.kept(part, [job.key(setting.mesh) for job in jobs], make)
    rows = []
    for count in WORKERS:
        rate = 60.0 * len(jobs) / runs[str(count)]["wall"]
        rows.append(
            Measured(
                part, f"presses per minute, workers: {count}", rate, f"{rate:.1f}", detail=runs[str(count)]
            )
        )
    ratio = runs["1"]["wall"] / runs["2"]["wall"]
    text = f"{ratio:.2f} ({core_count()} cores)"
    rows.append(Measured(part, "two workers over one", ratio, text, "at least 1.8"))
    peak = max(press["peak_memory"] for run in runs.values() for press in run["presses"])
    rows.append(
        Measured(
            part,
            "peak memory of a worker, the far field's factor included",
            peak,
            f"{1e-9 * peak:.2f} GB",
            "under 4 GB",
        )
    )
    once = runs["first"]["wall"] - runs["2"]["wall"]
    rows.append(
        Measured(
            part,
            f"far field's one-off cost for {len(jobs)} contacts, two workers",
            once,
            f"{once:.0f} s of wall time",
        )
    )
    side = SIDE * runs["2"]["wall"] / len(jobs) / 60.0
    rows.append(
        Measured(part, f"{SIDE} contacts on two workers, far field kept", side, f"{side:.0f} min", "20 min")
    )
    failed = [press["reason"] for press in runs["2"]["presses"] if not press["converged"]]
    gave_way = sum(bool(press.get("tried")) for press in runs["2"]["presses"])
    text = f"{len(failed)}, {gave_way} of {len(jobs)}"
    rows.append(
        Measured(
            part,
            "presses that failed; that gave way to full",
            len(failed),
            text,
            detail={"reasons": failed},
        )
    )
    return rows


def _run(setting: Setting, jobs: list[PressJob], folder: Path, count: int, name: str) -> dict[str, Any]:
    """Wall seconds of `jobs` from a warm start, and their values; Green's functions in `folder` are kept."""
    for kind in ("FarModes", "press"):
        shutil.rmtree(folder / kind, ignore_errors=True)
    done: list[PressOutcome] = []

    def tell(outcome: PressOutcome) -> None:
        done.append(outcome)
        setting.say(f"workers, {name}: {len(done)}/{len(jobs)}")

    with press_executor(count) as executor:
        warm_up(executor, setting.mesh, jobs[0], count)
        begun = time.perf_counter()
        outcomes = run_jobs(setting.mesh, jobs, Store(folder), executor, tell)
        wall = time.perf_counter() - begun
    return {"wall": wall, "presses": [clean((outcome.arrays, outcome.values)) for outcome in outcomes]}


def tool(setting: Setting, contacts: int = 3) -> list[Measured]:
    """Other tools where one has pressed before."""
    part = "tool"
    places = setting.contacts[:contacts]
    rows = []
    for share in OTHER_TOOLS:
        other = scaled(setting.tool, share)
        # no deeper than the first, nor than its own radius
        deepest = min(1.0, share)
        jobs = [setting.job(place) for place in places]
        seconds = [
            replace(job, tool=other, depths=tuple(deepest * depth for depth in job.depths)) for job in jobs
        ]
        found = setting.sequence(f"tool, {share:g} times the radius", setting.mesh, [*jobs, *seconds])
        first, second = found[:contacts], found[contacts:]
        kept = sum(press["far_field_kept"] is True for press in second)
        name = f"second tool, {share:g} times the radius"
        what = f"{name}: presses that solved nothing on the whole organ"
        detail = {"first": first, "second": second}
        rows.append(Measured(part, what, kept, f"{kept} of {contacts}", "all", detail))
        before, after = (
            sum(press["stages"].get("far_field", 0.0) for press in presses) for presses in (first, second)
        )
        text = f"{after:.1f} CPU s, the first tool's {before:.1f} ({sum(map(press_cpu, second)):.1f} in all)"
        rows.append(Measured(part, f"{name}: far-field stage of {contacts} presses", after, text))
    return rows


def scaled(given: ToolShape, share: float) -> ToolShape:
    """The same tool, all lengths times `share`."""
    lengths = {"radius", "edge_radius", "length"}
    parameters = tuple(
        (name, share * value if name in lengths else value) for name, value in given.parameters
    )
    return replace(given, parameters=parameters, vertices=share * given.vertices)
