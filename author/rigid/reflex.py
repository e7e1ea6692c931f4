# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Faces go on beyond reflex edges, under the wall that rises there.

A point that is sunk into that wall by s lies s beyond the face's boundary (walls at right angles), where the face is
met all the same.  The runtime looks up boundary lines only, so the lines of reflex edges are moved outward when
objects are cooked, as far as contact is followed; those of convex edges stay.
"""

from __future__ import annotations

import numpy as np

from palpate.author.rigid.body import Element

__all__ = ["past_reflex_edges"]

PARALLEL = 0.02
"""sine; boundary lines that meet at less than this have no common corner to move."""


def past_reflex_edges(face: Element, depth: float) -> tuple[np.ndarray, float]:
    """Boundary lines (k, 4) m of a polygon with those of reflex edges moved outward, and by how much its ball grows.

    Args:
        depth: m; the deepest contact that is followed.
    """
    lines, move = np.array(face.numbers, dtype=float), face.outward
    if not len(move) or not np.any(move[:, 2] > 0):
        return lines, 0.0
    ends, found, joints = lines.reshape(-1, 2, 2), [], []
    for i, own in enumerate(ends):
        at = []
        for p in own:
            near = [
                j for j in range(len(ends))
                if j != i and np.linalg.norm(ends[j] - p, axis=1).min() < 1e-12
            ]  # fmt: skip
            j = near[0] if near else i
            n, far = move[[i, j], :2], depth * move[[i, j], 2]
            if abs(np.linalg.det(n)) > PARALLEL:
                at.append(p + np.linalg.solve(n, far))
            else:  # one line goes on: a step where only one part is reflex
                at.append(p + far[0] * n[0])
                if i < j and abs(far[0] - far[1]) > 1e-12:
                    joints.append([*at[-1], *(p + far[1] * n[1])])
        found.append([*at[0], *at[1]])
    moved = np.array(found + joints)
    grown = float(
        np.linalg.norm(moved.reshape(-1, 2), axis=1).max()
        - np.linalg.norm(lines.reshape(-1, 2), axis=1).max()
    )
    return moved, max(grown, 0.0)
