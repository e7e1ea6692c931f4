# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a run for one tool says of the others."""

import json
from pathlib import Path

from palpate.author.one_tool import with_other_tools


def row(name: str, met: bool = True) -> dict:
    return {"name": name, "met": met}


def summary(*rows: dict, failures: tuple = ()) -> dict:
    return {"tools": list(rows), "tolerance_met": True, "failures": list(failures), "seconds": 1.0}


def test_rows_of_the_other_tools_stay_and_this_tool_s_is_new(tmp_path: Path) -> None:
    failed = {"tool": "a", "reason": "old"}, {"tool": "b", "reason": "old"}, {"tool": "gone", "reason": "old"}
    before = summary(row("a"), row("b", met=False), row("gone"), failures=failed)
    (tmp_path / "summary.json").write_text(json.dumps(before))
    now = with_other_tools(summary(row("b")), tmp_path, ["a", "b"])
    assert now["tools"] == [row("a"), row("b")] and now["not_judged"] == []
    assert now["failures"] == [failed[0]] and now["tolerance_met"]


def test_one_tool_s_success_is_not_another_s(tmp_path: Path) -> None:
    (tmp_path / "summary.json").write_text(json.dumps(summary(row("a", met=False))))
    assert not with_other_tools(summary(row("b")), tmp_path, ["a", "b"])["tolerance_met"]


def test_a_tool_that_no_summary_speaks_of_is_named_and_no_tolerance_is_met(tmp_path: Path) -> None:
    (tmp_path / "summary.json").write_text('{"tools": [')
    now = with_other_tools(summary(row("b")), tmp_path, ["a", "b"])
    assert now["not_judged"] == ["a"] and not now["tolerance_met"]
