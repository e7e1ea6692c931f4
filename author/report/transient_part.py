# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The report about the effect `transient`: what is stored, how it looks over time and frequency, how it sounds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.transients.pictures import tap_sound, transient_picture
from palpate.author.transients.stylus import Stylus
from palpate.author.transients.tap import swept
from palpate.author.transients.transient_stage import transient_summary
from palpate.fields.response_field import ResponseField
from palpate.fields.transient_layout import read_transient_layer

__all__ = ["draw_transient", "transient_row"]


def transient_row(field: ResponseField) -> dict[str, Any] | None:
    """What report.json says of it; None where the field has no such effect."""
    if "transient" not in field.layers:
        return None
    return {**transient_summary(field.layers["transient"]), "picture": None, "sound": None}


def draw_transient(
    folder: Path, field: ResponseField, row: dict[str, Any], suffix: str
) -> list[dict[str, str]]:
    """Draws the forces and sounds a tap at the middle velocity into `folder`; rows of the report's pictures.

    The sound is what the tip of the simulated stylus accelerates when it is given the force, three times.
    """
    layer = read_transient_layer(field.layers["transient"])
    rate, attenuation = layer.numbers["rate"], layer.numbers["attenuation"]
    picture, sound = folder / f"transient{suffix}.png", folder / f"transient{suffix}.wav"
    force = attenuation * layer.force.astype(float)
    transient_picture(rate, layer.velocity, force, picture)
    stylus = Stylus()
    middle = len(layer.velocity) // 2
    time = np.arange(0.0, (force.shape[1] - 1) / rate + 0.1, 1.0 / stylus.rate)
    played = np.interp(time, np.arange(force.shape[1]) / rate, force[middle], right=0.0)
    tap_sound(swept(stylus, -played), stylus.rate, sound)
    row |= {"picture": picture.name, "sound": sound.name, "sound_velocity": float(layer.velocity[middle])}
    caption = f"{field.tool.name}: transients by incoming velocity, over time and over frequency"
    return [{"file": picture.name, "tool": field.tool.name, "caption": caption}]
