# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a texture and a transient cost a tick: the tests' plane with each of them and without, in turns in one process.

    python tests/benchmarks/layer_ticks.py [ROUNDS]

A frictionless tool slides 1 mm deep; of each kind the fastest round of 4,000 ticks counts, so that other work on the
machine does not.  Above what the plane alone takes, asked for: at most 100 ns.
"""

import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "fields"))
import synthetic_field

from palpate.fields.cook import cook
from palpate.fields.texture import DeviceLimits, Texture, joined, noise
from palpate.fields.texture_layout import texture_bytes
from palpate.fields.transient_layout import transient_layer
from palpate.runtime import Config, Field, Session

TICKS = 4000
DT = 1e-4  # s
SLOW, FAST = 5e-3, 30e-3  # m/s
FADED = DeviceLimits(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1e-3)  # waves above 1 mHz are faded: all of them, for good
FADING = DeviceLimits(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 10.0)  # at 30 mm/s some of them go
SWING = 40
"""Ticks at 30 mm/s, then as many at 3 mm/s, and so on: gains never come to rest."""


def waves(count: int, masked: bool = False, limits: DeviceLimits | None = None) -> bytes:
    """Noise of so many waves, everywhere or in the test texture's mask."""
    group = noise(6e-6, (300.0, 2500.0), 3, count)
    masks = synthetic_field.patchy_texture().masks if masked else None
    return texture_bytes(
        Texture(
            joined([replace(group, mask=0 if masked else -1)]), 0.4e-3, 300.0, limits or DeviceLimits(), masks
        )
    )


def ringing() -> bytes:
    """A transient that lasts as long as a round does."""
    time_ = np.arange(int(2 * TICKS * DT * 1e3)) / 1e3
    force = np.outer([0.005, 0.01], np.sin(2 * np.pi * 60.0 * time_) * np.hanning(len(time_)))
    force[:, [0, -1]] = 0.0
    return transient_layer(1e3, np.array([0.01, 0.1]), force)


def round_of(field: Field, speed: float, swinging: bool = False) -> float:
    """ns a tick."""
    session = Session(field, Config(friction_coefficient=0.0))
    height = np.linspace(8e-3, 4e-3, 400)
    start = np.array([-4e-3, 0.0, 0.0])
    session.tick_batch(start + height[:, None] * [0.0, 0.0, 1.0], dt=DT)
    # There and back, so that every round stays in the field at any speed.
    slower = np.where(swinging & (np.arange(TICKS) // SWING % 2 == 1), 0.1, 1.0)
    to_and_fro = 4e-3 - abs(np.cumsum(speed * DT * slower) % 8e-3 - 4e-3)
    path = start + [0.0, 0.0, 4e-3] + to_and_fro[:, None] * [1.0, 0.0, 0.0]
    begin = time.perf_counter()
    out = session.tick_batch(path, dt=DT)
    took = time.perf_counter() - begin
    if not out["force"][:, 2].min() > 0.0:
        raise SystemExit("the path left contact")
    return 1e9 * took / TICKS


def main() -> None:
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 60
    plane = synthetic_field.small_plane()
    cases = {
        "nothing": (None, SLOW),
        "texture, 1 wave": (waves(1), SLOW),
        "texture, 12 waves": (waves(12), SLOW),
        "texture, 16 waves": (waves(16), SLOW),
        "texture, 12 waves with a mask": (waves(12, masked=True), SLOW),
        "texture, 16 waves with a mask": (waves(16, masked=True), SLOW),
        "nothing, fast": (None, FAST),
        "texture, 16 waves with a mask, fast": (waves(16, masked=True), FAST),
        "texture, 16 waves with a mask, fast, faded": (waves(16, masked=True, limits=FADED), FAST),
        "texture, 16 waves with a mask, fast, fading": (waves(16, masked=True, limits=FADING), FAST),
        "nothing, swinging": (None, FAST),
        "texture, 16 waves with a mask, swinging": (waves(16, masked=True, limits=FADING), FAST),
        "transient, playing": (ringing(), SLOW),
    }
    fields = {
        name: Field.open(cook(replace(plane, layers={kind_of(layer): layer} if layer else {})))
        for name, (layer, _) in cases.items()
    }
    least = dict.fromkeys(cases, np.inf)
    for _ in range(rounds):
        for name, (_, speed) in cases.items():
            least[name] = min(least[name], round_of(fields[name], speed, "swinging" in name))
    for name, took in least.items():
        alone = least[next(f"nothing{way}" for way in (", fast", ", swinging", "") if way in name)]
        print(f"{name:45s} {took:6.1f} ns a tick, {took - alone:+6.1f}, {took / alone:5.2f} times")


def kind_of(layer: bytes) -> str:
    """The effect's name."""
    return "texture" if layer[:4] == b"TEXT" else "transient"


if __name__ == "__main__":
    main()
