# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""ResponseField -> the bytes of an .rfield, which the runtime reads in place.

Geometry coefficients become int16 counts of at most 1 um (`SCALE_MAX`), so they are off by at most half a
micrometre; amplitudes become float32 (relative 6e-8); curves stay double.  The same field always gives the
same bytes: nothing in the file depends on the time, the machine or the order of a dictionary.
"""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
import zlib
from pathlib import Path

import numpy as np

from palpate.fields.largest_stiffness import largest_stiffness
from palpate.fields.lattice import ABSENT_UNREACHED, Lattice
from palpate.fields.response_field import DepthCurves, ResponseField
from palpate.fields.rfield_layout import (
    CHANNEL_LIMIT,
    HEADER,
    HEADER_DTYPE,
    LAYOUT_HASH,
    MAGIC,
    SECTION_ALIGNMENT,
    SECTIONS,
    VERSION,
    section_element_size,
)

__all__ = ["SCALE_MAX", "CookError", "cook", "write_rfield"]

SCALE_MAX = 1e-6
"""m; coarsest count of the int16 geometry.  Coarser counts would show in the force of a first contact."""


class CookError(ValueError):
    """The field cannot be cooked.  `key` names the part, `value` what it is, `unit` its unit."""

    def __init__(self, key: str, value: object, unit: str, right: str):
        super().__init__(f"{key} = {value}{' ' + unit if unit else ''}: {right}")
        self.key, self.value, self.unit = key, value, unit


def write_rfield(field: ResponseField, path: str | os.PathLike) -> None:
    """Cook `field` into the file `path`: complete or not there at all, never half of it."""
    path = Path(path)
    data = cook(field)
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=path.name, suffix=".part")
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise


def cook(field: ResponseField) -> bytes:
    """The .rfield of `field`.

    Raises:
        CookError: a number is not finite, a shape does not fit, or the geometry spans more than int16 holds.
    """
    _check(field)
    geometry, amplitudes = field.geometry.signed_distance, field.amplitudes
    counts, scale, bias = _counts(geometry)
    amplitude_index, rows = _amplitude_rows(amplitudes)
    provenance = json.dumps(_plain(field.provenance), sort_keys=True, separators=(",", ":"), allow_nan=False)
    arrays = [
        geometry.block_index.astype("<i4"),
        counts,
        amplitude_index,
        rows,
        _curve_rows(field.energy_curves),
        _curve_rows(field.stiffness_curves),
        _curve_rows(field.friction_curves),
        np.frombuffer(provenance.encode(), dtype=np.uint8),
    ]
    payloads = [np.ascontiguousarray(a).tobytes() for a in arrays]

    values = {
        "magic": MAGIC,
        "version": VERSION,
        "header_size": HEADER_DTYPE.itemsize,
        "layout_hash": LAYOUT_HASH,
        "section_count": len(SECTIONS),
        "tool_name": _text(field.tool.name, "tool_name"),
        "tool_shape": _text(field.tool.shape, "tool_shape"),
        "tool_hash": _text(field.tool.hash, "tool_hash"),
        "tool_offset": field.tool.offset,
        "depth_max": field.depth_max,
        "stiffness_max": largest_stiffness(field),
        "band": field.geometry.band,
        "geometry_error_p99": field.geometry.error_p99,
        "geometry_flagged_share": field.geometry.flagged_share,
        "geometry_origin": geometry.origin,
        "geometry_spacing": geometry.spacing,
        "geometry_scale": scale,
        "geometry_bias": bias,
        "geometry_blocks": geometry.block_index.shape,
        "geometry_stored": geometry.block_count,
        "amplitude_origin": amplitudes.origin,
        "amplitude_spacing": amplitudes.spacing,
        "amplitude_blocks": amplitudes.block_index.shape,
        "amplitude_stored": rows.shape[0],
        "channel_stride": rows.shape[-1],
    }
    for kind in ("energy", "stiffness", "friction"):
        curves: DepthCurves = getattr(field, f"{kind}_curves")
        values[f"{kind}_curve_count"] = curves.curve_count
        values[f"{kind}_intervals"] = curves.coefficients.shape[1]
        values[f"{kind}_depth_end"] = curves.depth_end

    header = np.zeros((), dtype=HEADER_DTYPE)
    offset, offsets, digest = HEADER_DTYPE.itemsize, [], hashlib.sha256()
    for section, payload in zip(SECTIONS, payloads, strict=True):
        offset += -offset % SECTION_ALIGNMENT
        offsets.append(offset)
        offset += len(payload)
        if section.name != "provenance":
            digest.update(payload)
    values |= {
        "field_hash": digest.hexdigest().encode(),
        "file_size": offset,
        "section_offset": offsets,
        "section_elements": [len(p) // section_element_size(s) for s, p in zip(SECTIONS, payloads, strict=True)],
        "section_element_size": [section_element_size(s) for s in SECTIONS],
    }  # fmt: skip
    for entry in HEADER:
        if entry.name in values:
            header[entry.name] = values[entry.name]

    data = bytearray(offset)
    data[: HEADER_DTYPE.itemsize] = header.tobytes()
    for start, payload in zip(offsets, payloads, strict=True):
        data[start : start + len(payload)] = payload
    header["checksum"] = zlib.crc32(data)  # still zero in `data`
    data[: HEADER_DTYPE.itemsize] = header.tobytes()
    return bytes(data)


def _counts(lattice: Lattice) -> tuple[np.ndarray, float, float]:
    c = lattice.coefficients[..., 0]
    low, high = float(c.min()), float(c.max())
    scale = max((high - low) / 65000.0, 1e-9)
    if scale > SCALE_MAX:
        raise CookError(
            "geometry", high - low, "m", "coefficients must span at most 0.065 m; narrow the band"
        )
    bias = 0.5 * (low + high)
    return np.rint((c - bias) / scale).astype("<i2"), scale, bias


def _amplitude_rows(lattice: Lattice) -> tuple[np.ndarray, np.ndarray]:
    """Rows with the zero block first and all-zero blocks dropped; index with 0 for every absent block."""
    c = lattice.coefficients.astype("<f4")
    kept = np.flatnonzero(np.any(c != 0, axis=(1, 2, 3, 4)))
    row_of = np.zeros(lattice.block_count + 1, dtype="<i4")  # the last entry serves absent blocks
    row_of[kept] = 1 + np.arange(kept.size)
    index = row_of[np.where(lattice.block_index < 0, lattice.block_count, lattice.block_index)]
    stride = max(4, -(-lattice.channel_count // 4) * 4)
    rows = np.zeros((1 + kept.size, 4, 4, 4, stride), dtype="<f4")
    rows[1:, ..., : lattice.channel_count] = c[kept]
    return index, rows


def _curve_rows(curves: DepthCurves) -> np.ndarray:
    """(M + 1, R, 4): the intervals, then the quadratic that continues the last one beyond depth_end."""
    c = curves.coefficients
    h = curves.depth_end / c.shape[1]
    c0, c1, c2, c3 = np.moveaxis(c[:, -1], -1, 0)
    end = np.stack(
        [c0 + h * (c1 + h * (c2 + h * c3)), c1 + h * (2 * c2 + 3 * h * c3), c2 + 3 * h * c3, 0 * c3], axis=-1
    )
    return np.concatenate([np.swapaxes(c, 0, 1), end[None]]).astype("<f8")


def _text(text: str, key: str) -> bytes:
    size = next(e.count for e in HEADER if e.name == key)
    data = text.encode()
    if len(data) >= size or b"\0" in data:
        raise CookError(key, repr(text), "", f"at most {size - 1} bytes of UTF-8 without NUL")
    return data


def _plain(value: object) -> object:
    """`value` with NumPy scalars and arrays as Python numbers and lists, for JSON."""
    if isinstance(value, dict):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value if value is None or isinstance(value, str | int | float | bool) else str(value)


def _check(field: ResponseField) -> None:
    curves = {k: getattr(field, f"{k}_curves") for k in ("energy", "stiffness", "friction")}
    for key, values in {
        "geometry.coefficients": field.geometry.signed_distance.coefficients,
        "amplitudes.coefficients": field.amplitudes.coefficients,
        **{f"{k}_curves": c.coefficients for k, c in curves.items()},
        "tool.offset": field.tool.offset,
        "depth_max": field.depth_max,
        "geometry.band": field.geometry.band,
    }.items():
        bad = int(np.count_nonzero(~np.isfinite(values)))
        if bad:
            raise CookError(key, f"{bad} numbers not finite", "", "every number must be finite")
    if field.depth_max <= 0:
        raise CookError("depth_max", field.depth_max, "m", "must be positive")
    channels = sum(c.curve_count for c in curves.values())
    if field.amplitudes.channel_count != channels or not 0 < channels <= CHANNEL_LIMIT:
        raise CookError("amplitudes", field.amplitudes.channel_count, "channels",
                        f"one for each of the {channels} curves, 1 to {CHANNEL_LIMIT}")  # fmt: skip
    if field.energy_curves.curve_count == 0:
        raise CookError("energy_curves", 0, "curves", "at least one")
    for name, lattice in (("geometry", field.geometry.signed_distance), ("amplitudes", field.amplitudes)):
        low, high = int(lattice.block_index.min()), int(lattice.block_index.max())
        if low < ABSENT_UNREACHED or high >= lattice.block_count or lattice.block_count == 0:
            raise CookError(f"{name}.block_index", f"{low} to {high}", "", f"-3 to {lattice.block_count - 1}")
