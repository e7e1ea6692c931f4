# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Memory is measured from what the system says, and workers are no more than it holds."""

from __future__ import annotations

import mmap
import sys
from pathlib import Path

import pytest

from palpate.author import memory
from palpate.author.effort import press_memory, worker_count

MEGABYTE = 1 << 20


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux can start a peak anew")
def test_each_press_has_a_peak_of_its_own() -> None:
    memory.restart_peak_memory()
    before = memory.peak_memory()
    with mmap.mmap(-1, 32 * MEGABYTE) as held:  # new pages, which an allocator may not give
        for page in range(0, len(held), mmap.PAGESIZE):
            held[page] = 1
        during = memory.peak_memory()
    assert during >= before + 0.9 * 32 * MEGABYTE
    memory.restart_peak_memory()
    assert memory.peak_memory() < during - 16 * MEGABYTE


def machine(folder: Path, available: int, limit: str, used: int = 0, cached: int = 0) -> None:
    (folder / "meminfo").write_text(
        f"MemTotal:  99999 kB\nMemAvailable:  {available // 1024} kB\nHugePages: 0\n"
    )
    (folder / "memory.max").write_text(limit)
    (folder / "memory.current").write_text(str(used))
    (folder / "memory.stat").write_text(f"anon 1\ninactive_file {cached}\n")


@pytest.mark.parametrize(
    ("limit", "used", "cached", "found"),
    [("max", 0, 0, 1000), ("600", 500, 200, 300), ("5000", 500, 0, 1000), ("100", 300, 0, 0)],
)
def test_a_container_s_limit_counts_where_it_is_the_tighter_one(
    limit: str, used: int, cached: int, found: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In MB.  What a container has only cached of files, it gets back."""
    size = limit if limit == "max" else str(int(limit) * MEGABYTE)
    machine(tmp_path, 1000 * MEGABYTE, size, used * MEGABYTE, cached * MEGABYTE)
    monkeypatch.setattr(memory, "PROC", tmp_path)
    monkeypatch.setattr(memory, "CGROUP", tmp_path)
    assert memory.available_memory() == found * MEGABYTE


def test_workers_are_no_more_than_memory_holds_and_that_is_said() -> None:
    assert worker_count(10**9, 10**10, cores=4) == (4, "")
    assert worker_count(10**9, None, cores=4, asked=8) == (8, "")
    count, said = worker_count(10**9, 2_600_000_000, cores=4)
    assert count == 2 and "4 workers may take 4.0 GB and 2.6 GB are free: 2" in said
    assert worker_count(10**9, 2_600_000_000, cores=4, asked=2) == (2, "")
    count, said = worker_count(10**9, 10**8, cores=4)
    assert count == 1 and "mesh_size" in said


def test_a_larger_organ_takes_more_memory_and_a_full_press_more_than_a_near_one() -> None:
    assert press_memory(20_000, ["near_field"]) > press_memory(2_000, ["near_field"])
    assert press_memory(20_000, ["full", "near_field"]) == press_memory(20_000, ["full"])
    assert press_memory(20_000, ["full"]) > press_memory(20_000, ["near_field"])
