# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Workers of a Dask cluster for presses, as a `concurrent.futures.Executor`.

No file system is shared: the organ is sent once, as a result that Dask hands from worker to worker and makes again
when all that held it are gone; records come back through their futures; far fields stay in the worker's own scratch
folder.  A press whose worker dies is given to another one by Dask.  A worker must press as the caller would: its
palpate and the digest of its mechanics are compared, before the first press and again with each one, because workers
may join later.
"""

from __future__ import annotations

import logging
import os
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Executor, Future
from contextlib import contextmanager, suppress
from typing import Any

from palpate.author.errors import InputError, InputProblem, PalpateError
from palpate.author.mechanics import mechanics_version
from palpate.author.organ_stage import OrganMesh
from palpate.author.press_jobs import PressJob, Solver
from palpate.author.store import Result
from palpate.author.worker_fit import ABOUT, other_mechanics, refusals, right_workers

__all__ = ["ClusterPresses", "cluster_executor"]

CONNECT = 10.0
"""s to reach the scheduler and to see its first worker."""
PATIENCE = 60.0
"""s without scheduler or workers until the run is given up; workers that are started anew need some."""
KEPT = "what was finished before is still there, and the same command goes on from it"


@contextmanager
def cluster_executor(
    address: str, tell: Callable[[str], None] = lambda sentence: None
) -> Iterator[ClusterPresses]:
    """Workers of the Dask scheduler at `address`, such as "tcp://10.0.0.5:8786".

    Args:
        tell: gets a sentence about what could be better.

    Raises:
        InputError: Dask is not installed, no scheduler or no worker there, or a worker that does not fit.
    """
    loggers = [logging.getLogger(name) for name in ("distributed", "distributed.client")]
    levels = [logger.level for logger in loggers]
    client = executor = None
    try:
        client = _connected(address)
        for logger in loggers:  # what goes wrong is told in sentences, not in tracebacks
            logger.setLevel(logging.CRITICAL)
        about = client.run(eval, ABOUT, on_error="return")
        problems = refusals(about, client.nthreads())
        if problems:
            raise InputError(_problem(address, "; ".join(problems), right_workers()))
        slow = [at for at, told in about.items() if told["blas_threads"] != "1"]
        if slow:
            tell(f"{', '.join(slow)}: faster with OMP_NUM_THREADS=1, one core each")
        executor = ClusterPresses(client, address)
        yield executor
    finally:
        if executor is not None:
            executor.shutdown(wait=False)
        if client is not None:
            with suppress(Exception):  # a scheduler that is gone cannot be told goodbye
                client.close(timeout=2.0)
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)


class ClusterPresses(Executor):
    """Presses on a Dask client's workers; `submit` takes what `run_jobs` gives.

    Attributes:
        workers: how many there were a second ago.
    """

    def __init__(self, client: Any, address: str) -> None:
        self._client, self._address = client, address
        self.workers = len(client.nthreads())
        self._dask = client.get_executor(pure=False)
        self._organs: dict[str, Any] = {}
        self._waiting: set[Future[Result]] = set()
        self._lock = threading.Lock()
        self._closed = threading.Event()
        threading.Thread(target=self._watch, daemon=True).start()

    def submit(self, solver: Solver, mesh: OrganMesh, job: PressJob, folder: str) -> Future[Result]:  # type: ignore[override]
        """One press; `folder`, the caller's, is no concern of a worker."""
        inner = self._dask.submit(press_on_worker, solver, self._sent(mesh), job, mechanics_version())
        outer: Future[Result] = Future()
        outer.set_running_or_notify_cancel()
        with self._lock:
            self._waiting.add(outer)
        inner.add_done_callback(lambda future: self._arrived(future, outer, job))
        return outer

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Workers that press right now end that press; what it finds is thrown away where nobody waits."""
        self._closed.set()
        with suppress(Exception):
            self._dask.shutdown(wait=wait)

    def _sent(self, mesh: OrganMesh) -> Any:
        """The organ as a Dask future, on every worker at once: otherwise presses would gather where it is."""
        from distributed import wait

        if mesh.hash not in self._organs:
            organ = self._client.submit(_given, mesh, key=f"organ-{mesh.hash}")
            with suppress(
                Exception
            ):  # a worker that is lost meanwhile; the others get it with their first press
                wait([organ], timeout=CONNECT)
                self._client.replicate([organ])
            self._organs[mesh.hash] = organ
        return self._organs[mesh.hash]

    def _arrived(self, inner: Future[Result], outer: Future[Result], job: PressJob) -> None:
        try:
            result, failure = inner.result(), None
        except CancelledError:
            result, failure = (
                None,
                PalpateError(f"the scheduler at {self._address} is gone, or cancelled presses; {KEPT}"),
            )
        except Exception as error:
            result, failure = None, self._explained(error, job)
        self._end(outer, result, failure)

    def _end(self, outer: Future[Result], result: Result | None, failure: BaseException | None) -> None:
        with self._lock:
            if outer not in self._waiting:
                return
            self._waiting.remove(outer)
        if failure is None:
            outer.set_result(result)  # type: ignore[arg-type]
        else:
            outer.set_exception(failure)

    def _explained(self, error: Exception, job: PressJob) -> BaseException:
        from distributed.scheduler import KilledWorker

        if isinstance(error, KilledWorker):
            where = ", ".join(f"{1e3 * x:.1f}" for x in job.contact_point)
            return PalpateError(
                f"the {job.fidelity} press at ({where}) mm ended one worker after another at {self._address} (most "
                f"often: their memory limit, dask worker --memory-limit); {KEPT}"
            )
        return error

    def _watch(self) -> None:
        """Ends the wait for a cluster that is gone."""
        alive = time.monotonic()
        while not self._closed.wait(1.0):
            self.workers = self._count()
            if self.workers:
                alive = time.monotonic()
            if time.monotonic() - alive > PATIENCE:
                sentence = f"the cluster at {self._address} has had no worker for {PATIENCE:.0f} s; {KEPT}"
                for outer in list(self._waiting):
                    self._end(outer, None, PalpateError(sentence))

    def _count(self) -> int:
        """Workers; 0 where the scheduler does not say."""
        if self._client.status == "running":
            with suppress(Exception):  # Dask has many ways of saying that nobody is there
                return len(self._client.nthreads())
        return 0


def press_on_worker(solver: Solver, mesh: OrganMesh, job: PressJob, mechanics: str) -> Result:
    """Runs in a worker, one at a time.  Raises PalpateError where its mechanics are others."""
    from distributed import get_worker

    from palpate.author.kernel_cache import claim_kernel_cache

    worker = get_worker()
    if mechanics_version() != mechanics:
        raise PalpateError(
            f"{other_mechanics(worker.address, mechanics_version(), mechanics)}; {right_workers()}"
        )
    claim_kernel_cache()
    return solver(mesh, job, os.path.join(worker.local_directory, "palpate"))


def _given(mesh: OrganMesh) -> OrganMesh:
    return mesh


def _problem(address: str, what: str, expected: str) -> InputProblem:
    return InputProblem("", "--scheduler", address, f"cannot press: {what}", expected)


def _connected(address: str) -> Any:
    try:
        from distributed import Client
    except ImportError as error:
        what = "distributed, Dask's cluster part, is not installed here"
        raise InputError(
            _problem(address, what, "palpate's extra named cluster: pip install distributed")
        ) from error
    where = "the address that dask scheduler prints, such as tcp://10.0.0.5:8786"
    try:
        client = Client(address, timeout=CONNECT, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        what = f"no Dask scheduler answers there ({str(error) or type(error).__name__})"
        raise InputError(_problem(address, what, where)) from error
    try:
        client.wait_for_workers(1, timeout=CONNECT)
    except TimeoutError as error:
        client.close()
        raise InputError(
            _problem(address, "the scheduler has no worker", f"at least one: {right_workers()}")
        ) from error
    return client
