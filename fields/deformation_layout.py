# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The one list of what an .rfield's layer `deformation` holds, and its bytes; C++: src/layers/deformation.h.

Header | arrays in the order of `arrays`, without gaps, doubles before floats, then zeros up to 8 bytes.  Little-endian.
"""

from __future__ import annotations

import numpy as np

from palpate.fields.deformation import COMPONENTS, Deformation, ToolGap
from palpate.fields.field_error import FieldError

__all__ = ["HEADER", "HEADER_DTYPE", "deformation_bytes", "layer_size", "read_deformation"]

MAGIC = 0x4D464544
"""DEFM."""
VERSION = 1
LIMITS = {"rank": 8, "radial_count": 64, "depth_count": 64, "node_count": 4096, "gap_count": 512}
"""Largest counts; the runtime's stack has room for these."""
ERRORS = ("p95", "max", "p95_m", "max_m", "within")

HEADER = (
    ("magic", "<u4", 1, "DEFM"),
    ("version", "<u4", 1, ""),
    ("rank", "<u4", 3, "shared tables of harmonics 0, 1, 2"),
    ("node_count", "<u4", 1, "N"),
    ("radial_count", "<u4", 1, "J"),
    ("depth_count", "<u4", 1, "K"),
    ("gap_count", "<u4", 2, "heights, distances"),
    ("depth_end", "<f8", 1, "m; of the last depth knot"),
    ("scale", "<f8", 1, "m; knots are even in R / (R + scale)"),
    ("radius", "<f8", 1, "m; nothing moves beyond"),
    ("normal_length", "<f8", 1, "m a unit of normal"),
    ("length", "<f8", 3, "m; of the covariance of each harmonic's amplitudes"),
    ("gap_step", "<f8", 1, "m"),
    ("error", "<f8", 5, "p95, worst share of depth; p95, worst, m; m from the contact; -1: not judged"),
)  # fmt: skip
HEADER_DTYPE = np.dtype(
    [(name, kind) if count == 1 else (name, kind, (count,)) for name, kind, count, _ in HEADER]
)


def arrays(h: np.ndarray) -> list[tuple[str, tuple[int, ...], str]]:
    """Name, shape and kind of what follows a header."""
    r, N, J, K = (
        [int(x) for x in h["rank"]],
        int(h["node_count"]),
        int(h["radial_count"]),
        int(h["depth_count"]),
    )
    r0, r1, r2 = r
    return [
        ("node", (N, 3), "<f8"),
        ("normal", (N, 3), "<f8"),
        ("mean", (r0,), "<f8"),
        ("weight", (N, r0 + 3 * r1 + 6 * r2), "<f8"),
        ("table_0", (r0, K, J, COMPONENTS[0]), "<f4"),
        ("table_1", (r1, K, J, COMPONENTS[1]), "<f4"),
        ("table_2", (r2, K, J, COMPONENTS[2]), "<f4"),
        ("stuck", (K, J, COMPONENTS[3]), "<f4"),
        ("gap", (int(h["gap_count"][0]), int(h["gap_count"][1])), "<f4"),
    ]


def layer_size(h: np.ndarray) -> int:
    """Bytes of a layer with the counts of a header (HEADER_DTYPE)."""
    size = HEADER_DTYPE.itemsize + sum(
        int(np.prod(shape)) * np.dtype(kind).itemsize for _, shape, kind in arrays(h)
    )
    return size + -size % 8


def deformation_bytes(model: Deformation) -> bytes:
    """Raises FieldError where a number is not finite or a count too large."""
    h = np.zeros((), HEADER_DTYPE)
    h["magic"], h["version"] = MAGIC, VERSION
    h["rank"] = model.ranks
    h["node_count"] = len(model.node)
    h["depth_count"], h["radial_count"] = model.stuck.shape[:2]
    h["gap_count"] = model.gap.value.shape
    for name in ("depth_end", "scale", "radius", "normal_length", "length"):
        h[name] = getattr(model, name)
    h["gap_step"] = model.gap.step
    h["error"] = [model.error.get(name, -1.0) for name in ERRORS]
    for name, limit in LIMITS.items():
        if int(np.max(h[name])) > limit:
            raise FieldError(f"deformation: {name} is {h[name]}; at most {limit} is right")
    held = {
        "node": model.node,
        "normal": model.normal,
        "mean": model.mean,
        "weight": model.weight,
        **{f"table_{i}": table for i, table in enumerate(model.tables)},
        "stuck": model.stuck,
        "gap": model.gap.value,
    }
    parts = [h.tobytes()]
    for name, shape, kind in arrays(h):
        value = np.ascontiguousarray(held[name], kind) + np.dtype(kind).type(
            0
        )  # no -0.0, which USD does not keep
        if value.shape != shape:
            raise FieldError(f"deformation: {name} has the shape {value.shape}; {shape} is right")
        if not np.isfinite(value).all():
            raise FieldError(f"deformation: {name} has numbers that are not finite")
        parts.append(value.tobytes())
    data = b"".join(parts)
    return data + bytes(-len(data) % 8)


def read_deformation(data: bytes) -> Deformation:
    """What `deformation_bytes` wrote, with the numbers that the runtime uses.  Raises FieldError."""
    if len(data) < HEADER_DTYPE.itemsize:
        raise FieldError(f"deformation: {len(data)} bytes; at least {HEADER_DTYPE.itemsize} are right")
    h = np.frombuffer(data, HEADER_DTYPE, 1)[0]
    if h["magic"] != MAGIC or h["version"] != VERSION:
        raise FieldError(f"deformation: version {h['version']}; {VERSION} is right")
    found, at = {}, HEADER_DTYPE.itemsize
    for name, shape, kind in arrays(h):
        count = int(np.prod(shape))
        size = count * np.dtype(kind).itemsize
        if at + size > len(data):
            raise FieldError(f"deformation: {len(data)} bytes end within {name}")
        found[name] = np.frombuffer(data, kind, count, at).reshape(shape).astype(float)
        at += size
    if len(data) != at + -at % 8:
        raise FieldError(f"deformation: {len(data)} bytes; {at + -at % 8} are right")
    length = [float(x) for x in h["length"]]
    return Deformation(
        depth_end=float(h["depth_end"]),
        scale=float(h["scale"]),
        radius=float(h["radius"]),
        tables=(found["table_0"], found["table_1"], found["table_2"]),
        stuck=found["stuck"],
        node=found["node"],
        normal=found["normal"],
        length=(length[0], length[1], length[2]),
        normal_length=float(h["normal_length"]),
        mean=found["mean"],
        weight=found["weight"],
        gap=ToolGap(float(h["gap_step"]), found["gap"]),
        error={name: float(e) for name, e in zip(ERRORS, h["error"], strict=True) if e >= 0.0},
    )
