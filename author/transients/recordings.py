# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings of force and acceleration, from CSV, NPZ and WAV; what cannot be right is refused by name.

CSV: a header line with `time` (s), `force` (N) and `acceleration` (m/s2), any order.  NPZ: arrays `rate` (Hz),
`acceleration`
and, for sweeps, `force`; for contacts `velocity` (m/s).  WAV: two channels, force and acceleration, or one,
acceleration; full
scale is `scale` (N, m/s2).  A contact starts where the recording does.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.io import wavfile

from palpate.author.errors import UNREADABLE, InputError, InputProblem

__all__ = ["Recording", "read_recording", "require_usable"]

BEGINS = 5e-3
"""s; a contact's acceleration reaches a tenth of its largest within that of the recording's start."""
CLIPPED = 4
"""As many samples in a row at the largest magnitude are a clipped recording."""


@dataclass(frozen=True)
class Recording:
    """Attributes: file; rate Hz; acceleration (n,) m/s2; force (n,) N or None; velocity m/s or None."""

    file: str
    rate: float
    acceleration: np.ndarray
    force: np.ndarray | None = None
    velocity: float | None = None


def read_recording(path: Path, scale: tuple[float, float] = (1.0, 1.0)) -> Recording:
    """The recording in `path`; raises InputError where it is none."""

    def refuse(what: str, expected: str, key: str = "") -> InputError:
        return InputError(InputProblem(str(path), key, None, what, expected))

    if not path.is_file():
        raise refuse("does not exist", "a CSV, NPZ or WAV file")
    kind = path.suffix.lower()
    force: np.ndarray | None = None
    velocity: float | None = None
    try:
        if kind == ".csv":
            table = np.genfromtxt(path, delimiter=",", names=True, dtype=float)
            names = table.dtype.names or ()
            if "time" not in names or "acceleration" not in names:
                raise refuse("lacks columns", "a header line with time, acceleration and, of a sweep, force")
            step = np.diff(table["time"])
            if len(step) < 2 or not np.all(step > 0.0) or np.ptp(step) > 0.01 * step.mean():
                raise refuse("is not sampled evenly", "times in s that rise by the same step", "time")
            rate, acceleration = 1.0 / step.mean(), table["acceleration"]
            force = table["force"] if "force" in names else None
        elif kind == ".npz":
            with np.load(path, allow_pickle=False) as data:
                if "rate" not in data or "acceleration" not in data:
                    raise refuse(
                        "lacks arrays", "rate and acceleration; force of a sweep; velocity of a contact"
                    )
                rate, acceleration = float(data["rate"]), _real(data["acceleration"])
                force = _real(data["force"]) if "force" in data else None
                velocity = float(data["velocity"]) if "velocity" in data else None
        elif kind == ".wav":
            rate, samples = wavfile.read(path)
            if samples.ndim == 2 and samples.shape[1] > 2:
                raise refuse(f"has {samples.shape[1]} channels", "force and acceleration, or acceleration")
            middle, full = 0.0, 1.0
            if samples.dtype.kind in "iu":
                full = np.iinfo(samples.dtype).max
            if samples.dtype == np.uint8:  # 8 bits are unsigned
                middle, full = 128.0, 127.0
            samples = (samples.astype(float) - middle) / full
            if samples.ndim == 2:
                force, acceleration = samples[:, 0] * scale[0], samples[:, 1] * scale[1]
            else:
                acceleration = samples * scale[1]
        else:
            raise refuse("is of no known kind", "CSV, NPZ or WAV")
    except UNREADABLE as error:
        raise refuse(f"cannot be read ({error})", "a CSV, NPZ or WAV file") from error
    return Recording(str(path), float(rate), acceleration, force, velocity)


def _real(values: np.ndarray) -> np.ndarray:
    if np.iscomplexobj(values):
        raise ValueError("complex numbers")
    return np.asarray(values, dtype=float)


def require_usable(recording: Recording, band: tuple[float, float], sweep: bool = False) -> None:
    """Raises InputError with all that is wrong: rate, numbers, clipping, lengths, force and acceleration out of step;
    of a contact (no `sweep`) a start that is not the contact's."""
    a, f, rate = recording.acceleration, recording.force, recording.rate
    problems: list[InputProblem] = []

    def add(key: str, value: float | None, what: str, expected: str) -> None:
        problems.append(InputProblem(recording.file, key, value, what, expected))

    if not (np.isfinite(rate) and rate >= 4.0 * band[1]):
        add("rate", rate, f"cannot carry {band[1]:g} Hz", f"at least {4 * band[1]:g} Hz")
    for key, x in (("acceleration", a), ("force", f)):
        if x is None:
            continue
        if x.ndim != 1 or len(x) < 16 or not np.all(np.isfinite(x)):
            add(key, None, "is no signal", "at least 16 finite numbers")
        elif key == "acceleration" and _clipped(x):
            add(key, float(abs(x).max()), "is clipped there", "a wider range of the sensor, or a softer tap")
    if sweep and f is None:
        add("force", None, "is missing", "the commanded force beside the acceleration")
    if sweep and not problems and f is not None:
        if len(f) != len(a):
            add(
                "force",
                None,
                f"has {len(f)} samples and acceleration {len(a)}",
                "recordings that start and end together",
            )
        else:
            late = _lag(f, a) / rate
            if not -0.002 <= late <= 0.02:
                add(
                    "acceleration", late, "s behind the force: they are misaligned", "a delay from 0 to 20 ms"
                )
    if not sweep and not problems and (peak := float(abs(a).max())) > 0.0:
        late = float(np.argmax(abs(a) >= 0.1 * peak)) / rate
        if late > BEGINS:
            what = "s after the recording begins is the contact: they are misaligned"
            add("acceleration", late, what, f"a recording that begins at the contact, to {1e3 * BEGINS:g} ms")
        elif abs(a[0]) > 0.5 * peak:
            what = "m/s2 at the first sample: the recording begins after the contact"
            add("acceleration", float(a[0]), what, "a recording that begins at the contact, at rest")
    if problems:
        raise InputError(problems)


def _clipped(x: np.ndarray) -> bool:
    for top in (x.max(), x.min()):
        if abs(top) > 0.0:
            at = np.concatenate([[0], (x == top).astype(int), [0]])
            edges = np.flatnonzero(np.diff(at))
            if len(edges) and np.max(edges[1::2] - edges[::2]) >= CLIPPED and abs(top) >= 0.99 * abs(x).max():
                return True
    return False


def _lag(f: np.ndarray, a: np.ndarray) -> int:
    """Samples by which the envelope of `a`'s correlation with `f` is late; the chirp compresses to a short pulse."""
    size = 2 ** int(np.ceil(np.log2(2 * len(f))))
    cross = np.fft.fft(f, size).conj() * np.fft.fft(a, size)
    cross[size // 2 :] = 0.0  # analytic: its magnitude is the envelope
    power = abs(np.fft.ifft(cross))
    k = int(np.argmax(power))
    return k if k < size // 2 else k - size
