# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What holds between the keys of [tool.transient], and between it and the rest of the scene."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from palpate.author.scene_tables import Device, SceneHead, Tool
from palpate.author.transients.transient_table import RATE, Transient, frequencies

__all__ = ["transients"]

Broken = tuple[str, Any, str, str]
"""key, value, what, expected."""
PER_PERIOD = 4.0
"""Samples in a period of the fastest oscillation at least, as of recordings (`require_usable`)."""
SAMPLES_LEAST = 8
"""In a duration."""

_KEYS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "pulse": (("amplitude", "duration"), ("rate",)),
    "decaying_sinusoid": (("amplitude", "frequency", "duration"), ("decay", "rate")),
    "modal": (("mode", "duration"), ("rate",)),
    "hunt_crossley": (("mass", "stiffness", "damping"), ("exponent", "velocity_count", "rate")),
    "library": (("library",), ()),
}
"""Shape: keys it needs, further keys it may have."""
_SHAPE_KEYS = tuple(sorted({key for pair in _KEYS.values() for keys in pair for key in keys}))


def transients(tools: Mapping[int, Tool], head: SceneHead | None, device: Device | None) -> Iterator[Broken]:
    """`tools`: those that could be read, by their place in the file."""
    asked = head is not None and "transient" in head.effects
    given = {i: tool.transient for i, tool in tools.items() if tool.transient is not None}
    if asked and tools and not given:
        what = "asks for transients that no tool describes"
        yield "scene.effects", list(head.effects) if head else [], what, "a table [tool.transient]"
    for i, transient in given.items():
        key = f"tool[{i}].transient"
        if head is not None and not asked:
            what = "describes what scene.effects leaves out"
            yield key, transient.shape, what, 'the effect "transient", or no such table'
        yield from _keys(key, transient)
        if device is not None:
            yield from _device(key, transient, device)


def _device(key: str, transient: Transient, device: Device) -> Iterator[Broken]:
    """Where the device's loop or force cannot do what is asked."""
    for name, frequency in frequencies(transient):
        if device.rate < PER_PERIOD * frequency:
            what = f"cannot be played by a loop of {device.rate:g} Hz (Hz)"
            yield f"{key}.{name}", frequency, what, f"at most {device.rate / PER_PERIOD:g} Hz"
    limit = device.max_force
    if limit is not None and transient.force_short is not None and transient.force_short > limit:
        what = f"is more than device.max_force, {limit:g} N (N)"
        yield f"{key}.force_short", transient.force_short, what, f"at most {limit:g} N"


def _keys(key: str, transient: Transient) -> Iterator[Broken]:
    """(key, value, what, expected) for what contradicts itself in the table at `key`."""
    needed, optional = _KEYS[transient.shape]
    for name in needed:
        if getattr(transient, name) is None:
            yield f"{key}.{name}", None, "is missing", f"{name} of a {transient.shape}"
    for name in _SHAPE_KEYS:
        if getattr(transient, name) is not None and name not in needed + optional:
            value = getattr(transient, name)
            told = [mode.model_dump() for mode in value] if name == "mode" else value
            yield (
                f"{key}.{name}",
                told,
                f"is not used by a {transient.shape}",
                "only " + ", ".join(needed + optional),
            )
    if transient.mode is not None and not transient.mode:
        yield f"{key}.mode", [], "sums nothing", "at least one mode"
    v = transient.velocity
    if v is not None and not v[0] < v[1]:
        yield f"{key}.velocity", list(v), "does not rise (m/s)", "the slowest contact, then the fastest"
    if transient.force_short is not None and transient.force_steady is not None:
        if transient.force_steady > transient.force_short:
            what = "is more than force_short (N)"
            yield f"{key}.force_steady", transient.force_steady, what, f"at most {transient.force_short:g} N"
    yield from _samples(key, transient)


def _samples(key: str, transient: Transient) -> Iterator[Broken]:
    """Where the stored rate cannot carry what is asked."""
    rate = transient.rate or RATE
    for name, frequency in frequencies(transient):
        if rate < PER_PERIOD * frequency:
            what = f"cannot carry {frequency:g} Hz ({name}) (Hz)"
            yield f"{key}.rate", rate, what, f"at least {PER_PERIOD * frequency:g} Hz"
    if transient.duration is not None and transient.duration * rate < SAMPLES_LEAST:
        what = f"has fewer than {SAMPLES_LEAST} samples at {rate:g} Hz (s)"
        yield f"{key}.duration", transient.duration, what, f"at least {SAMPLES_LEAST / rate:g} s"
