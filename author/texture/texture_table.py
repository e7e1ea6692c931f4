# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""[[texture]]: a small height on the organ's surface; rules between keys: texture_rules.py.

grating    amplitude; wavelength or spatial_frequency; direction
noise      amplitude (root mean square); band; seed, waves, direction (across which it is even)
profile    file; direction; amplitude (largest, rescaled), band, waves
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, Strict

from palpate.author.place import Place
from palpate.author.scene_types import Direction, Quantity, SurfaceFile

__all__ = ["FINEST", "WAVES", "Texture"]

FINEST = 1e6
"""1/m; the largest spatial frequency that a runtime takes."""

WAVES = 8
"""Of noise or a profile where the scene does not say."""

Length = Annotated[float, Quantity("length", above=0, most=0.1)]
SpatialFrequency = Annotated[float, Quantity("spatial frequency", above=0, most=FINEST)]


class Texture(Place):
    """[[texture]], everywhere where no place is given; the place is asked of the surface below the tool."""

    kind: Literal["grating", "profile", "noise"] = Field(description="grating | profile | noise")
    amplitude: Length | None = Field(
        default=None,
        description="height: of a grating's crest, of noise its root mean square, of a profile its largest; "
        "a profile's own when absent",
    )
    wavelength: Annotated[float, Quantity("length", least=1.0 / FINEST, most=0.1)] | None = Field(
        default=None, description="of a grating"
    )
    spatial_frequency: SpatialFrequency | None = Field(
        default=None, description="of a grating, instead of its wavelength"
    )
    direction: Direction | None = Field(
        default=None,
        description="along which heights change (grating, profile); noise that does not change along it",
    )
    file: SurfaceFile | None = Field(
        default=None,
        description="of a profile: CSV of two columns, position and height in m, or NPZ with arrays of these names",
    )
    band: tuple[SpatialFrequency, SpatialFrequency] | None = Field(
        default=None, description="least and largest spatial frequency, of noise or a profile"
    )
    seed: Annotated[int, Strict(), Field(ge=0)] | None = Field(
        default=None, description="of noise, a whole number from 0; 1 when absent"
    )
    waves: Annotated[int, Strict(), Field(ge=1, le=16)] | None = Field(
        default=None, description="of noise or a profile, 1 to 16; 8 when absent"
    )
    fade_depth: Length | None = Field(
        default=None,
        description="depth from which all of it is felt; of all textures the largest, and four times their heights "
        "together when absent",
    )
