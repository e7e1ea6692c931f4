# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The table of valid contact formations of a pair of bodies: principal contacts that one pose without penetration has.

Poses are drawn at random, half of them with a face or axis of one body along one of the other; then, a few times over,
some of the contacts within a wider threshold are drawn to half of eps at once (Gauss-Newton steps of least norm on the
six degrees of freedom).  What such a pose touches without going below zero gap is a valid formation by construction.
The table is as complete as the search: `news` tells how often its last quarter still met something new.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from palpate.author.rigid.body import Body
from palpate.author.rigid.cook import cooked_rigid
from palpate.author.rigid.law import LUO_XIAO, Law
from palpate.runtime.rigid import Rigid

__all__ = ["FormationTable", "formation_coverage", "formation_table", "keys_of", "quaternion"]


@dataclass(frozen=True)
class FormationTable:
    """Attributes:
    formations: rising keys (held element << 16 | fixed element) of each.
    news: fraction of the last quarter of the poses in contact whose formation was new.
    poses: how many were in contact.
    """

    formations: tuple[tuple[int, ...], ...]
    news: float
    poses: int


def formation_table(
    held: Body, fixed: Body, law: Law = LUO_XIAO, samples: int = 20_000, seed: int = 1
) -> FormationTable:
    """Searches valid formations with `samples` drawn poses."""
    exact = Rigid(cooked_rigid(held, fixed, 1.0, law))
    seen: set[tuple[int, ...]] = set()
    order = []
    for keys in _valid(exact.identify(*_touching(held, fixed, law, samples, seed))):
        if keys is not None:
            order.append(keys not in seen)
            seen.add(keys)
    last = order[-max(1, len(order) // 4) :]
    return FormationTable(tuple(sorted(seen)), float(np.mean(last)) if last else 0.0, len(order))


def formation_coverage(
    held: Body, fixed: Body, table: FormationTable, law: Law = LUO_XIAO, samples: int = 20_000, seed: int = 2
) -> dict[str, float]:
    """How often poses drawn anew have a formation of the table.

    Returns:
        poses: valid ones in contact.  found: fraction of them with a formation of the table; noisy: the same after the
        pose is moved by up to a tenth of eps by translation, and as much by rotation, among those still in contact.
    """
    exact, known = Rigid(cooked_rigid(held, fixed, 1.0, law)), set(table.formations)
    position, orientation = _touching(held, fixed, law, samples, seed)
    keys = _valid(exact.identify(position, orientation))
    there = np.array([k is not None for k in keys], dtype=bool)
    rng = np.random.default_rng(seed)
    radius = max(float(np.linalg.norm(e.ball[0] - held.centre)) + e.ball[1] for e in held.elements)
    push, turn = (_within_ball(int(there.sum()), rng) * 0.1 * law.threshold for _ in range(2))
    turned = Rotation.from_rotvec(turn / radius) * Rotation.from_quat(orientation[there])
    moved = exact.identify(position[there] + push, turned.as_quat())
    noisy = [keys_of(row) in known for row in moved if row["contact_count"]]
    return {
        "poses": int(there.sum()),
        "found": float(np.mean([k in known for k in keys if k is not None])) if there.any() else 0.0,
        "noisy": float(np.mean(noisy)) if noisy else 0.0,
    }


def _touching(held: Body, fixed: Body, law: Law, samples: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Drawn poses, some of whose near contacts are drawn together to half of eps."""
    small = min(held.smallest, fixed.smallest)
    wide = replace(
        law, threshold=min(6 * law.threshold, 0.3 * small), depth_max=min(6 * law.threshold, 0.4 * small)
    )
    wide = replace(wide, depth_max=max(wide.threshold, wide.depth_max))
    search = Rigid(cooked_rigid(held, fixed, 1.0, wide))
    rng = np.random.default_rng(seed)
    position, orientation = _drawn(held, fixed, samples, rng)
    for _ in range(14):
        found = search.identify(position, orientation)
        position, orientation = _drawn_together(found, position, orientation, 0.5 * law.threshold, rng)
    return position, orientation


def _valid(found: np.ndarray) -> list[tuple[int, ...] | None]:
    """Formations of poses that touch without going below zero gap; None of the others."""
    return [
        keys_of(row)
        if row["contact_count"]
        and row["status"] == 0
        and row["contact"]["gap"][: row["contact_count"]].min() >= 0
        else None
        for row in found
    ]


def _within_ball(count: int, rng: np.random.Generator) -> np.ndarray:
    v = rng.normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1)[:, None] * rng.random((count, 1)) ** (1 / 3)


def keys_of(response: np.void) -> tuple[int, ...]:
    """The rising keys of a response's formation."""
    contacts = response["contact"][: response["contact_count"]]
    return tuple(
        sorted(
            int(h) << 16 | int(f)
            for h, f in zip(contacts["held_element"], contacts["fixed_element"], strict=True)
        )
    )


def quaternion(matrix: np.ndarray) -> np.ndarray:
    """(n, 4) x y z w of rotation matrices (n, 3, 3)."""
    return Rotation.from_matrix(matrix).as_quat()


def _drawn(held: Body, fixed: Body, samples: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Poses with one of the held body's elements near one of the fixed body's, half of them lined up."""
    rotation = Rotation.random(samples, rng).as_matrix()
    ours = np.array([_direction(e) for e in held.elements])
    theirs = np.array([_direction(e) for e in fixed.elements])
    a, b = rng.integers(len(ours), size=samples), rng.integers(len(theirs), size=samples)
    for i in np.nonzero(rng.random(samples) < 0.7)[0]:
        first = -theirs[b[i]] if rng.random() < 0.8 else theirs[b[i]]
        spin = theirs[rng.integers(len(theirs))] if rng.random() < 0.5 else rng.normal(size=3)
        side = ours[rng.integers(len(ours))]
        rotation[i] = _frame(first, spin) @ _frame(ours[a[i]], side).T
    at = np.array([e.ball[0] - held.centre for e in held.elements])[a]
    to = np.array([e.ball[0] for e in fixed.elements])[b]
    reach = np.array([min(e.ball[1], 0.5) for e in fixed.elements])[b]
    scatter = (
        rng.uniform(-1, 1, (samples, 3))
        * np.minimum(reach, 0.15)[:, None]
        * rng.choice([0.1, 1.0], samples)[:, None]
    )
    return to + scatter - np.einsum("nij,nj->ni", rotation, at), quaternion(rotation)


def _direction(e) -> np.ndarray:
    return e.normal[0] if e.kind == "segment" else e.axis


def _frame(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    third = np.cross(first, second)
    if np.linalg.norm(third) < 1e-6:
        third = np.cross(first, np.eye(3)[int(np.argmin(np.abs(first)))])
    third = third / np.linalg.norm(third)
    return np.stack([first, np.cross(third, first), third], axis=1)


def _drawn_together(found, position, orientation, gap, rng):
    """One Gauss-Newton step towards `gap` at contacts taken with probability 0.8; turns are small."""
    contacts = found["contact"]
    there = (np.arange(8) < found["contact_count"][:, None]) & (rng.random(contacts.shape) < 0.8)
    arm = contacts["point"] - position[:, None]
    rows = (
        np.concatenate([contacts["normal"], np.cross(arm, contacts["normal"]) / 0.02], axis=2)
        * there[..., None]
    )
    wanted = (gap - contacts["gap"]) * there
    step = np.einsum("nij,nj->ni", np.linalg.pinv(rows, rcond=1e-3), wanted)
    length = np.maximum(1.0, np.linalg.norm(step, axis=1, keepdims=True) / 0.01)
    step = step / length
    turn = Rotation.from_rotvec(step[:, 3:] / 0.02) * Rotation.from_quat(orientation)
    return position + step[:, :3], turn.as_quat()
