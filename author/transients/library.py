# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Transients by incoming velocity, of which a contact plays the linear combination of the two nearest (the
paper, section 3.4).

Below the slowest recording its transient is scaled with velocity, down to nothing at rest; above the fastest one the
fastest is played, and the runtime says that it was limited.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from palpate.author.errors import InputError, InputProblem
from palpate.author.transients.identification import DeviceModel
from palpate.author.transients.inversion import Transient, inverted

__all__ = ["Library", "library_of", "library_of_shape"]


@dataclass(frozen=True)
class Library:
    """Attributes: rate Hz; velocity (k,) m/s, rising; force (k, n) N, positive out of the surface, zero at
    both ends."""

    rate: float
    velocity: np.ndarray
    force: np.ndarray

    def at(self, velocity: float) -> np.ndarray:
        """(n,) N for a contact at `velocity` m/s."""
        v = self.velocity
        if velocity <= v[0]:
            return self.force[0] * max(velocity, 0.0) / v[0]
        if velocity >= v[-1]:
            return self.force[-1]
        i = int(np.searchsorted(v, velocity)) - 1
        w = (velocity - v[i]) / (v[i + 1] - v[i])
        return (1.0 - w) * self.force[i] + w * self.force[i + 1]


def library_of(
    model: DeviceModel,
    acceleration: Sequence[np.ndarray],
    velocity: Sequence[float],
    rate: float,
    stiffness: float = 0.0,
) -> tuple[Library, list[Transient]]:
    """From recordings after contact, one a velocity (m/s); `stiffness` as in `inverted`.

    Raises InputError where two velocities are the same, one is not above 0, or a recording cannot be inverted.
    """
    order = np.argsort(velocity)
    v = np.asarray(velocity, dtype=float)[order]
    if len(v) < 1 or not np.all(np.isfinite(v)) or v[0] <= 0.0 or np.any(np.diff(v) <= 1e-4 * v[-1]):
        raise InputError(
            InputProblem(
                "",
                "velocity",
                [float(x) for x in v],
                "cannot index a library",
                "velocities above 0, all different",
            )
        )
    found = [inverted(model, acceleration[i], float(velocity[i]), rate, stiffness) for i in order]
    count = min(len(t.force) for t in found)
    return Library(rate, v, -np.stack([t.force[:count] for t in found])), found


def library_of_shape(
    shape: Callable[[np.ndarray, float], np.ndarray], duration: float, velocity: Sequence[float], rate: float
) -> Library:
    """Of `shape`(time, velocity) -> N, set to zero at both ends."""
    time = np.arange(round(duration * rate) + 1) / rate
    force = np.stack([shape(time, float(v)) for v in velocity])
    force[:, 0] = force[:, -1] = 0.0
    return Library(rate, np.asarray(velocity, dtype=float), force)
