# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Processes of this machine for presses, as a `concurrent.futures.Executor`.

A worker is a fresh process (spawned, never forked) with one BLAS thread and a Warp kernel cache of its own.  When one
dies, most often because memory ran out, the presses in flight go to new, fewer processes.
"""

from __future__ import annotations

import atexit
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import resource_tracker
from typing import Any, Protocol, TypeVar

from palpate.author.effort import press_memory, worker_count
from palpate.author.errors import PalpateError
from palpate.author.memory import available_memory

__all__ = [
    "PressProcesses",
    "core_count",
    "fitting_workers",
    "interrupts_held",
    "left_by_none",
    "one_blas_thread",
    "press_executor",
    "start_worker",
]

THREADS = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS")
"""What BLAS libraries read when they are loaded."""
PATIENCE = 1.0
"""s that workers get to end when they are told to, before they are killed."""


def core_count() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def fitting_workers(tets: int, fidelities: Iterable[str], asked: int | None = None) -> tuple[int, str]:
    """Workers for an organ of `tets` tetrahedra: as many as asked for, one a core when absent, and as fit in memory.

    Returns:
        how many, and a sentence where that is fewer than wanted.
    """
    return worker_count(press_memory(tets, fidelities), available_memory(), core_count(), asked)


@contextmanager
def press_executor(
    workers: int | None = None, tell: Callable[[str], None] = lambda sentence: None
) -> Iterator[PressProcesses]:
    """Processes for presses; none of them is left when this ends, however it ends.

    Args:
        workers: one for each core when absent.
        tell: gets a sentence when workers had to be given up.
    """
    with left_by_none(lambda: PressProcesses(workers or core_count(), tell)) as executor:
        yield executor


class Stoppable(Protocol):
    """An executor whose processes can be ended at once."""

    def stop(self) -> None: ...

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None: ...


Stopped = TypeVar("Stopped", bound=Stoppable)


@contextmanager
def left_by_none(make: Callable[[], Stopped]) -> Iterator[Stopped]:
    """An executor of processes with one BLAS thread; stopped at once where what it is used for ends badly."""
    with one_blas_thread():
        executor = make()
        try:
            yield executor
        except BaseException:
            executor.stop()
            raise
        else:
            executor.shutdown()


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Processes that are started meanwhile use one thread in BLAS libraries."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


class PressProcesses(Executor):
    """A pool of processes that outlives the death of some.

    Attributes:
        workers: processes at work; half of them after one has died, at least one.
    """

    def __init__(self, workers: int, tell: Callable[[str], None]) -> None:
        self.workers = workers
        self._tell = tell
        self._lock = threading.Lock()
        self._stopped = False
        self._pool = self._new_pool()

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """The future ends with PalpateError when even a single worker died of it."""
        outer: Future[Any] = Future()
        outer.set_running_or_notify_cancel()
        self._send(outer, (fn, args, kwargs))
        return outer

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        self._pool.shutdown(wait, cancel_futures=cancel_futures)

    def stop(self) -> None:
        """End all workers now, whatever they do."""
        with self._lock:
            self._stopped = True
            processes = list((getattr(self._pool, "_processes", None) or {}).values())
        for process in processes:
            process.terminate()
        end = time.monotonic() + PATIENCE
        for process in processes:
            process.join(max(0.0, end - time.monotonic()))
            if process.is_alive():
                process.kill()
        self._pool.shutdown(wait=False, cancel_futures=True)

    def _send(self, outer: Future[Any], work: tuple[Any, ...]) -> None:
        fn, args, kwargs = work
        pool = self._pool
        try:
            with interrupts_held():
                inner = pool.submit(fn, *args, **kwargs)
        except BrokenExecutor as error:
            self._died(pool, outer, work, error)
        else:
            inner.add_done_callback(lambda future: self._arrived(pool, future, outer, work))

    def _arrived(self, pool: Executor, inner: Future[Any], outer: Future[Any], work: tuple[Any, ...]) -> None:
        if inner.cancelled():
            outer.set_exception(PalpateError("the presses were stopped"))
        elif (error := inner.exception()) is None:
            outer.set_result(inner.result())
        elif isinstance(error, BrokenExecutor):
            self._died(pool, outer, work, error)
        else:
            outer.set_exception(error)

    def _died(self, pool: Executor, outer: Future[Any], work: tuple[Any, ...], error: BaseException) -> None:
        """Sends `work` to another pool, where there is one to try."""
        try:
            with self._lock:
                if pool is self._pool and not self._stopped and self.workers > 1:
                    before, self.workers = self.workers, max(1, self.workers // 2)
                    self._tell(
                        f"a worker process died (most often: memory ran out); going on with {self.workers} of {before}"
                    )
                    self._pool = self._new_pool()
                another = pool is not self._pool
            if another and not self._stopped:
                return self._send(outer, work)
            raise PalpateError(
                "a worker process died although it was the only one (most often: memory ran out, or the system ended "
                "it); what was finished before is still there, and the same command goes on from it. Free some "
                "memory, or give the organ a larger mesh_size"
            ) from error
        except BaseException as failure:  # a future that never ends would keep everybody waiting
            outer.set_exception(failure)

    def _new_pool(self) -> ProcessPoolExecutor:
        context = multiprocessing.get_context("spawn")
        return ProcessPoolExecutor(
            self.workers, mp_context=context, initializer=start_worker, initargs=(os.getpid(),)
        )


@contextmanager
def interrupts_held() -> Iterator[None]:
    """Processes that are started here never see Ctrl-C, which a terminal sends to all: their parent ends them."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # would otherwise start, and let interrupts through, in between
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def start_worker(parent: int) -> None:
    """What a process does before its first press."""
    from palpate.author.kernel_cache import claim_kernel_cache
    from palpate.author.press_solve import forget_organ

    atexit.register(forget_organ)
    threading.Thread(target=_follow_parent, args=(parent,), daemon=True).start()
    claim_kernel_cache()
    os.dup2(2, 1)  # solvers print; standard output belongs to the answer


def _follow_parent(parent: int) -> None:
    """End this process when the one that started it is gone, however it went."""
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)
