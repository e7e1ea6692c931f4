# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The force that makes a device accelerate as it did at a real contact (the paper, section 3.3).

A recorded acceleration a(t), t >= 0 at contact, is kept to the band by a filter without phase, divided by the
model in the
frequency domain, F = A / G, and tapered to zero at both ends.  Division there is the stable inverse also where
G has zeros in
the right half plane; what it then asks for before the contact cannot be played.  `LEAD` of that is kept by
starting the whole
transient so much later, as is the model's delay: the hand feels the same a few milliseconds late.  The forward
check plays the
force through the model again and holds magnitudes of the spectra against each other from 20 to 400 Hz.

Beside a response that pushes with f = -k d the paper attenuates transients by 0.8, for the response does part of their
work.  With `stiffness` that part is taken out before the division instead: the recorded motion d(t) = v t +
int int a would
make the response push with -k d(t), and the transient is the rest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, sosfiltfilt

from palpate.author.errors import InputError, InputProblem
from palpate.author.transients.identification import BAND, DeviceModel

__all__ = ["LEAD", "Transient", "in_band", "inverted", "require_invertible", "spectrum", "spectrum_error"]

JUDGED = (20.0, 400.0)
"""Hz, where spectra are compared."""
WINDOW = 0.1
"""s of a contact that are recorded, played and compared."""
LEAD = 2e-3
"""s; a zero-phase filter to 500 Hz starts about that long before what it filters."""
TAPER = (1e-3, 20e-3)
"""s at the start and at the end."""
QUIETEST = 1e-3
"""A model that answers this much less in the band than at its loudest cannot be inverted there (60 dB)."""
REPEATED = 0.2
"""Largest error of the forward check.  Zeros in the right half plane within the band ask for forces before contact,
which nobody can play: one at 50 Hz leaves 0.34 to 0.44, one at 200 Hz 0.22 to 0.42, none of them 0.07 to 0.13."""


@dataclass(frozen=True)
class Transient:
    """Attributes: velocity m/s; force (n,) N on the hand along the motion, negative out of the surface, from
    LEAD before
    contact on; error: of the forward check (see `spectrum_error`)."""

    velocity: float
    force: np.ndarray
    error: float


def require_invertible(model: DeviceModel, rate: float, band: tuple[float, float] = BAND) -> None:
    """Raises InputError where `model` cannot be inverted within `band` Hz, or `rate` Hz cannot carry it."""
    if rate < 4.0 * band[1]:
        what = f"cannot carry a band to {band[1]:g} Hz"
        raise InputError(InputProblem("", "rate", rate, what, f"at least {4 * band[1]:g} Hz"))
    if np.any(np.roots(model.denominator).real >= 0.0):
        raise InputError(InputProblem("", "model", None, "is unstable", "poles in the left half plane"))
    frequency = np.geomspace(*band, 2000)
    size = abs(model.transfer(frequency))
    quiet = size < QUIETEST * size.max()
    if quiet.any():
        what = (
            f"answers {QUIETEST:g} of its loudest or less at {frequency[np.argmin(size)]:.0f} Hz: its "
            "inverse would be unstable or deafening"
        )
        raise InputError(
            InputProblem(
                "", "model", None, what, f"a device that moves everywhere in {band[0]:g} to {band[1]:g} Hz"
            )
        )


def in_band(signal: np.ndarray, rate: float, band: tuple[float, float] = BAND) -> np.ndarray:
    """`signal` (..., n) without what lies outside of `band` Hz, its phase unchanged."""
    sections = butter(2, band, "bandpass", fs=rate, output="sos")
    return sosfiltfilt(sections, signal, padtype=None)


def inverted(
    model: DeviceModel, acceleration: np.ndarray, velocity: float, rate: float, stiffness: float = 0.0
) -> Transient:
    """The transient for `acceleration` (n,) m/s2 after a contact at `velocity` m/s, beside a response of
    `stiffness` N/m.

    Raises:
        InputError: the model cannot be inverted, the recording is shorter than 50 ms, or what can be played of the
            force, which begins LEAD before contact, does not repeat the recording.
    """
    require_invertible(model, rate)
    if len(acceleration) < 0.5 * WINDOW * rate:
        raise InputError(
            InputProblem(
                "",
                "acceleration",
                len(acceleration) / rate,
                f"is short (s, of the tap at {velocity:g} m/s)",
                f"at least {0.5 * WINDOW:g} s after contact",
            )
        )
    count = min(len(acceleration), round(WINDOW * rate))
    before, size = round(0.1 * rate), 2 ** int(np.ceil(np.log2(6 * count)))
    a = np.asarray(acceleration[:count], dtype=float)
    start = np.zeros(size)
    start[before : before + count] = a
    frequency = np.fft.rfftfreq(size, 1.0 / rate)
    frequency[0] = frequency[1]
    total = np.fft.irfft(np.fft.rfft(in_band(start, rate)) / model.transfer(frequency, delayed=False), size)
    lead = round(LEAD * rate)
    window = taper(count, rate)
    playable = slice(before - lead, before - lead + count)
    played = np.zeros(size)
    played[before : before + count] = total[playable] * window
    again = np.fft.irfft(np.fft.rfft(played) * model.transfer(frequency), size)[before : before + count]
    error = spectrum_error(again, in_band(start, rate)[playable], rate)
    if not error <= REPEATED:
        what = (
            f"asks for forces before the contact at {velocity:g} m/s: what can be played of them leaves the "
            f"spectrum {100 * error:.0f} % off"
        )
        expected = f"at most {100 * REPEATED:g} %: a model without slow zeros in the right half plane"
        raise InputError(InputProblem("", "model", None, what, expected))
    if not stiffness:
        return Transient(velocity, played[before : before + count].copy(), error)
    time = np.arange(count) / rate
    depth = velocity * time + np.cumsum(np.cumsum(a)) / rate**2
    push = np.zeros(size)
    push[before : before + count] = -stiffness * np.maximum(depth, 0.0)
    push[before + count :] = push[before + count - 1] * np.linspace(1.0, 0.0, size - before - count)
    return Transient(velocity, (total - in_band(push, rate))[playable] * window, float("nan"))


def taper(count: int, rate: float) -> np.ndarray:
    """(count,) from 0 up to 1 and down to 0, raised cosines."""
    up, down = (min(count // 2, max(2, round(length * rate))) for length in TAPER)
    window = np.ones(count)
    window[:up] = 0.5 - 0.5 * np.cos(np.pi * np.arange(up) / up)
    window[-down:] = 0.5 + 0.5 * np.cos(np.pi * np.arange(1, down + 1) / down)
    return window


def spectrum(signal: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies Hz and magnitudes (signal's unit times s) of the first WINDOW of `signal` (n,), between
    JUDGED's ends."""
    count = min(len(signal), round(WINDOW * rate))
    frequency = np.fft.rfftfreq(count, 1.0 / rate)
    kept = (frequency >= JUDGED[0]) & (frequency <= JUDGED[1])
    return frequency[kept], abs(np.fft.rfft(signal[:count]))[kept] / rate


def spectrum_error(signal: np.ndarray, target: np.ndarray, rate: float) -> float:
    """|| |S| - |T| || / || T || over the spectra's magnitudes from 20 to 400 Hz; 1 for silence."""
    (_, s), (_, t) = spectrum(signal, rate), spectrum(target, rate)
    return float(np.linalg.norm(s - t) / np.linalg.norm(t))
