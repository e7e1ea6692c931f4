# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""One press: by fidelity, by depths, by the patch's radius."""

from __future__ import annotations

import time
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from measured import Measured
from setting import Setting, middle, press_cpu, warm_up

from palpate.author.organ_stage import OrganMesh
from palpate.author.press_executor import press_executor
from palpate.author.press_jobs import PressJob
from palpate.author.store import Store
from palpate.author.tool_stage import solid_tool
from palpate.fem_offline.far_modes import FarModes
from palpate.fem_offline.press import press
from palpate.fem_offline.site import open_site, patch_size

__all__ = ["depths", "fidelity", "patch"]

FIDELITIES = ("linear", "near_field", "full")
RADII = (15e-3, 20e-3, 30e-3)
"""m."""
DEPTHS = (5, 10, 20)


def fidelity(setting: Setting, contacts: int = 3) -> list[Measured]:
    """The same ladders at each fidelity; what is compared is the stage `ladder`, after the same set-up."""
    part, found = "fidelity", []
    for contact in setting.contacts[:contacts]:
        jobs = [setting.job(contact, name) for name in ("near_field", *FIDELITIES)]
        first, *presses = setting.sequence(part, setting.mesh, jobs)
        found.append({"first": first, **dict(zip(FIDELITIES, presses, strict=True))})
    # a near field that gave way to full is no near field's ladder
    used = [f for f in found if all(f[n]["converged"] and f[n]["fidelity"] == n for n in FIDELITIES)]
    text = f"{len(used)} of {len(found)}"
    rows = [Measured(part, "contacts that converged at each fidelity", len(used), text)]
    for name in FIDELITIES:
        climbed = middle(f[name]["stages"]["ladder"] for f in used)
        set_up = middle(press_cpu(f[name]) - f[name]["stages"]["ladder"] for f in used)
        wall = middle(f[name]["seconds"] for f in used)
        what = f"{name}: ladder of ten depths to {1e3 * setting.depth_max:g} mm"
        rows.append(Measured(part, what, climbed, f"{climbed:.1f} CPU s"))
        rows.append(
            Measured(
                part, f"{name}: set-up (patch, far field from what is kept)", set_up, f"{set_up:.1f} CPU s"
            )
        )
        rows.append(Measured(part, f"{name}: whole press", wall, f"{wall:.1f} s"))
    ratio = middle(f["full"]["stages"]["ladder"] / f["near_field"]["stages"]["ladder"] for f in used)
    rows.append(
        Measured(
            part, "full over near_field, ladders", ratio, f"{ratio:.1f}", "at least 30", {"presses": found}
        )
    )
    for name in ("linear", "near_field"):
        off = [f[name]["force"][-1] / f["full"]["force"][-1] - 1.0 for f in used]
        worst = max(map(abs, off), default=float("nan"))
        asked = "1 % on broad faces, 2 % elsewhere" if name == "near_field" else ""
        what = f"{name} against full, force at the deepest, worst of these"
        rows.append(Measured(part, what, worst, f"{100 * worst:.2f} %", asked))
    return rows


def depths(setting: Setting) -> list[Measured]:
    """One contact, to the same depth in more or fewer steps."""
    contact, deepest = setting.contacts[0], setting.depth_max
    ladders = [tuple(map(float, deepest * np.arange(1, n + 1) / n)) for n in DEPTHS]
    jobs = [setting.job(contact, depths=given) for given in (ladders[0], *ladders)]
    rows = []
    for count, done in zip(DEPTHS, setting.sequence("depths", setting.mesh, jobs)[1:], strict=True):
        spent = done["stages"]["ladder"]
        text = f"{spent:.1f} CPU s, {spent / count:.2f} a depth"
        rows.append(Measured("depths", f"ladder of {count} depths", spent, text, detail=done))
    return rows


def patch(setting: Setting) -> list[Measured]:
    """One contact, patches of several radii; what a patch must be is press_solve.py's choice."""

    def make() -> dict[str, Any]:
        found = []
        job = setting.job(setting.contacts[0])
        with setting.far_fields() as folder, press_executor(1) as executor:
            warm_up(executor, setting.mesh, job)
            for radius in RADII:
                for _ in range(2):  # the first one makes what is kept
                    done = executor.submit(press_in_patch, setting.mesh, job, radius, str(folder)).result()
                found.append(done)
                setting.say(f"patch: {1e3 * radius:g} mm, {done['ladder']:.1f} CPU s")
        return {"presses": found}

    kept = setting.kept("patch", [setting.job(setting.contacts[0]).key(setting.mesh), RADII], make)["presses"]
    return [
        Measured(
            "patch",
            f"patch of {1e3 * radius:g} mm: {done['unknowns']} unknowns",
            done["set_up"] + done["ladder"],
            f"set-up {done['set_up']:.1f}, ladder {done['ladder']:.1f} CPU s; estimate {_percent(done['estimate'])}"
            + ("" if done["converged"] else f"; {done['reason']}"),
            detail=done,
        )
        for radius, done in zip(RADII, kept, strict=True)
    ]


def _percent(value: float | None) -> str:
    return "-" if value is None else f"{100 * value:.2f} %"


def press_in_patch(mesh: OrganMesh, job: PressJob, radius: float, folder: str) -> dict[str, Any]:
    """A press in a patch of a given radius (m), where Green's functions are kept and modes are not."""
    store, tool = Store(Path(folder)), solid_tool(job.tool)

    def far_field(kind: type, key: str, make):
        found = None if kind is FarModes else store.read(kind.__name__, key)
        if found is not None:
            return kind(**found[0])
        made = make()
        if kind is not FarModes:
            store.write(kind.__name__, key, asdict(made), {})
        return made

    size = replace(patch_size(tool, job.depths[-1], tilt=job.tool.tilt), radius=radius)
    begun = time.process_time()
    site = open_site(
        mesh.organ, np.array(job.contact_point), tool, size, job.fidelity, far_field, job.tool.tilt
    )
    opened = time.process_time()
    found = press(site, tool, np.array(job.depths))
    estimate = float(found.far_field_error.max())
    return {
        "radius": radius,
        "unknowns": found.unknowns,
        "tets": len(site.patch.tets),
        "set_up": opened - begun,
        "ladder": time.process_time() - opened,
        "force": found.force.tolist(),
        "estimate": estimate if np.isfinite(estimate) else None,
        "converged": found.converged,
        "reason": found.reason,
    }
