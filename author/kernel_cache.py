# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A folder of compiled Warp kernels for each process, kept between runs.

Two processes that compile into one folder at the same time can read each other's half-written files.  A folder is
therefore claimed with a lock that the system lets go of when its process ends, however it ends.
"""

from __future__ import annotations

import fcntl
import os
import platform
import tempfile
from pathlib import Path
from typing import TextIO

__all__ = ["claim_kernel_cache"]

_CLAIMED: list[TextIO] = []
"""The lock, open for as long as this process lives."""
MOST = 4096
"""Folders looked at; more processes than that on one machine do not happen."""


def claim_kernel_cache() -> Path:
    """The first folder that no other process has; Warp is told by PALPATE_WARP_CACHE.

    Kernels are compiled for this machine's processor, so that machines that share a home have folders of their own.
    """
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "palpate" / platform.node()
    if not _CLAIMED:
        os.environ["PALPATE_WARP_CACHE"] = str(_first_free(base))
    return Path(os.environ["PALPATE_WARP_CACHE"])


def _first_free(base: Path) -> Path:
    try:
        base.mkdir(parents=True, exist_ok=True)
        for k in range(MOST):
            lock = (base / f"warp-{k}.lock").open("a")
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                lock.close()
                continue
            _CLAIMED.append(lock)
            return base / f"warp-{k}"
    except OSError:
        pass  # a folder that cannot be written or locked: compile anew each time
    folder = tempfile.TemporaryDirectory(prefix="palpate-warp-")
    _CLAIMED.append(folder)  # type: ignore[arg-type]  # goes with this process
    return Path(folder.name)
