# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A library as a file, between `palpate transients library` and a scene: an NPZ with rate, velocity, force, beside.

`beside` is the stiffness (N/m) of the response that the forces leave its own push to; 0 where they know of none.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from palpate.author.errors import UNREADABLE, InputError, InputProblem
from palpate.author.transients.library import Library
from palpate.fields.transient_layout import SAMPLE_LIMIT, VELOCITY_LIMIT

__all__ = ["read_library", "write_library"]


def write_library(path: Path, library: Library, beside: float = 0.0) -> None:
    np.savez(path, rate=library.rate, velocity=library.velocity, force=library.force, beside=beside)


def read_library(path: Path) -> tuple[Library, float]:
    """The library and its `beside`.  Raises InputError where the file is none, with all that is wrong in it."""

    def problem(key: str, value: object, what: str, expected: str) -> InputProblem:
        return InputProblem(str(path), key, value, what, expected)

    made = "library.npz of `palpate transients library`"
    try:
        with np.load(path, allow_pickle=False) as data:
            missing = [key for key in ("rate", "velocity", "force") if key not in data]
            if missing:
                raise InputError(problem(", ".join(missing), None, "is missing", made))
            rate = float(data["rate"])
            velocity, force = (np.asarray(data[key], dtype=float) for key in ("velocity", "force"))
            beside = float(data["beside"]) if "beside" in data else 0.0
    except UNREADABLE as error:
        raise InputError(problem("", None, f"is no library ({error})", made)) from error
    problems = []
    if velocity.ndim != 1 or force.ndim != 2 or len(force) != len(velocity):
        shapes = f"has the shapes {velocity.shape} and {force.shape}"
        raise InputError(problem("velocity, force", None, shapes, "(k,) m/s and (k, n) N"))
    if not 1 <= len(velocity) <= VELOCITY_LIMIT:
        problems.append(
            problem("velocity", len(velocity), "is their number", f"1 to {VELOCITY_LIMIT} transients")
        )
    elif not (np.all(np.isfinite(velocity)) and velocity[0] > 0.0 and np.all(np.diff(velocity) > 0.0)):
        problems.append(problem("velocity", velocity.tolist(), "does not rise", "m/s above 0, each once"))
    if not 2 <= force.shape[1] <= SAMPLE_LIMIT:
        problems.append(problem("force", force.shape[1], "is its number of samples", f"2 to {SAMPLE_LIMIT}"))
    elif not np.all(np.isfinite(force)):
        problems.append(problem("force", None, "has numbers that are not finite", "N"))
    elif force[:, 0].any() or force[:, -1].any():
        problems.append(problem("force", None, "does not begin and end at zero", "tapered transients"))
    if not (np.isfinite(rate) and 100.0 <= rate <= 1e6):
        problems.append(problem("rate", rate, "is no sample rate (Hz)", "100 Hz to 1 MHz"))
    if not (np.isfinite(beside) and beside >= 0.0):
        problems.append(problem("beside", beside, "is no stiffness (N/m)", "0 or more"))
    if problems:
        raise InputError(problems)
    return Library(rate, velocity, force), beside
