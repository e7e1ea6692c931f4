# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What stands on the command line, as values: scenes, paths that exist, lengths with units, fidelities."""

from __future__ import annotations

from pathlib import Path

from palpate.author.capabilities import CAPABILITIES, require_capabilities
from palpate.author.errors import InputError, InputProblem
from palpate.author.place import Sphere
from palpate.author.scene import Scene, load_scene
from palpate.author.scene_tables import Tool
from palpate.author.tool_members import is_family, one_radius
from palpate.author.units import QuantityError, quantity

__all__ = [
    "ball_of",
    "existing",
    "fidelity_named",
    "lengths",
    "one_way_to_press",
    "pressed_radius",
    "radius_given",
    "ready_scene",
]


def ready_scene(path: Path) -> Scene:
    """The scene, read, checked, and within what this version can do.  Raises InputError."""
    scene = load_scene(path)
    require_capabilities(scene)
    return scene


def existing(path: Path, expected: str) -> Path:
    """`path`.  Raises InputError when nothing is there."""
    if not path.exists():
        raise InputError(InputProblem(str(path), "", None, "does not exist", expected))
    return path


def lengths(option: str, text: str, count: int | None = None) -> tuple[float, ...]:
    """`count` lengths (m; None: any number), separated by commas, each a number or a number with a unit.

    Raises:
        InputError: there are more or fewer, or one is no length.
    """
    parts = [part.strip() for part in text.split(",")]
    if count is not None and len(parts) != count:
        expected = "one length" if count == 1 else f"{count} lengths separated by commas"
        raise InputError(InputProblem("", option, text, f"has {len(parts)} entries", expected))
    try:
        return tuple(quantity(_number(part), "length") for part in parts)
    except QuantityError as error:
        raise InputError(InputProblem("", option, text, error.what, error.expected)) from None


def ball_of(option: str, text: str) -> Sphere:
    """A ball from x, y, z and radius, lengths as above.  Raises InputError."""
    *centre, radius = lengths(option, text, 4)
    if radius <= 0.0:
        raise InputError(
            InputProblem("", option, text, "has no radius above 0", "X,Y,Z,R, such as 0,0,30 mm,15 mm")
        )
    return Sphere(center=(centre[0], centre[1], centre[2]), radius=radius)


def radius_given(text: str) -> float | None:
    """The length (m) of --radius, None where it is not given.  Raises InputError."""
    if not text:
        return None
    radius = lengths("--radius", text, 1)[0]
    if not radius > 0.0:
        raise InputError(InputProblem("", "--radius", text, "is not above 0", 'a radius such as "3.5 mm"'))
    return radius


def pressed_radius(scene: Scene, tool: Tool, radius: float | None) -> Scene:
    """The scene with one radius (m) of a family.  Raises InputError where it is not clear which ball is meant."""
    if is_family(tool):
        if radius is None:
            known = ", ".join(f"{1e3 * one:.4g}" for one in tool.radius or ())
            what = f"is a family of balls ({known} mm), and one press takes one"
            raise InputError(InputProblem(str(scene.file), "--tool", tool.name, what, "--radius beside it"))
        return one_radius(scene, tool, radius)[0]
    if radius is not None:
        what = f"is asked of {tool.name}, which is no family"
        raise InputError(InputProblem(str(scene.file), "--radius", radius, what, "no --radius"))
    return scene


def fidelity_named(text: str) -> str:
    """`text`.  Raises InputError when this version has no such fidelity."""
    known = CAPABILITIES["fidelities"]
    if text not in known:
        what = "is no fidelity of this version"
        raise InputError(InputProblem("", "--fidelity", text, what, "one of " + ", ".join(known)))
    return text


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def one_way_to_press(workers: int | None, scheduler: str, device: str, batch: int | None) -> None:
    """Refuse options that say where presses run in two ways.  Raises InputError."""
    if scheduler and workers:
        what, expected = "is for this machine's processes", "either --workers or --scheduler"
        raise InputError(InputProblem("", "--workers", workers, what, expected))
    if scheduler and device:
        what, expected = "is for this machine's processes", "either --device or --scheduler"
        raise InputError(InputProblem("", "--device", device, what, expected))
    if batch and not device:
        what, expected = "says nothing without a device", "--device cuda, or cpu, beside it"
        raise InputError(InputProblem("", "--batch", batch, what, expected))
