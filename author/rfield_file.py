# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""An .rfield as a command names it: there, or what is wrong, or which one of a folder is meant."""

from __future__ import annotations

from pathlib import Path

from palpate.author.errors import InputProblem

__all__ = ["no_rfield"]


def no_rfield(path: Path) -> InputProblem | None:
    """What is wrong where `path` is no file; None where it is one."""
    if path.is_file():
        return None
    what = "is a folder" if path.is_dir() else "does not exist"
    inside = sorted(path.glob("*.rfield")) if path.is_dir() else []
    return InputProblem(str(path), "", None, what, f"an .rfield{f', such as {inside[0]}' if inside else ''}")
