# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What holds between the keys of [[texture]], and between it and the rest of the scene."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from palpate.author.scene_tables import Device, Organ, SceneHead
from palpate.author.texture.texture_table import Texture

__all__ = ["FACTORS", "textures"]

Broken = tuple[str, Any, str, str]
"""key, value, what, expected."""
FACTORS = {"time_factor": 2.0, "space_factor": 2.0, "force_factor": 10.0}
"""Safety factors where nobody says: the least of Hayward's table 1."""

_KEYS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "grating": (("amplitude", "direction"), ("wavelength", "spatial_frequency", "fade_depth")),
    "noise": (("amplitude", "band"), ("seed", "waves", "direction", "fade_depth")),
    "profile": (("file", "direction"), ("amplitude", "band", "waves", "fade_depth")),
}
"""Kind: keys it needs, further keys it may have."""
_OWN_KEYS = tuple(sorted({key for pair in _KEYS.values() for keys in pair for key in keys}))


def textures(
    tables: Mapping[int, Texture],
    head: SceneHead | None,
    organ: Organ | None,
    device: Device | None,
) -> Iterator[Broken]:
    """`tables`: those that could be read, by their place in the file."""
    asked = head is not None and "texture" in head.effects
    if asked and not tables:
        what = "asks for textures that the scene does not describe"
        yield "scene.effects", list(head.effects) if head else [], what, "a table [[texture]]"
    painted = organ.paint.texture_amplitude if organ is not None and organ.paint is not None else None
    if painted is not None and head is not None and not asked:
        what = "paints what scene.effects leaves out"
        yield "organ.paint.texture_amplitude", painted, what, 'the effect "texture", or no such paint'
    for i, texture in tables.items():
        key = f"texture[{i}]"
        if head is not None and not asked:
            what = "describes what scene.effects leaves out"
            yield key, texture.kind, what, 'the effect "texture", or no such table'
        yield from _own(key, texture)
        if device is not None and device.resolution is not None:
            yield from _resolved(key, texture, device, device.resolution)


def _own(key: str, texture: Texture) -> Iterator[Broken]:
    needed, optional = _KEYS[texture.kind]
    for name in needed:
        if getattr(texture, name) is None:
            yield f"{key}.{name}", None, "is missing", f"{name} of a {texture.kind}"
    for name in _OWN_KEYS:
        value = getattr(texture, name)
        if value is not None and name not in needed + optional:
            told = str(value) if name == "file" else list(value) if isinstance(value, tuple) else value
            yield (
                f"{key}.{name}",
                told,
                f"is not used by a {texture.kind}",
                "only " + ", ".join(needed + optional),
            )
    if texture.kind == "grating" and (texture.wavelength is None) == (texture.spatial_frequency is None):
        what = "is given twice" if texture.wavelength is not None else "is missing"
        yield f"{key}.wavelength", texture.wavelength, what, "wavelength or spatial_frequency"
    if texture.band is not None and not texture.band[0] < texture.band[1]:
        yield (
            f"{key}.band",
            list(texture.band),
            "does not rise (1/m)",
            "the least frequency, then the largest",
        )
    if texture.file is not None and texture.file.suffix.lower() not in (".csv", ".npz"):
        yield f"{key}.file", str(texture.file), "is of no known kind", "a .csv or .npz file"
    places = [
        name for name in ("box", "sphere", "half_space", "surface") if getattr(texture, name) is not None
    ]
    if len(places) > 1:
        yield f"{key}.{places[1]}", None, f"is given beside {places[0]}", "one place"


def _resolved(key: str, texture: Texture, device: Device, resolution: float) -> Iterator[Broken]:
    """What is finer than positions are known: a profile's harmonics are left out instead (texture_stage.py)."""
    factor = max(device.time_factor or FACTORS["time_factor"], device.space_factor or FACTORS["space_factor"])
    limit = 1.0 / (factor * resolution)
    named = (
        f"the device resolves {1e6 * resolution:g} um, and {factor:g} of them have to lie within a wavelength"
    )
    if texture.wavelength is not None and 1.0 / texture.wavelength >= limit:
        yield (
            f"{key}.wavelength",
            texture.wavelength,
            f"is finer than {named} (m)",
            f"more than {1.0 / limit:g} m",
        )
    if texture.spatial_frequency is not None and texture.spatial_frequency >= limit:
        what = f"is finer than {named} (1/m)"
        yield f"{key}.spatial_frequency", texture.spatial_frequency, what, f"less than {limit:g} 1/m"
    if texture.kind == "noise" and texture.band is not None and texture.band[1] >= limit:
        yield f"{key}.band[1]", texture.band[1], f"is finer than {named} (1/m)", f"less than {limit:g} 1/m"
