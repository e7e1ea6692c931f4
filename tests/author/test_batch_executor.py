# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Presses in threads of few processes: the same records, and what dies is done again by fewer."""

import os
import signal
import time
from pathlib import Path

import numpy as np
import pytest
from stand_in_solvers import AnyOrgan, deadly, deadly_once, jobs, meets, quick, raises

from palpate.author.batch_executor import batch_executor, device_named, threads_by_process
from palpate.author.command_line import main
from palpate.author.errors import InputError, PalpateError
from palpate.author.organ_stage import mesh_organ
from palpate.author.press_jobs import PressJob, run_jobs
from palpate.author.press_solve import solve
from palpate.author.scene import load_scene
from palpate.author.store import Store
from palpate.author.tool_stage import shape_of

ORGAN = AnyOrgan()


def test_each_thread_of_each_process_has_a_press_of_its_own(tmp_path: Path) -> None:
    with batch_executor("cpu", (2, 1)) as executor:
        assert executor.workers == 3
        found = [executor.submit(meets, 3, str(tmp_path)) for _ in range(3)]
        places = {tuple(future.result()) for future in found}
    assert len(places) == 3 and len({process for process, _ in places}) == 2
    assert os.getpid() not in {process for process, _ in places}


def test_more_jobs_than_threads_are_all_done_and_errors_come_back(tmp_path: Path) -> None:
    with batch_executor("cpu", (2,)) as executor:
        refused = executor.submit(raises, "this one")
        outcomes = run_jobs(ORGAN, jobs(7), Store(tmp_path), executor, solver=quick)
        with pytest.raises(ValueError, match="this one"):
            refused.result()
        with pytest.raises(AttributeError, match="Can't pickle local object"):
            executor.submit(lambda: None).result()
    assert [outcome.arrays["force_vector"][0, 0] for outcome in outcomes] == list(range(7))


def test_presses_outlive_a_process_that_dies(tmp_path: Path) -> None:
    told: list[str] = []
    with batch_executor("cpu", (4,), told.append) as executor:
        outcomes = run_jobs(ORGAN, jobs(6, 0.05), Store(tmp_path / "work"), executor, solver=deadly_once)
        assert executor.workers == 2
    assert len(outcomes) == 6
    assert told == ["a process with 4 presses died (most often: memory ran out); going on with 2"]


def test_a_press_that_ends_every_process_ends_the_run_with_a_sentence(tmp_path: Path) -> None:
    with (
        pytest.raises(PalpateError, match="although it did one press alone"),
        batch_executor("cpu", (2,)) as executor,
    ):
        run_jobs(ORGAN, jobs(3), Store(tmp_path), executor, solver=deadly)


def test_an_error_outside_ends_all_processes_at_once(tmp_path: Path) -> None:
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt), batch_executor("cpu", (2,)) as executor:
        pid = executor.submit(os.getpid).result()
        waiting = [executor.submit(time.sleep, 60.0) for _ in range(4)]
        raise KeyboardInterrupt
    assert time.monotonic() - begun < 30.0
    assert all(future.done() for future in waiting)
    with pytest.raises(ProcessLookupError):
        os.kill(pid, signal.SIG_DFL)


def test_a_device_that_is_not_there_is_refused_in_a_sentence() -> None:
    assert device_named("cpu") == "cpu"
    with pytest.raises(InputError) as refused:
        device_named("cuda:99")
    (problem,) = refused.value.problems
    assert problem.key == "--device" and problem.value == "cuda:99"
    assert "is no device that this machine has for presses" in problem.sentence
    with pytest.raises(ValueError, match="no device 'cuda:99'"), batch_executor("cuda:99", (2,)) as executor:
        executor.submit(os.getpid).result()


def test_options_of_batches_that_cannot_be_meant_are_refused(
    tmp_path: Path, write_scene, capsys: pytest.CaptureFixture[str]
) -> None:
    author = ["author", str(write_scene()), "--out", str(tmp_path / "out")]
    press = ["press", author[1], "--at", "0,0,0.04", "--tool", "ball", "--depth", "1 mm"]
    for arguments, sentence in (
        ([*author, "--device", "cuda:99"], "--device = "),
        ([*press, "--device", "cuda:99"], "is no device that this machine has"),
        ([*author, "--batch", "3"], "--batch = 3 says nothing without a device"),
        (
            [*author, "--device", "cpu", "--scheduler", "tcp://nowhere:1"],
            "either --device or --scheduler",
        ),
    ):
        assert main(arguments) == 2
        assert sentence in " ".join(capsys.readouterr().err.split())
    assert not (tmp_path / "out" / "work" / "press").exists()


def test_presses_are_spread_over_processes() -> None:
    assert threads_by_process(7, 3) == (3, 2, 2)
    assert threads_by_process(2, 5) == (1, 1)
    assert sum(threads_by_process(9)) == 9


def test_a_press_does_not_depend_on_who_presses_beside_it(tmp_path: Path, write_scene) -> None:
    """As far as its residual (1e-9) says."""
    coarse = ('surface = "block.stl"', 'surface = "block.stl"\nmesh_size = "15 mm"')
    scene = load_scene(write_scene("", coarse))
    mesh = mesh_organ(scene, Store(tmp_path / "mesh"))
    tool = shape_of(scene, scene.tool[0])
    places = ((0.0, 0.0, 0.04), (0.01, 0.005, 0.04))
    asked = [PressJob(place, tool, (1.6e-3,), "near_field", refinement=0.4) for place in places]
    with batch_executor("cpu", (2,)) as executor:
        arrays, values = executor.submit(solve, mesh, asked[0], str(tmp_path / "alone")).result()
        outcome, _ = run_jobs(mesh, asked, Store(tmp_path / "together"), executor)
    assert outcome.converged and values["converged"]
    for name in ("force_vector", "energy", "area", "sticking_stiffness"):
        scale = np.abs(arrays[name]).max()
        assert outcome.arrays[name] == pytest.approx(arrays[name], rel=0.0, abs=1e-7 * scale), name
