# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a benchmark says: one number beside what is asked of it, and the machine that it was measured on."""

from __future__ import annotations

import platform
import sys
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any

from palpate.author.mechanics import mechanics_version
from palpate.author.press_executor import core_count

__all__ = ["HEAD", "Measured", "lines", "machine", "record"]


@dataclass(frozen=True)
class Measured:
    """A row.

    Attributes:
        part: what it belongs to.
        what: in words.
        value: SI, or a ratio.
        text: the value for people.
        asked: of it, in words; "" where nothing is.
        detail: what it came from, JSON-clean.
    """

    part: str
    what: str
    value: float
    text: str
    asked: str = ""
    detail: dict[str, Any] = field(default_factory=dict)


def machine() -> dict[str, Any]:
    return {
        "name": platform.node(),
        "processor": _processor(),
        "cores": core_count(),
        "python": platform.python_version(),
        "system": f"{platform.system()} {platform.machine()}",
        "palpate": version("palpate"),
        "mechanics": mechanics_version()[:12],
    }


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    told = info.read_text().splitlines() if info.exists() else []
    names = [line.split(":")[1].strip() for line in told if "model name" in line]
    return names[0] if names else platform.processor() or sys.platform


HEAD = "| what | measured | asked |\n|---|---|---|"
"""Of a Markdown table."""


def lines(rows: Iterable[Measured]) -> str:
    """Of that table."""
    return "\n".join(f"| {row.what} | {row.text} | {row.asked or '-'} |" for row in rows)


def record(rows: Iterable[Measured], **more: Any) -> dict[str, Any]:
    """JSON-clean."""
    return {"machine": machine(), **more, "rows": [asdict(row) for row in rows]}
