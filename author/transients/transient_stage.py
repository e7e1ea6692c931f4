# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""From [tool.transient] to the layer `transient` of that tool's field.

Shapes that are linear in velocity are stored at the slowest and the fastest contact, between which the runtime's
linear combination is exact; Hunt-Crossley shocks at velocities in equal ratios; libraries as they are, cut to
`velocity` where the scene names one.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from palpate.author.device_profiles import profile_named
from palpate.author.errors import InputError
from palpate.author.scene import Scene
from palpate.author.scene_tables import Tool
from palpate.author.transients.identification import BAND
from palpate.author.transients.library import Library, library_of_shape
from palpate.author.transients.library_file import read_library
from palpate.author.transients.shapes import decaying_sinusoid, modal_sum, pulse
from palpate.author.transients.shock import shock
from palpate.author.transients.transient_table import ATTENUATION, RATE, Transient
from palpate.fields.response_field import ResponseField
from palpate.fields.transient_layout import TransientLayerError, read_transient_layer, transient_layer

__all__ = ["library_for", "transient_summary", "transients_of", "with_transient"]

VELOCITY = (0.02, 0.5)
"""m/s, stored where the scene does not say."""
COUNT = 16
"""Velocities of a shock; at ratios of 1.24 the combination of two is within a percent of the shock between."""
FORCE_SHORT = 8.5
"""N, of a PHANTOM Premium 1.5 (device_profiles.py), where nobody says what the device gives."""
ENDING = 0.1
"""Share of an oscillation's duration over which it fades, so that its end does not click."""
STEADY_SHARE = 1.0 / 6.0
"""Of force_short that motors bear for ever, where nobody says: a PHANTOM's 1.4 N of 8.5 N."""


def transients_of(scene: Scene, tool: Tool) -> tuple[bytes, dict[str, Any]] | None:
    """The layer's bytes and what a summary says of it; None where the scene asks for none of this tool.

    Raises:
        InputError: the library cannot be read, lies outside the velocities asked for, or the shape cannot be stored.
    """
    transient = tool.transient
    if transient is None or "transient" not in scene.effects:
        return None
    key = f"tool[{[one.name for one in scene.tool].index(tool.name)}].transient"
    made, beside = library_for(scene, key, transient)
    known = transient.shape != "library" or beside > 0.0
    attenuation = transient.attenuation
    if attenuation is None:
        attenuation = 1.0 if known else ATTENUATION
    force_short = transient.force_short or _device_force(scene) or FORCE_SHORT
    given = {
        name: getattr(transient, name)
        for name in ("steady_time", "velocity_min", "rearm_distance", "rearm_time", "energy_max")
        if getattr(transient, name) is not None
    }
    try:
        data = transient_layer(
            made.rate,
            made.velocity,
            made.force,
            attenuation=attenuation,
            force_short=force_short,
            force_steady=transient.force_steady or STEADY_SHARE * force_short,
            **given,
        )
    except TransientLayerError as error:
        raise InputError(
            scene.problem(key, transient.shape, f"makes no layer: {error}", "other parameters")
        ) from error
    return data, {"shape": transient.shape, "beside": beside, **transient_summary(data)}


def transient_summary(data: bytes) -> dict[str, Any]:
    """What is told of a layer; `limited` where the device cannot give its peak."""
    layer = read_transient_layer(data)
    peak = float(abs(layer.force).max()) * layer.numbers["attenuation"]
    return {
        "velocity": [float(layer.velocity[0]), float(layer.velocity[-1])],
        "velocity_count": len(layer.velocity),
        "duration": (layer.force.shape[1] - 1) / layer.numbers["rate"],
        "force_max": peak,
        "limited": peak > layer.numbers["force_short"],
        "bytes": len(data),
        **layer.numbers,
    }


def with_transient(scene: Scene, tool: Tool, field: ResponseField) -> tuple[ResponseField, dict[str, Any]]:
    """`field` of `tool` with the layer that the scene asks for, without any other transient; and its summary."""
    made = transients_of(scene, tool)
    others = {name: data for name, data in field.layers.items() if name != "transient"}
    if made is None:
        return replace(field, layers=others), {}
    return replace(field, layers={**others, "transient": made[0]}), made[1]


def library_for(scene: Scene, key: str, transient: Transient) -> tuple[Library, float]:
    """The forces of the table at `key` by velocity; and the response (N/m) that they were made beside."""
    if transient.shape == "library":
        assert transient.library is not None
        made, beside = read_library(transient.library)
        _carried(scene, key, made.rate)
        return _within(scene, key, transient, made), beside
    v, rate = transient.velocity or VELOCITY, transient.rate or RATE
    if transient.shape == "hunt_crossley":
        return _shocks(transient, np.geomspace(*v, transient.velocity_count or COUNT), rate), 0.0
    duration = transient.duration or 0.0

    def shape(time: np.ndarray, velocity: float) -> np.ndarray:
        if transient.shape == "pulse":
            return pulse(time, velocity, transient.amplitude or 0.0, duration)
        if transient.shape == "decaying_sinusoid":
            return _ending(time, duration) * decaying_sinusoid(
                time,
                velocity,
                transient.amplitude or 0.0,
                transient.frequency or 0.0,
                duration,
                transient.decay,
            )
        modes = [(mode.amplitude, mode.frequency, mode.decay) for mode in transient.mode or ()]
        return _ending(time, duration) * modal_sum(time, velocity, modes, duration)

    return library_of_shape(shape, duration, v, rate), 0.0


def _ending(time: np.ndarray, duration: float) -> np.ndarray:
    """(n,) 1, and a raised cosine down to 0 over the last ENDING of the duration."""
    share = np.clip((duration - time) / (ENDING * duration), 0.0, 1.0)
    return 0.5 - 0.5 * np.cos(np.pi * share)


def _shocks(transient: Transient, velocity: np.ndarray, rate: float) -> Library:
    """Each until its mass has left again, then nothing."""
    rows = [
        shock(
            float(v),
            transient.mass or 0.0,
            transient.stiffness or 0.0,
            transient.damping or 0.0,
            transient.exponent or 0.0,
            rate,
        )[2][:-1]
        for v in velocity
    ]
    force = np.zeros((len(rows), max(map(len, rows)) + 1))
    for row, own in zip(force, rows, strict=True):
        row[: len(own)] = own
    return Library(rate, velocity, force)


def _within(scene: Scene, key: str, transient: Transient, made: Library) -> Library:
    """`made`, cut to the velocities that the scene names; its ends are combined where they lie between two."""
    if transient.velocity is None:
        return made
    low, high = transient.velocity
    known = f"{made.velocity[0]:g} to {made.velocity[-1]:g} m/s"
    if low < made.velocity[0] * (1.0 - 1e-9) or high > made.velocity[-1] * (1.0 + 1e-9):
        what = f"lies outside the library, which was recorded from {known} (m/s)"
        raise InputError(scene.problem(f"{key}.velocity", [low, high], what, f"within {known}"))
    inside = made.velocity[(made.velocity > low) & (made.velocity < high)]
    velocity = np.array([low, *inside, high])
    return Library(made.rate, velocity, np.stack([made.at(float(v)) for v in velocity]))


def _carried(scene: Scene, key: str, rate: float) -> None:
    """A library sounds up to the end of the identified band; rate and device have to carry that."""
    least = 4.0 * BAND[1]
    if rate < least:
        what = f"holds {rate:g} samples a second, which cannot carry {BAND[1]:g} Hz"
        raise InputError(scene.problem(f"{key}.library", None, what, f"at least {least:g} Hz"))
    if scene.device is not None and scene.device.rate < least:
        what = f"cannot be played by a loop of {scene.device.rate:g} Hz: it sounds up to {BAND[1]:g} Hz"
        raise InputError(scene.problem(f"{key}.library", None, what, f"device.rate of at least {least:g} Hz"))


def _device_force(scene: Scene) -> float | None:
    """N, that the scene's device gives at most, where anybody says so."""
    if scene.device is None:
        return None
    profile = profile_named(scene.device.profile or "")
    return scene.device.max_force or (profile.max_force if profile else None)
