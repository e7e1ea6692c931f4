# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a device can render of a texture: the six limits of Hayward's table 1.

With a grating's spatial frequency k (1/m) and force amplitude A (N), scanned at v (m/s) in a loop of period T (s) by a
device that knows position to delta (m), gives force to b (N), holds stiffness up to A_0 (N/m) and has its first mode at
F_0 (Hz), and safety factors alpha, beta (at least 2, better 10), gamma (at least 10):

    scanning velocity           alpha k v T < 1
    low-speed reconstruction    beta k delta < 1
    high-speed reconstruction   alpha k delta < 1
    force reconstruction        gamma b < A
    gain                        A k < A_0
    structure                   v k < F_0

A height h inside U gives F_n dh / dx along the surface and k_n h along the normal (Texture.force_amplitude): A is a
wave's amplitude times the larger of 2 pi k F_n and k_n, at the largest normal force F_n and stiffness k_n of the field.

None of them promises that a grating is rendered well; each that is exceeded makes it likely that it is not.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from palpate.fields.texture import DeviceLimits, Texture, Waves

__all__ = ["DEVICES", "SPEEDS", "TextureDevice", "device_named", "finest", "judged", "limits_of", "rendered"]

SPEEDS = (0.02, 0.05, 0.1, 0.2, 0.5)
"""m/s, at which the finest grating is told."""


@dataclass(frozen=True)
class TextureDevice:
    """Attributes: name; rate Hz; resolution m; structural_frequency Hz; source, a clause."""

    name: str
    rate: float
    resolution: float
    structural_frequency: float
    source: str

    def limits(
        self, time_factor: float = 10.0, space_factor: float = 10.0, force_factor: float = 10.0
    ) -> DeviceLimits:
        return DeviceLimits(
            time_factor, space_factor, force_factor, self.resolution, 0.0, 0.0, self.structural_frequency
        )


DEVICES = (
    TextureDevice(
        "PHANTOM", 1000.0, 30e-6, 30.0,
        "first anti-resonance from the chapter; 30 um nominal, at 1 kHz",
    ),
    TextureDevice(
        "Pantograph", 10_000.0, 10e-6, 400.0,
        "structural bandwidth from the chapter; 10 um as its makers measured (Campion, Wang, Hayward 2005); "
        "10 kHz assumed",
    ),
)  # fmt: skip
"""The two examples of the chapter; what it gives of them is the structure's frequency."""


def device_named(name: str) -> TextureDevice | None:
    """Whatever its capitals; None where there is none."""
    return next((one for one in DEVICES if one.name.lower() == name.strip().lower()), None)


def limits_of(
    device: DeviceLimits, period: float, spatial_frequency: float, speed: float, force: float | None = None
) -> dict[str, dict[str, Any]]:
    """Each limit by name: `value`, `bound`, and whether it is `met`; None where the device's number is not known.

    Args:
        period: s.  spatial_frequency: 1/m.  speed: m/s, along the wave.  force: N, amplitude; not known when None.
    """
    k, v, d = spatial_frequency, speed, device
    rows = {
        "scanning_velocity": (d.time_factor * k * v * period, 1.0, d.time_factor > 0),
        "low_speed_reconstruction": (d.space_factor * k * d.resolution, 1.0, d.space_factor * d.resolution > 0),
        "high_speed_reconstruction": (d.time_factor * k * d.resolution, 1.0, d.time_factor * d.resolution > 0),
        "force_reconstruction": (
            d.force_factor * d.force_resolution, force or 0.0, d.force_factor * d.force_resolution > 0 and bool(force),
        ),
        "gain": ((force or 0.0) * k, d.stiffness_max, d.stiffness_max > 0 and force is not None),
        "structure": (v * k, d.structural_frequency, d.structural_frequency > 0),
    }  # fmt: skip
    return {
        name: {"value": value, "bound": bound, "met": value < bound if known else None}
        for name, (value, bound, known) in rows.items()
    }


def finest(device: DeviceLimits, period: float, speed: float) -> tuple[float, str]:
    """The finest wavelength (m) at `speed` (m/s), and which limit it is; 0 and "" where nothing is known."""
    wavelength = {
        "scanning_velocity": device.time_factor * speed * period,
        "low_speed_reconstruction": device.space_factor * device.resolution,
        "high_speed_reconstruction": device.time_factor * device.resolution,
        "structure": speed / device.structural_frequency if device.structural_frequency > 0 else 0.0,
    }
    name = max(wavelength, key=lambda one: wavelength[one])
    return (wavelength[name], name) if wavelength[name] > 0 else (0.0, "")


def fastest(device: DeviceLimits, period: float, spatial_frequency: float) -> tuple[float | None, str]:
    """The speed (m/s) at which a grating reaches its first limit, and which; None where nothing is known."""
    speeds = {}
    if device.time_factor > 0:
        speeds["scanning_velocity"] = 1.0 / (device.time_factor * spatial_frequency * period)
    if device.structural_frequency > 0:
        speeds["structure"] = device.structural_frequency / spatial_frequency
    if not speeds:
        return None, ""
    name = min(speeds, key=lambda one: speeds[one])
    return speeds[name], name


def rendered(
    device: DeviceLimits, rate: float, texture: Texture | None = None, normal_force: float | None = None
) -> dict[str, Any]:
    """What `palpate certify` tells: the finest grating by speed, and each wave of `texture` at `normal_force` (N).

    A wave is `met` where every limit without a speed is; `speed_max` (m/s) is where it reaches one of the others.
    """
    period = 1.0 / rate
    by_speed = []
    for speed in SPEEDS:
        wavelength, limit = finest(device, period, speed)
        by_speed.append({"speed": speed, "wavelength": wavelength, "limit": limit})
    waves = (
        []
        if texture is None
        else [row for w in texture.waves for row in judged(device, period, texture, w, normal_force)]
    )
    return {
        "rate": rate,
        "normal_force": texture.normal_force if texture and normal_force is None else normal_force,
        **{name: getattr(device, name) for name in device.__dataclass_fields__},
        "finest": by_speed,
        "waves": waves,
        "met": all(row["met"] for row in waves),
    }


def judged(
    device: DeviceLimits, period: float, texture: Texture, waves: Waves, normal_force: float | None = None
) -> list[dict[str, Any]]:
    """A row for each wave: wavelength, amplitude, force, limits, met, speed_max and its limit."""
    rows = []
    forces = texture.force_amplitude(waves, normal_force).tolist()
    for k, a, force in zip(waves.spatial_frequency.tolist(), waves.amplitude.tolist(), forces, strict=True):
        limits = limits_of(device, period, k, 0.0, force)
        speed, which = fastest(device, period, k)
        rows.append(
            {
                "wavelength": 1.0 / k if k > 0 else None,
                "amplitude": a,
                "force": force,
                "limits": limits,
                "met": all(one["met"] is not False for one in limits.values()),
                "speed_max": speed,
                "speed_limit": which,
            }
        )
    return rows
