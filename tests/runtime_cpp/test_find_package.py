# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""C and C++ programs find the installed wheel with find_package, link, run, and feel what Python feels."""

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from palpate.author.replay import replay
from palpate.runtime import Session, cmake_folder

EXAMPLES = Path(__file__).parents[2] / "runtime_cpp" / "examples"

PROJECT = """
cmake_minimum_required(VERSION 3.22)
project(host LANGUAGES C CXX)
find_package(palpate 0.1 REQUIRED)
add_executable(host press_along_a_line.c)
target_link_libraries(host PRIVATE palpate::palpate)
add_executable(loop servo_loop.cpp)
target_link_libraries(loop PRIVATE palpate::palpate)
"""

pytestmark = pytest.mark.skipif(
    shutil.which("cmake") is None or shutil.which("c++") is None, reason="needs cmake and a compiler"
)


@pytest.fixture(scope="module")
def built(tmp_path_factory, plane):
    """The folder of the examples, built against the installed package, and of plane.rfield."""
    folder = tmp_path_factory.mktemp("host")
    (folder / "CMakeLists.txt").write_text(PROJECT)
    for name in ("press_along_a_line.c", "servo_loop.cpp"):
        shutil.copy(EXAMPLES / name, folder)
    (folder / "plane.rfield").write_bytes(plane.data)
    shown(folder, "cmake", "-S", ".", "-B", "build", f"-DCMAKE_PREFIX_PATH={cmake_folder()}")
    shown(folder, "cmake", "--build", "build")
    return folder


def shown(folder, *command):
    return subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True).stdout


def test_the_c_example_builds_against_the_installed_package_and_agrees_with_python(built, plane):
    line = ["-0.004", "0", "0.008", "-0.004", "0", "0.003"]
    printed = shown(built, "build/host", "plane.rfield", *line)
    last = re.findall(r"force +(\S+) +(\S+) +(\S+) N", printed)[-1]
    session = Session(plane.field)
    for i in range(1001):
        r = session.tick((-4e-3, 0, 8e-3 + (3e-3 - 8e-3) * i / 1000))
    assert float(last[2]) == pytest.approx(r["force"][2], abs=1e-4) and float(last[2]) > 0.05
    work = float(re.search(r"work (\S+) J", printed)[1])
    assert work == pytest.approx(r["work_in"], rel=1e-5)


def test_what_a_servo_loop_recorded_is_replayed_to_the_same_forces(built):
    """C++ writes the trace, `palpate replay` reads it."""
    printed = shown(built, "build/loop", "plane.rfield", "trace.csv")
    felt = [[float(f) for f in row] for row in re.findall(r"force +(\S+) +(\S+) +(\S+) N", printed)]
    result = replay(built / "plane.rfield", built / "trace.csv", built / "answer.npz")
    assert result["ticks"] == 3000 and result["seconds"] == pytest.approx(3.0)
    with np.load(built / "answer.npz") as answer:
        forces = np.stack([answer[f"f{axis}"] for axis in "xyz"], axis=1)[::250]
    np.testing.assert_allclose(forces, felt, atol=5.1e-4)  # printed with three digits
    assert forces[-1, 2] == pytest.approx(0.4, abs=1e-3)
