# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""No two living processes share a folder of compiled kernels; a dead one's folder is taken again."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

CLAIM = """
from palpate.author.kernel_cache import claim_kernel_cache
first = claim_kernel_cache()
assert claim_kernel_cache() == first
print(first, flush=True)
input()
"""


def claimed(home: Path) -> tuple[subprocess.Popen[str], str]:
    process = subprocess.Popen(
        [sys.executable, "-c", CLAIM], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        env={**os.environ, "XDG_CACHE_HOME": str(home)},
    )  # fmt: skip
    assert process.stdout is not None
    return process, process.stdout.readline().strip()


def test_a_folder_belongs_to_one_process_until_it_ends_however_it_ends(tmp_path: Path) -> None:
    one, first = claimed(tmp_path)
    two, second = claimed(tmp_path)
    assert Path(first).name == "warp-0" and Path(second).name == "warp-1"
    one.kill()
    one.communicate()
    three, third = claimed(tmp_path)
    assert third == first
    for process in (two, three):
        process.communicate("\n")
        assert process.returncode == 0


def test_where_nothing_can_be_kept_a_folder_goes_with_its_process(tmp_path: Path) -> None:
    (tmp_path / "palpate").write_text("in the way")
    process, folder = claimed(tmp_path)
    assert Path(folder).is_dir() and tmp_path not in Path(folder).parents
    process.communicate("\n")
    assert not Path(folder).exists()
