# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The structs and constants of palpate.h as NumPy types; a test compares them with the library's own table."""

from __future__ import annotations

from enum import IntEnum, IntFlag

import numpy as np

__all__ = [
    "ABI_VERSION",
    "CONFIG",
    "DEFORMATION_INFO",
    "DEFORMATION_INPUT",
    "DEFORMATION_RESULT",
    "FIELD_INFO",
    "RESPONSE",
    "SAMPLE",
    "STATE",
    "TEXTURE_INFO",
    "TEXTURE_LIMITS",
    "Adhesion",
    "Input",
    "Region",
    "Response",
    "Tick",
]

ABI_VERSION = 4


class Region(IntEnum):
    """palpate_region: where a point is."""

    OUTSIDE = 0
    FREE = 1
    CONTACT = 2
    DEEP = 3
    UNREACHED = 4
    UNKNOWN = 5


class Adhesion(IntEnum):
    """palpate_adhesion: how a stretched contact slips."""

    STICK_SLIP = 1
    SMOOTH = 2
    PROPORTIONAL = 3
    DAHL = 4


class Response(IntEnum):
    """palpate_response_kind: what is felt along the surface."""

    POTENTIAL = 0
    AXIAL = 1
    AXIAL_UNGUARDED = 2


class Input(IntFlag):
    """PALPATE_INPUT_ flags."""

    POSITION_ONLY = 1
    RELEASE = 2
    ORGAN_POSE = 4


class Tick(IntFlag):
    """PALPATE_TICK_ status bits; all but those of FELT mean zero force."""

    EXTRAPOLATED = 1
    SLIPPING = 2
    UNREACHED = 4
    TOO_DEEP = 8
    PASSED_THROUGH = 16
    WAITING = 32
    JUMP = 64
    STALE = 128
    BAD_INPUT = 256
    RELEASED = 512
    BAD_ARGUMENT = 1024
    FORCE_LIMITED = 2048
    LEAK_COVERED = 4096
    RULE_YIELDED = 8192
    TRANSIENT = 16384
    TRANSIENT_LIMITED = 32768
    TEXTURE_LIMITED = 65536
    FELT = (
        EXTRAPOLATED
        | SLIPPING
        | FORCE_LIMITED
        | LEAK_COVERED
        | RULE_YIELDED
        | TRANSIENT
        | TRANSIENT_LIMITED
        | TEXTURE_LIMITED
    )


FIELD_INFO = np.dtype(
    [
        ("size", "<u4"),
        ("channel_count", "<u4"),
        ("tool_name", "<u8"),  # pointers
        ("tool_shape", "<u8"),
        ("tool_hash", "<u8"),
        ("field_hash", "<u8"),
        ("provenance", "<u8"),
        ("provenance_size", "<u8"),
        ("bytes", "<u8"),
        ("tool_offset", "<f8"),  # m
        ("depth_max", "<f8"),  # m
        ("stiffness_max", "<f8"),  # N/m
        ("band", "<f8", (2,)),  # m
        ("box_min", "<f8", (3,)),  # m
        ("box_max", "<f8", (3,)),  # m
        ("geometry_spacing", "<f8"),  # m
        ("amplitude_spacing", "<f8"),  # m
        ("geometry_error_p99", "<f8"),  # m
        ("geometry_flagged_share", "<f8"),
        ("geometry_blocks_stored", "<u8"),
        ("amplitude_blocks_stored", "<u8"),
        ("way_count", "<u4"),
        ("reserved", "<u4"),
        ("way_cosine", "<f8", (4,)),
        ("way_offset", "<f8", (4,)),  # m
    ]
)

SAMPLE = np.dtype(
    [
        ("size", "<u4"),
        ("region", "<u4"),
        ("depth", "<f8"),  # m
        ("normal", "<f8", (3,)),
        ("distance_gradient", "<f8", (3,)),
        ("stored_energy", "<f8"),  # J
        ("force", "<f8", (3,)),  # N
        ("normal_force", "<f8"),  # N
        ("stiffness", "<f8"),  # N/m
        ("friction_stiffness", "<f8"),  # N/m
        ("friction_coefficient", "<f8"),
    ]
)

CONFIG = np.dtype(
    [
        ("size", "<u4"),
        ("adhesion", "<u4"),
        ("reference_point", "<f8", (3,)),  # m
        ("friction_coefficient", "<f8"),
        ("speed_max", "<f8"),  # m/s
        ("dt_max", "<f8"),  # s
        ("adhesion_start", "<f8"),
        ("force_max", "<f8"),  # N
        ("passivity_control", "<u4"),
        ("response", "<u4"),
        ("tool_axis", "<f8", (3,)),
    ]
)

STATE = np.dtype(
    [
        ("size", "<u4"),
        ("flags", "<u4"),
        ("dt", "<f8"),  # s
        ("position", "<f8", (3,)),  # m
        ("orientation", "<f8", (4,)),  # x y z w
        ("organ_position", "<f8", (3,)),  # m
        ("organ_orientation", "<f8", (4,)),  # x y z w
    ]
)

RESPONSE = np.dtype(
    [
        ("size", "<u4"),
        ("status", "<u4"),
        ("region", "<u4"),
        ("reserved", "<u4"),
        ("force", "<f8", (3,)),  # N
        ("torque", "<f8", (3,)),  # N m
        ("reference_point", "<f8", (3,)),  # m
        ("anchor", "<f8", (3,)),  # m
        ("normal", "<f8", (3,)),
        ("depth", "<f8"),  # m
        ("normal_force", "<f8"),  # N
        ("stiffness", "<f8"),  # N/m
        ("friction_stiffness", "<f8"),  # N/m
        ("friction_coefficient", "<f8"),
        ("stored_energy", "<f8"),  # J
        ("spring_energy", "<f8"),  # J
        ("surface_offset", "<f8"),  # m
        ("work_in", "<f8"),  # J
        ("dissipated_friction", "<f8"),  # J
        ("dissipated_rule", "<f8"),  # J
        ("hold_leak", "<f8"),  # J
        ("organ_work", "<f8"),  # J
        ("injected", "<f8"),  # J
        ("way_cosine", "<f8"),
    ]
)

DEFORMATION_INFO = np.dtype(
    [
        ("size", "<u4"),
        ("node_count", "<u4"),
        ("bytes", "<u8"),
        ("radius", "<f8"),  # m
        ("depth_end", "<f8"),  # m
        ("error_p95", "<f8"),
        ("error_max", "<f8"),
        ("error_p95_length", "<f8"),  # m
        ("error_max_length", "<f8"),  # m
        ("error_within", "<f8"),  # m
    ]
)

DEFORMATION_INPUT = np.dtype(
    [
        ("size", "<u4"),
        ("flags", "<u4"),
        ("reference_point", "<f8", (3,)),  # m
        ("anchor", "<f8", (3,)),  # m
        ("surface_offset", "<f8"),  # m
        ("organ_position", "<f8", (3,)),  # m
        ("organ_orientation", "<f8", (4,)),  # x y z w
    ]
)

DEFORMATION_RESULT = np.dtype(
    [
        ("size", "<u4"),
        ("reserved", "<u4"),
        ("contact_point", "<f8", (3,)),  # m
        ("normal", "<f8", (3,)),
        ("depth", "<f8"),  # m
        ("radius", "<f8"),  # m
        ("moved_count", "<u8"),
    ]
)

_LIMITS = [
    ("time_factor", "<f8"),
    ("space_factor", "<f8"),
    ("force_factor", "<f8"),
    ("resolution", "<f8"),  # m
    ("force_resolution", "<f8"),  # N
    ("stiffness_max", "<f8"),  # N/m
    ("structural_frequency", "<f8"),  # Hz
]

TEXTURE_LIMITS = np.dtype([("size", "<u4"), ("reserved", "<u4"), *_LIMITS])

TEXTURE_INFO = np.dtype(
    [
        ("size", "<u4"),
        ("wave_count", "<u4"),
        ("bytes", "<u8"),
        ("height_max", "<f8"),  # m
        ("fade_depth", "<f8"),  # m
        ("spatial_frequency_max", "<f8"),  # 1/m
        ("stiffness", "<f8"),  # N/m
        *_LIMITS,
        ("normal_force", "<f8"),  # N
    ]
)
