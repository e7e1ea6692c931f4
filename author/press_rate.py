# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""How presses go while they run: rate, time left, worst error so far.

Rate and time left come from presses that were solved in this run; kept ones take no time.  With n_k presses of
fidelity k to go, of mean duration t_k each, on w workers,

    left = sum_k n_k t_k / w

t_k is measured; until one of that fidelity has ended it is the planned duration (effort.py), scaled as the others
turned out.
"""

from __future__ import annotations

import time
from collections import Counter, defaultdict
from collections.abc import Callable, Sequence

from palpate.author.effort import PRESS_SECONDS
from palpate.author.press_jobs import PressJob, PressOutcome

__all__ = ["PressRate"]


class PressRate:
    """Counts outcomes as they arrive.

    Args:
        jobs: all that will arrive.
        workers: how many are at work now.
        clock: s.
    """

    def __init__(
        self,
        jobs: Sequence[PressJob],
        workers: Callable[[], int],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._to_go = Counter(job.fidelity for job in jobs)
        self._workers, self._clock, self._begun = workers, clock, clock()
        self._durations: dict[str, list[float]] = defaultdict(list)
        self._worst: dict[str, float] = {}
        self.failed = 0

    def asked(self, jobs: Sequence[PressJob]) -> None:
        """More that will arrive."""
        self._to_go.update(job.fidelity for job in jobs)

    def arrived(self, outcome: PressOutcome) -> None:
        values = outcome.values
        self._to_go[outcome.job.fidelity] -= 1
        self.failed += not outcome.converged
        if outcome.fresh:
            self._durations[outcome.job.fidelity].append(float(values.get("seconds", 0.0)))
        for name in ("estimate", "work_mismatch"):
            if values.get(name) is not None:
                self._worst[name] = max(self._worst.get(name, 0.0), float(values[name]))

    @property
    def per_minute(self) -> float | None:
        """Fresh presses per minute of wall time; None before the first."""
        fresh = sum(map(len, self._durations.values()))
        spent = self._clock() - self._begun
        return 60.0 * fresh / spent if fresh and spent > 0.0 else None

    @property
    def left(self) -> float:
        """s."""
        measured = {kind: sum(found) / len(found) for kind, found in self._durations.items()}
        planned = sum(PRESS_SECONDS[kind] for kind in measured)
        scale = sum(measured.values()) / planned if measured else 1.0
        work = sum(n * measured.get(kind, scale * PRESS_SECONDS[kind]) for kind, n in self._to_go.items())
        return work / max(1, self._workers())

    @property
    def note(self) -> str:
        """Rate, failures and the worst error so far, for people."""
        parts = []
        if (rate := self.per_minute) is not None:
            parts.append(f"{rate:.2g} presses/min")
        if "estimate" in self._worst:
            parts.append(f"near field off by an estimated {100 * self._worst['estimate']:.2g} % at worst")
        elif "work_mismatch" in self._worst:
            parts.append(f"work and energy differ by {100 * self._worst['work_mismatch']:.2g} % at worst")
        if self.failed:
            parts.append(f"{self.failed} failed")
        return ", ".join(parts)
