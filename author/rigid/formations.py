# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The table of valid contact formations of a pair of bodies: principal contacts that one pose has exactly.

Poses are pulled into contact (formation_search.py) to a fortieth of eps and named with a threshold of a twentieth, so
that what only the tolerance of contact allows is not in the table: a face on one wall with an edge on another,
where a digital error made the edge of a second face.  The runtime prefers what the table has (rigid_formation.h).
The table is as complete as the search: `news` tells how often its last quarter still met something new.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from palpate.author.rigid.body import Body
from palpate.author.rigid.cook import cooked_rigid
from palpate.author.rigid.formation_search import touching_poses
from palpate.author.rigid.law import LUO_XIAO, Law
from palpate.runtime.rigid import Rigid

__all__ = ["FormationTable", "formation_coverage", "formation_table", "jolted", "keys_of"]

SHARP = 0.05
"""The table's threshold as a fraction of eps."""


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
    seen: set[tuple[int, ...]] = set()
    order = []
    for keys in _valid(held, fixed, law, samples, seed)[2]:
        order.append(keys not in seen)
        seen.add(keys)
    last = order[-max(1, len(order) // 4) :]
    return FormationTable(tuple(sorted(seen)), float(np.mean(last)) if last else 0.0, len(order))


def formation_coverage(
    held: Body,
    fixed: Body,
    table: FormationTable,
    law: Law = LUO_XIAO,
    noise: float = 0.1,
    samples: int = 20_000,
    seed: int = 2,
) -> dict[str, float]:
    """How the table and poses drawn anew agree.

    Args:
        noise: what the poses are moved by, as a fraction of eps; see `jolted`.

    Returns:
        poses: valid ones, of which nothing else is nearer than 1.6 eps.
        found: fraction of them with a formation of the table.
        right: fraction of them, moved, that is named rightly without the table; right_with_table: with it.
    """
    position, orientation, keys = _valid(held, fixed, law, samples, seed)
    clear = Rigid(cooked_rigid(held, fixed, 1.0, replace(law, threshold=1.6 * law.threshold)))
    named = [keys_of(row) for row in clear.identify(position, orientation)]
    there = np.array([a == b for a, b in zip(keys, named, strict=True)], dtype=bool)
    truth = [k for k, t in zip(keys, there, strict=True) if t]
    rng = np.random.default_rng(seed)
    moved = jolted(held, position[there], orientation[there], noise * law.threshold, rng)

    def right(formations: tuple[tuple[int, ...], ...]) -> float:
        found = Rigid(cooked_rigid(held, fixed, 1.0, law, formations)).identify(*moved)
        return float(np.mean([keys_of(row) == k for row, k in zip(found, truth, strict=True)]))

    known = set(table.formations)
    return {
        "poses": len(truth),
        "found": float(np.mean([k in known for k in truth])) if truth else 0.0,
        "right": right(()) if truth else 0.0,
        "right_with_table": right(table.formations) if truth else 0.0,
    }


def jolted(
    held: Body, position: np.ndarray, orientation: np.ndarray, noise: float, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Poses displaced by up to `noise` (m) and turned until no point of the held body moves by more than that again."""
    radius = max(float(np.linalg.norm(e.ball[0] - held.centre)) + e.ball[1] for e in held.elements)
    push, turn = (noise * _within_ball(len(position), rng) for _ in range(2))
    return position + push, (Rotation.from_rotvec(turn / radius) * Rotation.from_quat(orientation)).as_quat()


def keys_of(response: np.void) -> tuple[int, ...]:
    """The rising keys of a response's formation."""
    contacts = response["contact"][: response["contact_count"]]
    return tuple(
        sorted(
            int(h) << 16 | int(f)
            for h, f in zip(contacts["held_element"], contacts["fixed_element"], strict=True)
        )
    )


def _valid(
    held: Body, fixed: Body, law: Law, samples: int, seed: int
) -> tuple[np.ndarray, np.ndarray, list[tuple[int, ...]]]:
    """Poses that touch without going below zero gap, and their formations."""
    rng = np.random.default_rng(seed)
    exact = Rigid(cooked_rigid(held, fixed, 1.0, replace(law, threshold=SHARP * law.threshold)))
    position, orientation = touching_poses(held, fixed, law, 0.5 * SHARP * law.threshold, samples, rng)
    found = exact.identify(position, orientation)
    there = [
        bool(row["contact_count"])
        and row["status"] == 0
        and row["contact"]["gap"][: row["contact_count"]].min() >= 0
        for row in found
    ]
    return position[there], orientation[there], [keys_of(row) for row in found[there]]


def _within_ball(count: int, rng: np.random.Generator) -> np.ndarray:
    v = rng.normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1)[:, None] * rng.random((count, 1)) ** (1 / 3)
