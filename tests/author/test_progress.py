# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Progress goes to stderr, in lines where there is no terminal."""

from __future__ import annotations

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


def test_without_a_terminal_slow_steps_are_told_every_minute(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    now = [100.0]
    monkeypatch.setattr("palpate.author.progress.time.monotonic", lambda: now[0])
    with ConsoleProgress() as progress:
        progress.stage("pressing", 1000)
        for _ in range(10):
            now[0] += 25.0
            progress.advance()
    told = [line.split(",")[:2] for line in capsys.readouterr().err.splitlines()[1:-1]]
    assert told == [
        ["pressing: 3/1000", " 75 s"],
        ["pressing: 6/1000", " 150 s"],
        ["pressing: 9/1000", " 225 s"],
    ]


def test_silent_progress_says_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    progress = SilentProgress()
    progress.stage("pressing", 2)
    progress.advance(2, "both")
    captured = capsys.readouterr()
    assert captured.out + captured.err == ""


def test_time_left_is_the_caller_s_where_it_knows_better(capsys: pytest.CaptureFixture[str]) -> None:
    with ConsoleProgress() as progress:
        progress.stage("pressing", 2)
        progress.advance(1, "3 presses/min", left=42.0)
        progress.say("a worker [process] died")
    lines = capsys.readouterr().err.splitlines()
    assert lines[1].endswith("42 s left, 3 presses/min")
    assert lines[2] == "a worker [process] died"
