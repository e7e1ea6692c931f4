# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Judges the runtime's answers by what USD holds: potential, gradient and friction stiffness are evaluated here, for
all ticks of all paths at once.

Of the runtime's answers only what it sent and the state it says it is in are used: force f, anchor (stretch s), yielded
surface o, way of touching c.  With E(q; c, o) = U at depth rho(c) - phi(q) - o, each tick has to obey

    created = dE + d(k |s|^2 / 2) + f . dq - hold <= 0,
    hold    = E(q'; c, o) - E(q; c, o) - grad E . dq + k |P dq|^2 / 2

(the zero-order hold's own terms), in the organ's axes; created is summed over a path and held against the energy that
the path exchanged, sum |f . dq|.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from rfield_evaluation import curves_at

from palpate.fields.lattice import Lattice
from palpate.fields.response_field import ResponseField

__all__ = ["Verdict", "Ways", "judged"]


class Ways(NamedTuple):
    """The ways of touching that all fields of a subject have: cosines (falling), factors of stiffness, rho m."""

    cosine: np.ndarray
    factor: np.ndarray
    offset: np.ndarray


class Verdict(NamedTuple):
    """One number for each path: J of energy created (largest sum on the way) and exchanged, N of |f + grad U + k s|,
    J by which the runtime's own accounts are off."""

    created: np.ndarray
    exchanged: np.ndarray
    force_error: np.ndarray
    balance: np.ndarray


def lattice_at(lattice: Lattice, q: np.ndarray, channels: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The first channels (n, c), their gradients (n, 3, c), and whether all 27 coefficients are stored (n,); those that
    are not count as zero, and all of them where a stencil leaves the box."""
    flat = np.ascontiguousarray(lattice.coefficients.reshape(-1, lattice.channel_count)[:, :channels])
    parts = [_lattice_at(lattice, flat, q[i : i + 1024]) for i in range(0, len(q), 1024)]
    return tuple(np.concatenate(part) for part in zip(*parts, strict=True))


def _lattice_at(lattice: Lattice, flat: np.ndarray, q: np.ndarray):
    u = (q - lattice.origin) / lattice.spacing
    cell = np.floor(u).astype(int)
    t = (u - cell).T[..., None]  # (axis, n, 1)
    w = np.concatenate([0.5 * (1 - t) ** 2, 0.5 + t * (1 - t), 0.5 * t**2], axis=2)  # (axis, n, tap)
    d = np.concatenate([t - 1, 1 - 2 * t, t], axis=2) / lattice.spacing
    j = cell.T[..., None] + np.arange(3)  # (axis, n, tap)
    shape = np.array(lattice.block_index.shape)
    within = ((j >= 0) & (j < 4 * shape[:, None, None])).all(axis=(0, 2))
    j = np.where(within[:, None], j, 0)
    b, p = j >> 2, j & 3
    block = (b[0][:, :, None, None] * shape[1] + b[1][:, None, :, None]) * shape[2] + b[2][:, None, None, :]
    row = np.where(within[:, None, None, None], lattice.block_index.ravel()[block], -1)
    place = (p[0][:, :, None, None] * 4 + p[1][:, None, :, None]) * 4 + p[2][:, None, None, :]
    at = (np.maximum(row, 0) * 64 + place).reshape(len(q), 27)
    stored = (row >= 0).reshape(len(q), 27)
    c = flat[at]
    if not stored.all():
        c *= stored[..., None]
    yz = np.stack(
        [w[1][:, :, None] * w[2][:, None], d[1][:, :, None] * w[2][:, None], w[1][:, :, None] * d[2][:, None]]
    )
    weights = np.empty((len(q), 4, 3, 9))
    for i, (first, rest) in enumerate(((w, 0), (d, 0), (w, 1), (w, 2))):
        np.multiply(first[0][:, :, None], yz[rest].reshape(len(q), 1, 9), out=weights[:, i])
    sums = weights.reshape(len(q), 4, 27) @ c
    return sums[:, 0], sums[:, 1:], stored.all(axis=1)


class _Places:
    """The lattices at the points x (paths, ticks, 3), and E of any way, yielded surface and scale there."""

    def __init__(self, truth: ResponseField, ways: Ways, x: np.ndarray) -> None:
        self.truth, self.ways, self.shape = truth, ways, x.shape[:2]
        self.ru, self.rk = truth.energy_curves.curve_count, truth.stiffness_curves.curve_count
        q = x.reshape(-1, 3)
        phi, dphi, self.known = lattice_at(truth.geometry.signed_distance, q, 1)
        self.phi, self.dphi = phi[:, 0], dphi[..., 0]
        self.a, self.da, _ = lattice_at(truth.amplitudes, q, self.ru + self.rk)

    def normal(self) -> np.ndarray:
        length = np.linalg.norm(self.dphi, axis=1, keepdims=True)
        return (self.dphi / np.where(length > 0, length, 1.0)).reshape(*self.shape, 3)

    def _felt(self, c, o, scale, rows):
        """Depth (n,) and what U is multiplied with there (n,): 0 where nothing is felt: above the tissue, and
        where no distance is stored."""
        w = self.ways
        factor = scale * np.interp(c, w.cosine[::-1], w.factor[::-1])
        depth = np.interp(c, w.cosine[::-1], w.offset[::-1]) - o - self.phi[rows]
        return np.maximum(depth, 0.0), np.where((depth > 0) & self.known[rows], factor, 0.0)

    def energy(self, c, o, scale, rows=slice(None)) -> np.ndarray:
        """J (n,), at flat `rows`, for c, o and scale (n,)."""
        depth, by = self._felt(c, o, scale, rows)
        return by * np.einsum(
            "nr,nr->n", curves_at(self.truth.energy_curves, depth)[0], self.a[rows, : self.ru]
        )

    def response(self, c, o, scale) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """E (paths, ticks) J, its gradient (paths, ticks, 3) N and k (paths, ticks) N/m."""
        depth, by = self._felt(c.ravel(), o.ravel(), scale.ravel(), slice(None))
        value, slope = curves_at(self.truth.energy_curves, depth)
        stiffness, _ = curves_at(self.truth.stiffness_curves, depth)
        a = self.a[:, : self.ru]
        gradient = np.einsum("nr,nir->ni", value, self.da[..., : self.ru])
        gradient -= np.einsum("nr,nr->n", slope, a)[:, None] * self.dphi
        k = np.maximum(by * np.einsum("nr,nr->n", stiffness, self.a[:, self.ru :]), 0.0)
        energy = by * np.einsum("nr,nr->n", value, a)
        return (
            energy.reshape(self.shape),
            (by[:, None] * gradient).reshape(*self.shape, 3),
            k.reshape(self.shape),
        )


def judged(truth: ResponseField, ways: Ways, x, force, s, r, scale) -> Verdict:
    """The law of the module's docstring.

    Args:
        x, force, s: (paths, ticks, 3) m, N, m in the organ's axes: places, forces sent, the friction spring's stretch.
        r: (paths, ticks) the runtime's responses: way_cosine, surface_offset and the accounts are read.
        scale: (paths, ticks) how many times as stiff as `truth` the field in use is.
    """
    at = _Places(truth, ways, x)
    c, o = r["way_cosine"], r["surface_offset"]
    energy, gradient, k = at.response(c, o, scale)
    # E at the new place with what was in use before: the same number unless the way, the offset or the field changed.
    moved = energy.copy()
    before = [np.concatenate([v[:, :1], v[:, :-1]], axis=1) for v in (c, o, scale)]
    changed = np.flatnonzero(
        np.logical_or.reduce([v != b for v, b in zip((c, o, scale), before, strict=True)])
    )
    moved.ravel()[changed] = at.energy(*(b.ravel()[changed] for b in before), changed)
    dq, normal = np.diff(x, axis=1), at.normal()[:, :-1]
    out = np.einsum("pti,pti->pt", dq, normal)
    across_squared = np.einsum("pti,pti->pt", dq, dq) - out * out
    stored = energy + 0.5 * k * np.einsum("pti,pti->pt", s, s)
    hold = moved[:, 1:] - energy[:, :-1] - np.einsum("pti,pti->pt", gradient[:, :-1], dq)
    hold += 0.5 * k[:, :-1] * across_squared
    work = -np.einsum("pti,pti->pt", force[:, :-1], dq)
    created = np.cumsum(np.diff(stored, axis=1) - work - hold, axis=1).max(axis=1, initial=0.0)
    exchanged = np.abs(work).sum(axis=1) + stored.max(axis=1)
    balance = r["work_in"] + r["organ_work"] + r["hold_leak"] - r["stored_energy"] - r["dissipated_friction"]
    balance = np.abs(balance - r["dissipated_rule"]).max(axis=1)
    force_error = np.abs(force + gradient + k[..., None] * s).max(axis=(1, 2))
    return Verdict(created, exchanged, force_error, balance)
