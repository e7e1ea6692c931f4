# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A drag over a texture as a PNG: force over time, and the spectrum with the line at k v marked."""

from __future__ import annotations

from pathlib import Path

from palpate.author.texture.drag import Drag

__all__ = ["drag_picture"]

SHOWN = 4.0
"""The spectrum is drawn up to so many times k v."""


def drag_picture(dragged: Drag, path: Path) -> None:
    """Writes `path`; raises OSError where it cannot."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 6.0), layout="constrained")
    over_time, over_frequency = figure.subplots(2, 1)
    over_time.plot(dragged.time, dragged.plain, color="0.6", linewidth=1.4, label="without the texture")
    over_time.plot(dragged.time, dragged.force, color="C0", linewidth=1.1, label="with it")
    over_time.set_xlabel("time [s]")
    over_time.set_ylabel("force along the drag [N]")
    over_time.set_title(
        f"dragged at {1e3 * dragged.speed:.3g} mm/s along a wave of {1e3 * dragged.wavelength:.3g} mm, "
        f"{1e3 * dragged.depth:.3g} mm deep",
        fontsize="medium",
    )
    over_time.margins(y=0.25)  # room for the legend
    over_time.legend(fontsize="small", ncols=2, loc="upper right")
    over_time.grid(color="0.9")
    kept = dragged.frequency <= SHOWN * dragged.expected
    over_frequency.axvline(
        dragged.expected, color="C3", linewidth=1.2, linestyle="--", label=f"k v = {dragged.expected:.4g} Hz"
    )
    over_frequency.plot(
        dragged.frequency[kept],
        1e3 * dragged.spectrum[kept],
        color="C0",
        label=f"line at {dragged.line:.4g} Hz",
    )
    over_frequency.axhline(
        1e3 * dragged.judged, color="0.5", linewidth=1.0, linestyle=":",
        label=f"force amplitude of table 1: {1e3 * dragged.judged:.3g} mN at {dragged.normal_force:.3g} N",
    )  # fmt: skip
    over_frequency.set_xlabel("frequency [Hz]")
    over_frequency.set_ylabel("what the texture adds [mN]")
    over_frequency.margins(y=0.4)  # likewise
    over_frequency.set_ylim(bottom=0.0)
    over_frequency.grid(color="0.9")
    over_frequency.legend(fontsize="small", loc="upper right")
    figure.savefig(path, dpi=120)
