# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Where a tool goes to look for energy from nowhere: kinds of paths over a known organ, (n, TICKS, 3) m in its axes.

wander    a walk with inertia, half of them back the way they came
cycle     the cycle that steals from interpolated forces: press here, drag there, lift, and back through the air
border    to where a formula changes, and to and fro across it: first contact, cells of both lattices (some ticks
          exactly on the border), the end of the curves, the tool's direction along the surface
recorded  a simulated hand's touches (runtime/device.py: mass, damping, tremor, encoders' steps), recorded at the
          pole and played elsewhere on the organ
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from known_organ import KnownOrgan

from palpate.fields.response_field import ResponseField
from palpate.runtime import Config, Field, Session
from palpate.runtime.device import Device, Hand, simulate

__all__ = ["KINDS", "TICKS", "Ground", "paths_of"]

TICKS = 48
KINDS = ("wander", "cycle", "border", "recorded")
SHARES = (0.4, 0.25, 0.2, 0.15)
CAP = 13e-3
"""m from the pole: where paths start; what they reach is stored."""


@dataclass(frozen=True)
class Ground:
    """What paths are drawn on: the organ, its field as USD holds it, touches recorded on it (count, TICKS, 3) m."""

    organ: KnownOrgan
    truth: ResponseField
    touches: np.ndarray

    @staticmethod
    def of(organ: KnownOrgan, truth: ResponseField, field: Field, touches: int) -> Ground:
        return Ground(organ, truth, recorded_touches(organ, field, touches))


def paths_of(ground: Ground, step: np.ndarray, drop: float, rng: np.random.Generator):
    """Paths (n, TICKS, 3) m whose walks take steps of `step` (n,) m, and the kind of each (n,), an index into KINDS.

    `drop` (m): how much deeper all go, so that shorter ways of touching touch too."""
    n = len(step)
    kind = rng.choice(len(KINDS), n, p=SHARES)
    x = np.empty((n, TICKS, 3))
    for i, draw in enumerate((wander, cycle, border, recorded)):
        which = kind == i
        x[which] = draw(ground, step[which], drop, rng)
    return x, kind


def above(organ: KnownOrgan, n: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Places on the cap (n, 3) m and their normals."""
    c = organ.random_cap(n, rng, CAP)
    return c, organ.normal(c)


def wander(ground: Ground, step: np.ndarray, drop: float, rng: np.random.Generator) -> np.ndarray:
    n = len(step)
    c, out = above(ground.organ, n, rng)
    v = rng.normal(size=(n, TICKS - 1, 3)) * 0.4
    for i in range(1, TICKS - 1):
        v[:, i] += 0.9 * v[:, i - 1]
    v[:, :5] -= 1.2 * out[:, None]
    start = c + (ground.organ.radius + 0.5 * step[:, None]) * out
    q = np.concatenate([start[:, None], start[:, None] + np.cumsum(v * step[:, None, None], axis=1)], axis=1)
    q -= (drop * np.minimum(np.arange(TICKS) / 5.0, 1.0))[:, None] * out[:, None]
    half = TICKS // 2
    q[::2, half:] = q[::2, half - 1 :: -1][:, : TICKS - half]
    return q


def over(organ: KnownOrgan, xy: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Points `height` (...,) m above the organ's upper side at xy (..., 2) m."""
    a, b, h = organ.semi_axes
    z = h * np.sqrt(1 - (xy[..., 0] / a) ** 2 - (xy[..., 1] / b) ** 2)
    c = np.concatenate([xy, z[..., None]], axis=-1)
    return c + height[..., None] * organ.normal(c.reshape(-1, 3)).reshape(c.shape)


def cycle(ground: Ground, step: np.ndarray, drop: float, rng: np.random.Generator) -> np.ndarray:
    """Down in 10 ticks, across in 18, up in 10, back in the air; up to 4 mm deep, places up to 2 CAP apart."""
    n = len(step)
    here, there = (organ_xy(ground.organ, n, rng) for _ in range(2))
    free, deep = ground.organ.radius + 0.2e-3, ground.organ.radius - drop - rng.uniform(0.2e-3, 4e-3, (n, 1))
    tick = np.arange(TICKS)
    across = np.interp(tick, [0, 9, 27, 37, 47], [0, 0, 1, 1, 0])
    down = np.interp(tick, [0, 9, 27, 37, 47], [0, 1, 1, 0, 0])
    xy = here[:, None] + across[:, None] * (there - here)[:, None]
    return over(ground.organ, xy, free + down * (deep - free))


def organ_xy(organ: KnownOrgan, n: int, rng: np.random.Generator) -> np.ndarray:
    return organ.random_cap(n, rng, CAP)[:, :2]


def border(ground: Ground, step: np.ndarray, drop: float, rng: np.random.Generator) -> np.ndarray:
    n = len(step)
    c, out = above(ground.organ, n, rng)
    which = rng.integers(0, 5, n)  # contact, amplitudes' cells, geometry's cells, end of curves, direction
    depth = np.select([which == 0, which == 3], [drop, ground.truth.depth_max], rng.uniform(0.3e-3, 4e-3, n))
    place = c + (ground.organ.radius - depth)[:, None] * out
    line = rng.integers(0, 3, n)  # the axis whose border is crossed
    for i, lattice in ((1, ground.truth.amplitudes), (2, ground.truth.geometry.signed_distance)):
        rows = np.flatnonzero(which == i)
        at = place[rows, line[rows]]
        origin = np.broadcast_to(lattice.origin, 3)[line[rows]]
        place[rows, line[rows]] = origin + np.round((at - origin) / lattice.spacing) * lattice.spacing
    aside = np.cross(out, rng.normal(size=(n, 3)))
    aside /= np.linalg.norm(aside, axis=1, keepdims=True)
    direction = np.where(np.isin(which, (0, 3))[:, None], out, aside)
    direction = np.where(np.isin(which, (1, 2))[:, None], np.eye(3)[line], direction)
    size = np.minimum(step, 1e-4)[:, None] * 10.0 ** rng.uniform(-6, 0, (n, TICKS))
    size *= np.where(np.arange(TICKS) % 2 == 0, 1.0, -1.0) * (rng.uniform(size=(n, TICKS)) > 0.2)
    start = c + (ground.organ.radius + 1e-4) * out
    share = np.minimum(np.arange(TICKS) / 8.0, 1.0)[:, None]  # there in 8 ticks
    way = start[:, None] + share * (place - start)[:, None]
    return np.where(share < 1.0, way, place[:, None] + size[..., None] * direction[:, None])


def recorded(ground: Ground, step: np.ndarray, drop: float, rng: np.random.Generator) -> np.ndarray:
    """Recorded touches about other normals, turned at random; `step` is the recording's own."""
    n = len(step)
    c, out = above(ground.organ, n, rng)
    side = np.cross(out, rng.normal(size=(n, 3)))
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    axes = np.stack([side, np.cross(out, side), out], axis=2)  # columns: the recording's x, y, z
    touch = ground.touches[rng.integers(0, len(ground.touches), n)]
    return (
        c[:, None] + np.einsum("nij,ntj->nti", axes, touch) - drop * share_of(touch)[..., None] * out[:, None]
    )


def share_of(touch: np.ndarray) -> np.ndarray:
    """(n, TICKS) 0 at first, 1 from the fifth tick on."""
    return np.broadcast_to(np.minimum(np.arange(TICKS) / 5.0, 1.0), touch.shape[:2])


def recorded_touches(organ: KnownOrgan, field: Field, count: int) -> np.ndarray:
    """(count, TICKS, 3) m about the pole: taps, presses and strokes of a simulated hand at 100 Hz to 4 kHz, as its
    encoders saw them."""
    rng = np.random.default_rng(12)
    pole = np.array([0.0, 0.0, organ.axes[2]])
    touches = np.empty((count, TICKS, 3))
    for touch in touches:
        rate = 10.0 ** rng.uniform(2.0, 3.6)
        t = np.arange(TICKS) / rate
        span = t[-1]
        depth, drag = rng.uniform(0.5e-3, 4e-3), rng.normal(size=2) * 3e-3
        aim = np.zeros((TICKS, 3))
        aim[:, 2] = organ.radius + 0.2e-3 - depth * np.sqrt(np.abs(np.sin(np.pi * t / span)))
        aim[:, :2] = drag * np.sin(np.pi * t / span / 2)[:, None] ** 2
        tremor = rng.normal(size=3) * 1e-4  # m, at 8 to 12 Hz
        aim += tremor * np.sin(2 * np.pi * rng.uniform(8, 12) * t + rng.uniform(0, 6))[:, None]
        hand = Hand(stiffness=rng.uniform(200, 800), damping=rng.uniform(1, 8), intention=aim + pole)
        device = Device(damping=0.5, dry_friction=0.02, rate=rate, quantum=10.0 ** rng.uniform(-6, -4.3))
        session = Session(field, Config(friction_coefficient=rng.uniform(0, 0.5), speed_max=0.0))
        start = pole + np.array([0.0, 0.0, organ.radius + 0.2e-3])
        touch[:] = (
            simulate(session, device, hand, start, TICKS, substeps=4).responses["reference_point"] - pole
        )
    return touches
