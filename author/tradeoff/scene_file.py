# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A setting written back: the scene's own text, comments and units kept, with the keys that the setting turns."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import tomlkit

from palpate.author.capabilities import require_capabilities
from palpate.author.errors import InputError, InputProblem
from palpate.author.scene import Scene, load_scene
from palpate.author.tradeoff.knobs import Setting, scene_s_pressing

__all__ = ["require_scene_path", "write_scene"]


def require_scene_path(path: Path, scene: Scene) -> None:
    """Raises InputError where the recommended scene must not go."""
    what = None
    if path.suffix != ".toml":
        what, expected = "is no scene file", "a name that ends in .toml"
    elif path.resolve() == scene.file.resolve():
        what, expected = "is the scene itself", "another file, which this one is copied to"
    if what is not None:
        raise InputError(InputProblem("", "--write-scene", str(path), what, expected))


def write_scene(scene: Scene, setting: Setting, path: Path) -> Path:
    """Writes `scene` to `path` so that `palpate author` presses it as `setting` says; read again before it is there.

    Raises:
        InputError: what was written is no scene of this version (a bug, or a scene file that changed meanwhile).
        OSError: the file cannot be written.
    """
    document = tomlkit.parse(scene.file.read_text(encoding="utf-8"))
    how, own = setting.pressing, scene_s_pressing(scene, setting.pressing.mesh_size)
    if scene.organ.mesh_size is None or abs(how.mesh_size - scene.organ.mesh_size) > 1e-12:
        document["organ"]["mesh_size"] = _millimetres(how.mesh_size)
    if "accuracy" not in document:
        document["accuracy"] = tomlkit.table()
    accuracy: Any = document["accuracy"]
    accuracy["nodes"] = setting.nodes
    if how.fidelity != own.fidelity:
        accuracy["fidelity"] = how.fidelity
    if setting.knots != scene.accuracy.knots:
        accuracy["knots"] = setting.knots
    if how.patch_radius != own.patch_radius:
        accuracy["patch_radius"] = _millimetres(how.patch_radius)
    if how.patch_refinement != own.patch_refinement:
        accuracy["patch_refinement"] = round(how.patch_refinement, 6)
    accuracy.pop("time_budget", None)  # the node count says when to stop
    _move_files(document, scene.file.resolve().parent, path.resolve().parent)
    path.parent.mkdir(parents=True, exist_ok=True)
    unread = path.with_suffix(".part.toml")
    try:
        unread.write_text(tomlkit.dumps(document), encoding="utf-8")
        require_capabilities(load_scene(unread))
        unread.replace(path)
    finally:
        unread.unlink(missing_ok=True)
    return path


def _millimetres(length: float) -> str:
    return f"{1e3 * length:.6g} mm"


def _move_files(table: Any, before: Path, after: Path) -> None:
    """Every `surface`, wherever it stands, is named as seen from the folder `after`."""
    if isinstance(table, dict):
        for key in list(table):
            if key == "surface" and isinstance(table[key], str):
                there = (before / str(table[key])).resolve()
                table[key] = Path(os.path.relpath(there, after)).as_posix()
            else:
                _move_files(table[key], before, after)
    elif isinstance(table, list):
        for item in table:
            _move_files(item, before, after)
