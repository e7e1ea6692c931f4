# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The layer `transient` of an .rfield: forces by incoming velocity that the runtime plays at a crossing of the surface.

Block = HEADER | velocity f64 (velocity_count), m/s, rising, above 0 | force f32 (velocity_count, sample_count), N,
positive out of the surface, zero at both ends of each row; little-endian, nothing after.  The same list stands in
runtime_cpp/src/layers/transient.h.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

__all__ = [
    "HEADER_DTYPE",
    "MAGIC",
    "SAMPLE_LIMIT",
    "VELOCITY_LIMIT",
    "VERSION",
    "TransientLayer",
    "TransientLayerError",
    "read_transient_layer",
    "transient_layer",
]

MAGIC = 0x534E5254
"""The letters TRNS."""
VERSION = 1
VELOCITY_LIMIT = 64
SAMPLE_LIMIT = 65536
ENTRIES = (
    ("magic", "<u4"),
    ("version", "<u4"),
    ("velocity_count", "<u4"),
    ("sample_count", "<u4"),
    ("rate", "<f8"),  # Hz
    ("attenuation", "<f8"),  # 0 to 1
    ("force_short", "<f8"),  # N; of the device for a moment, response included
    ("force_steady", "<f8"),  # N; for ever
    ("steady_time", "<f8"),  # s; over which the mean square is taken
    ("rearm_distance", "<f8"),  # m; so far off the surface another event may begin
    ("rearm_time", "<f8"),  # s; or so long off it
    ("velocity_min", "<f8"),  # m/s; slower contacts begin no event
    ("velocity_time", "<f8"),  # s; of the filter that measures the incoming velocity
    ("energy_max", "<f8"),  # J; that one event may give to the hand
    ("reserved", "<f8", (4,)),
)
HEADER_DTYPE = np.dtype(list(ENTRIES))
LIMITS = {
    "rate": (100.0, 1e6),
    "attenuation": (0.0, 1.0),
    "force_short": (0.0, 1e3),
    "force_steady": (0.0, 1e3),
    "steady_time": (1e-3, 1e4),
    "rearm_distance": (0.0, 1.0),
    "rearm_time": (0.0, 1e3),
    "velocity_min": (0.0, 1e2),
    "velocity_time": (0.0, 1.0),
    "energy_max": (0.0, 1e2),
}
"""Smallest and largest value that the runtime takes."""


@dataclass(frozen=True)
class TransientLayer:
    """Attributes: velocity (k,) m/s; force (k, n) N, positive out of the surface; numbers: the header's, in ENTRIES'
    units, by name."""

    velocity: np.ndarray
    force: np.ndarray
    numbers: dict[str, float] = field(default_factory=dict)


class TransientLayerError(ValueError):
    """What is given makes no layer; the sentence says why."""


def transient_layer(
    rate: float,
    velocity: np.ndarray,
    force: np.ndarray,
    *,
    attenuation: float = 0.8,
    force_short: float = 8.5,
    force_steady: float = 1.4,
    steady_time: float = 1.0,
    rearm_distance: float = 0.5e-3,
    rearm_time: float = 0.05,
    velocity_min: float = 0.01,
    velocity_time: float = 3e-3,
    energy_max: float | None = None,
) -> bytes:
    """The block's bytes.

    Args:
        rate: Hz; velocity: (k,) m/s, rising, above 0; force: (k, n) N, zero at both ends of each row.
        energy_max: J; when absent the largest integral of |force| times its row's velocity: what a hand takes
            that goes on at the speed at which it came.

    Raises:
        TransientLayerError: a number is out of range, or the arrays do not fit.
    """
    velocity, force = np.asarray(velocity, dtype="<f8"), np.asarray(force, dtype="<f4")
    if (
        velocity.ndim != 1
        or force.ndim != 2
        or len(force) != len(velocity)
        or not 1 <= len(velocity) <= VELOCITY_LIMIT
    ):
        raise TransientLayerError(
            f"velocity and force have to be (k,) and (k, n), k from 1 to {VELOCITY_LIMIT}"
        )
    if not 2 <= force.shape[1] <= SAMPLE_LIMIT:
        raise TransientLayerError(
            f"a transient has {force.shape[1]} samples; it may have 2 to {SAMPLE_LIMIT}"
        )
    if not np.all(np.isfinite(force)) or abs(force).max() > 1e3:
        raise TransientLayerError("forces have to be finite and at most 1000 N")
    if force[:, 0].any() or force[:, -1].any():
        raise TransientLayerError("a transient has to be zero at both ends")
    if (
        not np.all(np.isfinite(velocity))
        or velocity[0] <= 0
        or velocity[-1] > 1e2
        or np.any(np.diff(velocity) <= 0)
    ):
        raise TransientLayerError("velocities have to rise, above 0 and up to 100 m/s")
    if energy_max is None:
        energy_max = float((abs(force).sum(axis=1) * velocity).max() / rate)
    header = np.zeros((), dtype=HEADER_DTYPE)
    header["magic"], header["version"] = MAGIC, VERSION
    header["velocity_count"], header["sample_count"] = force.shape
    given = {
        "rate": rate,
        "attenuation": attenuation,
        "force_short": force_short,
        "force_steady": force_steady,
        "steady_time": steady_time,
        "rearm_distance": rearm_distance,
        "rearm_time": rearm_time,
        "velocity_min": velocity_min,
        "velocity_time": velocity_time,
        "energy_max": energy_max,
    }
    for key, value in given.items():
        least, most = LIMITS[key]
        if not least <= value <= most:
            raise TransientLayerError(f"{key} = {value} is out of range: {least:g} to {most:g}")
        header[key] = value
    return header.tobytes() + velocity.tobytes() + force.tobytes()


def read_transient_layer(data: bytes) -> TransientLayer:
    """What `transient_layer` wrote.  Raises TransientLayerError."""
    if len(data) < HEADER_DTYPE.itemsize:
        raise TransientLayerError(f"{len(data)} bytes: shorter than the header of {HEADER_DTYPE.itemsize}")
    header = np.frombuffer(data, HEADER_DTYPE, count=1)[0]
    if header["magic"] != MAGIC or header["version"] != VERSION:
        raise TransientLayerError(f"not a transient layer of version {VERSION}")
    k, n = int(header["velocity_count"]), int(header["sample_count"])
    size = HEADER_DTYPE.itemsize + 8 * k + 4 * k * n
    if len(data) != size:
        raise TransientLayerError(f"{len(data)} bytes; {k} transients of {n} samples are {size}")
    velocity = np.frombuffer(data, "<f8", k, HEADER_DTYPE.itemsize)
    force = np.frombuffer(data, "<f4", k * n, HEADER_DTYPE.itemsize + 8 * k)
    return TransientLayer(
        velocity.astype(float), force.reshape(k, n).copy(), {key: float(header[key]) for key in LIMITS}
    )
