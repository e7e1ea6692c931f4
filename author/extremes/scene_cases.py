# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Scene files with one number beyond its end: to be refused by sentences that say where, and what would be right.

Each is a scene that is fine, with one key changed, taken as far as `palpate plan` takes it.  Values at the ends, which
have to be taken, are listed beside them for the tests; a value that is merely read is no case of the table.
"""

from __future__ import annotations

import copy
import json
import tempfile
import tomllib
from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.capabilities import require_capabilities
from palpate.author.errors import InputError
from palpate.author.extremes.case import Case, Refused, Wrong
from palpate.author.plan import plan
from palpate.author.scene import load_scene

__all__ = ["ENDS", "SHIPPED", "scene_cases", "taken"]

SHIPPED = Path(str(files("palpate.assets"))) / "scenes" / "palpation_block.toml"

Ends = tuple[str, tuple[tuple[Any, float | None], ...]]
ENDS: dict[str, tuple[Ends, ...]] = {
    "stiffness": (
        ("organ.material.youngs_modulus", (("10 Pa", 10.0), ("10 GPa", 1e10), ("0 Pa", None), ("-5.4 kPa", None),
                                           ("5.4 mm", None), ("nan", None))),
    ),
    "poissons_ratio": (
        ("organ.material.poissons_ratio", ((0.0, 0.0), (0.4999, 0.4999), (0.49999, None), (0.5, None), (-0.1, None))),
    ),
    "depth": (
        ("reach.depth_max", (("1 um", 1e-6), ("6 mm", 6e-3), ("7 mm", None), ("51 mm", None), ("0 mm", None),
                             ("-1 mm", None))),
    ),
    "tool": (
        ("tool.0.radius", (("4 mm", 4e-3), ("0 mm", None), ("200 mm", None), ("5 kPa", None), ("0.1 mm", None))),
    ),
    "friction": (("tool.0.friction", ((0.0, 0.0), (2.0, 2.0), (10.0, None), (-0.1, None))),),
    "mesh": (("organ.mesh_size", (("7 mm", 7e-3), ("0 mm", None), ("100 mm", None))),),
    "knots": (
        ("accuracy.knots", ((4, 4.0), (64, 64.0), (1, None), (3, None), (65, None), (1000, None), (12.5, None))),
    ),
    "organ_size": (("organ.units", (("mm", None),)),),
    "nodes": (("accuracy.held_out", ((1, 1.0), (100_000, 1e5), (0, None), (100_001, None))),),
    "tolerance": (("accuracy.force_tolerance", (("0.1 %", 1e-3), ("50 %", 0.5), ("0 %", None), ("60 %", None))),),
}  # fmt: skip
"""Axis: key, and values with what they mean in SI, or None where nothing can be made of them."""
SIZED = {"organ.mesh_size", "reach.depth_max", "tool.0.radius", "organ.units"}
"""Keys whose ends depend on the organ: cases of the shipped block only."""


def scene_cases(base: Path = SHIPPED) -> Iterator[Case]:
    """Cases on the scene file `base`."""
    shipped = base == SHIPPED
    for axis, keys in ENDS.items():
        for key, values in keys:
            if key in SIZED and not shipped:
                continue
            for value in (value for value, read in values if read is None):
                text = f"{key} = {json.dumps(value)}"
                yield Case(axis, text, lambda k=key, v=value: taken(base, k, v, None), True)
    if shipped:
        for scale, name in ((1e-3, "0.06 mm"), (200.0, "12 m")):
            value = f"organ of {name} in a scene"
            yield Case("organ_size", value, lambda s=scale: _sized(base, s), True)


def taken(base: Path, key: str, value: Any, expected: float | None) -> str:
    raw = tomllib.loads(base.read_text())
    return _read(base, _changed(raw, key, value), key, expected)


def _sized(base: Path, scale: float) -> str:
    """The scene with its organ `scale` times as large."""
    import trimesh

    raw = tomllib.loads(base.read_text())
    with tempfile.TemporaryDirectory() as folder:
        mesh = trimesh.load(base.parent / raw["organ"]["surface"], force="mesh")
        mesh.vertices = scale * np.asarray(mesh.vertices)
        path = Path(folder) / "organ.stl"
        mesh.export(path)
        return _read(base, _changed(raw, "organ.surface", str(path)), "organ.units", None)


def _changed(raw: dict[str, Any], key: str, value: Any) -> dict[str, Any]:
    raw = copy.deepcopy(raw)
    at: Any = raw
    *way, last = [int(part) if part.isdigit() else part for part in key.split(".")]
    for part in way:
        at = at[part] if isinstance(part, int) else at.setdefault(part, {})
    at[last] = value
    return raw


def _read(base: Path, raw: dict[str, Any], key: str, expected: float | None) -> str:
    """Raises Refused with what the scene's reader says, Wrong where it says nothing that names the key, or too much."""
    with tempfile.NamedTemporaryFile("w", suffix=".toml", dir=None, delete=False) as file:
        file.write(_toml(_absolute(raw, base.resolve().parent)))
    path = Path(file.name)
    try:
        scene = load_scene(path)
        require_capabilities(scene)
        plan(scene)
    except InputError as error:
        if expected is not None:
            raise Wrong(f"a legal value was refused: {error}") from error
        if not all(problem.key and problem.expected for problem in error.problems):
            raise Wrong(f"the refusal does not say where, or what would be right: {error}") from error
        raise Refused(error.problems[0].sentence.split(": ", 1)[-1]) from error
    finally:
        path.unlink()
    at: Any = scene
    for part in key.split("."):
        at = at[int(part)] if part.isdigit() else getattr(at, part)
    at = at[0] if isinstance(at, tuple) else at
    if expected is None:
        raise Wrong(f"was accepted, as {at}")
    if not float(at) == expected:
        raise Wrong(f"was read as {at}, not {expected}")
    return f"read as {at:g} in SI, and planned"


def _absolute(raw: Any, folder: Path, name: str = "") -> Any:
    """With the files that it names where they are."""
    if isinstance(raw, dict):
        return {key: _absolute(value, folder, key) for key, value in raw.items()}
    if isinstance(raw, list):
        return [_absolute(value, folder, name) for value in raw]
    return str((folder / raw).resolve()) if name == "surface" and isinstance(raw, str) else raw


def _toml(raw: dict[str, Any]) -> str:
    """Each top-level table inline: enough for a file that only this program reads."""
    return "\n".join(f"{key} = {_inline(value)}" for key, value in raw.items()) + "\n"


def _inline(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {_inline(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_inline, value)) + "]"
    return json.dumps(value, ensure_ascii=False)
