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
from palpate.author.transients.library import Library

__all__ = ["accelerations_picture", "bode_picture", "library_picture", "tap_sound"]


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
