# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The eleven samples of the paper's study (its table 1): three real ones and eight renderings.

Stiffnesses, amplitudes, durations and the frequency that the study really played (36.2 Hz, its footnote) are
the paper's.
It does not say what the block weighs, how its top gives way, or how materials lose energy: those are this
project's choices.
The block of wood on foam gives way by 7 kN/m, not by wood's 70 kN/m: a block that bends on its foam, such that the
contact rings near the 66 Hz at which the paper tuned its sinusoid, and stays within its device's force, as the
paper says.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.author.transients.library import Library, library_of_shape
from palpate.author.transients.shapes import decaying_sinusoid, pulse
from palpate.author.transients.stylus import Stylus
from palpate.author.transients.tap import Controller, RealSample
from palpate.author.transients.transient_table import ATTENUATION
from palpate.fields.transient_layout import transient_layer

__all__ = ["FIRM", "PULSE", "REAL", "SAMPLES", "SINUSOID", "SOFT", "Rendering", "controller", "layer_of"]

FIRM, SOFT = 680.0, 340.0
"""N/m, of the study's two proportional responses."""
PULSE = (5.7, 0.020)
"""N s/m and s (the paper, table 1)."""
SINUSOID = (15.9, 36.2, 0.055)
"""N s/m, Hz and s (the paper, table 1, and its footnote)."""
SHAPED = (0.01, 0.3)
"""m/s, between which the shapes are stored; they are linear in velocity."""

REAL = {
    "wood": RealSample(70_000.0, 4.0),
    "wood_on_foam": RealSample(7_000.0, 4.0, block=0.1, foam=350.0, foam_damping=4.0),
    "foam": RealSample(220.0, 0.0),
}


@dataclass(frozen=True)
class Rendering:
    """Attributes: stiffness N/m of the response; transient: pulse, sinusoid, library or none."""

    stiffness: float
    transient: str = "none"


SAMPLES: dict[str, RealSample | Rendering] = {
    **REAL,
    "firm_proportional": Rendering(FIRM),
    "soft_proportional": Rendering(SOFT),
    "firm_pulse": Rendering(FIRM, "pulse"),
    "soft_pulse": Rendering(SOFT, "pulse"),
    "firm_sinusoid": Rendering(FIRM, "sinusoid"),
    "soft_sinusoid": Rendering(SOFT, "sinusoid"),
    "firm_matched": Rendering(FIRM, "library"),
    "soft_matched": Rendering(SOFT, "library"),
}


def layer_of(
    rendering: Rendering, stylus: Stylus, library: Library | None = None, attenuation: float = 1.0
) -> bytes | None:
    """What the runtime plays beside the response; shapes as the study tuned them, the library times `attenuation`."""
    if rendering.transient == "none":
        return None
    if rendering.transient == "library":
        assert library is not None
        made = library
    elif rendering.transient == "pulse":
        made = library_of_shape(lambda t, v: pulse(t, v, *PULSE), PULSE[1], SHAPED, stylus.rate)
    else:
        made = library_of_shape(
            lambda t, v: decaying_sinusoid(t, v, *SINUSOID), SINUSOID[2], SHAPED, stylus.rate
        )
    return transient_layer(
        made.rate,
        made.velocity,
        made.force,
        attenuation=attenuation if rendering.transient == "library" else 1.0,
        force_short=stylus.force_max,
        force_steady=stylus.force_steady,
    )


def controller(
    rendering: Rendering,
    stylus: Stylus,
    library: Library | None = None,
    attenuation: float = ATTENUATION,
) -> Controller:
    """What the study's loop does, in Python: a spring, and from the first crossing on a transient for the velocity
    measured then.  The runtime is held against it.

    Velocity is the slope of the encoder's readings over the last `SPAN`.  Commands are positive into the sample.
    """
    history: list[np.ndarray] = []
    begun: dict[int, tuple[int, np.ndarray]] = {}
    span = round(SPAN * stylus.rate)
    time = np.arange(round(0.1 * stylus.rate)) / stylus.rate

    def transient(v: float) -> np.ndarray:
        if rendering.transient == "pulse":
            return pulse(time, v, *PULSE)
        if rendering.transient == "sinusoid":
            return decaying_sinusoid(time, v, *SINUSOID)
        assert library is not None
        return attenuation * library.at(v)

    def command(depth: np.ndarray) -> np.ndarray:
        history.append(depth)
        force = -rendering.stiffness * np.maximum(depth, 0.0)
        if rendering.transient == "none":
            return force
        k = len(history) - 1
        for i, d in enumerate(depth):
            if i not in begun and d > 0.0 and k >= span:
                past = np.array([h[i] for h in history[k - span : k + 1]])
                slope = np.polyfit(np.arange(span + 1) / stylus.rate, past, 1)[0]
                begun[i] = k, transient(float(slope))
            if i in begun and k - begun[i][0] < len(begun[i][1]):
                force[i] -= begun[i][1][k - begun[i][0]]
        return force

    return command


SPAN = 0.01
"""s; an encoder of 30 um then tells 0.1 m/s within 1 %."""
