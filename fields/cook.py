# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""ResponseField -> the bytes of an .rfield, which the runtime reads in place.

Of the geometry, which all tools of an asset share, the file holds what the tool's band needs.  Its coefficients
become int16 counts of at most 1 um (`SCALE_MAX`), so they are off by at most half a micrometre; amplitudes become
float32 (relative 6e-8); curves stay double.  The same field always gives the same bytes: nothing in the file
depends on the time, the machine or the order of a dictionary.
"""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
import zlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from palpate.fields.band import blocks_in_band
from palpate.fields.largest_stiffness import largest_stiffness
from palpate.fields.lattice import ABSENT_UNREACHED, Lattice
from palpate.fields.response_field import DepthCurves, ResponseField
from palpate.fields.rfield_layout import (
    CHANNEL_LIMIT,
    HEADER,
    HEADER_DTYPE,
    LAYER_LIMIT,
    LAYERS,
    LAYOUT_HASH,
    MAGIC,
    SECTION_ALIGNMENT,
    SECTIONS,
    VERSION,
    WAY_LIMIT,
    section_element_size,
)

__all__ = ["SCALE_MAX", "CookError", "cook", "geometry_counts", "write_rfield"]

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


def cook(field: ResponseField, tilted: Sequence[tuple[float, ResponseField]] = ()) -> bytes:
    """The .rfield of `field` in all its ways of touching.

    Args:
        field: the response with the tool's axis along the outward normal, or in its one way.
        tilted: further ways of touching in place of `field.ways`, each the cosine of the angle between tool axis and
            outward normal, falling from below 1 to 0, and its response: amplitudes (on the same lattice) and
            offset are its own, all else has to be `field`'s.

    Raises:
        CookError: a number is not finite, a shape does not fit, the geometry spans more than int16 holds, or a
            way of touching does not go with the first.
    """
    if not tilted:
        own = field.fields_by_way()
        tilted = [(way.cosine, one) for way, one in zip(field.ways, own[1:], strict=True)]
    ways = [field, *(way for _, way in tilted)]
    cosines = np.array([1.0, *(cosine for cosine, _ in tilted)])
    for way in ways:
        _check(way)
    _check_ways(ways, cosines)
    geometry, amplitudes = field.geometry.signed_distance, field.amplitudes
    counts, scale, bias = geometry_counts(geometry)
    kept = blocks_in_band(field.geometry, field.own_band)
    if not len(kept.rows):
        raise CookError("band", list(map(float, field.own_band)), "m", "the geometry must know some of it")
    amplitude_index, rows = _amplitude_rows([way.amplitudes for way in ways])
    provenance = json.dumps(_plain(field.provenance), sort_keys=True, separators=(",", ":"), allow_nan=False)
    arrays = [
        kept.index.astype("<i4"),
        counts[kept.rows],
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
        "tool_offset": max(way.tool.offset for way in ways),
        "depth_max": field.depth_max,
        "stiffness_max": max(largest_stiffness(way) for way in ways),
        "band": field.own_band,
        "geometry_error_p99": field.geometry.error_p99,
        "geometry_flagged_share": field.geometry.flagged_share,
        "geometry_origin": geometry.origin,
        "geometry_spacing": geometry.spacing,
        "geometry_scale": scale,
        "geometry_bias": bias,
        "geometry_blocks": geometry.block_index.shape,
        "geometry_stored": len(kept.rows),
        "amplitude_origin": amplitudes.origin,
        "amplitude_spacing": amplitudes.spacing,
        "amplitude_blocks": amplitudes.block_index.shape,
        "amplitude_stored": rows.shape[0],
        "channel_stride": rows.shape[-1],
        "way_count": len(ways),
        "way_cosine": np.pad(cosines, (0, WAY_LIMIT - len(ways))),
        "way_offset": np.pad([way.tool.offset for way in ways], (0, WAY_LIMIT - len(ways))),
    }
    for kind in ("energy", "stiffness", "friction"):
        curves: DepthCurves = getattr(field, f"{kind}_curves")
        values[f"{kind}_curve_count"] = curves.curve_count
        values[f"{kind}_intervals"] = curves.coefficients.shape[1]
        values[f"{kind}_depth_end"] = curves.depth_end

    header = np.zeros((), dtype=HEADER_DTYPE)
    layers = [(name, field.layers[name]) for name in LAYERS if name in field.layers]
    offset, offsets, digest = HEADER_DTYPE.itemsize, [], hashlib.sha256()
    for name, payload in [*zip([s.name for s in SECTIONS], payloads, strict=True), *layers]:
        offset += -offset % SECTION_ALIGNMENT
        offsets.append(offset)
        offset += len(payload)
        if name != "provenance":
            digest.update(payload)
    layer_table = np.zeros((LAYER_LIMIT, 2), dtype="<u8")
    for (name, payload), start in zip(layers, offsets[len(SECTIONS) :], strict=True):
        layer_table[LAYERS.index(name)] = start, len(payload)
    values |= {
        "field_hash": digest.hexdigest().encode(),
        "file_size": offset,
        "section_offset": offsets[: len(SECTIONS)],
        "section_elements": [len(p) // section_element_size(s) for s, p in zip(SECTIONS, payloads, strict=True)],
        "section_element_size": [section_element_size(s) for s in SECTIONS],
        "layer_offset": layer_table[:, 0],
        "layer_size": layer_table[:, 1],
    }  # fmt: skip
    for entry in HEADER:
        if entry.name in values:
            header[entry.name] = values[entry.name]

    data = bytearray(offset)
    data[: HEADER_DTYPE.itemsize] = header.tobytes()
    for start, payload in zip(offsets, [*payloads, *(payload for _, payload in layers)], strict=True):
        data[start : start + len(payload)] = payload
    header["checksum"] = zlib.crc32(data)  # still zero in `data`
    data[: HEADER_DTYPE.itemsize] = header.tobytes()
    return bytes(data)


def geometry_counts(lattice: Lattice) -> tuple[np.ndarray, float, float]:
    """(counts, scale, bias): a file's coefficients are bias + scale * counts, m.  Raises CookError."""
    c = lattice.coefficients[..., 0]
    low, high = float(c.min()), float(c.max())
    scale = max((high - low) / 65000.0, 1e-9)
    if scale > SCALE_MAX:
        raise CookError(
            "geometry", high - low, "m", "coefficients must span at most 0.065 m; narrow the band"
        )
    bias = 0.5 * (low + high)
    return np.rint((c - bias) / scale).astype("<i2"), scale, bias


def _amplitude_rows(lattices: Sequence[Lattice]) -> tuple[np.ndarray, np.ndarray]:
    """Rows (stored, 4, 4, 4, ways, stride) with the zero block first and blocks that are zero in every way dropped;
    index with 0 for every absent block."""
    shape = lattices[0].block_index.shape
    row_of = np.zeros(int(np.prod(shape)), dtype="<i4")
    for lattice in lattices:  # in the order of each one's rows
        places = lattice.block_index.ravel()
        at = np.flatnonzero(places >= 0)
        at = at[np.argsort(places[at], kind="stable")]
        at = at[np.any(lattice.coefficients.astype("<f4")[places[at]] != 0, axis=(1, 2, 3, 4))]
        new = at[row_of[at] == 0]
        row_of[new] = row_of.max(initial=0) + 1 + np.arange(new.size)
    channels = lattices[0].channel_count
    stride = max(4, -(-channels // 4) * 4)
    rows = np.zeros((1 + row_of.max(initial=0), 4, 4, 4, len(lattices), stride), dtype="<f4")
    for way, lattice in enumerate(lattices):
        places = lattice.block_index.ravel()
        at = np.flatnonzero((row_of > 0) & (places >= 0))
        rows[row_of[at], :, :, :, way, :channels] = lattice.coefficients[places[at]]
    return row_of.reshape(shape), rows


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
        "band": field.own_band,
    }.items():
        bad = int(np.count_nonzero(~np.isfinite(values)))
        if bad:
            raise CookError(key, f"{bad} numbers not finite", "", "every number must be finite")
    low, high = field.own_band
    if not low < high:
        raise CookError("band", [float(low), float(high)], "m", "smallest before largest")
    if field.depth_max <= 0:
        raise CookError("depth_max", field.depth_max, "m", "must be positive")
    channels = sum(c.curve_count for c in curves.values())
    if field.amplitudes.channel_count != channels or not 0 < channels <= CHANNEL_LIMIT:
        raise CookError("amplitudes", field.amplitudes.channel_count, "channels",
                        f"one for each of the {channels} curves, 1 to {CHANNEL_LIMIT}")  # fmt: skip
    unknown = sorted(set(field.layers) - set(LAYERS)) + [k for k, v in field.layers.items() if not v]
    if unknown:
        raise CookError("layers", ", ".join(unknown), "", f"of {', '.join(LAYERS)}, with bytes in them")
    if field.energy_curves.curve_count == 0:
        raise CookError("energy_curves", 0, "curves", "at least one")
    for name, lattice in (("geometry", field.geometry.signed_distance), ("amplitudes", field.amplitudes)):
        low, high = int(lattice.block_index.min()), int(lattice.block_index.max())
        if low < ABSENT_UNREACHED or high >= lattice.block_count or lattice.block_count == 0:
            raise CookError(f"{name}.block_index", f"{low} to {high}", "", f"-3 to {lattice.block_count - 1}")


def _check_ways(ways: Sequence[ResponseField], cosines: np.ndarray) -> None:
    if len(ways) > WAY_LIMIT:
        raise CookError("tilted", len(ways) - 1, "ways", f"at most {WAY_LIMIT - 1} beside the first")
    if not (np.all(np.diff(cosines) < 0) and cosines[-1] >= 0):
        raise CookError("tilted", cosines.tolist(), "", "cosines have to fall from below 1 to 0")
    first = ways[0]
    for i, way in enumerate(ways[1:]):
        a, b = first.amplitudes, way.amplitudes
        same = (
            np.array_equal(a.origin, b.origin)
            and a.spacing == b.spacing
            and a.block_index.shape == b.block_index.shape
            and all(
                getattr(first, k).depth_end == getattr(way, k).depth_end
                and np.array_equal(getattr(first, k).coefficients, getattr(way, k).coefficients)
                for k in ("energy_curves", "stiffness_curves", "friction_curves")
            )
            and np.array_equal(
                first.geometry.signed_distance.coefficients, way.geometry.signed_distance.coefficients
            )
        )
        if not same:
            raise CookError(
                f"tilted[{i}]", "another lattice, geometry or curves", "", "those of the first way"
            )
