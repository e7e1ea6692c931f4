# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""[tool.transient]: what a tool's contact plays on top of the response; rules between keys: transient_rules.py.

pulse              amplitude, duration                              shapes.py
decaying_sinusoid  amplitude, frequency, duration; decay            shapes.py
modal              mode = [{ amplitude, frequency, decay }, ...], duration
hunt_crossley      mass, stiffness, damping; exponent               shock.py
library            library = "library.npz" of `palpate transients library`
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, Strict

from palpate.author.scene_types import Quantity, SurfaceFile, Table

__all__ = ["ATTENUATION", "RATE", "Mode", "Transient", "frequencies"]

ATTENUATION = 0.8
"""Of a library that knows nothing of the response beside it (the paper, section 3.4)."""
RATE = 10_000.0
"""Hz, of stored samples where the scene does not say."""

Amplitude = Annotated[float, Quantity("damping")]
Frequency = Annotated[float, Quantity("frequency", above=0, most=5e3)]
Time = Annotated[float, Quantity("time", above=0, most=1)]
Velocity = Annotated[float, Quantity("velocity", above=0, most=100)]
Force = Annotated[float, Quantity("force", above=0, most=1000)]
Number = Annotated[float, Quantity("fraction", above=0)]


class Mode(Table):
    """A decaying sinusoid of a modal sum."""

    amplitude: Amplitude = Field(description="force over incoming velocity")
    frequency: Frequency = Field(description="above 0 and at most 5 kHz")
    decay: Time = Field(description="time constant, above 0 and at most 1 s")


class Transient(Table):
    """[tool.transient]: the forces that a contact of this tool plays, by incoming velocity."""

    shape: Literal["pulse", "decaying_sinusoid", "hunt_crossley", "modal", "library"] = Field(
        description="pulse decaying_sinusoid hunt_crossley modal library"
    )
    amplitude: Amplitude | None = Field(
        default=None, description="force over incoming velocity, out of the surface"
    )
    frequency: Frequency | None = Field(default=None, description="of the decaying sinusoid")
    duration: Time | None = Field(default=None, description="above 0 and at most 1 s")
    decay: Time | None = Field(
        default=None,
        description="time constant of the decaying sinusoid; a third of the duration when absent",
    )
    mode: tuple[Mode, ...] | None = Field(default=None, description="of the modal sum: at least one")
    mass: Annotated[float, Quantity("mass", above=0, most=100)] | None = Field(
        default=None, description="hunt_crossley: virtual mass that meets the surface"
    )
    stiffness: Number | None = Field(
        default=None, description="hunt_crossley: k0 of K(d) = k0 d^i, a number in N/m^(1+i)"
    )
    damping: Annotated[float, Quantity("fraction", least=0)] | None = Field(
        default=None, description="hunt_crossley: B0 of D(d) = B0 d, a number in N s/m^2"
    )
    exponent: Annotated[float, Quantity("fraction", least=0, most=5)] | None = Field(
        default=None, description="hunt_crossley: i; 0 when absent"
    )
    library: SurfaceFile | None = Field(
        default=None, description="an NPZ file of `palpate transients library`: rate, velocity, force"
    )
    velocity: tuple[Velocity, Velocity] | None = Field(
        default=None,
        description="slowest and fastest contact that is stored; 0.02 and 0.5 m/s, or the library's own, when absent",
    )
    velocity_count: Annotated[int, Strict(), Field(ge=2, le=64)] | None = Field(
        default=None, description="velocities that are stored of hunt_crossley, 2 to 64; 16 when absent"
    )
    rate: Annotated[float, Quantity("frequency", least=1e3, most=1e5)] | None = Field(
        default=None, description="of the stored samples, 1 to 100 kHz; 10 kHz, or the library's, when absent"
    )
    attenuation: Annotated[float, Quantity("fraction", least=0, most=1)] | None = Field(
        default=None,
        description="scales what is played, 0 to 1; when absent 0.8 of a library that was not made beside a response, "
        "else 1",
    )
    force_short: Force | None = Field(
        default=None,
        description="what the device gives for a moment, response included; [device]'s max_force or 8.5 N when absent",
    )
    force_steady: Force | None = Field(
        default=None, description="what the device bears for ever; a sixth of force_short when absent"
    )
    steady_time: Annotated[float, Quantity("time", least=1e-3, most=1e4)] | None = Field(
        default=None, description="over which force_steady is held against the mean square; 1 s when absent"
    )
    velocity_min: Annotated[float, Quantity("velocity", least=0, most=100)] | None = Field(
        default=None, description="slower contacts play nothing; 0.01 m/s when absent"
    )
    rearm_distance: Annotated[float, Quantity("length", least=0, most=1)] | None = Field(
        default=None, description="so far off the surface another contact may play; 0.5 mm when absent"
    )
    rearm_time: Annotated[float, Quantity("time", least=0, most=1e3)] | None = Field(
        default=None, description="or so long off it; 50 ms when absent"
    )
    energy_max: Annotated[float, Quantity("energy", least=0, most=100)] | None = Field(
        default=None,
        description="that one contact may give to the hand; when absent what a hand takes that goes on as it came",
    )


def frequencies(transient: Transient) -> list[tuple[str, float]]:
    """(key, Hz) of what is asked to sound."""
    own = [("frequency", transient.frequency)] if transient.frequency is not None else []
    return own + [(f"mode[{i}].frequency", mode.frequency) for i, mode in enumerate(transient.mode or ())]
