# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""`palpate press`: one press, for people who want to look."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.errors import InputError, PalpateError
from palpate.author.field_stage import tool_reference
from palpate.author.organ_stage import mesh_organ
from palpate.author.pipeline import ladder
from palpate.author.press_jobs import PressJob, press_executor, run_jobs
from palpate.author.progress import Progress, SilentProgress
from palpate.author.scene import Scene
from palpate.author.store import Store

__all__ = ["press"]


def press(
    scene: Scene,
    at: Sequence[float],
    tool: str,
    depth: float,
    lateral: Sequence[float] | None = None,
    fidelity: str = "near_field",
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Press `tool` at the surface point nearest to `at` (3 coordinates, m) down to `depth` (m).

    Args:
        lateral: two lengths (m) along the surface's tangents; the contact then sticks and moves aside.

    Returns:
        What `palpate press --json` prints.

    Raises:
        InputError: the depth goes through the organ, or the place is far from it.
    """
    progress = progress or SilentProgress()
    named = scene.tool_named(tool)
    reference = tool_reference(named)
    progress.stage("surface and tetrahedra")
    with tempfile.TemporaryDirectory(prefix="palpate-press-") as folder:
        store = Store(Path(folder))
        mesh = mesh_organ(scene, store)
        contact, normal = mesh.distance.project(np.array([at]))
        if (
            mesh.distance(contact - depth * normal)[0] > 0.0
            or mesh.distance(contact - 2.5 * depth * normal)[0] > 0.0
        ):
            what = (
                f"presses {1e3 * depth:.1f} mm deep where the tissue is thinner than {2.5e3 * depth:.1f} mm"
            )
            raise InputError(scene.problem("--depth", depth, what, "at most 40 % of the local thickness"))
        if mesh.held(contact)[0]:
            raise InputError(
                scene.problem("--at", list(at), "lies on a support", "a free place on the surface")
            )
        job = PressJob(
            tuple(map(float, contact[0])),
            reference.offset,
            tuple(map(float, ladder(depth))),
            fidelity,
            lateral=None if lateral is None else (float(lateral[0]), float(lateral[1])),
        )
        progress.stage("press")
        with press_executor(1) as executor:
            outcome = run_jobs(mesh, [job], store, executor)[0]
    arrays, values = outcome.arrays, outcome.values
    if "normal" not in arrays:
        raise PalpateError(f"the press could not be set up: {values['reason']}")
    return {
        "contact_point": arrays["contact_point"],
        "normal": arrays["normal"],
        "depth": arrays["depth"],
        "force": arrays["force_vector"] @ arrays["normal"],
        **{name: arrays[name] for name in ("force_vector", "moment", "energy", "area", "sticking_stiffness")},
        "reaction_error": arrays["reaction_error"],
        "penetration": arrays["penetration"],
        "residual": float(arrays["residual"].max()),
        "lateral": values["lateral"],
        **{
            name: values[name]
            for name in ("converged", "reason", "unknowns", "work_mismatch", "newton_steps")
        },
        "fidelity": fidelity,
        "seconds": values["seconds"],
        "cpu_seconds": values["cpu_seconds"],
    }
