# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Work and stored energy of a trace, recomputed from the ResponseField in NumPy.

Of the runtime only forces (what the hand felt) and anchors (where its friction spring holds) are used; U, grad U, k and
the normal come from `rfield_evaluation`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from rfield_evaluation import evaluate

from palpate.fields.response_field import ResponseField


class Books(NamedTuple):
    """Per path; J, N."""

    created: np.ndarray  # (paths, ticks) E - E_0 - W - leak: > 0 would be energy from nowhere
    net_work: np.ndarray  # (paths,) by the hand over the whole path
    leak: np.ndarray  # (paths,) of the zero-order hold
    leak_bound: np.ndarray  # (paths,) sum of 1/2 sigma |dq|^2 over ticks that touch
    force_error: float  # largest |f + grad U + k s|
    cone_excess: float  # largest |k s| - mu f_n
    force_step: np.ndarray  # (paths,) largest change of force in a tick


def books(
    truth: ResponseField, q: np.ndarray, response: np.ndarray, sigma: float, friction: float | None = None
) -> Books:
    """Balance of traces `q` (paths, ticks, 3) m with the runtime's `response` (paths, ticks)."""
    paths, ticks = q.shape[:2]
    e = evaluate(truth, q.reshape(-1, 3))
    touching = (e.depth > 0).reshape(paths, ticks)
    U = np.where(touching, e.energy.reshape(paths, ticks), 0)
    grad = e.gradient.reshape(paths, ticks, 3) * touching[..., None]
    k = e.friction_stiffness.reshape(paths, ticks) * touching
    n = e.normal.reshape(paths, ticks, 3)
    s = q - response["anchor"]
    f = response["force"]
    step = np.diff(q, axis=1)
    across = step - np.sum(step * n[:, :-1], axis=2, keepdims=True) * n[:, :-1]
    stored = U + 0.5 * k * np.sum(s * s, axis=2)
    work = -np.sum(f[:, :-1] * step, axis=2)
    leak = np.diff(U, axis=1) - np.sum(grad[:, :-1] * step, axis=2)
    leak += 0.5 * k[:, :-1] * np.sum(across * across, axis=2)
    created = np.diff(stored, axis=1, prepend=stored[:, :1])
    created[:, 1:] -= work + leak
    created = np.cumsum(created, axis=1)
    normal_force = np.maximum(-np.sum(grad * n, axis=2), 0)
    mu = e.friction_coefficient.reshape(paths, ticks) if friction is None else friction
    cone = np.where(touching, k * np.linalg.norm(s, axis=2) - mu * normal_force, 0)
    active = touching[:, 1:] | touching[:, :-1]
    bound = 0.5 * sigma * np.sum(step * step, axis=2) * active
    return Books(
        created,
        work.sum(axis=1),
        leak.sum(axis=1),
        bound.sum(axis=1),
        float(np.abs(f + grad + k[..., None] * s).max()),
        float(cone.max()),
        np.linalg.norm(np.diff(f, axis=1), axis=2).max(axis=1),
    )
