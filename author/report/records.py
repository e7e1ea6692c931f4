# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What else a report shows and no run of `palpate author` finds: tick times here, and the verification table.

Both are kept in the asset's folder `validation`, so that every later report shows them too.
"""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path
from typing import Any

from palpate.author.errors import InputError, InputProblem

__all__ = ["TICKS", "VERIFICATION", "file_hash", "keep_ticks", "keep_verification"]

TICKS = "{tool}-ticks.json"
VERIFICATION = "verification.json"
"""In the asset's folder `validation`."""


def file_hash(path: Path) -> str:
    """Hex sha256."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def keep_ticks(asset: Path, tool: str) -> dict[str, Any]:
    """Times the tick on <asset>/<tool>.rfield (about ten seconds) and keeps it.

    Raises:
        InputError: there is no such file.
    """
    from palpate.runtime import bench

    path = asset / f"{tool}.rfield"
    if not path.is_file():
        what = "does not exist, so there is nothing to time"
        raise InputError(InputProblem(str(path), "--bench", None, what, f"palpate cook {asset} before it"))
    busy = os.getloadavg()[0]
    record = {"tool": tool, "sha256": file_hash(path), "load": busy, "cores": os.cpu_count(), **bench(path)}
    _keep(asset / "validation" / TICKS.format(tool=tool), record)
    return record


def keep_verification(asset: Path, file: Path) -> dict[str, Any]:
    """Keeps what `palpate verify --json` printed into `file`.

    Raises:
        InputError: it is something else.
    """
    found: Any = None
    what = "does not exist"
    if file.is_file():
        what = "is not what palpate verify --json prints"
        try:
            found = json.loads(file.read_text(encoding="utf-8"))
        except ValueError:
            found = None
    wanted = {"name", "reference", "value", "error", "bar", "met"}
    rows = found.get("rows") if isinstance(found, dict) else None
    if (
        not isinstance(rows, list)
        or not rows
        or not all(isinstance(r, dict) and wanted <= set(r) for r in rows)
    ):
        raise InputError(
            InputProblem("", "--verification", str(file), what, "palpate verify --json > verification.json")
        )
    _keep(asset / "validation" / VERIFICATION, found)
    return found


def _keep(path: Path, record: dict[str, Any]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{path.name}.part")
    part.write_text(json.dumps(record, indent=1), encoding="utf-8")
    part.replace(path)
