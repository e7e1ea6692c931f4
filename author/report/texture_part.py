# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The report about the effect `texture`: what is stored, and a drag over it with its line at k v."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from palpate.author.texture.drag import drag
from palpate.author.texture.drag_picture import drag_picture
from palpate.fields.cook import cook
from palpate.fields.response_field import ResponseField
from palpate.fields.texture_layout import read_texture

__all__ = ["draw_texture", "texture_row"]


def texture_row(field: ResponseField) -> dict[str, Any] | None:
    """What report.json says of it; None where the field has no such effect."""
    if "texture" not in field.layers:
        return None
    texture = read_texture(field.layers["texture"])
    k = [
        float(k)
        for w in texture.waves
        for k, a in zip(w.spatial_frequency, w.amplitude, strict=True)
        if a > 0.0
    ]
    return {
        "wave_count": len(k),
        "wavelength": [1.0 / max(k), 1.0 / min(k)] if k and min(k) > 0.0 else [None, None],
        "height_max": texture.height_max,
        "fade_depth": texture.fade_depth,
        "force_max": texture.stiffness * texture.height_max,
        "force_amplitude": float(max(texture.force_amplitude(w).max() for w in texture.waves)),
        "drag": None,
        "picture": None,
    }


def draw_texture(
    folder: Path, field: ResponseField, row: dict[str, Any], suffix: str
) -> list[dict[str, str]]:
    """Drags the tool over the strongest wave and draws that into `folder`; rows of the report's pictures."""
    dragged = drag(cook(field))
    if dragged is None:
        return []
    picture = folder / f"texture{suffix}.png"
    drag_picture(dragged, picture)
    row |= {"drag": dragged.told(), "picture": picture.name}
    caption = f"{field.tool.name}: force of a drag over its strongest wave, and its spectrum"
    return [{"file": picture.name, "tool": field.tool.name, "caption": caption}]
