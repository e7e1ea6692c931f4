# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The sweep: presses within the budget, then a row for each setting that they allow, then what to take.

1. Held-out presses, full, on the scene's own mesh, which no other is finer than: one truth for all settings.
2. Nodes of the scene's own pressing, where errors ask for them, as many as the scene would press.
3. The same places pressed otherwise, one knob at a time, cheapest first, each only where the budget seems to hold it:
   at first for the rows of fewest nodes, then for more.
4. More nodes of the scene's own pressing.
5. All knobs at once turned to the cheapest value that met the tolerance on its own.

A row's nodes are the first ones of that order, so most rows press nothing anew.
"""

from __future__ import annotations

import time
from contextlib import AbstractContextManager, ExitStack, nullcontext
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

from palpate.author.effort import seed_count
from palpate.author.errors import InputError, InputProblem
from palpate.author.field_stage import contact_geometry_of
from palpate.author.organ_stage import OrganMesh
from palpate.author.plan import planned_mesh_size
from palpate.author.press_executor import fitting_workers, press_executor
from palpate.author.press_jobs import PressJob, PressOutcome, Solver, kept_key
from palpate.author.progress import Progress
from palpate.author.scene import Scene
from palpate.author.scene_tables import Tool
from palpate.author.tool_members import is_family, is_tilted
from palpate.author.tool_work import TRUTH, ToolWork
from palpate.author.tradeoff.cost import PricedStore, cpu_seconds_of
from palpate.author.tradeoff.front import chance, pareto, recommended
from palpate.author.tradeoff.knobs import (
    NOT_SWEPT,
    Pressing,
    Setting,
    changed,
    node_counts,
    pressings,
    scene_s_pressing,
    settings_of,
)
from palpate.author.tradeoff.presses import Presses, jobs_of, organ_of
from palpate.author.tradeoff.rows import Judge

__all__ = ["Sweep"]

PRESSING = 0.8
"""Share of the budget for presses; fits and ticks take the rest."""
HELD_OUT_AT_LEAST = 8
"""A redraw of fewer presses tells nothing about those that are not there."""


class Sweep:
    """One sweep of one tool of a scene.

    Args:
        out: folder; work that was done there is taken up.
        budget: s of wall time from now, None: as long as it takes.
        held_out: presses that judge (count); the scene's, at least 8, when None.
    """

    def __init__(
        self,
        scene: Scene,
        tool: Tool,
        out: Path,
        progress: Progress,
        budget: float | None,
        held_out: int | None = None,
        workers: int | None = None,
        executor: Any = None,
        solver: Solver | None = None,
    ) -> None:
        _refuse_members(scene, tool)
        self.scene, self.tool, self.out, self.progress = scene, tool, Path(out), progress
        self._budget, self._asked_workers, self._executor, self.solver = budget, workers, executor, solver
        self._organs: dict[float, tuple[OrganMesh, float]] = {}
        self.store = PricedStore(self.out / "work")
        self.store.sweep()
        self.left_out: list[dict[str, Any]] = [{"knob": k, "reason": why} for k, why in NOT_SWEPT.items()]
        count = max(scene.accuracy.held_out, HELD_OUT_AT_LEAST) if held_out is None else held_out
        self._held_scene = scene.model_copy(
            update={"accuracy": scene.accuracy.model_copy(update={"held_out": count})}
        )

    def organ(self, size: float) -> tuple[OrganMesh, float]:
        """In tetrahedra of `size` m, and its price in CPU seconds."""
        if size not in self._organs:
            self._organs[size] = organ_of(self.scene, size, self.store)
        return self._organs[size]

    @cached_property
    def base(self) -> Setting:
        """What the scene asks for itself."""
        from palpate.author.organ_parts import organ_parts, rough_summary

        summary, _ = rough_summary(organ_parts(self.scene))
        pressing = scene_s_pressing(self.scene, planned_mesh_size(self.scene, summary))
        own = ToolWork(self._held_scene, self.organ(pressing.mesh_size)[0], self.tool)
        self._samples = own.samples
        return Setting(pressing, own.most, self.scene.accuracy.knots)

    @cached_property
    def counts(self) -> list[int]:
        return node_counts(self.base.nodes)

    @cached_property
    def work(self) -> ToolWork:
        """Chooses the nodes of the scene's own pressing."""
        return self._choosing(self.base.nodes)

    def _choosing(self, nodes: int) -> ToolWork:
        """Chooses so many, the same ones first however many they are."""
        accuracy = self._held_scene.accuracy.model_copy(update={"nodes": nodes})
        scene = self._held_scene.model_copy(update={"accuracy": accuracy})
        mesh, _ = self.organ(self.base.pressing.mesh_size)
        work = ToolWork(scene, mesh, self.tool, self._samples)
        work.seeds = min(nodes, seed_count(self.base.nodes))
        return work

    def run(self) -> dict[str, Any]:
        """Presses, rows, front and recommendation; see `tradeoff`."""
        begun = time.monotonic()
        self.progress.stage("surface and tetrahedra")
        base_mesh, _ = self.organ(self.base.pressing.mesh_size)
        geometry, geometry_cpu = self._geometry()
        with ExitStack() as stack:
            executor = stack.enter_context(self.executor())
            spent = time.monotonic() - begun
            left = None if self._budget is None else max(0.0, PRESSING * self._budget - spent)
            self.presses = Presses(self.out / "work", executor, self.progress, left, self.solver)
            held = self.presses.press(
                "held-out", base_mesh, self.work.held_jobs, f"held-out presses, {TRUTH}"
            )
            if len(held) < len(self.work.held_jobs):
                raise InputError(self._too_short(len(held), len(self.work.held_jobs), "held-out presses"))
            own = self.base.pressing
            nodes = self.presses.choose(
                own.name, base_mesh, self.work, lambda: geometry, "nodes of the scene's own"
            )
            if len(nodes) < self.counts[0]:
                raise InputError(self._too_short(len(nodes), self.counts[0], "nodes"))
            self.judge = Judge(
                self.scene, self.tool, self.work.samples, geometry, geometry_cpu,
                [outcome for outcome in held if outcome.converged],
                self.out / "fields", self.store,
            )  # fmt: skip
            like = [outcome.job for outcome in nodes]
            pressed = {own: nodes, **self._otherwise(pressings(own), like)}
            if not self.presses.out_of_time:
                longer = self._choosing(self.counts[-1])
                more = self.presses.choose(own.name, base_mesh, longer, lambda: geometry, "more nodes")
                pressed[own] = max(nodes, more, key=len)
            self.nodes = pressed[own]
            rows = self._rows(pressed)
            together = self._together(rows)
            if together is not None and together not in pressed:
                rows += self._rows(self._otherwise([together], like))
        return self._answer(rows, held, time.monotonic() - begun)

    def executor(self) -> AbstractContextManager[Any]:
        """Processes that press, as many as memory holds; or what was given instead."""
        if self._executor is not None:
            return nullcontext(self._executor)
        tets = len(self.organ(self.base.pressing.mesh_size)[0].tets)
        fidelities = {TRUTH, *(one.fidelity for one in pressings(self.base.pressing))}
        count, limited = fitting_workers(tets, fidelities, self._asked_workers)
        if limited:
            self.progress.say(limited)
        return press_executor(count, self.progress.say)

    def _geometry(self):
        """The contact geometry, and its price."""
        mesh, _ = self.organ(self.base.pressing.mesh_size)
        alone = self.scene.model_copy(update={"tool": (self.tool,)})
        return cpu_seconds_of(lambda: contact_geometry_of(alone, mesh, self.work.samples))

    def _otherwise(self, others: list[Pressing], like: list[PressJob]) -> dict[Pressing, list[PressOutcome]]:
        """The nodes `like` pressed otherwise, as far as the budget holds them; what it does not hold is noted."""
        found: dict[Pressing, list[PressOutcome]] = {pressing: [] for pressing in others}
        why: dict[Pressing, str] = {}
        for count in [n for n in self.counts if n <= len(like)]:
            for pressing in others:
                if pressing not in why:
                    found[pressing], reason = self._press(pressing, like[:count])
                    why |= {pressing: reason} if reason else {}
        for pressing, reason in why.items():
            kept = len(found[pressing])
            self.left_out.append({"pressing": pressing.name, "pressed": kept, "reason": reason})
        return {pressing: nodes for pressing, nodes in found.items() if len(nodes) >= self.counts[0]}

    def _press(self, pressing: Pressing, like: list[PressJob]) -> tuple[list[PressOutcome], str]:
        """As many of the nodes `like` as the budget holds, and why not all."""
        store = self.presses.store(pressing.name)
        mesh, _ = self.organ(pressing.mesh_size)
        jobs = jobs_of(pressing, like)
        to_do = sum(not store.path("press", kept_key(mesh, job, store)).exists() for job in jobs)
        expected = self.presses.expected(to_do, pressing.fidelity)
        if to_do and not self.presses.has(expected):
            found = self.presses.press(pressing.name, mesh, jobs[: len(jobs) - to_do], pressing.name)
            return (
                found,
                f"the budget does not hold {to_do} presses more, of about {expected / 60.0:.1f} min in all",
            )
        found = self.presses.press(pressing.name, mesh, jobs, pressing.name)
        ended = f"the budget ended after {len(found)} of {len(jobs)} presses"
        return found, "" if len(found) == len(jobs) else ended

    def _rows(self, pressed: dict[Pressing, list[PressOutcome]]) -> list[dict[str, Any]]:
        settings = [
            setting
            for pressing, nodes in pressed.items()
            for setting in settings_of(pressing, [n for n in self.counts if n <= len(nodes)], self.base)
        ]
        self.progress.stage("fields, ticks and errors", len(settings))
        rows = []
        for setting in settings:
            mesh, price = self.organ(setting.pressing.mesh_size)
            row = self._row(setting, mesh, price, pressed[setting.pressing][: setting.nodes])
            if row is not None:
                rows.append(row)
            self.progress.advance()
        return rows

    def _row(self, setting: Setting, mesh: OrganMesh, price: float, nodes: list[PressOutcome]):
        """None, and noted, where so few presses make no field."""
        tolerance, draw = self.scene.accuracy.force_tolerance, self.scene.accuracy.held_out
        try:
            row = self.judge.row(setting, mesh, price, nodes)
        except ValueError as error:
            self.left_out.append({"setting": setting.as_json(), "reason": str(error)})
            return None
        row["changed"] = changed(setting, self.base)
        row["chance"] = chance(row["presses"], tolerance, draw) if row["met"] else 0.0
        return row

    def _together(self, rows: list[dict[str, Any]]) -> Pressing | None:
        """Every knob of pressing at its cheapest value that met the tolerance alone; None where that is one knob."""
        base, together, turned = self.base.pressing, self.base.pressing, 0
        for knob in ("fidelity", "mesh_size", "patch_radius", "patch_refinement"):
            alone = [row for row in rows if set(row["changed"]) <= {knob, "nodes"} and row["offered"]]
            best = recommended(alone)
            if best is not None and alone[best]["setting"][knob] != getattr(base, knob):
                together = replace(together, **{knob: alone[best]["setting"][knob]})
                turned += 1
        return together if turned > 1 else None

    def _answer(self, rows: list[dict[str, Any]], held: list[PressOutcome], seconds: float) -> dict[str, Any]:
        best = recommended(rows)
        return {
            "scene": self.scene.name,
            "tool": self.tool.name,
            "tolerance": self.scene.accuracy.force_tolerance,
            "base": self.base.as_json(),
            "rows": rows,
            "pareto": pareto(rows),
            "recommended": best,
            "left_out": self.left_out,
            "truth": {
                "fidelity": TRUTH,
                "mesh_size": self.base.pressing.mesh_size,
                "presses": len(held),
                "failed": sum(not outcome.converged for outcome in held),
                "cpu_seconds": float(sum(outcome.values.get("cpu_seconds", 0.0) for outcome in held)),
            },
            "budget": self._budget,
            "seconds": seconds,
            "fresh_press_cpu_seconds": self.presses.fresh_cpu_seconds,
        }

    def _too_short(self, count: int, wanted: int, what: str) -> InputProblem:
        return InputProblem(
            "",
            "--budget",
            f"{self._budget:g} s",
            f"ended after {count} of {wanted} {what}, before a row could be made",
            "more, or the same command again: what was pressed is kept, and it goes on from there",
        )


def _refuse_members(scene: Scene, tool: Tool) -> None:
    if is_family(tool) or is_tilted(tool):
        index = scene.tool.index(tool)
        key, value = ("radius", tool.radius) if is_family(tool) else ("tilt", tool.tilt)
        what = "is several, and a trade-off is weighed for one at a time"
        raise InputError(
            scene.problem(f"tool[{index}].{key}", value, what, f"one {key}, in a scene of its own")
        )
