# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Inspecting, cooking and timing a field: what is told is what is inside, and damage is refused in one sentence."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from synthetic_field import synthetic_field

from palpate.author.command_line import main
from palpate.fields.cook import write_rfield
from palpate.fields.rfield_layout import SECTION_ALIGNMENT, SECTIONS, VERSION


@pytest.fixture(scope="module")
def rfield(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("field") / "ball.rfield"
    write_rfield(synthetic_field(), path)
    return path


def answer(arguments: list[str], capfd: pytest.CaptureFixture[str]) -> tuple[int, dict]:
    code = main([*arguments, "--json"])
    return code, json.loads(capfd.readouterr().out)


def test_a_cooked_field_tells_what_is_in_it(rfield: Path, capfd: pytest.CaptureFixture[str]) -> None:
    field = synthetic_field()
    code, told = answer(["inspect", str(rfield)], capfd)
    assert code == 0
    assert told["bytes"] == rfield.stat().st_size
    assert told["tool_name"] == field.tool.name
    assert told["tool_hash"] == field.tool.hash
    assert told["depth_max"] == pytest.approx(field.depth_max, rel=1e-6)
    assert told["geometry_blocks_stored"] == field.geometry.signed_distance.block_count


def test_the_sizes_of_the_sections_and_the_header_make_the_file(
    rfield: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    _, told = answer(["inspect", str(rfield)], capfd)
    assert [section["name"] for section in told["sections"]] == [section.name for section in SECTIONS]
    sizes = {section["name"]: section["bytes"] for section in told["sections"]}
    between = told["bytes"] - told["header_bytes"] - sum(sizes.values())
    assert 0 <= between < SECTION_ALIGNMENT * len(sizes)
    assert sizes["geometry_coefficients"] == 64 * 2 * told["geometry_blocks_stored"]
    assert told["version"] == VERSION
    main(["inspect", str(rfield)])
    assert "amplitude_coefficients" in capfd.readouterr().out


@pytest.mark.parametrize("kept", [0, 10, 100, 0.5, 0.999])
def test_a_truncated_field_is_refused_in_one_sentence(
    kept: float, rfield: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    data = rfield.read_bytes()
    path = tmp_path / "short.rfield"
    path.write_bytes(data[: kept if isinstance(kept, int) else int(kept * len(data))])
    assert main(["inspect", str(path), "--json"]) == 2
    captured = capfd.readouterr()
    (problem,) = json.loads(captured.out)["error"]["problems"]
    assert str(path) in problem["sentence"]
    assert captured.err.count("\n") == 1
    assert "Traceback" not in captured.err


def test_a_folder_that_is_no_asset_is_refused(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    for command in ("inspect", "cook"):
        code, told = answer([command, str(tmp_path)], capfd)
        assert code == 2
        assert told["error"]["problems"][0]["sentence"]
