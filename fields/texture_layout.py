# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The layer `texture` of an .rfield, and its bytes; C++: src/layers/texture.h.

Header (version 1: without its last number) | kx, ky, kz (1/m), phase (cycles), amplitude (m), each 4 group_count f64 |
with masks: zeros up to 64 bytes | index i32, then zeros up to 64 bytes | coefficients f32 (mask_stored, 4, 4, 4, 4),
the first block zero.  Little-endian.
"""

from __future__ import annotations

import numpy as np

from palpate.fields.field_error import FieldError
from palpate.fields.lattice import BLOCK_EDGE, Lattice
from palpate.fields.texture import MASK_LIMIT, WAVE_LIMIT, DeviceLimits, Texture, Waves

__all__ = ["HEADER_DTYPE", "read_texture", "texture_bytes"]

MAGIC = 0x54584554
"""TEXT."""
VERSION = 2
NO_MASK = 0xFFFFFFFF
LIMITS = tuple(DeviceLimits.__dataclass_fields__)
HEADER_DTYPE = np.dtype(
    [
        ("magic", "<u4"),
        ("version", "<u4"),
        ("group_count", "<u4"),
        ("mask_stored", "<u4"),  # blocks, the zero block included; 0: no masks
        ("mask_blocks", "<u4", (3,)),
        ("reserved", "<u4"),
        ("mask_channel", "<u4", (WAVE_LIMIT // 4,)),  # or NO_MASK
        ("fade_depth", "<f8"),  # m
        ("stiffness", "<f8"),  # N/m
        *((name, "<f8") for name in LIMITS),
        ("mask_origin", "<f8", (3,)),  # m
        ("mask_spacing", "<f8"),  # m
        ("normal_force", "<f8"),  # N; since version 2
    ]
)
HEADER_BYTES = {1: HEADER_DTYPE.fields["normal_force"][1], VERSION: HEADER_DTYPE.itemsize}
"""By version."""


def texture_bytes(texture: Texture) -> bytes:
    """Raises FieldError where a number is not finite or a mask is not between 0 and 1."""
    h = np.zeros((), HEADER_DTYPE)
    h["magic"], h["version"] = MAGIC, VERSION
    h["mask_channel"] = NO_MASK
    h["fade_depth"], h["stiffness"] = texture.fade_depth, texture.stiffness
    h["normal_force"] = texture.normal_force
    for name in LIMITS:
        h[name] = getattr(texture.limits, name)
    groups = []
    for w in texture.waves:
        for first in range(0, len(w.phase), 4):
            rows = np.zeros((5, 4))
            some = slice(first, first + 4)
            count = len(w.phase[some])
            rows[:3, :count], rows[3, :count], rows[4, :count] = (
                w.vector[some].T,
                w.phase[some],
                w.amplitude[some],
            )
            if w.mask >= 0:
                h["mask_channel"][len(groups)] = w.mask
            groups.append(rows)
    h["group_count"] = len(groups)
    waves = np.concatenate(groups, axis=1).astype("<f8")
    if not np.isfinite(waves).all() or (any(w.mask >= 0 for w in texture.waves) and texture.masks is None):
        raise FieldError("texture: a wave has a number that is not finite, or a mask that is not there")
    data = b""
    if texture.masks is not None:
        lattice = texture.masks
        kept = np.zeros((1 + lattice.block_count, BLOCK_EDGE, BLOCK_EDGE, BLOCK_EDGE, MASK_LIMIT), "<f4")
        kept[1:, ..., : lattice.channel_count] = lattice.coefficients
        if not (np.isfinite(kept).all() and kept.min() >= 0.0 and kept.max() <= 1.0):
            raise FieldError("texture: masks have to be between 0 and 1")
        h["mask_stored"], h["mask_blocks"] = len(kept), lattice.block_index.shape
        h["mask_origin"], h["mask_spacing"] = lattice.origin, lattice.spacing
        index = np.where(lattice.block_index >= 0, lattice.block_index + 1, 0).astype("<i4").tobytes()
        data = index + bytes(-len(index) % 64) + kept.tobytes()
    head = h.tobytes() + waves.tobytes()
    return head + (bytes(-len(head) % 64) + data if data else b"")


def read_texture(data: bytes) -> Texture:
    """What `texture_bytes` wrote.  Raises FieldError."""
    if len(data) < HEADER_BYTES[1]:
        raise FieldError(f"texture: {len(data)} bytes; at least {HEADER_BYTES[1]} are right")
    h = np.frombuffer(data[: HEADER_DTYPE.itemsize].ljust(HEADER_DTYPE.itemsize, b"\0"), HEADER_DTYPE)[
        0
    ].copy()
    if (
        h["magic"] != MAGIC
        or h["version"] not in HEADER_BYTES
        or not 1 <= h["group_count"] <= WAVE_LIMIT // 4
    ):
        known = " or ".join(map(str, HEADER_BYTES))
        raise FieldError(f"texture: version {h['version']} with {h['group_count']} groups; {known} is right")
    if h["version"] == 1:
        h["normal_force"] = 0.0
    count, at = 4 * int(h["group_count"]), HEADER_BYTES[int(h["version"])]
    end = at + 5 * 8 * count
    masks = None
    if h["mask_stored"]:
        blocks = tuple(int(b) for b in h["mask_blocks"])
        index_at = end + -end % 64
        index_end = index_at + 4 * int(np.prod(blocks))
        coefficients_at = index_end + -(index_end - index_at) % 64
        shape = (int(h["mask_stored"]), BLOCK_EDGE, BLOCK_EDGE, BLOCK_EDGE, MASK_LIMIT)
        end = coefficients_at + 4 * int(np.prod(shape))
    if len(data) != end:
        raise FieldError(f"texture: {len(data)} bytes; {end} are right")
    rows = np.frombuffer(data, "<f8", 5 * count, at).reshape(5, count)
    if h["mask_stored"]:
        index = np.frombuffer(data, "<i4", int(np.prod(blocks)), index_at).reshape(blocks)
        kept = np.frombuffer(data, "<f4", int(np.prod(shape)), coefficients_at).reshape(shape)
        masks = Lattice(
            h["mask_origin"].copy(),
            float(h["mask_spacing"]),
            index.astype(np.int32) - 1,
            kept[1:].astype(float),
        )
    waves = []
    for mask in dict.fromkeys(int(c) for c in h["mask_channel"][: count // 4]):
        own = np.repeat(h["mask_channel"][: count // 4] == mask, 4) & (rows[4] > 0)
        row = -1 if mask == NO_MASK else mask
        waves.append(Waves(rows[:3, own].T.copy(), rows[3, own].copy(), rows[4, own].copy(), row))
    return Texture(
        tuple(waves),
        float(h["fade_depth"]),
        float(h["stiffness"]),
        DeviceLimits(**{name: float(h[name]) for name in LIMITS}),
        masks,
        float(h["normal_force"]),
    )
