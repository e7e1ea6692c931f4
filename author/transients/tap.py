# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Taps of the simulated stylus on a thing, real or rendered.

A real sample pushes the stylus's tip back with Hunt and Crossley's law (1975) for a linear spring,

    f = k d (1 + lambda d') >= 0,

d the tip's depth against the sample's top; a block of wood on foam has a mass of its own between that spring
and the foam's.
A rendering reads the motor's encoder at the loop's rate and commands a force, which the motor gives `delay` later and
holds.  The hand goes on at the speed that it had: a person takes 100 ms to react, longer than what is simulated.
Between commands the linear part moves by its exact matrix exponential in `SUBSTEPS` steps, contact forces held
over each.
All taps of a call move at once, as columns.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm
from scipy.signal import cont2discrete, dlsim

from palpate.author.transients.stylus import V1, V2, V3, X1, X2, X3, Stylus, Z

__all__ = ["RealSample", "Taps", "swept", "tapped"]

SUBSTEPS = 4
"""A loop's period in steps; 25 us at 10 kHz, where wood's contact lasts about 2 ms."""
APPROACH = 0.02
"""s, before the tip would reach the sample."""

Controller = Callable[[np.ndarray], np.ndarray]
"""From the depths that encoders read (taps,) m to the forces that are commanded (taps,) N, once a period."""


@dataclass(frozen=True)
class RealSample:
    """Attributes: stiffness N/m and loss s/m (k, lambda) of its top; block kg on foam N/m with foam_damping N s/m,
    or a block of 0 kg: it does not give way."""

    stiffness: float
    loss: float
    block: float = 0.0
    foam: float = 0.0
    foam_damping: float = 0.0


@dataclass(frozen=True)
class Taps:
    """Attributes: rate Hz; time (n,) s, 0 where the tip first touches; velocity (taps,) m/s before contact;
    acceleration
    (taps, n) m/s2 of the tip, positive into the sample; depth (taps, n) m, of the tip; command (taps, n) N,
    the motor's,
    positive into the sample, cut at the amplifier's limit; saturated (taps,) bool."""

    rate: float
    time: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    depth: np.ndarray
    command: np.ndarray
    saturated: np.ndarray


def tapped(
    stylus: Stylus,
    velocity: np.ndarray,
    sample: RealSample | None = None,
    controller: Controller | None = None,
    duration: float = 0.12,
    seed: int | None = None,
) -> Taps:
    """Taps at `velocity` (taps,) m/s for `duration` s after contact; with `seed`, accelerations carry the
    sensor's noise."""
    velocity = np.atleast_1d(np.asarray(velocity, dtype=float))
    period = 1.0 / stylus.rate
    before = round(APPROACH * stylus.rate)
    state = np.zeros((7, len(velocity)))
    state[[X1, X2, X3]] = -velocity * before * period
    (c1, c2, _), (k1, k2) = stylus.dampings, stylus.springs
    state[X2] -= (c1 + c2) * velocity / k2  # the arm trails behind the hand that pushes it
    state[X1] = state[X2] - c1 * velocity / k1
    state[[V1, V2, V3]] = velocity
    state[Z] = -sum(stylus.dampings) * velocity
    hand = velocity - state[Z] / stylus.hand_damping
    count = before + round(duration * stylus.rate)
    taps = _driven(stylus, state, hand, count, sample, controller, seed)
    return Taps(
        taps.rate,
        taps.time - before * period,
        velocity,
        taps.acceleration,
        taps.depth,
        taps.command,
        taps.saturated,
    )


def swept(stylus: Stylus, force: np.ndarray) -> np.ndarray:
    """(n,) m/s2: what the tip does, away from any sample, when `force` (n,) N is commanded and held."""
    a, b = stylus.matrices()
    steps = 2  # a period is 100 us and the delay a whole number of half ones
    step = 1.0 / (stylus.rate * steps)
    late = round(stylus.delay / step)
    held = np.repeat(np.clip(force, -stylus.force_max, stylus.force_max), steps)
    held = np.concatenate([np.zeros(late), held])[: len(held)]
    system = cont2discrete((a, b[:, :1], a[V3][None], b[V3, :1][None]), step)
    return dlsim(system, held)[1][::steps, 0]


def _driven(
    stylus: Stylus,
    state: np.ndarray,
    hand: np.ndarray,
    count: int,
    sample: RealSample | None = None,
    controller: Controller | None = None,
    seed: int | None = None,
) -> Taps:
    """`count` periods from `state` (7, taps), the hand's far end moving at `hand` (taps,) m/s."""
    a, b = stylus.matrices()
    step = 1.0 / (stylus.rate * SUBSTEPS)
    whole = expm(np.block([[a, b], [np.zeros((3, 10))]]) * step)
    move, push = whole[:7, :7], whole[:7, 7:]
    taps = state.shape[1]
    late = round(stylus.delay / step)
    waiting = np.zeros((late + SUBSTEPS, taps))  # commands on their way, a row a substep
    block, speed = np.zeros(taps), np.zeros(taps)
    acceleration, depth, commands = (np.zeros((taps, count)) for _ in range(3))
    saturated = np.zeros(taps, dtype=bool)
    state = state.copy()
    inputs = np.zeros((3, taps))
    inputs[2] = hand
    at = 0
    for k in range(count):
        depth[:, k] = state[X3]
        if controller is not None:
            read = state[X1]
            read = np.round(read / stylus.quantum) * stylus.quantum if stylus.quantum else read
            asked = controller(read)
            command = np.clip(asked, -stylus.force_max, stylus.force_max)
            saturated |= command != asked
            commands[:, k] = command
            for j in range(SUBSTEPS):
                waiting[(at + late + j) % len(waiting)] = command
        for j in range(SUBSTEPS):
            inputs[0] = waiting[at % len(waiting)]
            at += 1
            if sample is not None:
                d = state[X3] - block
                inputs[1] = -np.maximum(
                    0.0, sample.stiffness * np.maximum(d, 0.0) * (1.0 + sample.loss * (state[V3] - speed))
                )
                if sample.block > 0.0:
                    push_down = -inputs[1] - sample.foam * block - sample.foam_damping * speed
                    speed = speed + step / sample.block * push_down
                    block = block + step * speed
            if j == 0:
                acceleration[:, k] = a[V3] @ state + b[V3] @ inputs
            state = move @ state + push @ inputs
    if seed is not None:
        acceleration += stylus.noise * np.random.default_rng(seed).standard_normal(acceleration.shape)
    time = np.arange(count) / stylus.rate
    return Taps(stylus.rate, time, np.zeros(taps), acceleration, depth, commands, saturated)
