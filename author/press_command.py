# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""`palpate press`: one press, for people who want to look.

With `out`, the mesh, the far field and the record are kept in its folder work/, which `palpate author --out` shares,
and a picture and the answer as JSON go to its folder presses/; without it, nothing is kept.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.batch_executor import device_named
from palpate.author.console import plain
from palpate.author.errors import InputError, InputProblem, PalpateError
from palpate.author.organ_stage import OrganMesh, mesh_organ
from palpate.author.press_jobs import PressJob, PressOutcome, run_here
from palpate.author.progress import Progress, SilentProgress
from palpate.author.scene import Scene
from palpate.author.scene_tables import Tool
from palpate.author.store import Store
from palpate.author.tool_stage import offset_of, shape_of
from palpate.author.tool_work import ladder
from palpate.fem_offline.pose import tangents

__all__ = ["PressFiles", "press", "press_lines"]

DRAG_SHARES = (0.25, 0.5, 0.75, 1.0)
"""Of the depth; where --drag drags."""
SUFFIXES = {"plot": (".png",), "vtu": (".vtu",), "usd": (".usda", ".usdc", ".usd")}


@dataclass(frozen=True)
class PressFiles:
    """Where a press leaves what people look at.

    Attributes:
        out: folder that keeps the work, the answer and a picture.
        plot: PNG.  vtu: deformed tetrahedra.  usd: deformed surface.
    """

    out: Path | None = None
    plot: Path | None = None
    vtu: Path | None = None
    usd: Path | None = None

    def __post_init__(self) -> None:
        """Raises InputError where a file's suffix says that it is something else."""
        for name, suffixes in SUFFIXES.items():
            path = getattr(self, name)
            if path is not None and path.suffix.lower() not in suffixes:
                what = "has another suffix than what is written"
                expected = "a file name that ends with " + " or ".join(suffixes)
                raise InputError(InputProblem("", f"--{name}", str(path), what, expected))

    @property
    def shows_shape(self) -> bool:
        return self.vtu is not None or self.usd is not None


def press(
    scene: Scene,
    at: Sequence[float],
    tool: str,
    depth: float,
    lateral: Sequence[float] | None = None,
    fidelity: str = "near_field",
    progress: Progress | None = None,
    drag: bool = False,
    files: PressFiles = PressFiles(),
    device: str = "",
) -> dict[str, Any]:
    """Press `tool` at the surface point nearest to `at` (3 coordinates, m) down to `depth` (m).

    Args:
        lateral: two lengths (m) along the surface's tangents; the contact then sticks and moves aside.
        drag: then drag the tool both ways at DRAG_SHARES of the depth, with its friction.
        files: what is written beside the answer.
        device: evaluates the elements; this process itself when "".

    Returns:
        What `palpate press --json` prints.

    Raises:
        InputError: the depth goes through the organ, the place is far from it, or there is no such device.
        PalpateError: the press could not be set up.
    """
    progress = progress or SilentProgress()
    named = scene.tool_named(tool)
    with ExitStack() as stack:
        if device:
            from palpate.fem_offline.batch import Batch

            batch = stack.enter_context(Batch(device_named(device)))
            stack.enter_context(batch.member())
        folder = files.out / "work" if files.out else None
        if folder is None:
            folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="palpate-press-")))
        store = Store(folder)
        progress.stage("surface and tetrahedra")
        mesh = mesh_organ(scene, store)
        job = _job(scene, mesh, named, at, depth, fidelity)
        job = replace(
            job,
            lateral=None if lateral is None else (float(lateral[0]), float(lateral[1])),
            shape=files.shows_shape,
            friction=_friction(scene, named, mesh, job) if drag else 0.0,
            drag=tuple(float(share * depth) for share in DRAG_SHARES) if drag else (),
        )
        progress.stage("press", len(job.depths) + len(job.drag))
        outcome = run_here(mesh, job, store, lambda d: progress.advance(1, f"{1e3 * d:.2f} mm deep"))
    result = _result(scene, named, mesh, outcome)
    result["files"] = _written(files, result, outcome, progress)
    return result


def press_lines(result: dict[str, Any]) -> str:
    """The answer as people read it."""
    rows = zip(result["depth"], result["force"], result["energy"], result["area"], strict=True)
    lines = ["depth (mm)  force (N)  energy (mJ)  area (mm2)"]
    lines += [f"{1e3 * d:10.3f}  {f:9.4f}  {1e3 * u:11.5f}  {1e6 * a:10.2f}" for d, f, u, a in rows]
    state = "converged" if result["converged"] else f"NOT converged: {result['reason']}"
    errors = f"reaction error {np.max(result['reaction_error']):.0e}, residual {result['residual']:.0e}"
    lines += [f"{state}, {errors}, {result['unknowns']} unknowns, {result['seconds']:.1f} s"]
    drag = result["drag"]
    if drag is not None:
        lines += ["depth (mm)  friction, dragged both ways"]
        rows = zip(drag["depth"], drag["friction"], strict=True)
        lines += [f"{1e3 * d:10.3f}  " + ("none" if mu is None else f"{mu:.4f}") for d, mu in rows]
        law = "Amontons' law holds" if drag["amontons"] else "Amontons' law does NOT hold"
        lines += [f"given {drag['given']:g}; {law}" if drag["converged"] else f"dragging: {drag['reason']}"]
    return "\n".join(lines + [f"{kind}: {path}" for kind, path in result["files"].items()])


def _job(
    scene: Scene,
    mesh: OrganMesh,
    tool: Tool,
    at: Sequence[float],
    depth: float,
    fidelity: str,
) -> PressJob:
    contact, normal = mesh.distance.project(np.array([at]))
    if (
        mesh.distance(contact - depth * normal)[0] > 0.0
        or mesh.distance(contact - 2.5 * depth * normal)[0] > 0.0
    ):
        what = f"presses {1e3 * depth:.1f} mm deep where the tissue is thinner than {2.5e3 * depth:.1f} mm"
        raise InputError(scene.problem("--depth", depth, what, "at most 40 % of the local thickness"))
    if mesh.supported(contact)[0]:
        raise InputError(scene.problem("--at", list(at), "lies on a support", "a free place on the surface"))
    return PressJob(
        tuple(map(float, contact[0])),
        shape_of(scene, tool),
        tuple(map(float, ladder(depth))),
        fidelity,
        refinement=scene.accuracy.patch_refinement or 1.0,
        patch_radius=scene.accuracy.patch_radius,
    )


def _friction(scene: Scene, tool: Tool, mesh: OrganMesh, job: PressJob) -> float:
    """The coefficient, the tool's or painted.  Raises InputError where there is none to drag with."""
    painted = mesh.painted("friction", np.array([job.contact_point]))
    if painted is not None and painted[0] > 0.0:
        return float(painted[0])
    if not tool.friction:
        key = f"tool[{scene.tool.index(tool)}].friction"
        raise InputError(
            scene.problem(key, tool.friction, "drags nothing", "a coefficient above 0 for --drag")
        )
    return tool.friction


def _result(scene: Scene, tool: Tool, mesh: OrganMesh, outcome: PressOutcome) -> dict[str, Any]:
    arrays, values = outcome.arrays, outcome.values
    if "normal" not in arrays:
        raise PalpateError(f"the press could not be set up: {values['reason']}")
    shape = outcome.job.tool
    names = (
        "force_vector",
        "moment",
        "energy",
        "area",
        "penetration",
        "reaction_error",
        "sticking_stiffness",
        "friction_share",
    )
    facts = ("converged", "reason", "unknowns", "work_mismatch", "newton_steps", "seconds", "cpu_seconds")
    return {
        "scene": scene.name,
        "tool": {
            "name": tool.name,
            "shape": tool.shape,
            "parameters": dict(shape.parameters),
            "tilt": shape.tilt,
            "offset": offset_of(shape),
            "hash": shape.hash,
        },
        "material": {
            **scene.organ.material.model_dump(mode="json", exclude_none=True),
            "shear_modulus": scene.organ.material.shear_modulus,
        },
        "contact_point": arrays["contact_point"],
        "normal": arrays["normal"],
        "tangents": tangents(arrays["normal"]),
        "depth_asked": outcome.job.depths[-1],
        "depth": arrays["depth"],
        "force": arrays["force_vector"] @ arrays["normal"],
        **{name: arrays[name] for name in names},
        "residual": float(arrays["residual"].max()),
        "lateral": values["lateral"],
        "drag": values.get("drag"),
        **{name: values[name] for name in facts},
        "fidelity": outcome.job.fidelity,
        "hash": outcome.key,
        "kept": not outcome.fresh,
    }


def _written(
    files: PressFiles, result: dict[str, Any], outcome: PressOutcome, progress: Progress
) -> dict[str, str]:
    """Writes what is asked for; kind -> path."""
    from palpate.author import press_shape
    from palpate.author.press_picture import press_picture

    progress.stage("files")
    plot, answer = files.plot, None
    if files.out is not None:
        stem = files.out / "presses" / f"{result['tool']['name']}_{result['hash'][:8]}"
        plot, answer = plot or stem.with_suffix(".png"), stem.with_suffix(".json")
    paths = {"plot": plot, "vtu": files.vtu, "usd": files.usd, "json": answer}
    told = {kind: str(path) for kind, path in paths.items() if path is not None}
    about = {
        "scene": result["scene"],
        "tool": result["tool"]["name"],
        "depth": float(outcome.values.get("shape_depth", 0.0)),
        "fidelity": result["fidelity"],
        "hash": result["hash"],
    }
    try:
        if plot is not None:
            press_picture(plot, result)
        if files.vtu is not None:
            press_shape.write_vtu(files.vtu, press_shape.shape_of(outcome.arrays), about)
        if files.usd is not None:
            press_shape.write_usd(files.usd, press_shape.shape_of(outcome.arrays), about)
        if answer is not None:
            answer.parent.mkdir(parents=True, exist_ok=True)
            answer.write_text(json.dumps(plain({**result, "files": told}), indent=1))
    except OSError as error:
        raise PalpateError(f"a file could not be written: {error}") from error
    return told
