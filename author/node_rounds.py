# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The rounds in which one tool's nodes are pressed: batches that follow each other without anybody waiting.

Batch k is chosen from what the batches up to k - 2 have found, knowing where batch k - 1 presses: while one is
pressed the next one is ready.  What a batch depends on is therefore always the same, however fast its presses were: a
run that was killed asks for the same presses again, and they are kept.  The first batch has to wait for the seeds, and
where the field seems near enough no more is asked for than the next batch, whose tests decide.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np

from palpate.author.press_jobs import PressJob, PressOutcome
from palpate.author.sampling_by_error import SamplingByError
from palpate.fields.node_fit import PressArrays, fit_nodes

__all__ = ["NodeRounds"]


class NodeRounds:
    """Asks for one tool's nodes.

    Args:
        seeds: places (indices of the sampling's terrain) to begin with.
        job_of: press at a place.
        press_of: a press as the field takes it, or None where it cannot.
        sampling: makes what chooses; called while the seeds are pressed.
        knots: (K,) m, depths of the node curves.
        width: presses in a batch (count); the same whenever a run goes on.
        out_of_time: whether the time budget is spent.
    """

    def __init__(
        self,
        seeds: Sequence[int],
        job_of: Callable[[int], PressJob],
        press_of: Callable[[PressOutcome], PressArrays | None],
        sampling: Callable[[], SamplingByError],
        knots: np.ndarray,
        width: int,
        out_of_time: Callable[[], bool],
    ) -> None:
        self._make = sampling
        self._job_of, self._press_of, self._knots, self._width = job_of, press_of, knots, width
        self._out_of_time = out_of_time
        self._batches: list[list[int]] = [list(dict.fromkeys(map(int, seeds)))]
        self._jobs: dict[PressJob, int] = {}
        self._outcome: dict[int, PressOutcome] = {}
        self._presses: list[PressArrays] = []
        self._index: list[int] = []
        self._unusable: list[int] = []
        self._told = 0

    @property
    def outcomes(self) -> list[PressOutcome]:
        """Of all nodes, in the order in which they were asked for."""
        return [self._outcome[i] for batch in self._batches for i in batch if i in self._outcome]

    @property
    def batches(self) -> list[list[int]]:
        """Places that were asked for and have been pressed, seeds first."""
        return [[i for i in batch if i in self._outcome] for batch in self._batches]

    def key(self, i: int) -> str:
        """Hash of the press at place `i`."""
        return self._outcome[i].key

    @cached_property
    def sampling(self) -> SamplingByError:
        return self._make()

    def seeds(self) -> list[PressJob]:
        return self._asked(self._batches[0])

    def arrived(self, outcome: PressOutcome) -> None:
        if outcome.job in self._jobs:
            self._outcome[self._jobs[outcome.job]] = outcome

    def more(self) -> list[PressJob]:
        """The next batch's presses, if it is time for it."""
        jobs: list[PressJob] = []
        while not self.sampling.ended and self._due():
            jobs += self._next()
        return jobs

    def _due(self) -> bool:
        """Whether all that the next batch depends on has arrived."""
        return all(i in self._outcome for batch in self._batches[: self._known] for i in batch)

    @property
    def _known(self) -> int:
        """Batches that the next one depends on: all but the last, and that one too where there is nothing else new."""
        before_last = max(1, len(self._batches) - 1)
        return before_last if before_last > self._told else len(self._batches)

    def _next(self) -> list[PressJob]:
        known = self._known
        for batch in self._batches[self._told : known]:
            self._learn(batch)
        self._told = known
        if self._out_of_time():
            self.sampling.ended = "time budget spent"
            return []
        under_way = [i for batch in self._batches[known:] for i in batch]
        if not self._presses:
            self.sampling.ended = "no press that could become a node"
            return []
        nodes = fit_nodes(self._presses, self._knots, self.sampling.offset)
        count = self._width if under_way else 2 * self._width
        chosen = self.sampling.choose(nodes, self._index, [*under_way, *self._unusable], count).tolist()
        if not under_way and not self.sampling.near_enough:
            self._batches += [part for part in (chosen[: self._width], chosen[self._width :]) if part]
        else:
            chosen = chosen[: self._width]
            self._batches += [chosen] if chosen else []
        if not chosen and not self.sampling.ended:
            self.sampling.ended = "no place left to press"
        return self._asked(chosen)

    def _learn(self, batch: list[int]) -> None:
        for i in batch:
            press = self._press_of(self._outcome[i])
            if press is None:
                self._unusable.append(i)
            else:
                self._presses.append(press)
                self._index.append(i)

    def _asked(self, places: Sequence[int]) -> list[PressJob]:
        jobs = [self._job_of(i) for i in places]
        self._jobs.update(zip(jobs, places, strict=True))
        return jobs
