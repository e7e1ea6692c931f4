# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Solvers that stand in for finite elements: quick, deadly to their worker, or a law of contact that is known.

They are a module of their own because spawned workers import them by name.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from concurrent.futures import Future
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from palpate.author.press_jobs import PressJob
from palpate.author.tool_stage import ToolShape

BALL = ToolShape("sphere", (("radius", 5e-3),))


@dataclass(frozen=True)
class AnyOrgan:
    hash: str = "organ"


def jobs(count: int, seconds: float = 0.0) -> list[PressJob]:
    """Presses that take `seconds` each."""
    return [
        PressJob((float(k), 0.0, 0.0), BALL, (1e-3,), "near_field", friction=seconds) for k in range(count)
    ]


def quick(mesh: AnyOrgan, job: PressJob, folder: str):
    time.sleep(job.friction)
    arrays = {"depth": np.array([0.0, 1e-3]), "force_vector": np.full((2, 3), job.contact_point[0])}
    return arrays, {"converged": True, "reason": "", "seconds": job.friction, "pid": os.getpid()}


def deadly(mesh: AnyOrgan, job: PressJob, folder: str):
    """The press at 1 ends its worker the way the system does when memory runs out: always."""
    if job.contact_point[0] == 1.0:
        os.kill(os.getpid(), signal.SIGKILL)
    return quick(mesh, job, folder)


def deadly_once(mesh: AnyOrgan, job: PressJob, folder: str):
    """The same, the first time only."""
    died = Path(folder).parent / "died"
    if job.contact_point[0] == 1.0 and not died.exists():
        died.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return quick(mesh, job, folder)


def meets(others: int, folder: str) -> list[int]:
    """Ends when as many threads of this process are in it at once."""
    path = Path(folder) / f"{os.getpid()}-{threading.get_ident()}"
    path.touch()
    end = time.monotonic() + 20.0
    while len(list(Path(folder).iterdir())) < others:
        assert time.monotonic() < end
        time.sleep(0.01)
    return [os.getpid(), threading.get_ident()]


def raises(text: str) -> None:
    raise ValueError(text)


MODULUS = 7e3
"""Pa, of `known_block` in its middle."""


def known_energy(x: np.ndarray, R: float, d: np.ndarray) -> np.ndarray:
    """U (J) of a ball of radius R (m), d (m) deep at places x (m) of a block that is stiffer at one side.

    Zhang et al. 2014: F = 4/3 E* sqrt(R) d^1.5 (1 - 0.15 d / R).
    """
    scale = MODULUS * np.exp(x / 40e-3) * np.sqrt(R)
    return scale * (8 / 15 * d**2.5 - 4 / 3 * 0.15 * d**3.5 / (3.5 * R))


def known_block(mesh, job: PressJob, folder: str, progress=None):
    """Presses of balls on the top of a block, z up, as `known_energy` says; sticks with k = 0.7 f'."""
    return known_press(job, dict(job.tool.parameters)["radius"], 1.0, 0.0)


def known_probe(mesh, job: PressJob, folder: str, progress=None):
    """The same of a cone's tip: half as stiff again when it leans by 30 degrees, and 1 mm off to where it leans."""
    leans = (1 - np.cos(job.tool.tilt)) / (1 - np.cos(np.pi / 6))
    aside = 1e-3 * np.sin(job.tool.tilt) / np.sin(np.pi / 6)
    return known_press(job, dict(job.tool.parameters)["edge_radius"], 1 + 0.5 * leans, aside)


def known_press(job: PressJob, R: float, factor: float, aside: float):
    """A press of a ball of radius R (m), `factor` times `known_energy` at a place `aside` (m) of its own."""
    x = job.contact_point[0] + aside
    depth = np.concatenate([[0.0], job.depths])
    step = 1e-7

    def slope(d: np.ndarray) -> np.ndarray:
        below = np.maximum(d - step, 0.0)
        rise = known_energy(x, R, d + step) - known_energy(x, R, below)
        return factor * rise / (d + step - below)

    force = np.zeros((len(depth), 3))
    force[1:, 2] = slope(depth[1:])
    force[:, 0] = -factor * known_energy(x, R, depth) / 40e-3  # -dU/dx
    k = np.zeros(len(depth))
    k[1:] = 0.7 * (slope(depth[1:] + 1e-5) - slope(depth[1:] - 1e-5)) / 2e-5
    lateral = []
    for index, share, angle in job.moves:
        i = index + 1
        s = share * job.friction * force[i, 2] / k[i] * np.array([np.cos(angle), np.sin(angle), 0.0])
        moved = [force[i].tolist(), (force[i] - k[i] * s).tolist()]
        lateral.append(
            {"depth": depth[i], "deflection": [[0, 0, 0], s.tolist()], "force_vector": moved, "energy": []}
        )
    unknown = np.full((len(depth), 3, 3), np.nan)
    arrays = {
        "contact_point": np.array(job.contact_point),
        "normal": np.array([0.0, 0.0, 1.0]),
        "depth": depth,
        "force_vector": force,
        "energy": factor * known_energy(x, R, depth),
        "sticking_stiffness": k[:, None, None] * np.diag([1.0, 1.0, 0.0]) if job.stiffness else unknown,
        "friction_share": np.ones(len(depth)) if job.stiffness else unknown[:, 0, 0],
    }
    if job.surface:
        arrays |= known_surface(np.array(job.contact_point), depth)
    return arrays, {"converged": True, "reason": "", "lateral": lateral, "seconds": 0.0, "estimate": 0.0}


def known_surface(c: np.ndarray, depth: np.ndarray) -> dict[str, np.ndarray]:
    """u = -d e_z / (1 + r^2 / a^2), a = 5 mm, on the plane around c; what sticks follows as 1 / (1 + r^2 / a^2)."""
    r, angle = np.meshgrid(1e-3 * np.arange(0.5, 30.0), 0.5 * np.arange(12.0))
    x, y = (r * np.cos(angle)).ravel(), (r * np.sin(angle)).ravel()
    bell = 1.0 / (1.0 + (x**2 + y**2) / (5e-3) ** 2)
    along = np.eye(3)[:, :2]
    return {
        "surface_point": c + np.stack([x, y, 0.0 * x], axis=1),
        "surface_displacement": -depth[:, None, None] * bell[:, None] * np.array([0.0, 0.0, 1.0]),
        "surface_stuck": (bell[:, None, None] * along)[None],
        "surface_stuck_depth": depth[-1:],
    }


LUMP = (0.003, -0.002), 4e-3, 0.4
"""Centre (m), width (m) and height of the rise of force above what `known_lump` hides."""


def known_lump(mesh, job: PressJob, folder: str, progress=None):
    """Presses of balls on the top of a block, z up, LUMP stiffer at one place; steepest at its width."""
    (x0, y0), width, height = LUMP
    R = dict(job.tool.parameters)["radius"]
    x, y = job.contact_point[0] - x0, job.contact_point[1] - y0
    bump = height * np.exp(-(x**2 + y**2) / (2 * width**2))
    outcome = known_press(replace(job, contact_point=(0.0, 0.0, job.contact_point[2])), R, 1.0, 0.0)
    arrays, values = outcome
    energy, force = arrays["energy"], arrays["force_vector"]
    force = (1 + bump) * np.array([0.0, 0.0, 1.0]) * force[:, 2:]
    force[:, :2] = energy[:, None] * bump * np.array([x, y]) / width**2  # -dU/dx
    stiffness = (1 + bump) * arrays["sticking_stiffness"]
    found = {
        "contact_point": np.array(job.contact_point),
        "force_vector": force,
        "energy": (1 + bump) * energy,
    }
    return arrays | found | {"sticking_stiffness": stiffness}, values


class Inline:
    """An executor whose presses are done at once, in this process."""

    workers = 1

    def submit(self, fn, *args):
        future: Future = Future()
        future.set_result(fn(*args))
        return future
