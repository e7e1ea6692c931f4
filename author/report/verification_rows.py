# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The verification table as a report shows it, and whether it speaks of the finite elements that pressed this asset."""

from __future__ import annotations

from typing import Any

from palpate.author.report.gather import Sources

__all__ = ["verification"]


def verification(sources: Sources) -> dict[str, Any] | None:
    """rows, how many are met and were not run, and `same`: whether the mechanics' source is that of every tool's
    presses (None where either is not known).  None where `palpate verify` was not kept."""
    found = sources.verification
    if not found:
        return None
    pressed = {(field.provenance.get("presses") or {}).get("mechanics") for field in sources.fields}
    known = found.get("mechanics")
    rows = found["rows"]
    return {
        "rows": rows,
        "count": len(rows),
        "met": sum(bool(row["met"]) for row in rows),
        "not_run": sum(bool(row.get("missing")) for row in rows),
        "same": pressed == {known} if known and None not in pressed else None,
    }
