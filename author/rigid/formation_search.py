# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Poses in which two bodies touch: drawn, then pulled into contact.

Most poses have a face or axis of one body along one of the other; half have a corner near a corner, half come in from
outside.  Then, a few times over, some of the elementary contacts within a wider threshold are drawn together at once,
and at last those that touch already are (Gauss-Newton steps of least norm on the six degrees of freedom).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from palpate.author.rigid.body import Body, Element, frame_of
from palpate.author.rigid.cook import cooked_rigid
from palpate.author.rigid.law import Law
from palpate.runtime.rigid import Rigid

__all__ = ["touching_poses"]

RADIUS = 0.02
"""m; the lever that weighs turns against displacements in a step of least norm."""
STEP_MAX = 0.01
"""m"""
FAR = 0.3
"""m; where bodies come from at most."""


def touching_poses(
    held: Body, fixed: Body, law: Law, gap: float, samples: int, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n, 3) m of the centre of mass and orientations (n, 4); what touches has about `gap` (m)."""
    small = min(held.smallest, fixed.smallest)
    wide = min(6 * law.threshold, 0.3 * small)
    deep = max(wide, min(6 * law.threshold, 0.4 * small))
    search = Rigid(cooked_rigid(held, fixed, 1.0, replace(law, threshold=wide, depth_max=deep), merged=False))
    position, orientation = _drawn(held, fixed, samples, rng)
    coming = rng.random(samples) < 0.5
    position[coming] = _come_in(search, held, fixed, position[coming], orientation[coming], wide, rng)
    share = rng.uniform(0.2, 1.0, (samples, 1))
    for _ in range(8):
        found = search.identify(position, orientation)
        chosen = rng.random(found["contact"].shape) < share
        position, orientation = _drawn_together(found, position, orientation, gap, chosen)
    for near in (0.5, 0.5, 0.5, 0.2, 0.2, 0.2):
        found = search.identify(position, orientation)
        chosen = found["contact"]["gap"] < near * law.threshold
        position, orientation = _drawn_together(found, position, orientation, gap, chosen)
    return position, orientation


def _drawn_together(found, position, orientation, gap, chosen):
    """One Gauss-Newton step of the chosen contacts towards `gap`."""
    contacts = found["contact"]
    there = chosen & (np.arange(contacts.shape[1]) < found["contact_count"][:, None])
    arm = contacts["point"] - position[:, None]
    turning = np.cross(arm, contacts["normal"]) / RADIUS
    rows = np.concatenate([contacts["normal"], turning], axis=2) * there[..., None]
    step = np.einsum("nij,nj->ni", np.linalg.pinv(rows, rcond=1e-3), (gap - contacts["gap"]) * there)
    step = step / np.maximum(1.0, np.linalg.norm(step, axis=1, keepdims=True) / STEP_MAX)
    turn = Rotation.from_rotvec(step[:, 3:] / RADIUS) * Rotation.from_quat(orientation)
    return position + step[:, :3], turn.as_quat()


def _come_in(search, held, fixed, position, orientation, wide, rng):
    """Where bodies that come along straight lines towards their drawn positions (n, 3) are near contact first."""
    count = len(position)
    theirs = np.array([_direction(e) for e in fixed.elements])
    along = rng.random((count, 1)) < 0.5
    line = np.where(along, rng.choice(theirs, count), _unit(rng.normal(size=(count, 3))))
    far = min(_radius(held) + _radius(fixed), FAR)
    left, place = np.ones(count, dtype=bool), position.copy()
    for s in np.arange(far, -far, -max(0.8 * wide, far / 32)):
        at = position[left] + s * line[left]
        near = search.identify(at, orientation[left])["contact_count"] > 0
        i = np.nonzero(left)[0][near]
        place[i] = at[near]
        left[i] = False
    return place


def _radius(body: Body) -> float:
    return max(float(np.linalg.norm(e.ball[0] - body.centre)) + e.ball[1] for e in body.elements)


def _drawn(held: Body, fixed: Body, samples: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    rotation = Rotation.random(samples, rng).as_matrix()
    ours = np.array([_direction(e) for e in held.elements])
    theirs = np.array([_direction(e) for e in fixed.elements])
    a, b = rng.integers(len(ours), size=samples), rng.integers(len(theirs), size=samples)
    for i in np.nonzero(rng.random(samples) < 0.7)[0]:
        first = -theirs[b[i]] if rng.random() < 0.8 else theirs[b[i]]
        spin = theirs[rng.integers(len(theirs))] if rng.random() < 0.5 else rng.normal(size=3)
        side = ours[rng.integers(len(ours))]
        rotation[i] = _frame(first, spin) @ _frame(ours[a[i]], side).T
    at = np.array([e.ball[0] for e in held.elements])[a]
    to = np.array([e.ball[0] for e in fixed.elements])[b]
    reach = np.array([min(e.ball[1], 0.15) for e in fixed.elements])[b]
    corner = np.nonzero(rng.random(samples) < 0.5)[0]
    at[corner] = rng.choice(_corners(held), len(corner))
    to[corner] = rng.choice(_corners(fixed), len(corner))
    scatter = rng.uniform(-1, 1, (samples, 3)) * reach[:, None] * rng.choice([0.1, 1.0], (samples, 1))
    position = to + scatter - np.einsum("nij,nj->ni", rotation, at - held.centre)
    return position, Rotation.from_matrix(rotation).as_quat()


def _corners(body: Body) -> np.ndarray:
    """(n, 3) m: ends of faces' boundary lines, reflex ones too, and the middles of all else."""
    points = [e.ball[0] for e in body.elements]
    for e in body.elements:
        if e.kind == "polygon" and len(e.numbers):
            across = frame_of(e.axis) if e.across is None else e.across
            plane = np.stack([across, np.cross(e.axis, across)])
            points += list(e.centre + np.asarray(e.numbers)[:, :2] @ plane)
    return np.array(points)


def _direction(e: Element) -> np.ndarray:
    return e.normal[0] if e.kind == "segment" else e.axis


def _unit(v: np.ndarray) -> np.ndarray:
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def _frame(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    third = np.cross(first, second)
    if np.linalg.norm(third) < 1e-6:
        third = np.cross(first, np.eye(3)[int(np.argmin(np.abs(first)))])
    third = third / np.linalg.norm(third)
    return np.stack([first, np.cross(third, first), third], axis=1)
