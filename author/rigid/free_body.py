# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A held object that nobody holds: it moves by the wrench that its hand would feel.  For tests and examples.

Semi-implicit Euler with the wrench of one tick, so that motion can be held against closed forms of rigid-body dynamics.
"""

from __future__ import annotations

import numpy as np

from palpate.author.rigid.body import Body
from palpate.runtime.rigid import RESPONSE, Rigid, RigidConfig, RigidSession

__all__ = ["let_go", "turned"]


def turned(orientation: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """(4,) x y z w: `orientation` turned by the rotation vector `turn` (3,), rad, in world axes."""
    angle = float(np.linalg.norm(turn))
    if angle < 1e-15:
        return orientation
    axis, w = np.sin(angle / 2) * turn / angle, np.cos(angle / 2)
    v, s = orientation[:3], orientation[3]
    out = np.array([*(w * v + s * axis + np.cross(axis, v)), w * s - axis @ v])
    return out / np.linalg.norm(out)


def _matrix(q: np.ndarray) -> np.ndarray:
    return np.stack([_rotated(q, e) for e in np.eye(3)], axis=1)


def _rotated(q: np.ndarray, v: np.ndarray) -> np.ndarray:
    c = np.cross(q[:3], v)
    return v + 2 * (q[3] * c + np.cross(q[:3], c))


def let_go(
    rigid: Rigid,
    body: Body,
    mass: float,
    position: np.ndarray,
    seconds: float,
    dt: float = 1e-3,
    orientation: np.ndarray | None = None,
    velocity: np.ndarray | None = None,
    angular_velocity: np.ndarray | None = None,
    session: RigidSession | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Lets the object go at `position` (3,), m, in free space; or where `session` has brought it.

    Returns:
        (n, 7) m and x y z w, places; (n, 6) m/s and rad/s, velocities; (n,) RESPONSE, of n ticks.
    """
    session = session or RigidSession(rigid, RigidConfig(inertia=False))
    inertia = body.inertia(mass)
    p, q = (
        np.array(position, dtype=float),
        np.array([0, 0, 0, 1.0] if orientation is None else orientation, dtype=float),
    )
    v = np.zeros(3) if velocity is None else np.array(velocity, dtype=float)
    w = np.zeros(3) if angular_velocity is None else np.array(angular_velocity, dtype=float)
    count = round(seconds / dt)
    places, velocities, responses = (
        np.zeros((count, 7)),
        np.zeros((count, 6)),
        np.zeros(count, dtype=RESPONSE),
    )
    for i in range(count):
        out = session.tick(p, q, dt)
        places[i], velocities[i], responses[i] = [*p, *q], [*v, *w], out
        rotation = _matrix(q)
        world = rotation @ inertia @ rotation.T
        v = v + dt * out["force"] / mass
        w = w + dt * np.linalg.solve(world, out["torque"] - np.cross(w, world @ w))
        p = p + dt * v
        q = turned(q, dt * w)
    return places, velocities, responses
