# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""One case of the table of extremes, and how its outcome is found.

verified   it came to an end and agrees with a scaling law, a closed form or a fresh press within the case's bar
refused    it was not done, and a sentence says why: what is wrong and, where an input is, what would be right
wrong      anything else: a number that disagrees, an input accepted that cannot be, a crash without a sentence, no end
"""

from __future__ import annotations

import signal
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

__all__ = [
    "OUTCOMES",
    "Case",
    "Refused",
    "Row",
    "Wrong",
    "close_to",
    "must_refuse",
    "not_above",
    "outcome_of",
]

OUTCOMES = ("verified", "refused", "wrong")
TIME_LIMIT = 600.0
"""s of wall time; a case that has not ended by then is wrong."""
OWN_SENTENCES = (ValueError, RuntimeError, ArithmeticError)
"""Built-in errors whose text is this project's where this project raises them."""


class Refused(Exception):
    """The work was not done; the text says why."""


class Wrong(Exception):
    """The work was done, and what came out does not hold."""


@dataclass(frozen=True)
class Case:
    """One extreme.

    Attributes:
        axis: what is driven to its end.
        value: how far, with its unit.
        run: does it; gives a sentence that says what it was held against and how far off it is, or raises.
        quick: cheap enough for every test run.
    """

    axis: str
    value: str
    run: Callable[[], str]
    quick: bool = False


@dataclass(frozen=True)
class Row:
    """What came of a case.

    Attributes:
        outcome: one of OUTCOMES.
        reason: one sentence.
        seconds: CPU time.
    """

    axis: str
    value: str
    outcome: str
    reason: str
    seconds: float


def close_to(what: str, value: float, expected: float, bar: float) -> str:
    """A sentence where |value / expected - 1| <= bar.  Raises Wrong elsewhere, numbers that are not finite included."""
    off = abs(value / expected - 1.0) if expected else abs(value)
    said = f"{what}: off by {100.0 * off:.2g} % (bar {100.0 * bar:.2g} %)"
    if not (np.isfinite(off) and off <= bar):
        raise Wrong(f"{said}; {value:.6g} for {expected:.6g}")
    return said


def not_above(what: str, value: float, bar: float) -> str:
    """A sentence where value <= bar.  Raises Wrong elsewhere."""
    said = f"{what} {value:.3g} (bar {bar:.3g})"
    if not (np.isfinite(value) and value <= bar):
        raise Wrong(said)
    return said


def must_refuse(work: Callable[[], Any]) -> str:
    """For an input that nothing can be made of: `work` has to raise, and what it says is the reason.  Raises Wrong."""
    work()
    raise Wrong("was accepted without a word")


def outcome_of(case: Case, time_limit: float = TIME_LIMIT) -> Row:
    """Runs a case."""
    begun = time.process_time()

    def row(outcome: str, reason: str) -> Row:
        return Row(case.axis, case.value, outcome, " ".join(reason.split()), time.process_time() - begun)

    try:
        with _limited(time_limit):
            return row("verified", case.run())
    except Wrong as error:
        return row("wrong", str(error))
    except Exception as error:
        return row(*_judged(error))


def _judged(error: Exception) -> tuple[str, str]:
    """A refusal is a sentence of this project's own; a library's message says nothing about the input."""
    said = str(error).strip()
    frames = traceback.extract_tb(error.__traceback__)
    deliberate = type(error).__module__.startswith("palpate.") or (
        isinstance(error, OWN_SENTENCES) and _ours(frames[-1].filename)
    )
    if deliberate and len(said.split()) >= 3:
        return "refused", said
    where = next((f"{f.filename.rsplit('/', 1)[-1]}:{f.lineno}" for f in reversed(frames)), "")
    return "wrong", f"{type(error).__name__} at {where} without a reason that names the input: {said}"


def _ours(filename: str) -> bool:
    import palpate.author as author

    roots = [str(folder).rsplit("/", 1)[0] for folder in author.__path__]
    rooms = ("author", "fem_offline", "fields", "runtime", "runtime_cpp")
    from pathlib import Path

    path = Path(filename)
    return any(path.resolve().is_relative_to(Path(root).resolve()) for root in roots) or any(
        f"/palpate/{room}/" in filename for room in rooms
    )


@contextmanager
def _limited(seconds: float) -> Iterator[None]:
    """Raises Wrong in this thread after `seconds`; where there are no alarms, nothing happens."""
    if not hasattr(signal, "SIGALRM") or threading.current_thread() is not threading.main_thread():
        yield
        return

    def ring(number: int, frame: object) -> None:
        raise Wrong(f"has not ended within {seconds:.0f} s")

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
