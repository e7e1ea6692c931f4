# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The haptic device that a field is held against: a scene's [device] table, options in its place, and what nobody said.

A name brings what is published of that device (device_profiles.py); a table has a name or numbers, and options replace
either.  Without a damping and a rate there is no verdict; whatever else is missing counts as none of it, and that is
listed as assumed, as is a damping that follows from a profile and a rate that the table left to its default.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from palpate.author.device_profiles import PROFILES, profile_named
from palpate.author.errors import InputError, InputProblem
from palpate.author.scene import Scene, load_scene
from palpate.author.scene_tables import Device

__all__ = ["HapticDevice", "device_from", "scene_device"]

MASS = 0.05
"""kg, of a simulated device where nobody said one."""


@dataclass(frozen=True)
class HapticDevice:
    """Seen at its tip.

    Attributes: name ("" when nobody named it); rate Hz; damping N s/m; delay s; resolution m; friction N (dry);
    max_force N or None; mass kg (of simulations); assumed: what nobody said, a clause each.
    """

    name: str
    rate: float
    damping: float
    delay: float = 0.0
    resolution: float = 0.0
    friction: float = 0.0
    max_force: float | None = None
    mass: float = MASS
    assumed: tuple[str, ...] = ()


def device_from(
    scene: Path | None,
    *,
    name: str | None = None,
    rate: float | None = None,
    damping: float | None = None,
    delay: float | None = None,
    quantum: float | None = None,
    dry_friction: float | None = None,
    max_force: float | None = None,
    mass: float | None = None,
) -> HapticDevice:
    """The device of the [device] table in the scene file `scene`; what is given here replaces the table's.

    Args:
        name: of a profile, instead of the table's; the table's numbers then count no more, but for its rate.

    Raises:
        InputError: the scene is wrong or has no [device], the name is unknown, or nobody said the damping or the rate.
    """
    table = None
    if scene is not None:
        table = load_scene(scene).device
        if table is None:
            what = "is not in this scene"
            raise InputError(
                InputProblem(str(scene), "device", None, what, "a table [device], or no --scene")
            )
    return _device(
        table, str(scene or ""), name, rate, damping, delay, quantum, dry_friction, max_force, mass
    )


def scene_device(scene: Scene) -> HapticDevice | None:
    """The scene's device; None where it names none.  Raises InputError as device_from does."""
    return _device(scene.device, str(scene.file)) if scene.device is not None else None


def _device(
    table: Device | None,
    file: str,
    name: str | None = None,
    rate: float | None = None,
    damping: float | None = None,
    delay: float | None = None,
    quantum: float | None = None,
    dry_friction: float | None = None,
    max_force: float | None = None,
    mass: float | None = None,
) -> HapticDevice:
    if table is not None:
        rate = table.rate if rate is None else rate
        if name is None:
            damping = table.damping if damping is None else damping
            quantum = table.resolution if quantum is None else quantum
            dry_friction = table.friction if dry_friction is None else dry_friction
    if max_force is None and table is not None and name is None:
        max_force = table.max_force
    known = ", ".join(profile.name for profile in PROFILES)
    if name is not None and profile_named(name) is None:
        raise InputError(
            InputProblem("", "--device", name, "is not a device with a profile", f"one of {known}")
        )
    name = name or (table.profile if table is not None else None) or ""
    profile = profile_named(name)
    derived = profile is not None and damping is None
    if profile is not None:
        damping = profile.damping if damping is None else damping
        max_force = profile.max_force if max_force is None else max_force
    problems = []
    if damping is None:
        whose = f'of the device "{name}" is' if name else "is"
        what = f"{whose} not known: makers do not publish it and it is not guessed"
        expected = f"--damping in N s/m, as measured, or --device: {known}"
        problems.append(InputProblem(file, "--damping", None, what, expected))
    if rate is None:
        what, expected = "is not given", '--rate in Hz, or --scene with a [device] (rate = "1 kHz")'
        problems.append(InputProblem("", "--rate", None, what, expected))
    if problems or damping is None or rate is None:
        raise InputError(problems)
    by_default = table is not None and "rate" not in table.model_fields_set and rate == table.rate
    missing = {
        "no computation delay (--delay)": delay,
        "exact positions (--quantum)": quantum,
        "no dry friction (--dry-friction)": dry_friction,
    }
    return HapticDevice(
        name,
        rate,
        damping,
        delay or 0.0,
        quantum or 0.0,
        dry_friction or 0.0,
        max_force,
        MASS if mass is None else mass,
        (
            *([profile.source] if derived else []),
            *([f"{rate:g} Hz, the table's default (--rate)"] if by_default else []),
            *(clause for clause, value in missing.items() if value is None),
        ),
    )
