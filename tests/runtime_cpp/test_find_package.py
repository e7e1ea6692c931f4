# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A C program finds the installed wheel with find_package, links, runs, and feels what Python feels."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from palpate.runtime import Session, cmake_folder

EXAMPLE = Path(__file__).parents[2] / "runtime_cpp" / "examples" / "press_along_a_line.c"

PROJECT = """
cmake_minimum_required(VERSION 3.22)
project(host LANGUAGES C)
find_package(palpate 0.1 REQUIRED)
add_executable(host press_along_a_line.c)
target_link_libraries(host PRIVATE palpate::palpate)
"""


@pytest.mark.skipif(
    shutil.which("cmake") is None or shutil.which("cc") is None, reason="needs cmake and a C compiler"
)
def test_the_c_example_builds_against_the_installed_package_and_agrees_with_python(tmp_path, plane):
    (tmp_path / "CMakeLists.txt").write_text(PROJECT)
    shutil.copy(EXAMPLE, tmp_path)
    (tmp_path / "plane.rfield").write_bytes(plane.data)
    for command in (
        ["cmake", "-S", ".", "-B", "build", f"-DCMAKE_PREFIX_PATH={cmake_folder()}"],
        ["cmake", "--build", "build"],
    ):
        subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, text=True)
    line = ["-0.004", "0", "0.008", "-0.004", "0", "0.003"]
    shown = subprocess.run(
        ["build/host", "plane.rfield", *line], cwd=tmp_path, check=True, capture_output=True, text=True
    ).stdout
    last = re.findall(r"force +(\S+) +(\S+) +(\S+) N", shown)[-1]
    session = Session(plane.field)
    for i in range(1001):
        r = session.tick((-4e-3, 0, 8e-3 + (3e-3 - 8e-3) * i / 1000))
    assert float(last[2]) == pytest.approx(r["force"][2], abs=1e-4) and float(last[2]) > 0.05
    work = float(re.search(r"work (\S+) J", shown)[1])
    assert work == pytest.approx(r["work_in"], rel=1e-5)
