# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Which settings nothing beats, and which of them to take.

A row is beaten by one that is no worse in CPU seconds, bytes, tick and error, and better in one; of rows that are equal
the first one stays, which turns fewer knobs.  Two digits count, and ticks within TICK_NOISE of each other are equal:
what provenance adds to a file, or a machine to a second, is no choice.

Recommended is the setting that costs least CPU time among those that meet the tolerance surely enough: of REDRAWS draws
of as many held-out presses as the scene asks for, with replacement (B. Efron, Bootstrap methods: another look at the
jackknife, 1979), at least SURE meet it.  It knows no place that was not pressed; `--confirm-seeds` presses there.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from palpate.author.tradeoff.rows import ERRORS

__all__ = ["chance", "pareto", "recommended", "worst_error"]

TICK_NOISE = 0.05
REDRAWS = 400
SURE = 0.95
"""19 of 20."""


def worst_error(row: dict[str, Any]) -> float:
    """The largest 95th percentile of the kinds of error, fraction of normal force."""
    return max(row[kind]["p95"] for kind in ERRORS if row[kind])


def pareto(rows: Sequence[dict[str, Any]]) -> list[int]:
    """Indices of rows that no other one beats; only what is offered can be taken, and so can beat."""
    taken = [i for i, row in enumerate(rows) if row["offered"] and row["force_error"]]
    return [i for i in taken if not any(_beats(rows[j], rows[i], j < i) for j in taken if j != i)]


def _beats(a: dict[str, Any], b: dict[str, Any], first: bool) -> bool:
    """Whether `a` is better than `b`, or as good and stands `first`."""
    ours, theirs = (
        [_two_digits(x) for x in (row["cpu_seconds"], row["bytes"], worst_error(row))] for row in (a, b)
    )
    slower = a["tick_ns"] > (1.0 + TICK_NOISE) * b["tick_ns"]
    faster = b["tick_ns"] > (1.0 + TICK_NOISE) * a["tick_ns"]
    no_worse = all(x <= y for x, y in zip(ours, theirs, strict=True)) and not slower
    return no_worse and (ours != theirs or faster or first)


def _two_digits(value: float) -> float:
    return float(f"{value:.1e}")


def chance(presses: Sequence[dict[str, Any]], tolerance: float, draw: int) -> float:
    """Share of redraws of `draw` presses that meet the tolerance, as `judgement_of` (held_out.py) says it."""
    if not presses or not all(press["converged"] for press in presses):
        return 0.0
    picks = np.random.default_rng(1).integers(0, len(presses), (REDRAWS, draw))
    kinds = [[_known(errors) for errors in kind] for kind in _errors_by_kind(presses)]
    met = 0
    for pick in picks:
        drawn = [np.concatenate([kind[i] for i in pick]) for kind in kinds]
        met += len(drawn[0]) > 0 and all(_meets(errors, tolerance) for errors in drawn)
    return met / REDRAWS


def _errors_by_kind(presses: Sequence[dict[str, Any]]) -> list[list[list[float | None]]]:
    """Normal, lateral, stuck and slid errors of each press."""
    plain = [[press[kind] for press in presses] for kind in ("force_error", "lateral_error")]
    moved = [[[one["error"] for one in press[kind]] for press in presses] for kind in ("moves", "slides")]
    return [*plain, *moved]


def _known(errors: Sequence[float | None]) -> np.ndarray:
    return np.array([error for error in errors if error is not None], float)


def _meets(errors: np.ndarray, tolerance: float) -> bool:
    if not len(errors):
        return True
    return bool(np.percentile(errors, 95) <= tolerance and errors.max() <= 2.0 * tolerance)


def recommended(rows: Sequence[dict[str, Any]]) -> int | None:
    """Index of the cheapest row that is offered and meets the tolerance surely enough; None where none does."""
    good = [i for i, row in enumerate(rows) if row["offered"] and row["met"] and row["chance"] >= SURE]
    order = lambda i: (rows[i]["cpu_seconds"], rows[i]["tick_ns"], rows[i]["bytes"])  # noqa: E731
    return min(good, key=order, default=None)
