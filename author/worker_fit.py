# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Whether another process would press as this one does: the same palpate, the same mechanics, one press at a time."""

from __future__ import annotations

import os
from importlib.metadata import version
from typing import Any

from palpate.author.mechanics import mechanics_version

__all__ = ["ABOUT", "about_this_process", "other_mechanics", "refusals", "right_workers"]

ABOUT = "__import__('palpate.author.worker_fit').author.worker_fit.about_this_process()"
"""Evaluated in workers: a text, so that one without palpate can say so."""


def refusals(about: dict[str, Any], threads: dict[str, int]) -> list[str]:
    """Why workers cannot press for this process: a clause for each that cannot.

    Args:
        about: worker's address -> `about_this_process` there, or the exception that it raised.
        threads: worker's address -> presses that it would run at once.
    """
    here = about_this_process()
    found = []
    for at, told in sorted(about.items()):
        if isinstance(told, ImportError):
            found.append(f"worker {at} has no palpate ({told})")
        elif isinstance(told, BaseException):
            found.append(f"worker {at} cannot load palpate ({type(told).__name__}: {told})")
        elif told["palpate"] != here["palpate"]:
            found.append(f"worker {at} has palpate {told['palpate']}, not {here['palpate']}")
        elif told["mechanics"] != here["mechanics"]:
            found.append(other_mechanics(at, told["mechanics"], here["mechanics"]))
        elif threads.get(at, 1) != 1:
            found.append(f"worker {at} runs {threads[at]} threads, and presses need a process each")
    return found


def about_this_process() -> dict[str, str]:
    """What decides whether presses of two processes are the same."""
    return {
        "palpate": version("palpate"),
        "mechanics": mechanics_version(),
        "blas_threads": os.environ.get("OMP_NUM_THREADS", "all"),
    }


def other_mechanics(at: str, theirs: str, ours: str) -> str:
    return f"worker {at} has other mechanics ({theirs[:8]}, not {ours[:8]}) and would find other forces"


def right_workers() -> str:
    return (
        "one and the same palpate on this machine, the scheduler and each worker, "
        "started with: dask worker ADDRESS --nthreads 1 --nworkers CORES"
    )
