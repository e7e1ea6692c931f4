# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Whatever ends a run, what it has finished is kept, nothing is left behind, and people are told how to go on."""

from __future__ import annotations

import errno
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from stand_in_solvers import AnyOrgan, deadly, deadly_once, jobs, quick

from palpate.author.errors import PalpateError
from palpate.author.press_executor import press_executor
from palpate.author.press_jobs import PressJob, run_jobs
from palpate.author.store import Store

HERE = Path(__file__).parent
ORGAN = AnyOrgan()

RUN = """
import sys
from pathlib import Path
from stand_in_solvers import AnyOrgan, jobs, quick
from palpate.author.press_executor import press_executor
from palpate.author.press_jobs import run_jobs
from palpate.author.store import Store

def told(outcome):
    print("kept", outcome.key[:32], outcome.values["pid"], flush=True)

def author(scene, out, workers, **options):
    with press_executor(workers) as executor:
        run_jobs(AnyOrgan(), jobs(20, 0.25), Store(Path(out) / "work"), executor, told, quick)
"""
ALONE = RUN + "author(None, sys.argv[1], 2)\n"
AS_COMMAND = (
    RUN
    + """
import types
pipeline = types.ModuleType("palpate.author.pipeline")
pipeline.author = author
sys.modules["palpate.author.pipeline"] = pipeline
from palpate.author.command_line import main
sys.exit(main(["author", sys.argv[2], "--out", sys.argv[1], "--workers", "2"]))
"""
)


def begun(script: str, *arguments: str) -> subprocess.Popen[str]:
    """A run in a process group of its own, as a shell starts one."""
    # A shell that runs this in the background leaves SIGINT ignored, and children inherit that.
    default = lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)  # noqa: E731
    return subprocess.Popen(
        [sys.executable, "-c", script, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        preexec_fn=default, start_new_session=True, env={**os.environ, "PYTHONPATH": str(HERE)},
    )  # fmt: skip


def first_kept(lines, count: int) -> tuple[list[str], set[int]]:
    """File stems and worker ids of the first `count` presses."""
    found = []
    for line in lines:
        if match := re.match(r"kept (\w+) (\d+)", line):
            found.append(match.groups())
        if len(found) == count:
            break
    return [stem for stem, _ in found], {int(pid) for _, pid in found}


def ended_within(seconds: float, pids: set[int]) -> bool:
    end = time.monotonic() + seconds
    while any(Path(f"/proc/{pid}/stat").exists() and not _is_zombie(pid) for pid in pids):
        if time.monotonic() > end:
            return False
        time.sleep(0.05)
    return True


def _is_zombie(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except OSError:
        return True


def test_a_killed_run_loses_only_presses_in_flight_and_leaves_no_worker(tmp_path: Path) -> None:
    with begun(ALONE, str(tmp_path)) as process:
        stems, workers = first_kept(process.stdout, 3)
        process.kill()
        process.communicate()
    assert ended_within(3.0, workers)
    store = Store(tmp_path / "work")
    kept = {path.stem: path.stat().st_mtime_ns for path in (store.folder / "press").glob("*.npz")}
    assert set(stems) <= set(kept) and len(kept) < 20
    with ThreadPoolExecutor(20) as executor:
        outcomes = run_jobs(ORGAN, jobs(20, 0.25), store, executor, solver=quick)
    assert {o.key[:32] for o in outcomes if not o.fresh} == set(kept)
    assert len(outcomes) == 20 and store.damaged == []
    assert all(
        store.path("press", o.key).stat().st_mtime_ns == kept[o.key[:32]] for o in outcomes if not o.fresh
    )


def test_ctrl_c_ends_at_once_and_says_what_is_kept_and_how_to_go_on(
    tmp_path: Path, write_scene: Callable[..., Path]
) -> None:
    scene, out = str(write_scene()), str(tmp_path / "my out")
    with begun(AS_COMMAND, out, scene) as process:
        _, workers = first_kept(process.stderr, 3)
        pressed = time.monotonic()
        os.killpg(process.pid, signal.SIGINT)  # a terminal interrupts the workers too
        told_out, told = process.communicate(timeout=30)
    assert time.monotonic() - pressed < 3.0
    assert process.returncode == 130
    assert ended_within(0.5, workers)
    kept = len(list((Path(out) / "work" / "press").glob("*.npz")))
    last = told.splitlines()[-1]
    assert last == (
        f"Interrupted: {kept} of 20 presses are kept. "
        f"The same command goes on from there: palpate author {scene} --out '{out}' --workers 2"
    )
    assert "Traceback" not in told and told_out == ""


def test_presses_outlive_a_worker_that_dies(tmp_path: Path) -> None:
    told: list[str] = []
    with press_executor(2, told.append) as executor:
        outcomes = run_jobs(ORGAN, jobs(6, 0.1), Store(tmp_path / "work"), executor, solver=deadly_once)
        assert executor.workers == 1
    assert [o.arrays["force_vector"][0, 0] for o in outcomes] == list(range(6))
    (sentence,) = told
    assert "worker process died" in sentence and "1 of 2" in sentence


def test_a_press_that_ends_every_worker_ends_the_run_with_a_sentence(tmp_path: Path) -> None:
    store = Store(tmp_path / "work")
    with pytest.raises(PalpateError, match=r"only one.*memory.*goes on from it"):
        with press_executor(1) as executor:
            run_jobs(ORGAN, jobs(3), store, executor, solver=deadly)
    assert store.read("press", jobs(3)[0].key(ORGAN)) is not None


def test_a_full_disk_is_told_in_a_sentence_and_takes_nothing_away(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store, save, saved = Store(tmp_path / "work"), np.savez, []

    def disk_of_two(file, **arrays):
        if len(saved) == 2:
            raise OSError(errno.ENOSPC, "No space left on device")
        saved.append(save(file, **arrays))

    monkeypatch.setattr(np, "savez", disk_of_two)
    with ThreadPoolExecutor(1) as executor:
        with pytest.raises(PalpateError, match=r"No space left on device.*still there"):
            run_jobs(ORGAN, jobs(4), store, executor, solver=quick)
        monkeypatch.undo()
        outcomes = run_jobs(ORGAN, jobs(4), store, executor, solver=quick)
    assert sorted(o.fresh for o in outcomes) == [False, False, True, True]


def truncate(path: Path, other: Path) -> None:
    path.write_bytes(path.read_bytes()[:-30])


def garble(path: Path, other: Path) -> None:
    path.write_bytes(b"garbage" * 100)


def swap(path: Path, other: Path) -> None:
    path.write_bytes(other.read_bytes())


@pytest.mark.parametrize("harm", [truncate, garble, swap])
def test_a_corrupt_record_is_set_aside_named_and_made_again(
    harm: Callable[[Path, Path], None], tmp_path: Path
) -> None:
    store, asked = Store(tmp_path / "work"), jobs(3)
    with ThreadPoolExecutor(1) as executor:
        first = run_jobs(ORGAN, asked, store, executor, solver=quick)
        path = store.path("press", first[1].key)
        harm(path, store.path("press", first[0].key))
        again = run_jobs(ORGAN, asked, store, executor, solver=quick)
    assert [o.fresh for o in again] == [False, True, False]
    assert store.damaged == [str(path)] and path.with_suffix(".damaged").is_file()
    assert np.array_equal(again[1].arrays["force_vector"], first[1].arrays["force_vector"])


def test_a_job_s_key_names_its_organ_place_tool_depths_and_fidelity() -> None:
    one = jobs(1)[0]
    changed = [
        PressJob((0.0, 1e-9, 0.0), one.tool, one.depths, one.fidelity),
        PressJob(one.contact_point, one.tool, (1e-3, 2e-3), one.fidelity),
        PressJob(one.contact_point, one.tool, one.depths, "full"),
    ]
    keys = {job.key(ORGAN) for job in [one, *changed]} | {one.key(AnyOrgan("another"))}
    assert len(keys) == 5


def test_a_record_with_a_stiffness_serves_a_job_that_needs_none_and_not_the_other_way_round(
    tmp_path: Path,
) -> None:
    with_it, without = jobs(1)[0], replace(jobs(1)[0], stiffness=False)
    assert with_it.key(ORGAN) != without.key(ORGAN)
    for name, first, second, fresh in (
        ("more", with_it, without, False),
        ("less", without, with_it, True),
    ):
        store = Store(tmp_path / name)
        with ThreadPoolExecutor(1) as executor:
            run_jobs(ORGAN, [first], store, executor, solver=quick)
            (outcome,) = run_jobs(ORGAN, [second], store, executor, solver=quick)
        assert outcome.fresh is fresh and outcome.job == second
        assert outcome.key == with_it.key(ORGAN)


def test_a_corrupt_record_with_a_stiffness_is_not_replaced_by_one_without(tmp_path: Path) -> None:
    store, with_it = Store(tmp_path / "work"), jobs(1)[0]
    without = replace(with_it, stiffness=False)
    with ThreadPoolExecutor(1) as executor:
        run_jobs(ORGAN, [with_it], store, executor, solver=quick)
        garble(store.path("press", with_it.key(ORGAN)), tmp_path)
        (outcome,) = run_jobs(ORGAN, [without], store, executor, solver=quick)
    assert outcome.fresh and outcome.key == without.key(ORGAN)
    assert store.read("press", with_it.key(ORGAN)) is None
