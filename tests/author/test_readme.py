# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What the README shows is true: its scene is legal, its C compiles, its commands, pages and sentences exist."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from palpate.author.capabilities import require_capabilities
from palpate.author.command_line import app
from palpate.author.errors import InputError
from palpate.author.organ_check import check_against_organ
from palpate.author.organ_parts import organ_parts, rough_summary
from palpate.author.scene import load_scene

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text()


def block(mark: str) -> str:
    found = re.search(rf"<!-- {mark} -->\n```\w+\n(.*?)```", README, re.DOTALL)
    assert found, f"README.md has no block marked {mark}"
    return found[1]


def test_the_scene_in_the_readme_is_legal_and_means_what_it_says(folder: Path) -> None:
    path = folder / "readme.toml"
    path.write_text(block("scene: smallest"))
    scene = load_scene(path)
    require_capabilities(scene)
    organ, _ = rough_summary(organ_parts(scene))
    check_against_organ(scene, organ)
    assert scene.tool[0].radius == (0.005,)
    assert scene.organ.material.shear_modulus == pytest.approx(5400 / (2 * 1.48))
    assert scene.accuracy.force_tolerance == pytest.approx(0.035)


def test_the_sentence_in_the_readme_is_what_is_said(write_scene: Callable[..., Path]) -> None:
    path = write_scene("", ('"5 mm"', '"5 kPa"'))
    with pytest.raises(InputError) as caught:
        load_scene(path)
    assert caught.value.problems[0].sentence.replace(str(path), "scene.toml") in README


def test_the_readme_lists_the_registered_commands_and_no_others() -> None:
    told = set(re.findall(r"^\| `palpate (\w+)", README, re.MULTILINE))
    visible = {
        info.callback.__name__ for info in app.registered_commands if info.callback and not info.hidden
    }
    visible |= {group.name for group in app.registered_groups if group.name}
    assert told == visible


def test_the_c_of_the_readme_compiles(folder: Path) -> None:
    compiler = shutil.which("gcc")
    if compiler is None:
        pytest.skip("needs gcc")
    source = folder / "readme.c"
    source.write_text(
        "#include <stdlib.h>\n#include <palpate/palpate.h>\n"
        "void read_the_device(double* position);\n"
        "void send_to_the_device(const double* force, const double* torque);\n"
        "void host(void);\n"
        "void host(void) {\npalpate_field* field;\npalpate_session* session;\nchar why[256];\n"
        + block("the loop")
        + "}\n"
    )
    flags = ["-std=c11", "-Wall", "-Wextra", "-Werror", "-fsyntax-only"]
    include = ROOT / "runtime_cpp" / "include"
    subprocess.run([compiler, *flags, f"-I{include}", source], check=True)


@pytest.mark.parametrize(
    "page", [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))], ids=lambda p: p.name
)
def test_links_lead_somewhere(page: Path) -> None:
    text = page.read_text()
    linked = re.findall(r"\]\((?!https?:)([^)#]+)", text)
    assert not [link for link in linked if not (page.parent / link).exists()]


def test_every_page_is_named_in_the_readme() -> None:
    assert not [page.name for page in (ROOT / "docs").glob("*.md") if f"(docs/{page.name})" not in README]


def test_the_main_command_names_a_shipped_scene() -> None:
    scene = re.search(r"palpate author (\S+)", block("command: main"))
    assert scene
    require_capabilities(load_scene(ROOT / scene[1]))


def test_the_install_line_brings_what_the_doctor_looks_for() -> None:
    from palpate.author.doctor import SHARED_OBJECTS

    named = block("command: system").split()
    opengl = [package for soname, needed, _, package in SHARED_OBJECTS if needed and soname != "libgmp.so.10"]
    assert set(opengl) | {"g++"} <= set(named)
