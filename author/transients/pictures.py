# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Bode plot, library and figure 8's accelerations as PNG, and a tap as a WAV file for the ears."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import wavfile
from scipy.signal import resample_poly

from palpate.author.transients.identification import DeviceModel, Empirical
from palpate.author.transients.inversion import spectrum
from palpate.author.transients.library import Library

__all__ = [
    "accelerations_picture",
    "bode_picture",
    "library_picture",
    "spectra_picture",
    "tap_sound",
    "transient_picture",
]

SHOWN = 6
"""Lines of a picture at most."""


def bode_picture(measured: Empirical, model: DeviceModel, path: Path) -> None:
    """Gain, phase and coherence of what was measured and fitted."""
    figure, (gain, phase, trust) = _figure(3, (7.0, 8.0))
    f = measured.frequency
    for h, name, style in ((measured.transfer, "measured", "0.6"), (model.transfer(f), "model", "C0")):
        gain.plot(f, 20.0 * np.log10(abs(h)), color=style, label=name)
        phase.plot(f, np.degrees(np.unwrap(np.angle(h))), color=style)
    trust.plot(f, measured.coherence, color="0.4")
    gain.set_ylabel("acceleration over force [dB re 1 m/s² per N]")
    gain.legend()
    phase.set_ylabel("phase [deg]")
    trust.set_ylabel("coherence")
    trust.set_ylim(0.0, 1.05)
    for axis in (gain, phase, trust):
        axis.set_xscale("log")
    trust.set_xlabel("frequency [Hz]")
    figure.savefig(path, dpi=120)


def library_picture(library: Library, path: Path) -> None:
    """Force against time, a line for each velocity."""
    figure, (axis,) = _figure(1, (7.0, 4.0))
    time = 1e3 * np.arange(library.force.shape[1]) / library.rate
    for i, (v, force) in enumerate(zip(library.velocity, library.force, strict=True)):
        axis.plot(time, force, color=_shade(i, len(library.velocity)), label=f"{v:.3g} m/s")
    axis.set_xlabel("time [ms]")
    axis.set_ylabel("force out of the surface [N]")
    axis.legend(fontsize="small")
    figure.savefig(path, dpi=120)


def transient_picture(rate: float, velocity: np.ndarray, force: np.ndarray, path: Path) -> None:
    """`force` (k, n) N by `velocity` (k,) m/s: over time, and the magnitude of its spectrum to 1 kHz."""
    figure, (over_time, over_frequency) = _figure(2, (7.0, 6.0))
    time = 1e3 * np.arange(force.shape[1]) / rate
    shown = np.unique(np.linspace(0, len(velocity) - 1, min(len(velocity), SHOWN)).round().astype(int))
    count = max(2048, force.shape[1])
    frequency = np.fft.rfftfreq(count, 1.0 / rate)
    kept = frequency <= 1000.0
    for k, i in enumerate(shown):
        colour, name = _shade(k, len(shown)), f"{velocity[i]:.3g} m/s"
        over_time.plot(time, force[i], color=colour, label=name, linewidth=1.1)
        over_frequency.plot(
            frequency[kept], abs(np.fft.rfft(force[i], count))[kept] / rate, color=colour, linewidth=1.1
        )
    over_time.set_xlabel("time after contact [ms]")
    over_time.set_ylabel("force out of the surface [N]")
    over_time.legend(fontsize="small")
    over_frequency.set_xlabel("frequency [Hz]")
    over_frequency.set_ylabel("force spectrum [N s]")
    over_frequency.set_ylim(bottom=0.0)
    figure.savefig(path, dpi=120)


def spectra_picture(result: dict[str, Any], path: Path) -> None:
    """What `assess` found, as magnitudes of the acceleration's spectrum from 20 to 400 Hz against the target's."""
    figure, axes = _figure(2, (7.0, 7.0), sharex=True)
    target = spectrum(result["curves"][result["target"]], result["rate"])
    for axis, kind in zip(axes, ("firm", "soft"), strict=True):
        axis.plot(*target, color="0.2", linewidth=2.2, label=result["target"])
        names = [row["sample"] for row in result["rows"] if row["sample"].startswith(kind)]
        for i, name in enumerate(names):
            axis.plot(
                *spectrum(result["curves"][name], result["rate"]), color=f"C{i}", linewidth=1.1, label=name
            )
        axis.set_ylabel("acceleration spectrum [m/s² s]")
        axis.legend(fontsize="small")
    axes[-1].set_xlabel("frequency [Hz]")
    figure.savefig(path, dpi=120)


def accelerations_picture(result: dict[str, Any], path: Path) -> None:
    """What `assess` found, as the paper's figure 8: one panel a sample, by rising error."""
    rows = result["rows"]
    figure, axes = _figure(len(rows), (7.0, 1.1 * len(rows) + 0.8), sharex=True)
    for axis, row in zip(axes, rows, strict=True):
        curve = result["curves"][row["sample"]]
        axis.plot(1e3 * np.arange(len(curve)) / result["rate"], curve, color="C0", linewidth=0.9)
        axis.set_title(
            f"{row['sample']}: spectrum off by {100 * row['spectrum_error_mean']:.0f} %",
            fontsize=8,
            loc="left",
        )
        axis.tick_params(labelsize=7)
    axes[-1].set_xlabel("time after contact [ms]")
    axes[len(rows) // 2].set_ylabel("acceleration [m/s²]")
    figure.savefig(path, dpi=120)


def tap_sound(acceleration: np.ndarray, rate: float, path: Path) -> None:
    """Three taps of `acceleration` (n,) m/s2, scaled to the file's range, 44.1 kHz."""
    rest = np.zeros(round(0.4 * rate))
    signal = np.concatenate([rest[: len(rest) // 4], *([acceleration, rest] * 3)])
    sound = resample_poly(signal, 44100, round(rate))
    wavfile.write(path, 44100, np.round(30000.0 * sound / max(abs(sound).max(), 1e-12)).astype(np.int16))


def _figure(rows: int, size: tuple[float, float], **options: Any):
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(rows, 1, squeeze=False, **options)[:, 0]
    return figure, axes


def _shade(i: int, count: int) -> tuple[float, float, float]:
    share = i / max(count - 1, 1)
    return (0.1 + 0.8 * share, 0.3, 0.8 - 0.6 * share)
