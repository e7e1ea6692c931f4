# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""How numbers are written for people: 2-3 significant digits, units beside them, a dash for what is absent."""

from __future__ import annotations

import math
from typing import Any

__all__ = ["ABSENT", "KINDS", "asked", "percent", "significant", "written"]

ABSENT = "–"
"""Stands where nothing was measured or judged."""


def significant(value: float, digits: int = 3) -> str:
    """`value` rounded to `digits` significant digits, never in powers of ten between 1e-4 and 1e6."""
    if value == 0:
        return "0"
    exponent = math.floor(math.log10(abs(value)))
    if not -5 < exponent < 6:
        return f"{value:.{digits - 1}e}"
    rounded = round(value, digits - 1 - exponent)
    exponent = math.floor(math.log10(abs(rounded)))
    return f"{rounded:.{max(0, digits - 1 - exponent)}f}"


def percent(fraction: float | None, digits: int = 3) -> str:
    """A fraction as percentage: two digits below 1 %, three above; "below 0.001 %" rather than powers of ten."""
    if fraction is None:
        return ABSENT
    if 0 < abs(fraction) < 1e-5:
        return "< 0.001 %"
    return f"{significant(100 * fraction, 2 if abs(fraction) < 0.01 else digits)} %"


def asked(fraction: float) -> str:
    """A fraction that somebody chose, as percentage, without digits that nobody gave."""
    return f"{100 * fraction:.3g} %"


def _bytes(value: float) -> str:
    if value < 1024:
        return f"{value:.0f} B"
    return f"{significant(value / 1024)} KiB" if value < 1024**2 else f"{significant(value / 1024**2)} MiB"


def _seconds(value: float) -> str:
    if value < 120:
        return f"{significant(value)} s"
    return f"{significant(value / 60)} min" if value < 7200 else f"{significant(value / 3600)} h"


def _vector(value: list[float]) -> str:
    return ", ".join(f"{1e3 * x:.1f}" for x in value)


KINDS = {
    "percent": percent,
    "asked": asked,
    "size": lambda v: f"{1e3 * v:.4g} mm",
    "degrees": lambda v: f"{math.degrees(v):.3g}°",
    "mm": lambda v: f"{significant(1e3 * v)} mm",
    "um": lambda v: f"{significant(1e6 * v)} µm",
    "mm_vector": _vector,
    "N": lambda v: f"{significant(v)} N",
    "Ns/m": lambda v: f"{significant(v)} N s/m",
    "area": lambda v: f"{significant(1e4 * v)} cm²",
    "N/m": lambda v: f"{significant(v)} N/m",
    "Hz": lambda v: f"{v:.0f} Hz" if v >= 100 else f"{significant(v)} Hz",
    "ns": lambda v: f"{v:.0f} ns",
    "m/s": lambda v: f"{significant(v)} m/s",
    "mJ": lambda v: f"{significant(1e3 * v)} mJ",
    "milliseconds": lambda v: f"{significant(1e3 * v)} ms",
    "ms": lambda v: f"{significant(v)} ms",
    "seconds": _seconds,
    "bytes": _bytes,
    "count": lambda v: f"{v:d}" if isinstance(v, int) else f"{v:g}",
    "number": lambda v: significant(v),
    "short": lambda v: str(v)[:12],
    "text": str,
}
"""How each kind is written, from m, N, s, rad (but ns and ms as they say); asked, size: chosen, not measured."""


def written(value: Any, kind: str) -> str:
    """`value` as people read it; ABSENT for None."""
    return ABSENT if value is None else KINDS[kind](value)
