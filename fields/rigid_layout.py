# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Cooked rigid objects, byte for byte: the list that runtime_cpp/src/layers/rigid_layout.h has in C++.

A file of its own (.rigid): a rigid scene has no response field.  Little endian; sections begin at multiples of 64.
"""

from __future__ import annotations

import zlib

import numpy as np

__all__ = [
    "ELEMENT",
    "FORMATION",
    "HEADER",
    "KINDS",
    "MAGIC",
    "MERGE",
    "PAIR",
    "VERSION",
    "formation_hash",
    "packed",
]

MAGIC, VERSION = 0x44474952, 1
ALIGNMENT = 64
KINDS = (
    "vertex", "segment", "circle", "polygon", "disc", "sphere", "cylinder", "cone", "torus", "paraboloid",
)  # fmt: skip

_SECTIONS = ("elements", "pairs", "numbers", "indices", "merges", "formations", "formation_indices")

HEADER = np.dtype(
    [
        ("magic", "<u4"), ("version", "<u4"), ("byte_count", "<u8"), ("checksum", "<u4"), ("reserved", "<u4"),
        ("held_count", "<u4"), ("element_count", "<u4"),
        *((name, "<u4") for name in ("pair_count", "number_count", "index_count", "merge_count",
                                     "formation_count", "formation_index_count")),
        *((name, "<u8") for name in _SECTIONS),
        *((name, "<f8") for name in ("threshold", "stiffness", "damping", "static_friction", "kinetic_friction",
                                     "tangential_stiffness", "depth_max", "speed_static", "hysteresis")),
        ("gravity", "<f8", 3), ("mass", "<f8"), ("inertia", "<f8", 6), ("held_radius", "<f8"),
    ]
)  # fmt: skip

ELEMENT = np.dtype(
    [
        ("kind", "<u4"), ("side", "<i4"), ("beside_first", "<u4"), ("beside_count", "<u4"), ("up_first", "<u4"),
        ("up_count", "<u4"), ("number_first", "<u4"), ("number_count", "<u4"),
        ("bound_centre", "<f8", 3), ("bound_radius", "<f8"), ("centre", "<f8", 3), ("axis", "<f8", 3),
        ("across", "<f8", 3),
        ("radius", "<f8"), ("size", "<f8"), ("low", "<f8"), ("high", "<f8"), ("cosine", "<f8"),
        ("normal", "<f8", (2, 3)),
    ]
)  # fmt: skip

PAIR = np.dtype([("held", "<u2"), ("fixed", "<u2")])
MERGE = np.dtype([("key", "<u4"), ("region", "<u4")])
FORMATION = np.dtype([("hash", "<u8"), ("first", "<u4"), ("count", "<u4")])


def formation_hash(keys: tuple[int, ...]) -> int:
    """FNV-1a (Fowler, Noll, Vo 1991) over the rising keys as words: what the runtime looks a formation up by."""
    value = 0xCBF29CE484222325
    for key in keys:
        value = ((value ^ key) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    return value


def packed(header: np.ndarray, sections: dict[str, np.ndarray]) -> bytes:
    """The bytes of cooked objects.

    Args:
        header: () HEADER, parameters filled; counts, offsets, size and checksum are written here.
        sections: arrays by the names of `_SECTIONS`.
    """
    header = header.copy()
    header["magic"], header["version"], header["checksum"] = MAGIC, VERSION, 0
    at, body = -(-HEADER.itemsize // ALIGNMENT) * ALIGNMENT, b""
    first = at
    counts = {
        "pairs": "pair_count", "numbers": "number_count", "indices": "index_count", "merges": "merge_count",
        "formations": "formation_count", "formation_indices": "formation_index_count", "elements": "element_count",
    }  # fmt: skip
    for name in _SECTIONS:
        raw = sections[name].tobytes()
        header[name], header[counts[name]] = first + len(body), len(sections[name])
        body += raw + bytes(-len(raw) % ALIGNMENT)
    header["byte_count"] = first + len(body)
    front = bytes(first - HEADER.itemsize)
    header["checksum"] = zlib.crc32(header.tobytes() + front + body)
    return header.tobytes() + front + body
