# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Presses in batches, as a `concurrent.futures.Executor`: a few processes, each with many presses in threads.

The presses of a process evaluate their elements in common launches on one device (fem_offline/batch.py) and solve
their linear systems on the cores.  Python runs one thread of a process at a time, so more cores want more processes.
A process that dies, most often because memory ran out, is followed by one with half its threads.
"""

from __future__ import annotations

import math
import multiprocessing
import os
import sys
import threading
import traceback
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, InvalidStateError, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from typing import Any

from palpate.author.errors import InputError, InputProblem, PalpateError
from palpate.author.press_executor import core_count, interrupts_held, left_by_none, start_worker

__all__ = ["PRESSES_A_CORE", "BatchProcesses", "batch_executor", "device_named", "threads_by_process"]

CORES_A_PROCESS = 4
"""Cores that the threads of one process are expected to fill."""
PRESSES_A_CORE = 2
"""Presses at once: some wait for the device while others solve.  Not measured where there is a GPU."""
SWITCH = 2e-4
"""s after which a thread lets another one run; with Python's own 5 ms, each answer of the device waits that long."""
PATIENCE = 2.0
"""s that processes get to end when they are told to, before they are killed."""

REFUSED = 0
"""Number of what a process says that cannot start."""

Work = tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]


def device_named(text: str) -> str:
    """`text`.  Raises InputError where this machine has no such device."""
    from palpate.fem_offline.warp_session import devices

    known = devices()
    if text in known or (text == "cuda" and len(known) > 1):
        return text
    what = "is no device that this machine has for presses"
    expected = (
        "one of " + ", ".join(known) if len(known) > 1 else "cpu; cuda needs an NVIDIA GPU and its driver"
    )
    raise InputError(InputProblem("", "--device", text, what, expected))


def threads_by_process(presses: int, processes: int | None = None) -> tuple[int, ...]:
    """Threads of each process.

    Args:
        presses: at once, in all.
        processes: one for every four cores when absent; no more than presses.
    """
    processes = min(presses, processes or math.ceil(core_count() / CORES_A_PROCESS))
    return tuple(presses // processes + (k < presses % processes) for k in range(processes))


@contextmanager
def batch_executor(
    device: str, threads: tuple[int, ...], tell: Callable[[str], None] = lambda sentence: None
) -> Iterator[BatchProcesses]:
    """Processes that press in batches; none of them is left when this ends, however it ends.

    Args:
        device: from `device_named`.
        threads: of each process, from `threads_by_process`.
        tell: gets a sentence when a process had to be followed by a smaller one.
    """
    with left_by_none(lambda: BatchProcesses(device, threads, tell)) as executor:
        yield executor


class BatchProcesses(Executor):
    """Gives each process as many presses at once as it has threads."""

    def __init__(self, device: str, threads: tuple[int, ...], tell: Callable[[str], None]) -> None:
        self.device = device
        self._tell = tell
        self._lock = threading.RLock()
        self._waiting: deque[tuple[Future[Any], Work]] = deque()
        self._closed = False
        self._processes = [_Process(self, count) for count in threads]

    @property
    def workers(self) -> int:
        """Presses at once."""
        return sum(process.threads for process in self._processes)

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """The future ends with PalpateError when a process died that pressed nothing else."""
        future: Future[Any] = Future()
        with self._lock:
            if self._closed:
                raise RuntimeError("the executor is shut down")
            self._waiting.append((future, (fn, args, kwargs)))
        self._feed()
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        with self._lock:
            self._closed = True
            while cancel_futures and self._waiting:
                self._waiting.popleft()[0].cancel()
        self._feed()
        while wait and (left := list(self._processes)):
            left[0].reader.join()

    def stop(self) -> None:
        """End all processes now, whatever they do."""
        with self._lock:
            self._closed = True
            futures = [future for future, _ in self._waiting]
            self._waiting.clear()
            processes, self._processes = self._processes, []
        for process in processes:
            futures += process.end()
        for future in futures:
            if not future.cancel():
                with suppress(InvalidStateError):  # it came in just now
                    future.set_exception(PalpateError("the presses were stopped"))

    def _feed(self) -> None:
        """Sends what waits to threads that are free; lets processes end that are needed no more."""
        with self._lock:
            while self._waiting and (free := [p for p in self._processes if len(p.pressing) < p.threads]):
                future, work = self._waiting.popleft()
                if future.running() or future.set_running_or_notify_cancel():
                    min(free, key=lambda process: len(process.pressing) / process.threads).send(future, work)
            for process in self._processes if self._closed and not self._waiting else ():
                if not process.pressing:
                    process.close()

    def _ended(self, process: _Process) -> None:
        """A process is gone: as it was told, or with presses that others have to do."""
        with self._lock:
            if process not in self._processes:
                return
            k = self._processes.index(process)
            left = list(process.pressing.values())
            if self._closed and not left and not self._waiting:
                del self._processes[k]
                return
            if process.threads == 1 or process.refusal is not None:
                self._give_up(k, left, process.refusal)
            else:
                half = process.threads // 2
                self._tell(
                    f"a process with {process.threads} presses died (most often: memory ran out); going on with {half}"
                )
                self._waiting.extendleft(reversed(left))
                self._processes[k] = _Process(self, half)
        self._feed()

    def _give_up(self, k: int, left: list[tuple[Future[Any], Work]], refusal: BaseException | None) -> None:
        del self._processes[k]
        error = refusal or PalpateError(
            "a process died although it did one press alone (most often: memory ran out, or the system ended it); "
            "what was finished before is still there, and the same command goes on from it. Free some memory, or give "
            "the organ a larger mesh_size"
        )
        if not self._processes:
            left = left + list(self._waiting)
            self._waiting.clear()
        for future, _ in left:
            if future.running() or future.set_running_or_notify_cancel():
                future.set_exception(error)


class _Process:
    """One process, as its parent sees it."""

    def __init__(self, owner: BatchProcesses, threads: int) -> None:
        self.owner, self.threads = owner, threads
        self.pressing: dict[int, tuple[Future[Any], Work]] = {}
        self.refusal: BaseException | None = None
        self._count = 0
        context = multiprocessing.get_context("spawn")
        self._connection, other = context.Pipe()
        self._process = context.Process(target=_press, args=(other, owner.device, threads, os.getpid()))
        with interrupts_held():
            self._process.start()
        other.close()
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def send(self, future: Future[Any], work: Work) -> None:
        self._count += 1
        self.pressing[self._count] = (future, work)
        try:
            self._connection.send((self._count, work))
        except OSError:
            pass  # it is gone: the reader finds out, and another one gets the work
        except Exception as error:  # it cannot be pickled
            del self.pressing[self._count]
            future.set_exception(error)

    def close(self) -> None:
        with suppress(OSError):
            self._connection.send(None)

    def end(self) -> list[Future[Any]]:
        """Kills; gives the futures that will never be."""
        self._process.terminate()
        self._process.join(PATIENCE)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        return [future for future, _ in self.pressing.values()]

    def _read(self) -> None:
        with suppress(EOFError, OSError):
            while True:
                number, result, error = self._connection.recv()
                if number == REFUSED:
                    self.refusal = error
                    continue
                with self.owner._lock:
                    future, _ = self.pressing.pop(number)
                if error is None:
                    future.set_result(result)
                else:
                    future.set_exception(error)
                self.owner._feed()
        self._process.join()
        self.owner._ended(self)


def _press(connection: Connection, device: str, threads: int, parent: int) -> None:
    """The process: takes work, gives (number, result, error) in whatever order it is done."""
    start_worker(parent)
    sys.setswitchinterval(SWITCH)
    from palpate.fem_offline.batch import Batch

    sending = threading.Lock()

    def do(number: int, work: Work) -> None:
        fn, args, kwargs = work
        try:
            with batch.member():
                answer = (number, fn(*args, **kwargs), None)
        except BaseException as error:
            error.add_note(traceback.format_exc())
            answer = (number, None, error)
        with sending:
            try:
                connection.send(answer)
            except (TypeError, AttributeError, ValueError) as error:  # it cannot be pickled
                connection.send((number, None, PalpateError(f"an answer could not be sent: {error}")))

    try:
        batch = Batch(device)
    except Exception as error:
        return connection.send((REFUSED, None, error))
    with batch, ThreadPoolExecutor(threads) as pool:
        while (message := connection.recv()) is not None:
            pool.submit(do, *message)
