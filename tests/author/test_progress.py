# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Progress goes to stderr, in lines where there is no terminal; an interrupt ends long work cleanly."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from palpate.author.progress import ConsoleProgress, SilentProgress


def test_without_a_terminal_each_stage_and_each_tenth_is_a_line(capsys: pytest.CaptureFixture[str]) -> None:
    with ConsoleProgress() as progress:
        progress.stage("repairing")
        progress.stage("pressing", 40)
        for _ in range(40):
            progress.advance()
    captured = capsys.readouterr()
    lines = captured.err.splitlines()
    assert captured.out == ""
    assert lines[0] == "repairing"
    assert lines[1].startswith("repairing: done in")
    assert lines[2] == "pressing (40)"
    assert [line.split(",")[0] for line in lines[3:13]] == [f"pressing: {4 * k}/40" for k in range(1, 11)]
    assert lines[13].startswith("pressing: done in")


def test_silent_progress_says_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    progress = SilentProgress()
    progress.stage("pressing", 2)
    progress.advance(2, "both")
    captured = capsys.readouterr()
    assert captured.out + captured.err == ""


LONG_WORK = """
import sys, time, types
module = types.ModuleType("palpate.author.pipeline")
def author(scene, out, progress):
    progress.stage("pressing", 10)
    time.sleep(60)
module.author = author
sys.modules["palpate.author.pipeline"] = module
from palpate.author.command_line import main
sys.exit(main(["author", sys.argv[1], "--out", "out", "--json"]))
"""


def test_a_real_interrupt_ends_cleanly(write_scene: Callable[..., Path]) -> None:
    command = [sys.executable, "-c", LONG_WORK, str(write_scene())]
    # A shell that runs this in the background leaves SIGINT ignored, and children inherit that.
    default = lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)  # noqa: E731
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, preexec_fn=default) as process:
        assert process.stderr is not None
        for line in process.stderr:
            if line.startswith("pressing"):
                break
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)
    assert process.returncode == 130
    assert json.loads(out)["error"]["exit_code"] == 130
    assert "the same command goes on from there" in err
    assert "Traceback" not in err
