# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Phantoms and scenes that ship with palpate, all made by its own code."""

from pathlib import Path

__all__ = ["PHANTOM_FOLDER", "SCENE_FOLDER", "scene_path"]

PHANTOM_FOLDER = Path(__file__).parent / "phantoms"
SCENE_FOLDER = Path(__file__).parent / "scenes"


def scene_path(name: str) -> Path:
    """The file of a shipped scene, for example scene_path("liver_phantom").

    Raises:
        FileNotFoundError: no scene of that name; the message lists those there are.
    """
    path = SCENE_FOLDER / f"{name}.toml"
    if not path.is_file():
        names = ", ".join(sorted(p.stem for p in SCENE_FOLDER.glob("*.toml")))
        raise FileNotFoundError(f"no scene {name!r} ships with palpate; there are: {names}")
    return path
