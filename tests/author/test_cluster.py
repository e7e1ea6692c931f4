# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Presses on a Dask cluster of real processes are the presses of this machine, though a worker is killed meanwhile."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from stand_in_solvers import BALL, AnyOrgan, jobs, quick

from palpate.author import cluster
from palpate.author.cluster import cluster_executor
from palpate.author.command_line import main
from palpate.author.errors import InputError, PalpateError
from palpate.author.organ_stage import OrganMesh, mesh_organ
from palpate.author.press_executor import press_executor
from palpate.author.press_jobs import PressJob, run_jobs
from palpate.author.scene import load_scene
from palpate.author.store import Store
from palpate.author.worker_fit import about_this_process, refusals

QUIET = {
    **os.environ,
    "PYTHONPATH": str(Path(__file__).parent),
    "OMP_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
}
OTHER_MECHANICS = """
import palpate.author.mechanics as mechanics
mechanics.mechanics_version = lambda: "0123456789"
"""
NO_PALPATE = "import sys; sys.modules['palpate'] = None\n"
AS_WORKER = "\nfrom distributed.cli.dask_worker import main; main()"


@contextmanager
def running(*command: str) -> Iterator[subprocess.Popen[str]]:
    process = subprocess.Popen(
        [sys.executable, *command], env=QUIET, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True
    )
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


@contextmanager
def scheduler() -> Iterator[str]:
    options = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard")
    with running("-m", "distributed.cli.dask_scheduler", *options) as process:
        assert process.stderr is not None
        for line in process.stderr:
            if found := re.search(r"Scheduler at:\s+(tcp://\S+)", line):
                break
        yield found[1]


@contextmanager
def worker(address: str, folder: Path, code: str = "") -> Iterator[subprocess.Popen[str]]:
    """Without a nanny, so that a killed worker stays away."""
    start = ("-c", code + AS_WORKER) if code else ("-m", "distributed.cli.dask_worker")
    options = ("--nthreads", "1", "--no-nanny", "--no-dashboard", "--local-directory", str(folder))
    with running(*start, address, *options) as process:
        assert process.stderr is not None
        for line in process.stderr:
            if "Registered to" in line:
                break
        yield process


@pytest.fixture(scope="module")
def organ(cube: Path, tmp_path_factory: pytest.TempPathFactory) -> OrganMesh:
    return mesh_organ(load_scene(cube), Store(tmp_path_factory.mktemp("work")))


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    with scheduler() as found:
        yield found


def test_a_cluster_finds_what_this_machine_finds_though_a_worker_is_killed(
    organ: OrganMesh, address: str, tmp_path: Path
) -> None:
    """Bit for bit the same forces when this was written; the bar leaves room for other linear algebra."""
    asked = [PressJob((x, 1e-3, 0.02), BALL, (8e-4,), "near_field", refinement=0.2) for x in (0.0, 2e-3)]
    with press_executor(2) as executor:
        here = run_jobs(organ, asked, Store(tmp_path / "here"), executor)
    for outcome in here:
        assert outcome.converged
        stages = outcome.values["stages"]
        assert set(stages) == {"organ", "patch", "far_field", "ladder"} and min(stages.values()) >= 0.0
        assert sum(stages.values()) == pytest.approx(outcome.values["cpu_seconds"], rel=0.2)
        assert 1e8 < outcome.values["peak_memory"] < 4e9

    store, told, lost = Store(tmp_path / "there"), [], []
    with worker(address, tmp_path), worker(address, tmp_path) as victim:
        with cluster_executor(address, told.append) as executor:

            def kill_in_the_middle() -> None:
                client = executor._client
                (at,) = [at for at, pid in client.run(os.getpid).items() if pid == victim.pid]
                while not client.processing()[at]:
                    time.sleep(0.1)
                time.sleep(1.0)
                lost.extend(client.processing()[at])
                os.kill(victim.pid, signal.SIGKILL)

            assert executor.workers == 2
            killer = threading.Thread(target=kill_in_the_middle)
            killer.start()
            there = run_jobs(organ, asked, store, executor)
            killer.join()
            assert executor.workers == 1
    assert lost and told == []
    assert [outcome.key for outcome in there] == [outcome.key for outcome in here]
    for one, other in zip(here, there, strict=True):
        assert set(one.arrays) == set(other.arrays)
        for name, found in one.arrays.items():
            scale = np.nanmax(np.abs(found), initial=1e-300)
            assert np.nanmax(np.abs(other.arrays[name] - found), initial=0.0) <= 1e-6 * scale, name
        assert other.values["unknowns"] == one.values["unknowns"]
        kept = store.read("press", other.key)
        assert kept is not None and np.array_equal(kept[0]["force_vector"], other.arrays["force_vector"])


def test_workers_without_this_palpate_are_refused_by_name(address: str, tmp_path: Path) -> None:
    with worker(address, tmp_path, OTHER_MECHANICS), worker(address, tmp_path, NO_PALPATE):
        with pytest.raises(InputError) as caught, cluster_executor(address):
            pass
    (problem,) = caught.value.problems
    assert problem.key == "--scheduler" and problem.value == address
    assert re.search(r"worker tcp://\S+ has other mechanics \(01234567, not \w{8}\)", problem.what)
    assert re.search(r"worker tcp://\S+ has no palpate", problem.what)
    assert "--nthreads 1" in problem.expected


def test_a_worker_of_another_version_or_with_threads_is_refused() -> None:
    same = about_this_process()
    assert refusals({"a": same}, {"a": 1}) == []
    (clause,) = refusals({"a": same, "b": {**same, "palpate": "0.0.1"}}, {"a": 1, "b": 1})
    assert clause.startswith("worker b has palpate 0.0.1, not ")
    (clause,) = refusals({"a": same}, {"a": 8})
    assert "8 threads" in clause


def test_a_worker_that_joins_later_with_other_mechanics_presses_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("distributed.get_worker", lambda: SimpleNamespace(address="tcp://late:1"))
    with pytest.raises(PalpateError, match=r"worker tcp://late:1 has other mechanics"):
        cluster.press_on_worker(quick, AnyOrgan(), jobs(1)[0], "0123456789")  # type: ignore[arg-type]


def test_a_cluster_that_goes_away_ends_the_run_and_takes_nothing_finished(
    address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "PATIENCE", 1.0)
    store, done = Store(tmp_path / "work"), []
    with worker(address, tmp_path) as only:
        with pytest.raises(PalpateError, match=r"had no worker for 1 s; .* goes on from it"):
            with cluster_executor(address) as executor:

                def kill(outcome) -> None:
                    done.append(outcome.key)
                    only.kill()

                run_jobs(AnyOrgan(), jobs(40, 0.05), store, executor, kill, quick)
    assert done and all(store.read("press", key) is not None for key in done)


def test_a_press_that_ends_worker_after_worker_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    from distributed.scheduler import KilledWorker

    presses = object.__new__(cluster.ClusterPresses)
    presses._address = "tcp://here:1"
    failure = presses._explained(KilledWorker("press", SimpleNamespace(address="w"), 3), jobs(2)[1])
    assert "the near_field press at (1000.0, 0.0, 0.0) mm" in str(failure) and "memory" in str(failure)


def test_no_scheduler_there_is_told_in_a_sentence(
    write_scene: Callable[..., Path], monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(cluster, "CONNECT", 0.3)
    asked = ["author", str(write_scene()), "--out", "out", "--scheduler"]
    assert main([*asked, "tcp://127.0.0.1:9"]) == 2
    assert "tcp://127.0.0.1:9" in (told := capfd.readouterr().err) and "no Dask scheduler answers" in told
    assert main([*asked, "nowhere"]) == 2
    assert "such as tcp://" in capfd.readouterr().err
    assert main([*asked, "tcp://127.0.0.1:9", "--workers", "2"]) == 2
    assert "--workers" in capfd.readouterr().err


def test_without_dask_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match=r"pip install distributed"), cluster_executor("tcp://127.0.0.1:9"):
        pass
