# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What the device of `palpate certify` renders of a field's texture, and of gratings at all."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.errors import InputError, InputProblem
from palpate.author.haptic_device import HapticDevice
from palpate.author.scene import load_scene
from palpate.author.texture.rendered import DEVICES, device_named, rendered
from palpate.fields.texture import DeviceLimits

__all__ = ["FACTOR", "certified_drag", "certified_texture", "texture_lines"]

FACTOR = 10.0
"""Safety factors where no option says: the better ones of Hayward's table 1."""


def certified_texture(
    field: Path,
    scene: Path | None,
    held: HapticDevice,
    name: str | None,
    factors: dict[str, float | None],
    numbers: dict[str, float | None],
    normal_force: float | None = None,
) -> dict[str, Any]:
    """As `rendered` of the .rfield `field`.

    Args:
        scene: whose [device] says what no option does.
        held: the device, whose rate and resolution count.
        name: of one of DEVICES, whose rate, resolution and structure count instead.
        factors, numbers: options, of DeviceLimits; None where they are not given.
        normal_force: N, at which waves are judged; the field's largest when None.

    Raises:
        InputError: there is no such device, or a number is out of range.
    """
    from palpate.fields.rfield_read import read_rfield
    from palpate.fields.texture_layout import read_texture

    problems = [
        InputProblem("", f"--{key.replace('_', '-')}", value, "is not usable", "0 or more")
        for key, value in {**factors, **numbers, "normal_force": normal_force}.items()
        if value is not None and not (np.isfinite(value) and value >= 0.0)
    ]
    device = None if name is None else device_named(name)
    if name is not None and device is None:
        known = ", ".join(one.name for one in DEVICES)
        problems.append(InputProblem("", "--texture-device", name, "is not known", f"one of {known}"))
    if problems:
        raise InputError(problems)
    table = None if scene is None else load_scene(scene).device
    given: dict[str, float] = {"resolution": held.resolution}
    for key in numbers:
        given[key] = (getattr(table, key) if table is not None else None) or 0.0
    if device is not None:
        given |= {"resolution": device.resolution, "structural_frequency": device.structural_frequency}
    given |= {key: value for key, value in numbers.items() if value is not None}
    given |= {key: FACTOR if value is None else value for key, value in factors.items()}
    layers = read_rfield(field).layers
    texture = read_texture(layers["texture"]) if "texture" in layers else None
    rate = device.rate if device is not None else held.rate
    told = rendered(DeviceLimits(**given), rate, texture, normal_force)
    return {"device": device.name if device else held.name, "source": device.source if device else "", **told}


def certified_drag(field: Path, file: Path) -> dict[str, Any]:
    """Draws a drag over the texture of the .rfield `field` into the PNG `file`.

    Returns:
        As `Drag.told`, and file.

    Raises:
        InputError: there is no texture, or no room for a drag over it.
    """
    from palpate.author.texture.drag import LEAST, drag
    from palpate.author.texture.drag_picture import drag_picture

    dragged = drag(field.read_bytes())
    if dragged is None:
        expected = f"an .rfield with the effect texture, whose reach has room for {LEAST} wavelengths"
        raise InputError(InputProblem(str(field), "--drag", str(file), "has nothing to show", expected))
    drag_picture(dragged, file)
    return {**dragged.told(), "file": str(file)}


def texture_lines(told: dict[str, Any]) -> list[str]:
    """Of what `certified_texture` found; empty where nobody asked."""
    if not told["waves"] and not told["source"]:
        return []
    dragged = told.get("drag")
    whose = f"{told['device']} ({told['source']})" if told["source"] else "this device"
    at = told["normal_force"]
    lines = [
        f"gratings on {whose} at {told['rate']:g} Hz, factors {told['time_factor']:g}, {told['space_factor']:g}, "
        f"{told['force_factor']:g}: "
        + "; ".join(
            f"{1e3 * row['wavelength']:.3g} mm at {row['speed']:g} m/s ({row['limit'].replace('_', ' ')})"
            for row in told["finest"]
        )
    ]
    for row in told["waves"]:
        broken = [name.replace("_", " ") for name, one in row["limits"].items() if one["met"] is False]
        speed = "" if row["speed_max"] is None else (
            f", up to {row['speed_max']:.3g} m/s ({row['speed_limit'].replace('_', ' ')})"
        )  # fmt: skip
        verdict = f"not rendered: {', '.join(broken)}" if broken else f"rendered{speed}"
        length = 1e3 * row["wavelength"] if row["wavelength"] else float("inf")
        lines.append(
            f"texture wave of {length:.3g} mm, {1e6 * row['amplitude']:.3g} um, {row['force']:.2g} N "
            f"{f'under {at:.3g} N' if at else 'along the normal'}: {verdict}"
        )
    if dragged:
        lines.append(
            f"{dragged['file']}: dragged at {1e3 * dragged['speed']:.3g} mm/s, k v = {dragged['expected']:.4g} Hz, "
            f"line at {dragged['line']:.4g} Hz ({100 * dragged['line_error']:+.2f} %) of {dragged['amplitude']:.3g} N "
            f"at {dragged['normal_force']:.3g} N; table 1 would be asked about {dragged['judged']:.3g} N there"
        )
    return lines
