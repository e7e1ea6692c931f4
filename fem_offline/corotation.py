# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""How an interface moves when what lies behind it is linear but turns.

Coordinates y give the linear displacement B y of the interface.  Its mean t, its mean infinitesimal rotation theta and
the rest v are linear in y; the interface then follows with a finite rotation Q(theta),

    B y = t + theta x (X - c) + v,      u(y) = t + (Q - 1)(X - c) + Q v

while the energy behind it stays y . S y / 2: rotating costs what it costs in linear elasticity and strains nothing on
the way (the corotational idea of Rankin and Brogan 1986, for a part that is held elsewhere).  A linear interface would
grow by 1/cos of the angle, and a lobe that gives way would stiffen.

Q is Cayley's rotation, Q = 1 + s (K + K^2/2), K = [theta]x, s = 4 / (4 + theta^2): rational, equal to exp K to the
second order.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["Corotation", "cayley", "corotation"]

_E = np.array([np.cross(np.eye(3)[k], np.eye(3)).T for k in range(3)])  # [e_k]x


def cayley(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Q (3, 3), dQ/dtheta_k (3, 3, 3) and d2Q/dtheta_k dtheta_l (3, 3, 3, 3), first indices k, l."""
    K = np.einsum("k,kij->ij", theta, _E)
    s = 4.0 / (4.0 + theta @ theta)
    N = K + 0.5 * K @ K
    N_k = _E + 0.5 * (_E @ K + K @ _E)
    product = np.einsum("kij,ljm->klim", _E, _E)
    N_kl = 0.5 * (product + np.swapaxes(product, 0, 1))
    s_k = -0.5 * s**2 * theta
    s_kl = -0.5 * s**2 * np.eye(3) + 0.5 * s**3 * np.outer(theta, theta)
    first = s_k[:, None, None] * N + s * N_k
    cross = np.einsum("k,lij->klij", s_k, N_k)
    second = s_kl[:, :, None, None] * N + cross + np.swapaxes(cross, 0, 1) + s * N_kl
    return np.eye(3) + s * N, first, second


@dataclass(frozen=True)
class Corotation:
    """An interface of I points moved by n coordinates.

    Attributes:
        arm: (I, 3) m; points from their middle.
        mean: (3, n), turn: (3, n) 1/m: t and theta of unit coordinates.
        rest: (I, 3, n); v of unit coordinates.
    """

    arm: np.ndarray
    mean: np.ndarray
    turn: np.ndarray
    rest: np.ndarray

    def displacement(self, y: np.ndarray) -> np.ndarray:
        """(I, 3) m at coordinates y (n,)."""
        Q, _, _ = cayley(self.turn @ y)
        return self.mean @ y + (self.arm + self.rest @ y) @ Q.T - self.arm

    def angle(self, y: np.ndarray) -> float:
        """rad; of the rotation."""
        return float(2.0 * np.arctan(0.5 * np.linalg.norm(self.turn @ y)))

    def slope(self, y: np.ndarray) -> np.ndarray:
        """(3 I, n); du/dy."""
        Q, first, _ = cayley(self.turn @ y)
        r = self.arm + self.rest @ y
        spun = np.einsum("kij,aj->aik", first, r)
        J = self.mean[None] + np.einsum("ij,ajn->ain", Q, self.rest) + spun @ self.turn
        return J.reshape(3 * len(self.arm), J.shape[-1])

    def curvature(self, y: np.ndarray, force: np.ndarray) -> np.ndarray:
        """(n, n) N/m; sum_a f_a . d2u_a/dy2 for forces f (I, 3) N."""
        _, first, second = cayley(self.turn @ y)
        r = self.arm + self.rest @ y
        mixed = np.einsum("ai,kij,ajn->kn", force, first, self.rest, optimize=True)
        twice = np.einsum("ai,klij,aj->kl", force, second, r, optimize=True)
        product = self.turn.T @ mixed
        return product + product.T + self.turn.T @ twice @ self.turn


def corotation(points: np.ndarray, trace: np.ndarray, turning: bool = True) -> Corotation:
    """Of interface points (I, 3) m with displacements trace (3 I, n) of unit coordinates; linear if not `turning`."""
    if not len(points):  # a patch that is the whole organ
        return Corotation(points, np.zeros((3, 0)), np.zeros((3, 0)), np.zeros((0, 3, 0)))
    arm = points - points.mean(axis=0)
    u = trace.reshape(len(points), 3, -1)
    mean = u.mean(axis=0)
    if not turning:
        return Corotation(arm, mean, np.zeros_like(mean), u - mean[None])
    inertia = np.eye(3) * np.sum(arm**2) - arm.T @ arm
    moment = np.cross(arm[:, :, None], u, axisa=1, axisb=1, axisc=1).sum(axis=0)
    turn = np.linalg.solve(inertia, moment)
    spin = np.cross(turn.T[None], arm[:, None], axis=2)  # (I, n, 3)
    return Corotation(arm, mean, turn, u - mean[None] - np.swapaxes(spin, 1, 2))
