# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Scenes for the tests of the author shell: a block on its base, and the complete scene with its files."""

from __future__ import annotations

import ctypes
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import trimesh

from palpate.author.doctor import SHARED_OBJECTS

SMALLEST = """
[scene]
name = "block"

[organ]
surface = "block.stl"

[[organ.support]]
box = { min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 0.005] }

[[tool]]
name = "ball"
shape = "sphere"
radius = "5 mm"
"""


CUBE = """
[scene]
name = "cube"

[organ]
surface = "cube.stl"
mesh_size = "8 mm"

[[organ.support]]
box = { min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 0.001] }

[[tool]]
name = "ball"
shape = "sphere"
radius = "5 mm"
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Surfaces: block.stl (100 x 80 x 40 mm on z = 0, in m), liver.obj and grasper.stl (the same block)."""
    block = trimesh.creation.box((0.10, 0.08, 0.04))
    block.apply_translation((0.0, 0.0, 0.02))
    for name in ("block.stl", "liver.obj", "grasper.stl"):
        block.export(tmp_path / name)
    return tmp_path


@pytest.fixture
def write_scene(folder: Path) -> Callable[..., Path]:
    """Writes the smallest legal scene with `extra` behind it and each `replace` pair applied."""

    def write(extra: str = "", *replace: tuple[str, str]) -> Path:
        text = SMALLEST
        for old, new in replace:
            assert old in text
            text = text.replace(old, new)
        path = folder / "scene.toml"
        path.write_text(text + "\n" + extra)
        return path

    return write


@pytest.fixture(scope="session")
def cube(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A scene file: a block of 40 x 40 x 20 mm on its base."""
    folder = tmp_path_factory.mktemp("cube")
    block = trimesh.creation.box((0.04, 0.04, 0.02))
    block.apply_translation((0.0, 0.0, 0.01))
    block.export(folder / "cube.stl")
    (folder / "scene.toml").write_text(CUBE)
    return folder / "scene.toml"


@pytest.fixture
def can_draw() -> None:
    """Skips where a library that off-screen drawing loads is absent; where all are there, drawing must work."""
    if not sys.platform.startswith("linux"):
        return
    for soname, needed, used_for, _ in SHARED_OBJECTS:
        if needed and "pictures" in used_for:
            try:
                ctypes.CDLL(soname)
            except OSError as error:
                pytest.skip(f"pictures need {soname}: {error}")


@pytest.fixture
def complete_scene(folder: Path) -> Path:
    """The scene that names everything a scene file can name."""
    return Path(shutil.copy(Path(__file__).parent / "scenes" / "complete.toml", folder / "complete.toml"))
