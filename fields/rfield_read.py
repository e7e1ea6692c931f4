# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""An .rfield back as arrays, for inspection and for tests that must not trust the runtime.

What comes back has exactly the numbers that the runtime uses (int16 counts decoded, float32 amplitudes).
Node curves are not in a cooked file, so `nodes` is empty.  The runtime's `open` is what proves a file; this
reader checks size, magic, version, layout and checksum only.
"""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from palpate.fields.lattice import Lattice
from palpate.fields.response_field import (
    ContactGeometry,
    DepthCurves,
    ResponseField,
    ResponseNodes,
    ToolReference,
)
from palpate.fields.rfield_layout import (
    HEADER_DTYPE,
    LAYERS,
    LAYOUT_HASH,
    MAGIC,
    OLDER_VERSIONS,
    SECTIONS,
    VERSION,
)

__all__ = ["RFieldError", "read_header", "read_rfield"]

_DTYPES = {"i32": "<i4", "i16": "<i2", "f32": "<f4", "f64": "<f8", "char": "S1"}


class RFieldError(ValueError):
    """The bytes are not an .rfield of this version; the message says what is wrong."""


def read_header(source: bytes | str | os.PathLike) -> np.ndarray:
    """The header as a NumPy structure (see `rfield_layout.HEADER` for names and units).

    Raises:
        RFieldError: truncated, not an .rfield, another version or layout, or damaged.
    """
    data = source if isinstance(source, bytes) else Path(source).read_bytes()
    known = {VERSION: (LAYOUT_HASH, HEADER_DTYPE.itemsize), **OLDER_VERSIONS}
    shortest = min(size for _, size in known.values())
    if len(data) < shortest:
        raise RFieldError(f"{len(data)} bytes: shorter than the header of {shortest}")
    begin = data[: HEADER_DTYPE.itemsize].ljust(HEADER_DTYPE.itemsize, b"\0")
    header = np.frombuffer(begin, dtype=HEADER_DTYPE, count=1)[0].copy()
    if header["magic"] != MAGIC:
        raise RFieldError("not an .rfield: the first bytes are not PALPRFLD")
    version = int(header["version"])
    if (int(header["layout_hash"]), int(header["header_size"])) != known.get(version):
        raise RFieldError(f"layout version {version}; this palpate reads version {VERSION}: cook it again")
    size = int(header["header_size"])
    header = np.frombuffer(data[:size].ljust(len(begin), b"\0"), dtype=HEADER_DTYPE, count=1)[0].copy()
    if header["file_size"] != len(data):
        raise RFieldError(
            f"{len(data)} bytes where the header says {header['file_size']}: truncated or appended to"
        )
    blank = header.copy()
    blank["checksum"] = 0
    if zlib.crc32(data[size:], zlib.crc32(blank.tobytes()[:size])) != header["checksum"]:
        raise RFieldError("the checksum does not fit: the file is damaged")
    if version == 1:
        header["way_count"], header["way_cosine"][0], header["way_offset"][0] = 1, 1.0, header["tool_offset"]
    return header


def read_rfield(source: bytes | str | os.PathLike, way: int = 0) -> ResponseField:
    """The cooked field of one way of touching, with empty `nodes`; see `read_header` for errors."""
    data = source if isinstance(source, bytes) else Path(source).read_bytes()
    h = read_header(data)
    arrays = {}
    for i, s in enumerate(SECTIONS):
        arrays[s.name] = np.frombuffer(
            data, _DTYPES[s.kind], count=int(h["section_elements"][i]), offset=int(h["section_offset"][i])
        )
    phi = h["geometry_bias"] + h["geometry_scale"] * arrays["geometry_coefficients"].astype(float)
    channels = sum(int(h[f"{k}_curve_count"]) for k in ("energy", "stiffness", "friction"))
    if not 0 <= way < int(h["way_count"]):
        raise RFieldError(f"way {way} of {h['way_count']}")
    stored = arrays["amplitude_coefficients"].astype(float)
    rows = stored.reshape(-1, 4, 4, 4, int(h["way_count"]), int(h["channel_stride"]))[..., way, :]
    row_of = arrays["amplitude_index"].reshape(h["amplitude_blocks"])
    curves = {}
    for k in ("energy", "stiffness", "friction"):
        c = arrays[f"{k}_curves"].reshape(int(h[f"{k}_intervals"]) + 1, int(h[f"{k}_curve_count"]), 4)
        curves[k] = DepthCurves(float(h[f"{k}_depth_end"]), np.swapaxes(c[:-1], 0, 1).copy())
    empty = np.zeros((0, 0))
    return ResponseField(
        tool=ToolReference(h["tool_name"].decode(), h["tool_shape"].decode(), float(h["way_offset"][way]), {},
                           h["tool_hash"].decode()),
        geometry=ContactGeometry(
            Lattice(h["geometry_origin"].copy(), float(h["geometry_spacing"]),
                    arrays["geometry_index"].reshape(h["geometry_blocks"]), phi.reshape(-1, 4, 4, 4, 1)),
            h["band"].copy(), float(h["geometry_error_p99"]), float(h["geometry_flagged_share"])),
        nodes=ResponseNodes(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), empty, empty, np.zeros((0, 0, 3)),
                            empty, empty, np.zeros(0), np.zeros(0, bool), np.zeros(0), np.zeros(0, str)),
        energy_curves=curves["energy"],
        stiffness_curves=curves["stiffness"],
        friction_curves=curves["friction"],
        amplitudes=Lattice(h["amplitude_origin"].copy(), float(h["amplitude_spacing"]),
                           np.where(row_of == 0, -1, row_of).astype(np.int32), rows[..., :channels].copy()),
        depth_max=float(h["depth_max"]),
        provenance=json.loads(arrays["provenance"].tobytes().decode()),
        layers={name: data[start : start + size] for name, start, size in _layers(h)},
    )  # fmt: skip


def _layers(header: np.ndarray) -> Iterator[tuple[str, int, int]]:
    """Name, first byte and bytes of each layer that is there."""
    for i, name in enumerate(LAYERS):
        if header["layer_size"][i]:
            yield name, int(header["layer_offset"][i]), int(header["layer_size"][i])
