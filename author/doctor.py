# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What this machine has of what palpate needs, and the line that installs the rest.

The shared objects are those that the wheels of pymeshlab and pyvista (VTK) were seen to load from outside
themselves; nothing else than loading them tells whether a slim image has them.
"""

from __future__ import annotations

import ctypes
import importlib
import os
import platform
import shutil
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.table import Table
from rich.text import Text

from palpate.author.console import Answer, table_of

__all__ = ["Check", "doctor"]

GIB = 1024.0**3


@dataclass(frozen=True)
class Check:
    """One thing that was looked for.

    Attributes:
        name: what it is.
        ok: whether it is there.
        needed: whether a command cannot work without it.
        found: version, amount, or why not.
        used_for: what needs it.
        package: Debian package that brings it, "" where a Python package does.
    """

    name: str
    ok: bool
    needed: bool
    found: str
    used_for: str
    package: str = ""


SHARED_OBJECTS = (
    ("libGL.so.1", True, "pymeshlab (surface repair), pyvista (pictures)", "libgl1"),
    ("libOpenGL.so.0", True, "pymeshlab (surface repair)", "libopengl0"),
    ("libX11.so.6", True, "pymeshlab (surface repair), pyvista (pictures)", "libx11-6"),
    ("libEGL.so.1", True, "pyvista (pictures without a display)", "libegl1"),
    ("libgmp.so.10", True, "pymeshlab (surface repair)", "libgmp10"),
    ("libXcursor.so.1", False, "pyvista (windows on a display)", "libxcursor1"),
)


def doctor(folder: Path | None = None) -> Answer:
    """Every check, and one install line for what is missing; exit code 3 when something needed is missing.

    `folder`: where results would be written, for the free space; the working folder when absent.
    """
    checks = [_python(), _compiler(), *(_shared_object(*row) for row in SHARED_OBJECTS)]
    checks += [_import(name, used_for) for name, used_for in _PYTHON_PACKAGES]
    checks += [_probe("pypardiso", "direct solver (fast)", _pardiso, needed=False)]
    checks += [_probe("palpate runtime", "rendering, validation, bench", _runtime)]
    checks += _machine(folder or Path.cwd())
    packages = sorted({check.package for check in checks if check.package and not check.ok})
    install = f"apt-get install -y --no-install-recommends {' '.join(packages)}" if packages else ""
    ok = all(check.ok for check in checks if check.needed)
    result = {"ok": ok, "checks": [vars(check) for check in checks], "install": install}
    shown: list[Any] = [_table(checks)]
    if install:
        shown.append(f"Install what is missing: {install}")
    return Answer(result, shown, 0 if ok else 3)


_PYTHON_PACKAGES = (
    ("numpy", "everything"),
    ("scipy", "linear algebra"),
    ("warp", "FEM kernels"),
    ("trimesh", "reading surfaces"),
    ("igl", "geometry queries"),
    ("pymeshlab", "surface repair"),
    ("pytetwild", "tetrahedra"),
    ("mmgpy", "refinement around a contact"),
    ("pxr.Usd", "assets"),
    ("pyvista", "pictures"),
)


def _python() -> Check:
    ok = sys.version_info >= (3, 11)
    return Check("python", ok, True, platform.python_version() + ("" if ok else ", needs 3.11"), "everything")


def _compiler() -> Check:
    named = os.environ.get("CXX", "")
    found = next(
        (path for name in (named, "c++", "g++", "clang++") if name and (path := shutil.which(name))), ""
    )
    return Check("C++ compiler", bool(found), False, found or "none", "installing from source", "g++")


def _shared_object(soname: str, needed: bool, used_for: str, package: str) -> Check:
    if not sys.platform.startswith("linux"):
        return Check(soname, True, False, "not used on this system", used_for)
    try:
        ctypes.CDLL(soname)
    except OSError as error:
        return Check(soname, False, needed, str(error), used_for, package)
    return Check(soname, True, needed, "loads", used_for, package)


def _import(name: str, used_for: str) -> Check:
    return _probe(name, used_for, lambda: getattr(importlib.import_module(name), "__version__", "imports"))


def _probe(name: str, used_for: str, probe: Callable[[], str], needed: bool = True) -> Check:
    try:
        return Check(name, True, needed, probe(), used_for)
    except Exception as error:
        return Check(name, False, needed, f"{type(error).__name__}: {error}", used_for)


def _pardiso() -> str:
    import numpy as np
    import pypardiso
    from scipy import sparse

    matrix = sparse.csr_matrix(np.array([[4.0, 1.0], [1.0, 3.0]]))
    solution = pypardiso.spsolve(matrix, np.array([1.0, 2.0]))
    if not np.allclose(matrix @ solution, [1.0, 2.0], atol=1e-12):
        raise ArithmeticError(f"solves 2 x 2 equations wrongly: {solution}")
    return getattr(pypardiso, "__version__", "solves")


def _runtime() -> str:
    from palpate import runtime

    return runtime.version()


def _machine(folder: Path) -> list[Check]:
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    memory = _memory() / GIB
    disk = shutil.disk_usage(folder).free / GIB
    return [
        Check("cores", cores >= 2, False, f"{cores}", "presses side by side; 2 or more"),
        Check("memory", memory >= 6.0, False, f"{memory:.1f} GiB", "an anatomical organ; 6 GiB or more"),
        Check("disk", disk >= 2.0, False, f"{disk:.1f} GiB free", "presses and kernels; 2 GiB or more"),
    ]


def _memory() -> float:
    """Bytes that this process may use: of the machine, or of its control group where that is less."""
    if not hasattr(os, "sysconf"):
        return 0.0
    memory = float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    limit = Path("/sys/fs/cgroup/memory.max")
    text = limit.read_text().strip() if limit.is_file() else ""
    return min(memory, float(text)) if text.isdigit() else memory


def _table(checks: list[Check]) -> Table:
    table = table_of("", "what", "found", "used for")
    for check in checks:
        style = "green" if check.ok else "red" if check.needed else "yellow"
        mark = Text("ok" if check.ok else "missing" if check.needed else "optional", style)
        table.add_row(mark, check.name, check.found, check.used_for)
    return table
