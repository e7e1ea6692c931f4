# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Times the runtime's tick on one field."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from palpate.author.console import Answer, table_of
from palpate.author.errors import InputError, InputProblem
from palpate.author.rfield_file import no_rfield

__all__ = ["bench"]


def bench(field: Path | None = None) -> Answer:
    """`field`: an .rfield; a shipped one when absent."""
    from palpate import runtime

    path = field or _shipped()
    if problem := no_rfield(path):
        raise InputError(problem)
    result = {"field": str(path), **runtime.bench(path)}
    table = table_of("ns a tick", "p50", "p99", "p99.9", "max")
    for key, row in result.items():
        if key.endswith("_ns") and isinstance(row, dict) and row["p50"] is not None:
            table.add_row(key[:-3], *(f"{row[column]:.0f}" for column in ("p50", "p99", "p999", "max")))
    size, load = f"{result['bytes'] / 1024:.0f} KiB", f"opened in {result['load_ms']:.2f} ms"
    return Answer(result, [f"{path}: {size}, {load}, {result['machine']}", table])


def _shipped() -> Path:
    folder = Path(str(files("palpate.assets"))) / "fields"
    shipped = sorted(folder.glob("*.rfield"))
    if not shipped:
        what = "is missing, as this version ships no field"
        raise InputError(
            InputProblem("", "FIELD", None, what, "an .rfield, such as one that author has made")
        )
    return shipped[0]
