# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Thin view of the C++ runtime: the same field, session and tick that a servo loop uses, on NumPy arrays.

    field = Field.open("liver.rfield")
    session = Session(field)
    response = session.tick([0, 0, 0.05], dt=1e-3)

Units are SI, axes the organ's own while it has no pose; `palpate.h` (see `include_folder`) is the manual.
"""

from palpate.runtime.bench import bench
from palpate.runtime.deformation import DeformationInfo, deformation, deformation_info
from palpate.runtime.field import Field, FieldInfo
from palpate.runtime.layout import Adhesion, Region, Response, Tick
from palpate.runtime.library import RuntimeFailure, cmake_folder, include_folder, version
from palpate.runtime.organ import Organ
from palpate.runtime.servo import Servo
from palpate.runtime.session import Config, Session
from palpate.runtime.texture import TextureInfo, TextureLimits, texture_info

__all__ = [
    "Adhesion",
    "Config",
    "DeformationInfo",
    "Field",
    "FieldInfo",
    "Organ",
    "Region",
    "Response",
    "RuntimeFailure",
    "Servo",
    "Session",
    "TextureInfo",
    "TextureLimits",
    "Tick",
    "bench",
    "cmake_folder",
    "deformation",
    "deformation_info",
    "include_folder",
    "texture_info",
    "version",
]
