# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""`palpate detect`: which nodules a hand could feel, by their depth, size and stiffness.

A cell of the chart is one press straight above the middle of a ball of stiffer tissue, against one press at the same
place of the same organ without it, which is what the hand feels far from a nodule:

    contrast = f_n(with) / f_n(without) - 1       at the same depth of the tool

and is noticeable from the just-noticeable difference on (verdict.py).  The ball is the organ's own material times a
factor, bonded to it; its top lies `under` the surface.  Modelled are the tool, the contact and the large deformation of
the scene, quasi-static and frictionless, at the scene's fidelity; not a slip plane around the nodule, a hand's search
movement, or noise.  Presses are kept in the work folder; a second run presses nothing.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.console import plain
from palpate.author.errors import InputError, InputProblem, PalpateError
from palpate.author.organ_stage import OrganMesh, mesh_organ
from palpate.author.place import Sphere
from palpate.author.press_executor import fitting_workers, press_executor
from palpate.author.press_jobs import PressJob, PressOutcome, run_jobs
from palpate.author.progress import Progress, SilentProgress
from palpate.author.report.verdict import JUST_NOTICEABLE
from palpate.author.scene import Scene
from palpate.author.scene_tables import Material, Region
from palpate.author.store import Store
from palpate.author.tool_stage import shape_of
from palpate.author.tool_work import ladder

__all__ = ["detect_lines", "detectability", "reached_under", "stiffened"]

MODULI = ("youngs_modulus", "mu", "c10", "c01", "c20", "c30", "c1")
"""Constants of a material that are stresses."""
KEPT_BELOW = 2e-3
"""m; tissue between the nodule and the far side."""


def detectability(
    scene: Scene,
    out: Path,
    at: Sequence[float] | None = None,
    tool: str | None = None,
    depth: float | None = None,
    under: Sequence[float] = (2e-3, 5e-3, 8e-3, 11e-3),
    radius: Sequence[float] = (3e-3, 5e-3),
    stiffer: Sequence[float] = (3.0, 13.0),
    workers: int | None = None,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """The chart, in `out`/detectability.png and .json.

    A cell's "along" is its contrast at each depth to "reached" (m); its "contrast", that at the full depth, is None
    where the press stopped before.

    Args:
        at: (3,) m, goes to the surface; the middle of the reach when None.
        tool: the scene's first when None.
        depth: m, of the press; the scene's depth_max when None.
        under: m, of the nodule's top under the surface.  radius: m.  stiffer: times the organ's stiffness.

    Raises:
        InputError: the scene names no reach and no place is given, or no nodule fits into the organ there.
        PalpateError: the press without a nodule did not converge.
    """
    progress = progress or SilentProgress()
    named = scene.tool_named(tool) if tool else scene.tool[0]
    deepest = scene.depth_max(named) if depth is None else depth
    plain_scene = _with_regions(scene, ())
    store = Store(out / "work")
    progress.stage("surface and tetrahedra")
    mesh = mesh_organ(plain_scene, store)
    contact, normal = _place(scene, mesh, at)
    refused = _refused(mesh, contact, normal, deepest)
    if refused:
        raise InputError(scene.problem("--at", list(map(float, contact)), *refused))
    job = PressJob(
        tuple(map(float, contact)),
        shape_of(scene, named),
        tuple(map(float, ladder(deepest))),
        scene.accuracy.fidelity,
        stiffness=False,
    )
    asked = [(u, r, k) for k in stiffer for r in radius for u in under]
    cells: list[dict[str, Any]] = []
    work: list[tuple[OrganMesh, int | None]] = [(mesh, None)]
    for top, r, k in asked:
        centre = contact - (top + r) * normal
        cell: dict[str, Any] = {"under": top, "radius": r, "stiffer": k, "contrast": None, "reason": ""}
        cells.append(cell)
        if (
            mesh.distance((centre - (r + KEPT_BELOW) * normal)[None])[0] > 0.0
            or mesh.distance(centre[None])[0] > -r
        ):
            cell["reason"] = "does not fit into the organ"
            continue
        region = Region(
            name="nodule",
            sphere=Sphere(center=(float(centre[0]), float(centre[1]), float(centre[2])), radius=r),
            material=stiffened(scene.organ.material, k),
        )
        work.append((mesh_organ(_with_regions(scene, (region,)), store), len(cells) - 1))
    progress.stage("presses", len(work))
    count, limited = fitting_workers(len(mesh.tets), {scene.accuracy.fidelity}, workers)
    if limited:
        progress.say(limited)
    outcomes: dict[int | None, PressOutcome] = {}
    with ThreadPoolExecutor(count) as threads, press_executor(count, progress.say) as executor:
        found = {index: threads.submit(run_jobs, one, [job], store, executor) for one, index in work}
        for index, future in found.items():
            outcomes[index] = future.result()[0]
            progress.advance(1)
    quiet = outcomes[None]
    if not quiet.converged:
        raise PalpateError(f"the press without a nodule did not converge: {quiet.values['reason']}")
    normals = {index: _normal_force(outcome) for index, outcome in outcomes.items()}
    for index, outcome in outcomes.items():
        if index is None:
            continue
        known = min(len(normals[index]), len(normals[None]))
        contrast = normals[index][:known] / normals[None][:known] - 1.0
        cells[index] |= {
            "along": contrast.tolist(),
            "reached": float(job.depths[known - 1]) if known else 0.0,
        }
        if outcome.converged:
            cells[index]["contrast"] = float(contrast[-1])
        else:
            cells[index]["reason"] = str(outcome.values["reason"])
    result: dict[str, Any] = {
        "scene": scene.name,
        "tool": named.name,
        "fidelity": scene.accuracy.fidelity,
        "contact_point": contact,
        "depth": deepest,
        "depths": list(job.depths),
        "force": float(normals[None][-1]),
        "shear_modulus": scene.organ.material.shear_modulus,
        "just_noticeable": JUST_NOTICEABLE,
        "presses": len(outcomes),
        "failed": sum(not outcome.converged for outcome in outcomes.values()),
        "fresh": sum(outcome.fresh for outcome in outcomes.values()),
        "cells": cells,
        "deepest_felt": _deepest_felt(cells, under, radius, stiffer),
        "modelled": "a bonded ball of the organ's material, stiffer by a factor; one quasi-static frictionless press "
        "straight above its middle against the same place without it; no slip plane, search movement or noise",
        "picture": str(out / "detectability.png"),
    }
    from palpate.author.detectability_picture import detectability_picture

    detectability_picture(out / "detectability.png", result)
    (out / "detectability.json").write_text(json.dumps(plain(result), indent=1))
    return result


def stiffened(material: Material, factor: float) -> Material:
    """The material with every stress in it times `factor`."""
    given = material.model_dump(exclude_none=True)
    for name in MODULI:
        if name in given:
            value = given[name]
            given[name] = tuple(factor * one for one in value) if isinstance(value, tuple) else factor * value
    return Material.model_validate(given)


def reached_under(under: Sequence[float], contrast: Sequence[float | None]) -> float | None:
    """How deep (m) a nodule's top may lie so that its contrast is the just-noticeable difference.

    Between the two cells around it log(contrast) is taken as linear in depth.

    Returns:
        None where the shallowest is not felt; the deepest that was pressed where all are.
    """
    known = [(u, c) for u, c in sorted(zip(under, contrast, strict=True)) if c is not None]
    felt = [c >= JUST_NOTICEABLE for _, c in known]
    if not known or not felt[0]:
        return None
    if all(felt):
        return known[-1][0]
    k = felt.index(False)
    (u0, c0), (u1, c1) = known[k - 1], known[k]
    share = np.log(c0 / JUST_NOTICEABLE) / np.log(c0 / max(c1, 1e-6))
    return float(u0 + share * (u1 - u0))


def detect_lines(result: dict[str, Any]) -> str:
    """The answer as people read it."""
    lines = [
        f"{result['tool']} {1e3 * result['depth']:.2g} mm deep into {result['scene']}: {result['force']:.4f} N without "
        f"a nodule; {result['presses']} presses, {result['fresh']} of them fresh",
        "stiffer  radius (mm)  top under the surface (mm): more force",
    ]
    rows: dict[tuple[float, float], list[str]] = {}
    for cell in result["cells"]:
        shown = cell["reason"] if cell["contrast"] is None else f"{100 * cell['contrast']:.1f} %"
        if cell["contrast"] is None and cell.get("along"):
            shown = f"{100 * cell['along'][-1]:.1f} % {1e3 * cell['reached']:.2g} mm deep, where it {shown}"
        rows.setdefault((cell["stiffer"], cell["radius"]), []).append(f"{1e3 * cell['under']:g}: {shown}")
    for row in result["deepest_felt"]:
        key = (row["stiffer"], row["radius"])
        known = row["under"]
        if not row["known"]:
            lines.append(f"{key[0]:7g}  {1e3 * key[1]:11g}  {', '.join(rows[key])}; not known")
            continue
        told = (
            "not felt"
            if known is None
            else f"felt to {'at least ' if row['at_least'] else ''}{1e3 * known:.1f} mm"
        )
        lines.append(f"{key[0]:7g}  {1e3 * key[1]:11g}  {', '.join(rows[key])}; {told}")
    return "\n".join([*lines, f"modelled: {result['modelled']}", result["picture"]])


def _with_regions(scene: Scene, regions: tuple[Region, ...]) -> Scene:
    return scene.model_copy(update={"organ": scene.organ.model_copy(update={"region": regions})})


def _place(scene: Scene, mesh: OrganMesh, at: Sequence[float] | None) -> tuple[np.ndarray, np.ndarray]:
    if at is None:
        corners = mesh.vertices[mesh.triangles].mean(axis=1)
        inside = scene.reach.contains(corners) & ~mesh.supported(corners)
        if not scene.reach.is_given or not inside.any():
            what = "is not given, and the scene has no reach with a middle"
            raise InputError(InputProblem("", "--at", None, what, "a place, X,Y,Z"))
        at = corners[inside].mean(axis=0).tolist()
    contact, normal = mesh.distance.project(np.array([at]))
    return contact[0], normal[0]


def _refused(
    mesh: OrganMesh, contact: np.ndarray, normal: np.ndarray, depth: float
) -> tuple[str, str] | None:
    if mesh.supported(contact[None])[0]:
        return "lies on a support", "a free place on the surface"
    if mesh.distance((contact - 2.5 * depth * normal)[None])[0] > 0.0:
        return "is pressed deeper than 40 % of the local thickness", "a smaller depth"
    return None


def _normal_force(outcome: PressOutcome) -> np.ndarray:
    arrays = outcome.arrays
    return arrays["force_vector"][1:] @ arrays["normal"] if "normal" in arrays else np.zeros(0)


def _deepest_felt(
    cells: Sequence[dict[str, Any]], under: Sequence[float], radius: Sequence[float], stiffer: Sequence[float]
) -> list[dict[str, Any]]:
    rows = []
    for k in stiffer:
        for r in radius:
            mine = {c["under"]: c["contrast"] for c in cells if (c["radius"], c["stiffer"]) == (r, k)}
            reached = reached_under(list(mine), list(mine.values()))
            known = [c for c in mine.values() if c is not None]
            at_least = bool(known) and all(c >= JUST_NOTICEABLE for c in known)
            rows.append(
                {"stiffer": k, "radius": r, "under": reached, "at_least": at_least, "known": bool(known)}
            )
    return rows
