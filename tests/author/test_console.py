# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a command answers where its folder cannot be."""

from __future__ import annotations

from pathlib import Path

import pytest

from palpate.author.console import Answer, answer_of


def test_a_file_where_a_folder_should_be_is_a_sentence_and_no_bug(
    folder: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (folder / "taken").write_text("")

    def work() -> Answer:
        (folder / "taken" / "pictures").mkdir(parents=True)
        return Answer({})

    assert answer_of(work, as_json=False) == 3
    told = capfd.readouterr().err
    assert str(folder / "taken") in told
    assert "Traceback" not in told and "bug" not in told
