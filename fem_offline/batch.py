# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Many presses in one process, one thread each, whose evaluations on a device are gathered into common launches.

A press is written as if it were alone.  Where it needs the device, it asks `together(function, argument)`; in a
thread that is a member of a batch, requests of all members are collected and

    answers = function([argument of each that asked])

runs once, in the batch's own thread: the only one that touches the device.  What has been asked for while one launch
ran goes into the next (as databases commit in groups), so launches grow with the load by themselves; `gather` makes
the thread wait for members that are still at work on their linear systems.

Whatever a member asks for, its answer does not depend on who asks beside it.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any, TypeVar

from palpate.fem_offline.warp_session import devices

__all__ = ["Batch", "current_device", "together"]

A = TypeVar("A")
R = TypeVar("R")
Together = Callable[[Sequence[A]], Sequence[R]]

_current: ContextVar[Batch | None] = ContextVar("batch", default=None)


def current_device() -> str:
    """Warp device of this thread's batch; "cpu" outside one."""
    batch = _current.get()
    return "cpu" if batch is None else batch.device


def together(function: Together[A, R], argument: A) -> R:
    """function([argument])[0], in one call with what other members of this thread's batch ask of the function."""
    batch = _current.get()
    return function([argument])[0] if batch is None else batch.ask(function, argument)


class Batch:
    """Gathers what its members ask for.

    Args:
        device: Warp device of what its members build.
        gather: s; how long the first request of a launch waits for other members' at most.  0: until the device is
            free.

    Attributes:
        launches: calls of gathered functions.  requests: arguments in them.
        busy: s spent in them.

    Raises:
        ValueError: there is no such device.
    """

    def __init__(self, device: str = "cpu", gather: float = 0.0) -> None:
        known = devices()
        if device not in known and not (device == "cuda" and len(known) > 1):
            raise ValueError(f"this machine has no device {device!r}; it has {', '.join(known)}")
        self.device = (
            known[1] if device == "cuda" else device
        )  # by name: every thread has a current GPU of its own
        self.gather = gather
        self.launches, self.requests, self.busy = 0, 0, 0.0
        self._changed = threading.Condition()
        self._members = 0
        self._waiting: list[tuple[Together[Any, Any], Any, Future[Any]]] = []
        self._closed = False
        self._thread = threading.Thread(target=self._serve, name="palpate-batch", daemon=True)
        self._thread.start()

    def __enter__(self) -> Batch:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def close(self) -> None:
        """Answer what is asked, then end.  Later requests raise RuntimeError."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        self._thread.join()

    @contextmanager
    def member(self) -> Iterator[None]:
        """Within it, this thread's element systems are on the batch's device and evaluated together with others'."""
        token = _current.set(self)
        self._count(1)
        try:
            yield
        finally:
            self._count(-1)
            _current.reset(token)

    def ask(self, function: Together[A, R], argument: A) -> R:
        """The function's answer for one argument; waits for it.  Raises what the function raises for it."""
        answer: Future[R] = Future()
        with self._changed:
            if self._closed:
                raise RuntimeError("the batch is closed")
            self._waiting.append((function, argument, answer))
            self._changed.notify_all()
        return answer.result()

    def _count(self, change: int) -> None:
        with self._changed:
            self._members += change
            self._changed.notify_all()

    def _serve(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._waiting or self._closed)
                if not self._waiting:
                    return
                end = time.perf_counter() + self.gather
                while len(self._waiting) < self._members and not self._closed:
                    left = end - time.perf_counter()
                    if left <= 0.0 or not self._changed.wait(left):
                        break
                taken, self._waiting = self._waiting, []
            begun = time.perf_counter()
            self._answer(taken)
            self.busy += time.perf_counter() - begun

    def _answer(self, taken: list[tuple[Together[Any, Any], Any, Future[Any]]]) -> None:
        for function in dict.fromkeys(function for function, _, _ in taken):
            asked = [(argument, answer) for wanted, argument, answer in taken if wanted == function]
            self.launches += 1
            self.requests += len(asked)
            try:
                found = list(function([argument for argument, _ in asked]))
            except BaseException as error:
                if len(asked) == 1:
                    asked[0][1].set_exception(error)
                else:  # only who asked for what cannot be answered hears of it
                    for one in asked:
                        self._answer([(function, *one)])
            else:
                for (_, answer), value in zip(asked, found, strict=True):
                    answer.set_result(value)
