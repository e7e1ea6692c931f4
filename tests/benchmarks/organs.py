# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What an organ costs once, and what a press costs on coarser and finer meshes of it."""

from __future__ import annotations

from measured import Measured
from setting import Setting, press_cpu

__all__ = ["organ_size"]

STAGES = ("patch", "far_field", "ladder")

SHARES = (1.6, 1.0, 1.0 / 1.6)
"""Of the scene's mesh size: about four times as many tetrahedra each."""
CONTACTS = 3


def organ_size(setting: Setting) -> list[Measured]:
    """The same contacts on the same organ in three meshes.

    The first press makes what the organ needs once; when all contacts have been pressed their Green's functions are
    kept, and they are pressed anew.
    """
    part = "organ_size"
    jobs = [setting.job(contact) for contact in setting.contacts[:CONTACTS]]
    rows, found = [], []
    for share in SHARES:
        mesh = setting.meshed(share * setting.mesh_size)
        presses = setting.sequence(part, mesh, [*jobs, *jobs])
        first, again = presses[0], presses[len(jobs) :]
        spent = sum(map(press_cpu, again)) / len(again)
        found.append((len(mesh.tets), spent))
        once = first["stages"]["organ"] + first["stages"].get("far_field", 0.0)
        name = f"organ of {len(mesh.tets)} tetrahedra ({1e3 * share * setting.mesh_size:.1f} mm)"
        rows.append(Measured(part, f"{name}: one-off part of the first contact", once, f"{once:.1f} CPU s"))
        mean = {s: sum(p["stages"].get(s, 0.0) for p in again) / len(again) for s in STAGES}
        unknowns = sum(p["unknowns"] for p in again) / len(again)
        told = ", ".join(f"{stage} {seconds:.1f}" for stage, seconds in mean.items())
        text = f"{spent:.1f} CPU s ({told}); {unknowns:.0f} unknowns"
        if strange := sum(bool(p.get("tried") or not p["converged"]) for p in again):
            text += f"; {strange} of {len(again)} gave way to full or failed"
        rows.append(Measured(part, f"{name}: a press without it", spent, text, detail={"presses": presses}))
    (few, before), (many, after) = found[1:]
    growth = after / before - 1.0
    text = f"{100 * growth:+.0f} % on {many / few:.1f} times the tetrahedra"
    rows.append(
        Measured(part, "a press, without the one-off part, on the finest organ", growth, text, "within 20 %")
    )
    return rows
