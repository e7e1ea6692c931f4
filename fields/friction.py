# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The friction spring: the NumPy twin of the runtime's sticking and slipping.

State: stretch s = tangential part of p - c (p tool reference, c anchor) and the spring's stiffness k.
Stored energy E = U(p) + 1/2 k |s|^2.  One tick, from p to p + dp (Hayward and Armstrong, A new computational model
of friction applied to haptic rendering, 2000, eq. 3 for the yield):

1. the force sent was f = -grad U - k s; the hand moves p by dp against it, at fixed k and c:  s <- s + P dp,
   P = I - n n^T at the old place; then s turns with the normal, n -> n', by the smallest rotation,
   s <- s - (s . n') / (1 + n . n') (n + n'), which keeps |s|;
2. k follows the field: where it rises, s shrinks so that k s stays; where it falls, s stays;
3. slip: where |k s| > mu f_n, s shrinks to |k s| = mu f_n.

The rotation, 2 and 3 never raise E, so what the hand did not put in is at most the zero-order hold's
1/2 sigma |dp|^2 (energy.py recomputes this).  First contact starts from k = 0, hence s = 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.fields.interpolation import evaluate
from palpate.fields.response_field import ResponseField

__all__ = ["FrictionPath", "follow"]


@dataclass(frozen=True)
class FrictionPath:
    """A path of T ticks.

    Attributes:
        force: (T, 3) N, on the tool, sent at each tick.
        stretch: (T, 3) m, s after each tick.
        stiffness: (T,) N/m, k after each tick.
        stored: (T,) J, U + 1/2 k |s|^2 after each tick.
        slipping: (T,) bool, True where step 3 shortened s.
        valid: (T,) bool, the field's word on the position.
    """

    force: np.ndarray
    stretch: np.ndarray
    stiffness: np.ndarray
    stored: np.ndarray
    slipping: np.ndarray
    valid: np.ndarray


def follow(field: ResponseField, positions: np.ndarray) -> FrictionPath:
    """Forces and stored energy along tool reference `positions` (T, 3) m, one per tick, starting unstretched."""
    positions = np.asarray(positions, dtype=float)
    response = evaluate(field, positions)
    normal, limit = response.normal, response.friction_coefficient * np.maximum(response.normal_force, 0.0)
    count = len(positions)
    stretch, stiffness = np.zeros((count, 3)), np.zeros(count)
    slipping = np.zeros(count, dtype=bool)
    s, k, touching = np.zeros(3), 0.0, False
    for i in range(count):
        target, n = response.friction_stiffness[i], normal[i]
        if not response.depth[i] > 0.0:
            s, k, touching = np.zeros(3), 0.0, False
            continue
        if touching:
            before, dp = normal[i - 1], positions[i] - positions[i - 1]
            s = s + dp - (dp @ before) * before
            s = s - (s @ n) / (1.0 + before @ n) * (before + n)
        touching = True
        if target > k:
            s = s * (k / target)
        elif target == 0.0:
            s = np.zeros(3)
        k = target
        pull = k * np.linalg.norm(s)
        if pull > limit[i]:
            s = s * (limit[i] / pull)
            slipping[i] = True
        stretch[i], stiffness[i] = s, k
    force = response.force - stiffness[:, None] * stretch
    stored = response.energy + 0.5 * stiffness * np.sum(stretch**2, axis=1)
    return FrictionPath(force, stretch, stiffness, stored, slipping, response.valid)
