# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The haptic device that a field is held against: a scene's [device] table, options in its place, and what nobody said.

A profile in the table names a device; what it needs in numbers (damping above all, which makers do not publish) comes
from the table or from options.  Nothing is guessed: without a damping and a rate there is no verdict, and whatever
else is missing counts as none of it and is listed as assumed.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from palpate.author.errors import InputError, InputProblem
from palpate.author.scene import load_scene

__all__ = ["HapticDevice", "device_from"]

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
    rate: float | None = None,
    damping: float | None = None,
    delay: float | None = None,
    quantum: float | None = None,
    dry_friction: float | None = None,
    mass: float | None = None,
) -> HapticDevice:
    """The device of the [device] table in the scene file `scene`; a number that is given here replaces the table's.

    Raises:
        InputError: the scene is wrong or has no [device], or nobody said the damping or the rate.
    """
    table = None
    if scene is not None:
        loaded = load_scene(scene)
        table = loaded.device
        if table is None:
            what = "is not in this scene"
            raise InputError(
                InputProblem(str(scene), "device", None, what, "a table [device], or no --scene")
            )
        rate = table.rate if rate is None else rate
        damping = table.damping if damping is None else damping
        quantum = table.resolution if quantum is None else quantum
        dry_friction = table.friction if dry_friction is None else dry_friction
    name = (table.profile or "") if table is not None else ""
    problems = []
    if damping is None:
        whose = f'of the device "{name}" is' if name else "is"
        what = f"{whose} not known: makers do not publish it and it is not guessed"
        expected = "--damping in N s/m, as measured on the device (or damping in the scene's [device])"
        problems.append(InputProblem(str(scene or ""), "--damping", None, what, expected))
    if rate is None:
        what, expected = "is not given", '--rate in Hz, or --scene with a [device] (rate = "1 kHz")'
        problems.append(InputProblem("", "--rate", None, what, expected))
    if problems or damping is None or rate is None:
        raise InputError(problems)
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
        table.max_force if table is not None else None,
        MASS if mass is None else mass,
        tuple(clause for clause, value in missing.items() if value is None),
    )
