# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The effect texture of an opened field, and what a device can render of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.runtime.field import Field
from palpate.runtime.layout import TEXTURE_INFO, TEXTURE_LIMITS
from palpate.runtime.library import check, library

__all__ = ["TextureInfo", "TextureLimits", "texture_info"]


@dataclass(frozen=True)
class TextureLimits:
    """palpate_texture_limits: Hayward's table 1; 0 is no limit.

    Attributes:
        time_factor, space_factor, force_factor: alpha, beta, gamma.
        resolution: delta, m; of position.
        force_resolution: b, N.
        stiffness_max: A_0, N/m.
        structural_frequency: F_0, Hz.
    """

    time_factor: float = 0.0
    space_factor: float = 0.0
    force_factor: float = 0.0
    resolution: float = 0.0
    force_resolution: float = 0.0
    stiffness_max: float = 0.0
    structural_frequency: float = 0.0

    def as_struct(self) -> np.ndarray:
        """As palpate_texture_limits, ()."""
        raw = np.zeros((), TEXTURE_LIMITS)
        raw["size"] = TEXTURE_LIMITS.itemsize
        for name in self.__dataclass_fields__:
            raw[name] = getattr(self, name)
        return raw


@dataclass(frozen=True)
class TextureInfo:
    """palpate_texture_info: lengths in m, spatial frequency in 1/m, stiffness in N/m, force in N."""

    wave_count: int
    bytes: int
    height_max: float
    fade_depth: float
    spatial_frequency_max: float
    stiffness: float
    normal_force: float
    limits: TextureLimits


def texture_info(field: Field) -> TextureInfo:
    """Raises RuntimeFailure where the field has no such effect."""
    raw = np.zeros((), TEXTURE_INFO)
    raw["size"] = TEXTURE_INFO.itemsize
    check(library().palpate_texture_describe(field.handle, raw.ctypes.data))
    limits = {name: raw[name].item() for name in TextureLimits.__dataclass_fields__}
    names = [name for name in TextureInfo.__dataclass_fields__ if name != "limits"]
    return TextureInfo(**{name: raw[name].item() for name in names}, limits=TextureLimits(**limits))
