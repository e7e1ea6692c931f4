# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Solvers that stand in for finite elements where a test is about processes: quick, and deadly to their worker.

They are a module of their own because spawned workers import them by name.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from dataclasses import dataclass
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
