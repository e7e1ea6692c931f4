# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""From recordings of a swept force to a model of the device that can be inverted (the paper, section 3.2).

The plan is a linear sweep f(t) = A sin(2 pi (F0 t + (F1 - F0) t^2 / (2 T))), tapered at both ends.  The
empirical transfer function
is H = sum_r conj(U_r) Y_r / sum_r |U_r|^2 over runs r, a complex average; neighbouring frequencies within
`SMOOTHING` are
averaged too, which is what quietens noise between runs.  The held command's own half-sample and droop are
taken out, so H is
the device's, from force to acceleration.  The model is

    G(s) = K prod_i (s - z_i) / prod_i (s - p_i) exp(-s tau),

with `order` poles and order - relative_degree zeros.  Poles are kept stable by parametrising real pairs s^2 +
exp(a) s + exp(b).
Starting points: poles spread over the band; then scipy's least squares on the complex logarithm (dB and
degrees at once).
Limits: a linear device; one zero of acceleration at rest is not forced, for a hand hides it (as in the paper).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.optimize import least_squares
from scipy.signal import chirp
from scipy.signal.windows import tukey

from palpate.author.errors import InputError, InputProblem

__all__ = ["BAND", "DeviceModel", "Empirical", "empirical_transfer", "fitted_model", "sweep"]

BAND = (10.0, 500.0)
"""Hz."""
RATE_MAX = 1e6
"""Hz, as of a field's transients."""
SMOOTHING = 4.0
"""Hz, of the average over neighbouring frequencies; a resonance of 130 Hz with a quality of 10 is 13 Hz wide."""
GOOD = 0.03
"""Root mean square of the complex logarithm's residual at which no further starting point is tried; 0.26 dB
and 1.7 deg."""


@dataclass(frozen=True)
class Empirical:
    """Attributes: frequency (n,) Hz; transfer (n,) complex (m/s2)/N; coherence (n,) 0 to 1; runs."""

    frequency: np.ndarray
    transfer: np.ndarray
    coherence: np.ndarray
    runs: int


@dataclass(frozen=True)
class DeviceModel:
    """Attributes: numerator and denominator (falling powers of s, rad/s); delay s; gain_error dB and phase_error deg,
    the largest distance to what it was fitted to, between 20 and 400 Hz."""

    numerator: np.ndarray
    denominator: np.ndarray
    delay: float
    gain_error: float = 0.0
    phase_error: float = 0.0

    def transfer(self, frequency: np.ndarray, delayed: bool = True) -> np.ndarray:
        """(n,) complex, (m/s2)/N at `frequency` (n,) Hz."""
        s = 2j * np.pi * np.asarray(frequency, dtype=float)
        value = np.polyval(self.numerator, s) / np.polyval(self.denominator, s)
        return value * np.exp(-s * self.delay) if delayed else value


def sweep(
    amplitude: float, rate: float, band: tuple[float, float] = BAND, duration: float = 2.5
) -> np.ndarray:
    """(n,) N at 1 / rate s: a swept sine that starts and ends at zero.

    Raises InputError where `rate` cannot carry the band.
    """
    if not 4.0 * band[1] <= rate <= RATE_MAX:
        what = f"is no rate of a loop that carries a sweep to {band[1]:g} Hz"
        expected = f"{4 * band[1]:g} to {RATE_MAX:g} Hz"
        raise InputError(InputProblem("", "--rate", rate, what, expected))
    time = np.arange(round(duration * rate)) / rate
    return amplitude * chirp(time, band[0], duration, band[1], phi=-90) * tukey(len(time), 0.04)


def empirical_transfer(
    force: np.ndarray, acceleration: np.ndarray, rate: float, held: bool = True
) -> Empirical:
    """Of `force` (runs, n) N and `acceleration` (runs, n) m/s2 at `rate` Hz; `held`: the command was held
    between samples."""
    force, acceleration = np.atleast_2d(force), np.atleast_2d(acceleration)
    frequency = np.fft.rfftfreq(force.shape[1], 1.0 / rate)
    u, y = np.fft.rfft(force), np.fft.rfft(acceleration - acceleration.mean(axis=1, keepdims=True))
    size = max(1, round(SMOOTHING / frequency[1]))

    def smooth(x: np.ndarray) -> np.ndarray:
        return uniform_filter1d(x.real, size) + 1j * uniform_filter1d(x.imag, size)

    cross, power, answer = (
        smooth(x) for x in ((u.conj() * y).sum(0), (abs(u) ** 2).sum(0), (abs(y) ** 2).sum(0))
    )
    kept = (frequency >= BAND[0]) & (frequency <= BAND[1])
    transfer = cross[kept] / power[kept]
    if held:
        period = 1.0 / rate
        transfer = transfer / (
            np.sinc(frequency[kept] * period) * np.exp(-1j * np.pi * frequency[kept] * period)
        )
    coherence = abs(cross[kept]) ** 2 / (power[kept].real * answer[kept].real)
    return Empirical(frequency[kept], transfer, coherence, force.shape[0])


def fitted_model(
    measured: Empirical,
    order: int = 7,
    relative_degree: int = 4,
    delay: float | None = 0.25e-3,
    coherence: float = 0.5,
) -> DeviceModel:
    """The stable model of `order` and `relative_degree`; a `delay` of None is fitted too.

    Raises:
        InputError: the orders make no model, or the recordings are too incoherent for one.
    """
    if not 1 <= relative_degree <= order <= 20:
        raise InputError(
            InputProblem(
                "", "--relative-degree", relative_degree, "makes no model", "1 to the order, at most 20"
            )
        )
    good = measured.coherence >= coherence
    between = (measured.frequency >= 20.0) & (measured.frequency <= 400.0)
    if good[between].mean() < 0.9:
        what = (
            f"explain less than {100 * coherence:g} % of the acceleration at "
            f"{100 - 100 * good[between].mean():.0f} % of 20 to 400 Hz"
        )
        raise InputError(
            InputProblem("", "recordings", None, what, "a stronger sweep, a tighter grasp or more runs")
        )
    f, h = measured.frequency[good], measured.transfer[good]
    grid = np.geomspace(f[0], f[-1], 160)
    h = np.interp(grid, f, np.log(abs(h))) + 1j * np.interp(grid, f, np.unwrap(np.angle(h)))
    scale = 2.0 * np.pi * 100.0
    s = 2j * np.pi * grid / scale
    zeros = order - relative_degree
    pairs, odd = divmod(order, 2)
    free = delay is None

    def model(x: np.ndarray) -> np.ndarray:
        value = np.polyval(x[: zeros + 1], s)
        for i in range(pairs):
            value = value / (s**2 + np.exp(x[zeros + 1 + 2 * i]) * s + np.exp(x[zeros + 2 + 2 * i]))
        if odd:
            value = value / (s + np.exp(x[zeros + 1 + 2 * pairs]))
        late = np.exp(x[-1]) if free else (delay or 0.0) * scale
        return value * np.exp(-s * late)

    def residual(x: np.ndarray) -> np.ndarray:
        m = model(x)
        gain = np.log(np.maximum(abs(m), 1e-300)) - h.real
        turn = np.angle(m * np.exp(-1j * h.imag))
        return np.concatenate([gain, turn])

    best = None
    loudest = grid[np.argmax(h.real)]
    for spread in (1.3, 0.7, 3.0):
        if best is not None and best.cost < GOOD**2 * len(s):
            break
        poles = np.geomspace(max(f[0], 0.15 * loudest), 5.0 * f[-1], pairs + odd)
        if pairs > 1:
            poles[np.argmin(abs(np.log(poles / loudest)))] = loudest
        w = 2.0 * np.pi * poles / scale
        start = np.zeros(zeros + 1 + order + (1 if free else 0))
        for i in range(pairs):
            start[zeros + 1 + 2 * i : zeros + 3 + 2 * i] = np.log(0.3 * spread * w[i]), 2.0 * np.log(w[i])
        if odd:
            start[zeros + 1 + 2 * pairs] = np.log(w[-1])
        if free:
            start[-1] = np.log(0.25e-3 * scale)
        start[zeros] = 1.0
        target = np.exp(h) / model(start)  # a first numerator by linear least squares
        basis = s[:, None] ** np.arange(zeros, -1, -1) / target[:, None]
        start[: zeros + 1] = np.linalg.lstsq(
            np.vstack([basis.real, basis.imag]), np.r_[np.ones(len(s)), np.zeros(len(s))], rcond=None
        )[0]
        found = least_squares(residual, start, method="trf", x_scale="jac", max_nfev=150)
        if best is None or found.cost < best.cost:
            best = found
    assert best is not None
    x = best.x
    denominator = np.ones(1)
    for i in range(pairs):
        denominator = np.polymul(
            denominator, [1.0, np.exp(x[zeros + 1 + 2 * i]), np.exp(x[zeros + 2 + 2 * i])]
        )
    if odd:
        denominator = np.polymul(denominator, [1.0, np.exp(x[zeros + 1 + 2 * pairs])])
    late = float(np.exp(x[-1]) / scale) if free else float(delay or 0.0)
    model_ = DeviceModel(
        x[: zeros + 1] * scale ** np.arange(-zeros, 1) * scale**order,
        denominator * scale ** np.arange(order + 1),
        late,
    )
    inside = (grid >= 20.0) & (grid <= 400.0)
    off = np.log(model_.transfer(grid[inside])) - h[inside]
    turn = np.angle(np.exp(1j * off.imag), deg=True)
    return DeviceModel(
        model_.numerator,
        model_.denominator,
        late,
        float(abs(off.real).max() * 20.0 / np.log(10.0)),
        float(abs(turn).max()),
    )
