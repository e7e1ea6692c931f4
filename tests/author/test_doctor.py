# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The doctor finds what is there, and names the package that brings what is not."""

from __future__ import annotations

import ctypes

import pytest

from palpate.author import doctor as doctor_module
from palpate.author.doctor import doctor


def test_a_missing_library_is_told_with_its_install_line(monkeypatch: pytest.MonkeyPatch) -> None:
    real = ctypes.CDLL

    def without_opengl(name: str, *rest: object) -> object:
        if name in ("libGL.so.1", "libEGL.so.1"):
            raise OSError(f"{name}: cannot open shared object file")
        return real(name, *rest)

    monkeypatch.setattr(doctor_module.ctypes, "CDLL", without_opengl)
    monkeypatch.setattr(doctor_module, "_PYTHON_PACKAGES", (("no_such_package", "nothing"),))
    answer = doctor()
    checks = {check["name"]: check for check in answer.result["checks"]}
    assert not checks["libGL.so.1"]["ok"]
    assert "ModuleNotFoundError" in checks["no_such_package"]["found"]
    assert answer.exit_code == 3
    assert not answer.result["ok"]
    assert answer.result["install"].startswith("apt-get install")
    assert {"libgl1", "libegl1"} <= set(answer.result["install"].split())


def test_the_direct_solver_is_tried_and_not_only_imported() -> None:
    checks = {check["name"]: check for check in doctor().result["checks"]}
    assert checks["pypardiso"]["used_for"].startswith("direct solver")
    assert checks["python"]["ok"]
    assert {"cores", "memory", "disk", "palpate runtime", "C++ compiler"} <= set(checks)
