# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a sweep leaves in its folder: tradeoff.json, tradeoff.csv, tradeoff.png, index.html."""

from __future__ import annotations

import csv
import json
import os
from pathlib import Path
from typing import Any

from palpate.author.console import plain
from palpate.author.tradeoff.front import worst_error
from palpate.author.tradeoff.page import page
from palpate.author.tradeoff.picture import picture
from palpate.author.tradeoff.rows import ERRORS

__all__ = ["COLUMNS", "write_files"]

COLUMNS = (
    "row", "fidelity", "mesh_size", "patch_radius", "patch_refinement", "nodes", "knots", "response", "float_bits",
    "offered", "pareto", "recommended", "met", "chance", "cpu_seconds", "organ_cpu_seconds", "geometry_cpu_seconds",
    "press_cpu_seconds", "fit_cpu_seconds", "bytes", "tick_ns", "worst_p95",
    *(f"{kind}_{part}" for kind in ERRORS for part in ("p50", "p95", "max")),
)  # fmt: skip
"""Of the CSV; SI units, ns for ticks, errors as fractions."""


def write_files(result: dict[str, Any], folder: Path) -> dict[str, str]:
    """Writes all four; their paths by kind."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = {kind: folder / name for kind, name in (
        ("json", "tradeoff.json"), ("csv", "tradeoff.csv"), ("png", "tradeoff.png"), ("page", "index.html"),
    )}  # fmt: skip
    result = plain(result)
    _whole(paths["json"], json.dumps(result, indent=1, allow_nan=False))
    part = paths["csv"].with_suffix(".part")
    with part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        writer.writerows(_csv_row(i, row, result) for i, row in enumerate(result["rows"]))
    os.replace(part, paths["csv"])
    picture(result, paths["png"])
    _whole(paths["page"], page(result))
    return {kind: str(path) for kind, path in paths.items()}


def _whole(path: Path, text: str) -> None:
    part = path.with_suffix(".part")
    part.write_text(text, encoding="utf-8")
    os.replace(part, path)


def _csv_row(i: int, row: dict[str, Any], result: dict[str, Any]) -> list[Any]:
    values = {
        **row,
        **row["setting"],
        **{f"{kind}_{part}": value for kind in ERRORS for part, value in (row[kind] or {}).items()},
        "row": i,
        "pareto": i in result["pareto"],
        "recommended": i == result["recommended"],
        "worst_p95": worst_error(row),
    }
    return [values.get(name, "") if values.get(name) is not None else "" for name in COLUMNS]
