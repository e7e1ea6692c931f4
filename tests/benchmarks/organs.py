# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What an organ's mesh costs once, and what a press costs on coarser and finer ones."""

from __future__ import annotations

from measured import Measured
from setting import Setting, press_cpu

from palpate.fem_offline.pose import tangents

__all__ = ["organ_size"]

SHARES = (1.6, 1.0, 1.0 / 1.6)
"""Of the scene's mesh size: about four times as many tetrahedra each."""
ASIDE = 3e-3
"""m; how far from the first contact the second one is."""


def organ_size(setting: Setting) -> list[Measured]:
    """The same contacts on the same organ in three meshes.

    The first press makes what the organ needs once; the second one, nearby, may miss a few Green's functions; the third
    is the second anew, with all of them kept.
    """
    part = "organ_size"
    contact = setting.contacts[0]
    _, normal = setting.mesh.distance.project(contact[None])
    jobs = [setting.job(point) for point in (contact, *[contact + ASIDE * tangents(normal[0])[0]] * 2)]
    rows, found = [], []
    for share in SHARES:
        mesh = setting.meshed(share * setting.mesh_size)
        first, _, again = setting.sequence(part, mesh, jobs)
        found.append((len(mesh.tets), press_cpu(again)))
        once = first["stages"].get("far_field", 0.0) + first["stages"]["organ"]
        name = f"organ of {len(mesh.tets)} tetrahedra ({1e3 * share * setting.mesh_size:.1f} mm)"
        rows.append(
            Measured(part, f"{name}: one-off part, one contact's", once, f"{once:.1f} CPU s", detail=first)
        )
        stages = ", ".join(
            f"{stage} {again['stages'].get(stage, 0.0):.1f}" for stage in ("patch", "far_field", "ladder")
        )
        text = f"{press_cpu(again):.1f} CPU s ({stages})" + (
            "" if again["converged"] else f"; {again['reason']}"
        )
        if again["tried"]:
            text += "; widened or gave way to full"
        rows.append(Measured(part, f"{name}: a press without it", press_cpu(again), text, detail=again))
    (few, before), (many, after) = found[1:]
    growth = after / before - 1.0
    text = f"{100 * growth:+.0f} % on {many / few:.1f} times the tetrahedra"
    rows.append(
        Measured(part, "a press, without the one-off part, on the finest organ", growth, text, "within 20 %")
    )
    return rows
