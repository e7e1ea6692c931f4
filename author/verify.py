# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The verification table, printed: what the finite elements give beside what is known."""

from __future__ import annotations

import time
from collections.abc import Callable

from rich.table import Table
from rich.text import Text

from palpate.author.console import Answer, table_of
from palpate.author.mechanics import mechanics_version
from palpate.fem_offline.verification.row import Row
from palpate.fem_offline.verification.table import table

__all__ = ["verify"]


def verify(everything: bool = False, progress: Callable[[str], None] = lambda line: None) -> Answer:
    """Every row of the table; exit code 1 when one was checked and is not met.

    Args:
        everything: the slow rows too.
        progress: told about each row as it is found.
    """
    begun = time.perf_counter()
    rows = []
    for row in table(everything):
        rows.append(row)
        progress(f"{_mark(row):7} {row.name}")
    missed, absent = sum(row.failed for row in rows), [row for row in rows if row.missing]
    verdict = f"{len(rows) - missed - len(absent)} of {len(rows)} rows met"
    if absent:
        verdict += f", {len(absent)} not run: {'; '.join(sorted({row.missing for row in absent}))}"
    result = {
        "rows": [_as_json(row) for row in rows],
        "met": missed == 0,
        "not_run": len(absent),
        "mechanics": mechanics_version(),
        "seconds": time.perf_counter() - begun,
    }
    notes = [f"{row.name}: {row.note}" for row in rows if row.note]
    return Answer(result, [_shown(rows), "\n".join(notes), verdict], 1 if missed else 0)


def _mark(row: Row) -> str:
    return "not run" if row.missing else "met" if row.met else "NOT MET"


def _as_json(row: Row) -> dict[str, object]:
    return {**vars(row), "met": row.met}


def _shown(rows: list[Row]) -> Table:
    shown = table_of("", "against", "value", "error", "bar", "")
    for row in rows:
        mark = Text(_mark(row), "yellow" if row.missing else "green" if row.met else "red")
        shown.add_row(row.name, row.reference, f"{row.value:.6g}", f"{row.error:.1e}", f"{row.bar:.0e}", mark)
    return shown
