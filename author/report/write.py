# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Writes the report: read, map, draw, and only then replace what an earlier run has left."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from palpate.author.console import plain
from palpate.author.report.contents import contents
from palpate.author.report.figures import figures
from palpate.author.report.gather import gather
from palpate.author.report.on_reach import on_reach
from palpate.author.report.page import page
from palpate.author.report.pictures import pictures

__all__ = ["write"]


def write(asset: Path, summary: dict[str, Any]) -> Path:
    """See `write_report`."""
    folder = asset / "report"
    folder.mkdir(parents=True, exist_ok=True)
    sources = gather(asset, summary)
    reaches = [
        on_reach(sources.organ, field, sources.device, len(sources.fields)) for field in sources.fields
    ]
    report = contents(sources, reaches)
    drawn, notes = pictures(folder, sources, reaches, report)
    report["pictures"], report["notes"] = drawn, report["notes"] + notes
    report = plain(report)
    drawings = figures(sources, reaches, report)
    _replace(folder / "report.json", json.dumps(report, indent=1, allow_nan=False, ensure_ascii=False))
    index = folder / "index.html"
    _replace(index, page(report, drawings, folder))
    return index


def _replace(path: Path, text: str) -> None:
    part = path.with_name(f".{path.name}.part")
    part.write_text(text, encoding="utf-8")
    part.replace(path)
