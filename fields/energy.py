# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Was energy created?  An audit of forces that anyone sent along a path, from the field alone.

Each force is held while the tool moves on: work by the hand in tick i is  -f_(i-1) . dp,  dp = p_i - p_(i-1).
Stored energy is E = U + 1/2 k |s|^2.  A held force misses the spring's rise during dp by

    hold_i = U_i - U_(i-1) - grad U_(i-1) . dp + 1/2 k_(i-1) |dp|^2  <=  1/2 sigma |dp|^2

(sigma: largest stiffness on the way).  Passivity is:  E_i - E_0 <= work + sum of hold, at every tick, whatever
friction does.  The audit evaluates the field afresh and takes only positions, forces and stretches from outside.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.fields.interpolation import energy_hessian, evaluate
from palpate.fields.response_field import ResponseField

__all__ = ["EnergyAudit", "energy_audit"]


@dataclass(frozen=True)
class EnergyAudit:
    """Energy accounts along a path of T ticks, each (T,) J, from the first tick on.

    Attributes:
        work: by the hand on the tool.
        stored: U + 1/2 k |s|^2.
        hold: sum of the zero-order hold's terms, U's exact ones and the spring's.
        hold_bound: sum of 1/2 sigma |dp|^2, sigma from the field at five places of each step.
        created: stored - stored at the start - work - hold; never above zero (up to rounding) in a passive response.
        leak: largest `created`, J.
    """

    work: np.ndarray
    stored: np.ndarray
    hold: np.ndarray
    hold_bound: np.ndarray
    created: np.ndarray
    leak: float


def energy_audit(
    field: ResponseField, positions: np.ndarray, forces: np.ndarray, stretch: np.ndarray
) -> EnergyAudit:
    """Audit a response.

    Args:
        field: the field that the response claims to render.
        positions: (T, 3) m, tool reference at each tick.
        forces: (T, 3) N, on the tool, sent at each tick and held to the next.
        stretch: (T, 3) m, friction stretch s after each tick (its tangential part counts; p - anchor will do).

    Raises:
        ValueError: shapes differ, or a value is not finite.
    """
    p, f, s = (np.asarray(a, dtype=float) for a in (positions, forces, stretch))
    if not (p.shape == f.shape == s.shape and p.ndim == 2 and p.shape[1] == 3):
        raise ValueError(f"energy audit: shapes {p.shape}, {f.shape}, {s.shape}: three times (T, 3) needed")
    if not all(np.isfinite(a).all() for a in (p, f, s)):
        raise ValueError("energy audit: positions, forces and stretches must be finite")
    response = evaluate(field, p)
    k, n = response.friction_stiffness, response.normal
    s = s - np.sum(s * n, axis=1)[:, None] * n
    stored = response.energy + 0.5 * k * np.sum(s * s, axis=1)
    dp = np.diff(p, axis=0)
    square = np.sum(dp * dp, axis=1)
    work = -np.sum(f[:-1] * dp, axis=1)
    hold = np.diff(response.energy) - np.sum(response.gradient[:-1] * dp, axis=1) + 0.5 * k[:-1] * square
    sigma = np.zeros(len(dp))
    for share in np.linspace(0.0, 1.0, 5):
        hessian = energy_hessian(field, p[:-1] + share * dp)
        sigma = np.maximum(sigma, np.abs(np.linalg.eigvalsh(hessian)).max(axis=1))
    bound = 0.5 * (sigma + k[:-1]) * square

    def summed(step: np.ndarray) -> np.ndarray:
        return np.concatenate([[0.0], np.cumsum(step)])

    created = stored - stored[0] - summed(work) - summed(hold)
    return EnergyAudit(summed(work), stored, summed(hold), summed(bound), created, float(created.max()))
