# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Energy books of a trace, kept without the runtime: U, grad U, k, mu and n come from the field in NumPy.

Of the runtime only what it sent (force), where its friction spring holds (anchor) and whether it felt the tissue at all
are used.  With s = q - anchor and E = U + 1/2 k |s|^2 (0 where nothing is felt), for every tick

    created = dE - W - hold <= 0,   W = -f . dq,   hold = dU - grad U . dq + 1/2 k |dq_t|^2 <= 1/2 sigma |dq|^2

summed over the trace, sigma the field's largest stiffness (up to depth_max); |k s| <= mu f_n; f = -grad U - k s.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.author.extremes.case import Refused, Wrong, not_above
from palpate.fields.interpolation import evaluate
from palpate.fields.response_field import ResponseField
from palpate.runtime import Region, Tick

__all__ = ["Books", "books", "judged"]

ROUNDING = 1e-9
"""Of the energy exchanged."""
FELT = np.uint32(~np.uint32(Tick.FELT))


@dataclass(frozen=True)
class Books:
    """Of one trace.

    Attributes:
        exchanged: J, sum of |W|.
        created: J, largest sum on the way.
        hold_excess: J, largest hold - 1/2 sigma |dq|^2 of a tick within depth_max.
        force_error: N, largest |f + grad U + k s|; cone_excess: N, largest |k s| - mu f_n; force_max: N.
        balance: J by which the runtime's own accounts are off.
        felt: share of ticks that felt tissue.  released: status bits other than those, or-ed.
        force_step: N, largest change of force between ticks that both feel it.
    """

    exchanged: float
    created: float
    hold_excess: float
    force_error: float
    cone_excess: float
    force_max: float
    balance: float
    felt: float
    released: int
    force_step: float


def books(
    field: ResponseField, q: np.ndarray, r: np.ndarray, sigma: float, friction: float | None = None
) -> Books:
    """Books of the runtime's responses r (n,) at reference points q (n, 3) m.

    Args:
        sigma: N/m.  friction: coefficient in place of the field's.
    """
    e = evaluate(field, q)
    felt = ((r["status"] & FELT) == 0) & (r["region"] == Region.CONTACT)
    U, k = np.where(felt, e.energy, 0.0), np.where(felt, e.friction_stiffness, 0.0)
    gradient = np.where(felt[:, None], e.gradient, 0.0)
    s = np.where(felt[:, None], q - r["anchor"], 0.0)
    n, f = e.normal, r["force"]
    stored = U + 0.5 * k * np.sum(s * s, axis=1)
    dq = np.diff(q, axis=0)
    across = dq - np.sum(dq * n[:-1], axis=1, keepdims=True) * n[:-1]
    work = -np.sum(f[:-1] * dq, axis=1)
    hold = np.diff(U) - np.sum(gradient[:-1] * dq, axis=1) + 0.5 * k[:-1] * np.sum(across * across, axis=1)
    created = np.cumsum(np.diff(stored) - work - hold)
    shallow = felt & (e.depth <= field.depth_max)
    both = shallow[1:] & shallow[:-1]
    excess = np.where(both, hold - 0.5 * sigma * np.sum(dq * dq, axis=1), 0.0)
    mu = e.friction_coefficient if friction is None else friction
    cone = np.where(felt, k * np.linalg.norm(s, axis=1) - mu * np.maximum(e.normal_force, 0.0), 0.0)
    last = r[-1]
    accounts = last["work_in"] + last["organ_work"] + last["hold_leak"] - last["stored_energy"]
    accounts -= last["dissipated_friction"] + last["dissipated_rule"]
    step = np.linalg.norm(np.diff(f, axis=0), axis=1) * (felt[1:] & felt[:-1])
    return Books(
        float(np.abs(work).sum()),
        float(created.max(initial=0.0)),
        float(excess.max(initial=0.0)),
        float(np.abs(f + gradient + k[:, None] * s).max()),
        float(cone.max(initial=0.0)),
        float(np.abs(f).max()),
        float(abs(accounts)),
        float(felt.mean()),
        int(np.bitwise_or.reduce(r["status"] & FELT)),
        float(step.max(initial=0.0)),
    )


def judged(found: Books, ticks: int) -> str:
    """The verdict on a trace.

    Raises:
        Wrong: energy was created, a force is not the field's, or friction left its cone.
        Refused: nothing at all was felt, and the runtime says why.
    """
    scale = found.exchanged + 1e-12
    if not np.isfinite(list(vars(found).values())).all():
        raise Wrong("a number is not finite")
    said = not_above("energy created, of what was exchanged,", found.created / scale, ROUNDING)
    not_above(
        "force off the field's own, of the largest,", found.force_error / (found.force_max + 1e-9), 1e-6
    )
    not_above(
        "friction outside its cone, of the largest force,", found.cone_excess / (found.force_max + 1e-9), 1e-6
    )
    not_above("held force's energy above 1/2 sigma |dq|^2 (J)", found.hold_excess, ROUNDING * scale)
    not_above("the runtime's own accounts off, of what was exchanged,", found.balance / scale, ROUNDING)
    if found.felt == 0.0:
        raise Refused(f"nothing was felt: {_text(found.released)}")
    status = f"; at times nothing was felt: {_text(found.released)}" if found.released else ""
    return f"{said}, {ticks} ticks, {100 * found.felt:.0f} % in contact{status}"


def _text(status: int) -> str:
    names = [
        bit.name.lower().replace("_", " ")
        for bit in Tick
        if bit.name and status & bit and bit.value & (bit.value - 1) == 0
    ]
    return ", ".join(names) or "the tool was never in the tissue"
