# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The verification table, printed: what the finite elements give beside what is known."""

from __future__ import annotations

import time
from collections.abc import Callable

from rich.table import Table

from palpate.author.console import Answer, table_of
from palpate.fem_offline.verification.row import Row
from palpate.fem_offline.verification.table import table

__all__ = ["verify"]


def verify(everything: bool = False, progress: Callable[[str], None] = lambda line: None) -> Answer:
    """Every row of the table; exit code 1 when one is not met.

    Args:
        everything: the slow rows too.
        progress: told about each row as it is found.
    """
    begun = time.perf_counter()
    rows = []
    for row in table(everything):
        rows.append(row)
        progress(f"{'met    ' if row.met else 'NOT MET'} {row.name}")
    missed = sum(not row.met for row in rows)
    verdict = f"{len(rows) - missed} of {len(rows)} rows met"
    result = {
        "rows": [_as_json(row) for row in rows],
        "met": missed == 0,
        "seconds": time.perf_counter() - begun,
    }
    notes = [f"{row.name}: {row.note}" for row in rows if row.note]
    return Answer(result, [_shown(rows), "\n".join(notes), verdict], 1 if missed else 0)


def _as_json(row: Row) -> dict[str, object]:
    return {**vars(row), "met": row.met}


def _shown(rows: list[Row]) -> Table:
    shown = table_of("", "against", "value", "error", "bar", "")
    for row in rows:
        mark = "[green]met[/green]" if row.met else "[red]NOT MET[/red]"
        shown.add_row(row.name, row.reference, f"{row.value:.6g}", f"{row.error:.1e}", f"{row.bar:.0e}", mark)
    return shown
