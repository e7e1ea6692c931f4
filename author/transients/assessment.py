# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""How near do renderings come to a tap on the real thing?  A physical measure, not a user study.

Each of the eleven samples is tapped by the simulated stylus at the same velocities; renderings are the C++ runtime's,
its response and its layer `transient`, a tick each period.  What the tip accelerates in the first 100 ms is held
against the target's (wood on foam, as in the paper's figure 8): peak, magnitude of the spectrum from 20 to 400 Hz, and
the best correlation within 5 ms of delay.  The ranking is by the spectrum's error, averaged over velocities.  `gain` is
the factor by which a spectrum fits the target best and `shape_error` what is then left: a tap that is only too weak has
no shape error.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from palpate.author.transients.flat_surface import RuntimeLoop
from palpate.author.transients.identification import DeviceModel, empirical_transfer, fitted_model, sweep
from palpate.author.transients.inversion import WINDOW, in_band, spectrum, spectrum_error
from palpate.author.transients.library import Library, library_of
from palpate.author.transients.samples import REAL, SAMPLES, Rendering, layer_of
from palpate.author.transients.stylus import Stylus
from palpate.author.transients.tap import RealSample, Taps, swept, tapped
from palpate.author.transients.transient_table import ATTENUATION

__all__ = ["ASSESSED", "TARGET", "after_contact", "assess", "identified", "recorded_library"]

TARGET = "wood_on_foam"
RECORDED = (0.04, 0.06, 0.08, 0.10, 0.12, 0.14, 0.16, 0.18, 0.20, 0.22)
"""m/s, of the taps that the library is made from."""
ASSESSED = (0.05, 0.09, 0.11, 0.15, 0.20)
"""m/s; 0.11 is the study's mean."""


def identified(stylus: Stylus, runs: int = 4, noise: float = 0.1, seed: int = 1) -> DeviceModel:
    """The model that `runs` sweeps at each of three forces give; noise: of acceleration, over its own size
    (0.1: 20 dB)."""
    random = np.random.default_rng(seed)
    forces, accelerations = [], []
    for amplitude in (0.5, 1.0, 1.5):
        force = sweep(amplitude, stylus.rate)
        clean = swept(stylus, force)
        for _ in range(runs):
            forces.append(force)
            accelerations.append(clean + noise * clean.std() * random.standard_normal(len(clean)))
    return fitted_model(empirical_transfer(np.array(forces), np.array(accelerations), stylus.rate))


def recorded_library(
    stylus: Stylus,
    model: DeviceModel,
    target: RealSample = REAL[TARGET],
    velocity: Sequence[float] = RECORDED,
    stiffness: float = 0.0,
    seed: int = 2,
) -> Library:
    """From noisy taps on `target`; beside a response of `stiffness` N/m where that is not 0."""
    taps = tapped(stylus, np.array(velocity), target, seed=seed)
    return library_of(model, list(after_contact(taps)), list(velocity), stylus.rate, stiffness)[0]


def assess(
    stylus: Stylus | None = None,
    velocity: Sequence[float] = ASSESSED,
    attenuated: bool = False,
    progress: Callable[[str], None] | None = None,
) -> dict[str, Any]:
    """Taps all samples and ranks them.

    Args:
        attenuated: libraries know nothing of the response and are scaled by the paper's 0.8, instead of leaving to the
            response what it does itself.

    Returns:
        target, velocity (m/s), attenuated, model ({gain_error dB, phase_error deg, delay s}), rows: [{sample,
        spectrum_error (over `velocity`), spectrum_error_mean, spectrum_error_worst, gain, shape_error, peak_ratio,
        correlation, saturated (by the amplifier), limited (by the layer), given (J to the hand by the layer, at most)}]
        by rising mean error, order_reproduced, curves: {sample: (n,) m/s2 at drawn_velocity, nearest to 0.11}, rate.
    """
    say = progress or (lambda line: None)
    stylus = stylus or Stylus()
    v = np.asarray(velocity, dtype=float)
    say("identifying the device")
    model = identified(stylus)
    target = after_contact(tapped(stylus, v, REAL[TARGET]))
    rows, curves = [], {}
    middle = int(np.argmin(abs(v - 0.11)))
    libraries: dict[float, Library] = {}
    for name, sample in SAMPLES.items():
        say(f"tapping {name}")
        loop = None
        if isinstance(sample, Rendering):
            library = None
            if sample.transient == "library":
                beside = 0.0 if attenuated else sample.stiffness
                if beside not in libraries:
                    libraries[beside] = recorded_library(stylus, model, stiffness=beside)
                library = libraries[beside]
            layer = layer_of(sample, stylus, library, ATTENUATION if attenuated else 1.0)
            loop = RuntimeLoop(stylus, sample.stiffness, layer)
            taps = tapped(stylus, v, controller=loop)
        else:
            taps = tapped(stylus, v, sample)
        after = after_contact(taps)
        curves[name] = after[middle]
        errors = [spectrum_error(a, t, stylus.rate) for a, t in zip(after, target, strict=True)]
        gain, shape_error = _scaled(after, target, stylus.rate)
        rows.append(
            {
                "sample": name,
                "spectrum_error": errors,
                "spectrum_error_mean": float(np.mean(errors)),
                "spectrum_error_worst": float(np.max(errors)),
                "gain": gain,
                "shape_error": shape_error,
                "peak_ratio": float(np.mean(abs(after).max(1) / abs(target).max(1))),
                "correlation": float(
                    np.mean([_correlation(a, t, stylus.rate) for a, t in zip(after, target, strict=True)])
                ),
                "saturated": bool(taps.saturated.any()),
                "limited": bool(loop is not None and loop.limited.any()),
                "given": float(loop.given.max()) if loop is not None else 0.0,
            }
        )
    rows.sort(key=lambda row: row["spectrum_error_mean"])
    mean = {row["sample"]: row["spectrum_error_mean"] for row in rows}
    ordered = all(
        mean[f"{k}_matched"] < min(mean[f"{k}_pulse"], mean[f"{k}_sinusoid"])
        and max(mean[f"{k}_pulse"], mean[f"{k}_sinusoid"]) < mean[f"{k}_proportional"]
        for k in ("firm", "soft")
    )
    return {
        "target": TARGET,
        "velocity": [float(x) for x in v],
        "attenuated": attenuated,
        "model": {"gain_error": model.gain_error, "phase_error": model.phase_error, "delay": model.delay},
        "rows": rows,
        "order_reproduced": ordered,
        "curves": curves,
        "drawn_velocity": float(v[middle]),
        "rate": stylus.rate,
    }


def after_contact(taps: Taps) -> np.ndarray:
    """(taps, n) m/s2 from contact on."""
    first = int(np.searchsorted(taps.time, 0.0))
    return taps.acceleration[:, first : first + round(WINDOW * taps.rate)]


def _correlation(signal: np.ndarray, target: np.ndarray, rate: float) -> float:
    s, t = in_band(signal, rate), in_band(target, rate)
    late = range(-round(0.005 * rate), round(0.005 * rate) + 1)
    size = np.linalg.norm(s) * np.linalg.norm(t)
    return float(max(np.dot(np.roll(s, -k), t) for k in late) / size) if size > 0 else 0.0


def _scaled(after: np.ndarray, target: np.ndarray, rate: float) -> tuple[float, float]:
    """Means over taps of the factor that brings a spectrum nearest to the target's, and of the error that is left."""
    gains, errors = [], []
    for a, t in zip(after, target, strict=True):
        (_, s), (_, r) = spectrum(a, rate), spectrum(t, rate)
        gains.append(float(s @ r / (s @ s)))
        errors.append(float(np.linalg.norm(gains[-1] * s - r) / np.linalg.norm(r)))
    return float(np.mean(gains)), float(np.mean(errors))
