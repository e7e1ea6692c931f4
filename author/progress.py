# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Progress of long work: stages, counts and time left, on stderr."""

from __future__ import annotations

import sys
import time
from datetime import timedelta
from types import TracebackType
from typing import Protocol

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    ProgressColumn,
    SpinnerColumn,
    Task,
    TextColumn,
    TimeElapsedColumn,
)
from rich.progress import Progress as Bars
from rich.text import Text

__all__ = ["ConsoleProgress", "Progress", "SilentProgress"]

SILENCE = 60.0
"""s without a line, where lines are what people see, after which the next step tells again."""


class Progress(Protocol):
    """What long work reports to."""

    def stage(self, name: str, total: int | None = None) -> None:
        """The work before is done; `name` begins, with `total` steps when they can be counted."""
        ...

    def advance(self, count: int = 1, note: str = "", left: float | None = None) -> None:
        """`count` steps of the stage are done.

        Args:
            note: something about them.
            left: s to go, where the caller knows better than steps so far and time spent.
        """
        ...

    def say(self, sentence: str) -> None:
        """Something that people should know, and keep."""
        ...


class SilentProgress:
    """Reports nothing."""

    def stage(self, name: str, total: int | None = None) -> None: ...

    def advance(self, count: int = 1, note: str = "", left: float | None = None) -> None: ...

    def say(self, sentence: str) -> None: ...


class _TimeLeft(ProgressColumn):
    """What is left by the task's own reckoning."""

    def render(self, task: Task) -> Text:
        left = task.fields.get("left")
        return Text("" if left is None else f"{timedelta(seconds=round(left))} left")


class ConsoleProgress:
    """Bars on a terminal; elsewhere a line for each stage, for each tenth of a counted one, and after a minute."""

    def __init__(self) -> None:
        self._console = Console(file=sys.stderr)
        self._bars = Bars(
            SpinnerColumn(finished_text="[green]·"),
            TextColumn("{task.description}"),
            BarColumn(bar_width=24),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            _TimeLeft(),
            TextColumn("{task.fields[note]}"),
            console=self._console,
            disable=not self._console.is_terminal,
        )
        self._task = None
        self._total: int | None = None
        self._done = self._told = 0
        self._name, self._began = "", time.monotonic()
        self._spoke = self._began

    def __enter__(self) -> ConsoleProgress:
        self._bars.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self._end_stage()
        self._bars.stop()

    def stage(self, name: str, total: int | None = None) -> None:
        self._end_stage()
        self._name, self._total, self._began, self._done, self._told = name, total, time.monotonic(), 0, 0
        if self._console.is_terminal:
            self._task = self._bars.add_task(name, total=total, note="", left=None)
        else:
            self._say(name + (f" ({total})" if total else ""))

    def advance(self, count: int = 1, note: str = "", left: float | None = None) -> None:
        self._done += count
        spent = time.monotonic() - self._began
        if left is None and self._total and self._done:
            left = spent / self._done * (self._total - self._done)
        if self._task is not None:
            self._bars.update(self._task, advance=count, note=note, left=left)
        elif self._total and (
            self._done * 10 // self._total > self._told or time.monotonic() - self._spoke > SILENCE
        ):
            self._told = self._done * 10 // self._total
            told = [f"{self._name}: {self._done}/{self._total}", f"{spent:.0f} s", f"{left:.0f} s left", note]
            self._say(", ".join(part for part in told if part))

    def say(self, sentence: str) -> None:
        self._bars.console.print(sentence, markup=False, highlight=False, soft_wrap=True)

    def _end_stage(self) -> None:
        if self._task is not None:
            total = self._total or max(self._done, 1)
            self._bars.update(self._task, total=total, completed=total, note="", left=None)
            self._task = None
        elif self._name and not self._console.is_terminal:
            self._say(f"{self._name}: done in {time.monotonic() - self._began:.1f} s")
        self._name = ""

    def _say(self, line: str) -> None:
        self._spoke = time.monotonic()
        print(line, file=sys.stderr, flush=True)
