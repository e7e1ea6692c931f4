# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""CalculiX (Dhondt and Wittig, GPL-2): runs a deck in a process of its own, reads the forces that it prints.

CalculiX is nothing that palpate needs; it is an independent program to compare with.  Debian: calculix-ccx.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

__all__ = ["PACKAGE", "CalculixError", "CalculixMissingError", "run_calculix", "total_forces"]

PROGRAM, PACKAGE = "ccx", "CalculiX (Debian: calculix-ccx)"
SECONDS_MAX = 600.0


class CalculixError(RuntimeError):
    """CalculiX did not finish a deck; the message ends with what it said last."""


class CalculixMissingError(CalculixError):
    """CalculiX is not installed."""


def run_calculix(deck: str, seconds_max: float = SECONDS_MAX) -> str:
    """Run a deck to its end on one thread; the text of its .dat file.

    Raises:
        CalculixMissingError: no ccx on the PATH.
        CalculixError: it stopped early, or ran longer than `seconds_max`.
    """
    program = shutil.which(PROGRAM)
    if program is None:
        raise CalculixMissingError("CalculiX is not installed (Debian: apt-get install calculix-ccx)")
    with tempfile.TemporaryDirectory(prefix="palpate-ccx-") as folder:
        Path(folder, "job.inp").write_text(deck)
        one = {**os.environ, "OMP_NUM_THREADS": "1", "CCX_NPROC_EQUATION_SOLVER": "1"}
        try:
            run = subprocess.run(
                [program, "job"], cwd=folder, env=one, capture_output=True, text=True, timeout=seconds_max
            )
        except subprocess.TimeoutExpired as error:
            raise CalculixError(f"CalculiX was still busy after {seconds_max:g} s") from error
        if run.returncode != 0 or "Job finished" not in run.stdout:
            last = [line.strip() for line in (run.stdout + run.stderr).splitlines() if line.strip()][-6:]
            raise CalculixError(f"CalculiX ended with {run.returncode}: {' | '.join(last)}")
        return Path(folder, "job.dat").read_text()


_TOTAL = re.compile(
    r"total force \(fx,fy,fz\) for set (\S+) and time\s+(\S+)\s+(\S+)\s+(\S+)\s+(\S+)", re.IGNORECASE
)


def total_forces(dat: str, node_set: str) -> np.ndarray:
    """(K, 3) total forces on a node set, in the order they were printed (*NODE PRINT, TOTALS=ONLY; RF)."""
    found = [m.groups()[2:] for m in _TOTAL.finditer(dat) if m.group(1) == node_set.upper()]
    return np.array([[float(x) for x in row] for row in found]).reshape(-1, 3)
