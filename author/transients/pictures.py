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
TICKS = (10, 20, 50, 100, 200, 500)
"""Hz."""


def bode_picture(measured: Empirical, model: DeviceModel, path: Path) -> None:
    """Gain, phase and coherence of what was measured and fitted."""
    figure, (gain, phase, trust) = _figure(3, (7.0, 8.0), sharex=True)
    f = measured.frequency
    for h, name, style in (
        (measured.transfer, f"measured, {measured.runs} runs", {"color": "0.7", "linewidth": 4.0}),
        (model.transfer(f), "model", {"color": "C0", "linewidth": 1.3}),
    ):
        gain.plot(f, 20.0 * np.log10(abs(h)), label=name, **style)
        phase.plot(f, np.degrees(np.unwrap(np.angle(h))), **style)
    trust.plot(f, measured.coherence, color="0.4")
    gain.set_ylabel("acceleration over force\n[dB re 1 m/s² per N]")
    gain.legend(loc="upper left")
    phase.set_ylabel("phase [deg]")
    trust.set_ylabel("coherence [1]")
    trust.set_ylim(0.0, 1.05)
    trust.set_xscale("log")
    trust.set_xticks(TICKS, [str(tick) for tick in TICKS])
    trust.minorticks_off()
    trust.set_xlim(f[0], f[-1])
    trust.set_xlabel("frequency [Hz]")
    for axis in (gain, phase, trust):
        axis.grid(color="0.9")
    figure.savefig(path, dpi=120)


def library_picture(library: Library, path: Path) -> None:
    """Force against time, a line for each velocity."""
    figure, (axis,) = _figure(1, (7.0, 4.0))
    time = 1e3 * np.arange(library.force.shape[1]) / library.rate
    for i, (v, force) in enumerate(zip(library.velocity, library.force, strict=True)):
        axis.plot(
            time, force, color=_shade(i, len(library.velocity)), linewidth=1.1, zorder=3.0 - 0.01 * i,
            label=f"{v:.3g} m/s",
        )  # fmt: skip
    axis.set_xlabel("time after contact [ms]")
    axis.set_ylabel("force out of the surface [N]")
    axis.grid(color="0.9")
    _legend(axis, title="incoming velocity")
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
        style = {"color": colour, "linewidth": 1.1, "zorder": 3.0 - 0.01 * k}
        over_time.plot(time, force[i], label=name, **style)
        over_frequency.plot(frequency[kept], abs(np.fft.rfft(force[i], count))[kept] / rate, **style)
    over_time.set_xlabel("time after contact [ms]")
    over_time.set_ylabel("force out of the surface [N]")
    _legend(over_time, title="incoming velocity")
    over_frequency.set_xlabel("frequency [Hz]")
    over_frequency.set_ylabel("force spectrum [N s]")
    over_frequency.set_ylim(bottom=0.0)
    for axis in (over_time, over_frequency):
        axis.grid(color="0.9")
    figure.savefig(path, dpi=120)


def spectra_picture(result: dict[str, Any], path: Path) -> None:
    """What `assess` found, as magnitudes of the acceleration's spectrum from 20 to 400 Hz against the target's."""
    figure, axes = _figure(2, (7.0, 7.0), sharex=True, sharey=True)
    target = spectrum(result["curves"][result["target"]], result["rate"])
    for axis, kind in zip(axes, ("firm", "soft"), strict=True):
        axis.plot(*target, color="0.7", linewidth=4.0, label=_words(result["target"]))
        names = [row["sample"] for row in result["rows"] if row["sample"].startswith(kind)]
        for i, name in enumerate(names):
            axis.plot(
                *spectrum(result["curves"][name], result["rate"]),
                color=f"C{i}",
                linewidth=1.1,
                label=_words(name),
            )
        axis.set_ylabel("acceleration spectrum [m/s² s]")
        axis.set_ylim(bottom=0.0)
        axis.grid(color="0.9")
        _legend(axis)
    axes[0].set_title(f"taps at {result['drawn_velocity']:.3g} m/s", fontsize="medium")
    axes[-1].set_xlabel("frequency [Hz]")
    figure.savefig(path, dpi=120)


def accelerations_picture(result: dict[str, Any], path: Path) -> None:
    """What `assess` found, as the paper's figure 8: one panel a sample, by rising error, each over the target's.

    Panels have one scale, but for what is much louder than the target.
    """
    rows = result["rows"]
    figure, axes = _figure(len(rows), (7.0, 1.25 * len(rows) + 0.8), sharex=True)
    target = result["curves"][result["target"]]
    most = 1.1 * abs(target).max()
    for axis, row in zip(axes, rows, strict=True):
        curve = result["curves"][row["sample"]]
        time = 1e3 * np.arange(len(curve)) / result["rate"]
        axis.plot(time, target, color="0.75", linewidth=1.8)
        own = row["sample"] == result["target"]
        if not own:
            axis.plot(time, curve, color="C0", linewidth=0.9)
        off = "what the others are held against (grey)" if own else (
            f"spectrum off by {100 * row['spectrum_error_mean']:.0f} %"
        )  # fmt: skip
        louder = abs(curve).max() > 1.5 * most
        scale = ", another scale" if louder else ""
        axis.set_ylim(*(1.1 * abs(curve).max() * np.array([-1, 1]) if louder else (-most, most)))
        axis.set_xlim(0.0, 1e3 * len(curve) / result["rate"])
        axis.set_title(f"{_words(row['sample'])}: {off}{scale}", fontsize=9, loc="left")
        axis.tick_params(labelsize=8)
        axis.grid(color="0.92")
    axes[-1].set_xlabel("time after contact [ms]")
    figure.supylabel(
        f"acceleration of the tip, tapped at {result['drawn_velocity']:.3g} m/s [m/s²]", fontsize="medium"
    )
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


def _legend(axis: Any, **options: Any) -> None:
    axis.legend(fontsize="small", title_fontsize="small", loc="upper right", **options)


def _words(sample: str) -> str:
    return sample.replace("_", " ")


def _shade(i: int, count: int) -> tuple[float, float, float]:
    share = i / max(count - 1, 1)
    return (0.1 + 0.8 * share, 0.3, 0.8 - 0.6 * share)
