# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Commands as people and scripts meet them: exit codes, one JSON object on stdout, sentences on stderr."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import types
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typer

from palpate.author.command_line import app, main
from palpate.author.errors import InputError, InputProblem, PalpateError, ToleranceNotMet, exit_code
from palpate.fem_offline.errors import SurfaceError
from palpate.fields.field_error import FieldError
from palpate.runtime import RuntimeFailure

RESULT: dict[str, Any] = {
    "asset": Path("out/block"),
    "tools": [
        {
            "name": "ball",
            "rfield": Path("out/block/ball.rfield"),
            "bytes": np.int64(4096),
            "nodes": 20,
            "presses": 28,
            "failed": 0,
            "force_error": {"p50": np.float64(0.01), "p95": 0.02, "max": float("nan")},
        }
    ],
    "seconds": 12.0,
    "cpu_seconds": 20.0,
    "tolerance_met": True,
}


@pytest.fixture
def pipeline(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[Callable[[], Any]], None]]:
    """Puts a stand-in where the main job's module is."""

    def put(work: Callable[[], Any]) -> None:
        module = types.ModuleType("palpate.author.pipeline")
        module.author = lambda scene, out, **options: work()  # type: ignore[attr-defined]
        monkeypatch.setitem(sys.modules, "palpate.author.pipeline", module)

    yield put


def json_answer(captured: Any) -> dict[str, Any]:
    """The one JSON object on stdout; fails when anything else stands there."""
    assert captured.out.count("\n") == 1
    answer = json.loads(captured.out)
    assert isinstance(answer, dict)
    return answer


def test_stdout_holds_one_json_object_whatever_libraries_print(
    write_scene: Callable[..., Path], pipeline: Any, capfd: pytest.CaptureFixture[str]
) -> None:
    def noisy() -> dict[str, Any]:
        print("printed by Python")
        os.write(1, b"printed by native code\n")
        subprocess.run(["echo", "printed by a child"], check=True)
        return RESULT

    pipeline(noisy)
    assert main(["author", str(write_scene()), "--out", "out", "--json"]) == 0
    captured = capfd.readouterr()
    answer = json_answer(captured)
    assert answer["tools"][0]["force_error"] == {"p50": 0.01, "p95": 0.02, "max": None}
    assert answer["asset"] == "out/block"
    for noise in ("printed by Python", "printed by native code", "printed by a child"):
        assert noise in captured.err


def test_a_tolerance_that_is_not_met_ends_with_1_and_the_whole_answer(
    write_scene: Callable[..., Path], pipeline: Any, capfd: pytest.CaptureFixture[str]
) -> None:
    pipeline(lambda: {**RESULT, "tolerance_met": False})
    assert main(["author", str(write_scene()), "--out", "out", "--json"]) == 1
    assert json_answer(capfd.readouterr())["tolerance_met"] is False


def test_without_json_people_get_text(
    write_scene: Callable[..., Path], pipeline: Any, capfd: pytest.CaptureFixture[str]
) -> None:
    pipeline(lambda: RESULT)
    assert main(["author", str(write_scene()), "--out", "out"]) == 0
    assert "tolerance met" in capfd.readouterr().out


def test_wrong_input_ends_with_2_every_sentence_and_no_traceback(
    write_scene: Callable[..., Path], capfd: pytest.CaptureFixture[str]
) -> None:
    path = write_scene("", ('radius = "5 mm"', 'radius = "5 kPa"'), ('name = "block"', "name = 3"))
    assert main(["plan", str(path), "--json"]) == 2
    captured = capfd.readouterr()
    problems = json_answer(captured)["error"]["problems"]
    assert {problem["key"] for problem in problems} == {"scene.name", "tool[0].radius"}
    assert captured.err.count("\n") == 2
    assert 'tool[0].radius = "5 kPa" is a pressure, not a length; expected a length' in captured.err
    assert "Traceback" not in captured.err


def test_what_this_version_cannot_do_ends_with_2(
    complete_scene: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    asked = complete_scene.read_text().replace("effects = [", 'effects = ["cutting", ', 1)
    complete_scene.write_text(asked)
    assert main(["author", str(complete_scene), "--out", "out"]) == 2
    assert "not yet in this version; supported:" in capfd.readouterr().err


def test_an_interrupt_ends_with_130_and_says_how_to_go_on(
    write_scene: Callable[..., Path], pipeline: Any, capfd: pytest.CaptureFixture[str]
) -> None:
    def interrupted() -> None:
        raise KeyboardInterrupt

    pipeline(interrupted)
    assert main(["author", str(write_scene()), "--out", "out", "--json"]) == 130
    captured = capfd.readouterr()
    assert json_answer(captured)["error"]["exit_code"] == 130
    assert "The same command goes on from there: palpate author" in captured.err
    assert "Traceback" not in captured.err


def test_a_bug_ends_with_3_and_its_traceback(
    write_scene: Callable[..., Path], pipeline: Any, capfd: pytest.CaptureFixture[str]
) -> None:
    pipeline(lambda: 1 / 0)
    assert main(["author", str(write_scene()), "--out", "out", "--json"]) == 3
    captured = capfd.readouterr()
    assert "ZeroDivisionError" in json_answer(captured)["error"]["sentence"]
    assert "Traceback" in captured.err


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (InputError(InputProblem("a.toml", "b", 1, "is wrong")), 2),
        (SurfaceError("is open", "liver.obj", "a closed surface"), 2),
        (FieldError("is truncated"), 2),
        (ToleranceNotMet("p95 is 4 %"), 1),
        (PalpateError("out of memory"), 3),
        (KeyboardInterrupt(), 130),
        (ValueError("a bug"), 3),
    ],
)
def test_every_error_has_its_exit_code(error: BaseException, code: int) -> None:
    assert exit_code(error) == code


def test_what_is_wrong_with_a_file_is_no_bug() -> None:
    """Whatever palpate_status says of the bytes of a file, from PALPATE_TRUNCATED on, is a wrong input."""
    header = (Path(__file__).parents[2] / "runtime_cpp" / "include" / "palpate" / "palpate.h").read_text()
    body = re.search(r"typedef enum palpate_status \{(.*?)\}", header, re.DOTALL)
    assert body
    status = {name: int(number) for name, number in re.findall(r"PALPATE_(\w+) = (\d+)", body[1])}
    codes = {name: exit_code(RuntimeFailure(number, "")) for name, number in status.items()}
    assert len(codes) > 10 and {name for name, code in codes.items() if code == 2} == {
        name for name, number in status.items() if number >= status["TRUNCATED"]
    }


@pytest.mark.parametrize(
    "arguments",
    [["plan"], ["plan", "a.toml", "--nonsense"], ["nonsense"], ["validate", "asset", "--points", "many"]],
)
def test_wrong_arguments_end_with_2_and_still_one_json_object(
    arguments: list[str], capfd: pytest.CaptureFixture[str]
) -> None:
    assert main([*arguments, "--json"]) == 2
    captured = capfd.readouterr()
    assert json_answer(captured)["error"]["exit_code"] == 2
    assert captured.err


@pytest.mark.parametrize(
    ("options", "key"),
    [
        (["--at", "0,0", "--depth", "3 mm"], "--at"),
        (["--at", "0,0,3 kPa", "--depth", "3 mm"], "--at"),
        (["--at", "0,0,0", "--depth", "-3 mm"], "--depth"),
        (["--at", "-10 mm,0,0.04", "--depth", "3 mm", "--lateral", "1 mm"], "--lateral"),
        (["--at", "-0.01,0,0.04", "--depth", "0.003", "--fidelity", "lineal"], "--fidelity"),
    ],
)
def test_a_press_tells_which_option_is_wrong(
    options: list[str],
    key: str,
    write_scene: Callable[..., Path],
    capfd: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    module = types.ModuleType("palpate.author.press_command")
    module.press = lambda *a, **k: {}  # type: ignore[attr-defined]
    module.PressFiles = module.press_lines = module.press  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "palpate.author.press_command", module)
    assert main(["press", str(write_scene()), "--tool", "ball", *options, "--json"]) == 2
    assert [problem["key"] for problem in json_answer(capfd.readouterr())["error"]["problems"]] == [key]


def test_a_press_is_asked_for_in_si(
    write_scene: Callable[..., Path], capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: dict[str, Any] = {}

    def press(scene: Any, **options: Any) -> dict[str, Any]:
        asked.update(options)
        return {"depth": np.zeros(1), "converged": True}

    module = types.ModuleType("palpate.author.press_command")
    module.press = press  # type: ignore[attr-defined]
    module.PressFiles = lambda *paths: paths  # type: ignore[attr-defined]
    module.press_lines = lambda result: ""  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "palpate.author.press_command", module)
    options = ["--at=-10 mm,0,0.04", "--tool", "ball", "--depth", "3 mm", "--lateral", "1 mm,-2 mm"]
    assert main(["press", str(write_scene()), *options, "--json"]) == 0
    assert json_answer(capfd.readouterr()) == {"depth": [0.0], "converged": True}
    assert asked["at"] == pytest.approx((-0.01, 0.0, 0.04))
    assert asked["depth"] == pytest.approx(0.003)
    assert asked["lateral"] == pytest.approx((0.001, -0.002))
    assert asked["fidelity"] == "near_field"


@pytest.mark.parametrize("command", ["inspect", "cook", "bench", "validate"])
def test_what_does_not_exist_is_told(command: str, capfd: pytest.CaptureFixture[str]) -> None:
    assert main([command, "absent", "--json"]) == 2
    assert "does not exist" in json_answer(capfd.readouterr())["error"]["problems"][0]["sentence"]


def test_the_entry_point_needs_neither_usd_nor_warp_to_read_a_scene(write_scene: Callable[..., Path]) -> None:
    code = (
        "import sys; from palpate.author.command_line import main; "
        f"code = main(['plan', {str(write_scene())!r}, '--json']); "
        "assert not {'pxr', 'warp', 'pyvista', 'pymeshlab'} & set(sys.modules); sys.exit(code)"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    assert json.loads(ended.stdout)["scene"] == "block"


def test_only_commands_that_work_are_registered() -> None:
    names = {info.name or info.callback.__name__ for info in app.registered_commands if info.callback}
    planned = set("plan author press verify cook validate certify tradeoff extremes".split())
    planned |= {"view", "inspect", "replay", "bench", "doctor", "schema", "scan", "detect", "report", "rigid"}
    assert names <= planned
    assert {"plan", "author", "press", "cook", "validate", "inspect", "bench", "doctor"} <= names


def test_no_help_text_holds_brackets_which_the_terminal_would_take_for_markup():
    commands = typer.main.get_command(app).commands.values()  # type: ignore[attr-defined]
    told = [(command.name, command.help or "") for command in commands]
    told += [
        (command.name, getattr(one, "help", None) or "") for command in commands for one in command.params
    ]
    assert len(told) > 30
    assert [row for row in told if "[" in row[1]] == []
