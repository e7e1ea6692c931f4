# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A haptic device and the hand on it, simulated: what the runtime's forces do to something that moves.

    m dv/dt = f_held + f_hand - b v - f_c sign(v),     f_hand = push + k_h (x_h - x) - b_h v

f_held is the runtime's force, sampled each period T from the position as the encoders give it (rounded to the
quantum), sent tau later and held until the next one comes.  Holding a spring of stiffness sigma gives energy that
damping has to take: b >= sigma (T / 2 + tau); a position known to delta only, that friction has to take:
f_c >= sigma delta / 2 (V. Hayward, Physically-based haptic synthesis, 2008, section 1, after Colgate and Schenkel,
1994).  Between samples the motion is integrated in `substeps` steps, damping implicitly and dry friction so that it
stops but never reverses.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from palpate.runtime.session import Session

__all__ = ["Device", "Hand", "Motion", "simulate"]


@dataclass(frozen=True)
class Device:
    """Seen at its tip.

    Attributes:
        mass: kg.
        damping: N s/m, b.
        dry_friction: N, f_c.
        rate: Hz, 1 / T.
        delay: s, tau, from the sample to the motors; below T.
        quantum: m, delta; 0: exact positions.
    """

    mass: float = 0.05
    damping: float = 0.0
    dry_friction: float = 0.0
    rate: float = 1000.0
    delay: float = 0.0
    quantum: float = 0.0


@dataclass(frozen=True)
class Hand:
    """What a person adds: a constant push, and a spring and damper to where the hand means to be.

    Attributes:
        push: (3,) N.
        stiffness: N/m, k_h.
        damping: N s/m, b_h.
        intention: (n, 3) m, x_h at each tick (the last one stays); None: no spring.
        along: (3,), unit; the hand keeps the device on a line through its start in this direction; None: it does not.
    """

    push: tuple[float, float, float] = (0.0, 0.0, 0.0)
    stiffness: float = 0.0
    damping: float = 0.0
    intention: np.ndarray | None = None
    along: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class Motion:
    """What happened, at each tick.

    Attributes:
        position: (n, 3) m, the true one.
        velocity: (n, 3) m/s.
        responses: (n,) structured array, `layout.RESPONSE`.
    """

    position: np.ndarray
    velocity: np.ndarray
    responses: np.ndarray


def simulate(
    session: Session, device: Device, hand: Hand, start: ArrayLike, ticks: int, substeps: int = 20
) -> Motion:
    """Lets the hand move the device for `ticks` periods, from rest at `start` (3,) m.

    Raises:
        ValueError: mass or rate not above 0, delay not within a period, or a negative number elsewhere.
    """
    period = 1.0 / device.rate if device.rate > 0 else 0.0
    if not (device.mass > 0 and 0 <= device.delay < period):
        raise ValueError("mass and rate have to be above 0 and the delay within a period")
    if min(device.damping, device.dry_friction, device.quantum, hand.stiffness, hand.damping) < 0:
        raise ValueError("damping, friction, quantum and the hand's spring cannot be negative")
    x, v = np.array(start, dtype=float), np.zeros(3)
    held, push = np.zeros(3), np.array(hand.push, dtype=float)
    position, velocity, responses = np.zeros((ticks, 3)), np.zeros((ticks, 3)), []
    for tick in range(ticks):
        position[tick], velocity[tick] = x, v
        measured = np.round(x / device.quantum) * device.quantum if device.quantum else x
        response = session.tick(measured, dt=period)
        responses.append(response)
        aim = None if hand.intention is None else hand.intention[min(tick, len(hand.intention) - 1)]
        for duration, force in ((device.delay, held), (period - device.delay, response["force"])):
            if duration > 0:
                x, v = _move(device, hand, push + force, aim, x, v, duration / substeps, substeps)
        held = response["force"].copy()
    return Motion(position, velocity, np.array(responses))


def _move(device, hand, force, aim, x, v, dt, substeps):
    damping = device.damping + hand.damping
    for _ in range(substeps):
        pull = force if aim is None else force + hand.stiffness * (aim - x)
        if hand.along is not None:
            pull = np.dot(pull, hand.along) * np.asarray(hand.along)
        v = (v + dt / device.mass * pull) / (1.0 + dt * damping / device.mass)
        speed = np.linalg.norm(v)
        if device.dry_friction and speed > 0.0:
            v = v * max(0.0, 1.0 - dt * device.dry_friction / (device.mass * speed))
        x = x + dt * v
    return x, v
