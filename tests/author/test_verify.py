# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What `palpate verify` says of rows that are met, failed and not run."""

import json

import pytest

from palpate.author import verify
from palpate.author.console import plain
from palpate.fem_offline.verification.row import against, not_run

MET, FAILED = against("close", "law", 1.01, 1.0, 0.02), against("far", "law", 1.5, 1.0, 0.02)
ABSENT = not_run(
    "other code", "ccx", 0.02, "CalculiX is not installed (Debian: apt-get install calculix-ccx)"
)


@pytest.mark.parametrize(
    ("rows", "code", "words"),
    [
        ([MET], 0, "1 of 1 rows met"),
        ([MET, FAILED], 1, "1 of 2 rows met"),
        ([MET, ABSENT], 0, "1 of 2 rows met, 1 not run: CalculiX is not installed"),
    ],
)
def test_a_row_that_was_not_run_is_neither_met_nor_failed(monkeypatch, rows, code, words):
    monkeypatch.setattr(verify, "table", lambda everything: iter(rows))
    told = []
    answer = verify.verify(progress=told.append)
    assert answer.exit_code == code
    assert words in str(answer.shown[-1])
    assert [line[:7].strip() for line in told] == [
        "not run" if row.missing else "met" if row.met else "NOT MET" for row in rows
    ]
    result = json.loads(json.dumps(plain(answer.result), allow_nan=False))
    assert [row["met"] for row in result["rows"]] == [row.met for row in rows]
    assert result["not_run"] == sum(bool(row.missing) for row in rows)
