# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Memory of this process and of this machine, in bytes.

On Linux the peak is VmHWM of /proc/self/status, which can be started anew (proc(5), clear_refs), so that each press
has a peak of its own.  `ru_maxrss`, the fallback, cannot; and in a process that was just spawned it still holds
the peak of the one that started it.
"""

from __future__ import annotations

import os
import resource
import sys
from contextlib import suppress
from pathlib import Path

__all__ = ["available_memory", "peak_memory", "restart_peak_memory"]

PROC = Path("/proc")
CGROUP = Path("/sys/fs/cgroup")
UNLIMITED = 1 << 60
"""bytes; a limit as large as this is none."""


def restart_peak_memory() -> None:
    """Peaks are counted from now on, where the system can do that."""
    with suppress(OSError):
        (PROC / "self/clear_refs").write_text("5")


def peak_memory() -> int:
    """Largest resident set of this process since `restart_peak_memory`, bytes."""
    with suppress(OSError, KeyError, ValueError):
        return _table(PROC / "self/status")["VmHWM"]
    unit = 1 if sys.platform == "darwin" else 1024  # getrusage(2): macOS counts bytes, the others kibibytes
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit


def available_memory() -> int | None:
    """What new processes may take without swapping, bytes; None where the system does not say.

    The least of the kernel's own estimate (MemAvailable) and what a container's limit leaves (cgroup v2, v1).
    """
    found = []
    with suppress(OSError, KeyError, ValueError):
        found.append(_table(PROC / "meminfo")["MemAvailable"])
    for limit, used, cached in (
        ("memory.max", "memory.current", "inactive_file"),
        ("memory/memory.limit_in_bytes", "memory/memory.usage_in_bytes", "total_inactive_file"),
    ):
        with suppress(OSError, KeyError, ValueError):
            most = int((CGROUP / limit).read_text())  # "max" is no limit, and no number
            if most < UNLIMITED:
                counted = dict(
                    line.split()
                    for line in (CGROUP / limit).with_name("memory.stat").read_text().splitlines()
                )
                found.append(most - int((CGROUP / used).read_text()) + int(counted[cached]))
    if not found and "SC_AVPHYS_PAGES" in os.sysconf_names:
        found.append(os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    return max(min(found), 0) if found else None


def _table(path: Path) -> dict[str, int]:
    """Lines like "VmHWM:  1234 kB" -> bytes."""
    rows = (line.split() for line in path.read_text().splitlines())
    return {row[0].rstrip(":"): 1024 * int(row[1]) for row in rows if len(row) == 3 and row[2] == "kB"}
