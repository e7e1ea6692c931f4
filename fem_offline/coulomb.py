# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Contact with Coulomb friction, at the faces' quadrature points, step by step along the tool's path.

Normal part as in contact.py.  With X the point's place in the tool's frame (x = p + Q X), X_0 and tau_0 its place and
friction traction after the last step, T = 1 - n n^T and mu t the friction that can be reached,

    z = T (X - X_0 - tau_0 / eps_t),   tau = -eps_t z               where eps_t |z| <= mu t  (sticks)
                                       tau = -mu t z / |z|          elsewhere                (slides)

the return map of elastoplasticity (Wriggers, Computational Contact Mechanics, 2006, section 10.5; Simo and Laursen,
Comput. Struct. 42:97-116, 1992).  With t and n *lagged* this is the slope of a convex energy, Huber's function of z,

    h(z) = eps_t |z|^2 / 2   up to |z| = mu t / eps_t,   mu t |z| - (mu t)^2 / (2 eps_t)   beyond

so that an equilibrium is found as without friction; sliding.py brings the lagged values to the found ones.

A point that was open at the last step slides only from where it touched: with gap g_0 and normal n_0 there, and gap
g <= 0 now, it moved a share s = (g_0 - g) / -n_0.(X - X_0) of its way before, and its anchor is X_0 + s (X - X_0).
(An anchor at X_0 gives friction to the approach: along a tool pressed straight in, in the wrong direction.)

Dissipation of a step: sum_q w_q (mu t_0 + mu t)/2 gamma, gamma = max(0, |z| - mu t / eps_t), never negative.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from palpate.fem_offline.contact import ContactHessian, ContactState, Unilateral

__all__ = ["Coulomb", "FrictionCheck"]


@dataclass(frozen=True)
class FrictionCheck:
    """Coulomb's law at every quadrature point of one state, from its tractions and the way since the last step.

    Attributes:
        tension: largest pull, Pa.
        excess: largest |tau| - mu t over the largest mu t.
        turned: largest sine between sliding and -tau, weighted by |tau| over the largest mu t.
        sliding: share of the pressed area that slides.
        dissipation: J in the step.
    """

    tension: float
    excess: float
    turned: float
    sliding: float
    dissipation: float

    def failure(self, tolerance: float = 1e-6) -> str:
        """What is violated, "" where nothing is."""
        if self.tension > 0.0:
            return f"the contact pulls with {self.tension:.1e} Pa"
        if self.excess > tolerance:
            return f"friction exceeds the coefficient times the pressure by {self.excess:.1e}"
        if self.turned > tolerance:
            return f"friction does not oppose sliding; off by {self.turned:.1e}"
        return ""


@dataclass
class Coulomb(Unilateral):
    """Unilateral contact with friction.

    Attributes:
        friction: mu.
        tangential_penalty: eps_t, Pa/m.
        place: X_0, (B, Q, 3) m; base: tau_0, (B, Q, 3) Pa, both in the tool's frame, after the last step.
        reached: mu t_0, (B, Q) Pa; zero where open.
        opening: g_0, (B, Q) m; facing: n_0, (B, Q, 3), in the tool's frame; used where open.
    """

    friction: float = 0.0
    tangential_penalty: float = 0.0
    place: np.ndarray = field(init=False)
    base: np.ndarray = field(init=False)
    reached: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        b, q = self.surface.point_shape
        self.base, self.reached = np.zeros((b, q, 3)), np.zeros((b, q))
        self.start(np.zeros((int(self.surface.faces.max()) + 1, 3)))

    def start(self, u: np.ndarray) -> None:
        """Begin at u (N, 3) m without a past: nothing touches yet."""
        x, gap, normal, _ = self._distance(u)
        self.place = self.pose.into_tool(x)
        self.base, self.reached = np.zeros_like(x), np.zeros_like(gap)
        self.opening, self.facing = np.maximum(gap, 0.0), normal @ self.pose.rotation
        self.lag(u)
        self.anchor(u)

    def commit(self, u: np.ndarray) -> None:
        """Make the state at u (N, 3) m the end of a step."""
        self.lag(u)
        x, gap, normal, _ = self._distance(u)
        Q = self.pose.rotation
        base = self._friction(x)[1] @ Q
        self.place, self.base, self.reached = self.pose.into_tool(x), base, self.limit
        self.opening, self.facing = np.maximum(gap, 0.0), normal @ Q
        self.anchor(u)

    def anchor(self, u: np.ndarray) -> None:
        """Find where points that were open began to touch, on their way to u (N, 3) m."""
        x, gap, _, _ = self._distance(u)
        way = self.pose.into_tool(x) - self.place
        closing = -np.einsum("bqi,bqi->bq", self.facing, way)
        closed = self.opening - np.minimum(gap, 0.0)
        share = np.where(closing > closed, closed / np.maximum(closing, 1e-300), 1.0)
        self._anchor = np.where(
            (self.reached > 0.0)[:, :, None], self.place, self.place + share[:, :, None] * way
        )

    def expect(self) -> None:
        """Take the multiplier for the pressure: a first guess, before anything is solved at a new position."""
        self.limit = self.friction * self.multiplier

    def lag(self, u: np.ndarray) -> float:
        """Take pressure and normals from u (N, 3) m; returns the change of mu t over its 2-norm."""
        _, gap, normal, _ = self._distance(u)
        before = getattr(self, "limit", np.zeros_like(gap))
        self.limit = self.friction * np.maximum(0.0, self.multiplier - self.penalty * gap)
        self.normal = normal
        return float(np.linalg.norm(self.limit - before) / max(np.linalg.norm(self.limit), 1e-300))

    def _way(self, x: np.ndarray) -> np.ndarray:
        """X - X_0 (B, Q, 3) m, in the organ's frame."""
        return (self.pose.into_tool(x) - self._anchor) @ self.pose.rotation.T

    def _friction(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """z and tau (B, Q, 3), |z| (B, Q) at deformed points x."""
        q = self._way(x) - self.base @ self.pose.rotation.T / self.tangential_penalty
        z = q - np.einsum("bqi,bqi->bq", q, self.normal)[:, :, None] * self.normal
        length = np.linalg.norm(z, axis=2)
        tau = -np.minimum(self.tangential_penalty, self.limit / np.maximum(length, 1e-300))[:, :, None] * z
        return z, tau, length

    def state(self, u: np.ndarray) -> ContactState:
        """With the lagged pressure; the true state right after `lag(u)`."""
        pressed = super().state(u)
        x = self.surface.points(u)
        _, tau, length = self._friction(x)
        eps, limit, w = self.tangential_penalty, self.limit, self.surface.weight
        huber = np.where(eps * length <= limit, 0.5 * eps * length**2, limit * length - 0.5 * limit**2 / eps)
        load = w[:, :, None] * tau
        return replace(
            pressed,
            energy=pressed.energy + float(np.sum(w * huber)),
            gradient=pressed.gradient - self.surface.nodal(tau, len(u)),
            force=pressed.force - load.sum(axis=(0, 1)),
            moment=pressed.moment - np.cross(x - self.pose.position, load).sum(axis=(0, 1)),
            traction=pressed.traction + tau,
        )

    def _tangent(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Where z slides (B, Q), its direction (B, Q, 3), stiffness c = |tau| / |z| (B, Q), c d(z)/dx (B, Q, 3, 3)."""
        z, _, length = self._friction(x)
        direction = z / np.maximum(length, 1e-300)[:, :, None]
        slides = self.tangential_penalty * length > self.limit
        c = np.where(slides, self.limit / np.maximum(length, 1e-300), self.tangential_penalty)
        n = self.normal
        T = np.eye(3) - n[:, :, :, None] * n[:, :, None, :]
        T = T - np.where(slides[:, :, None, None], direction[:, :, :, None] * direction[:, :, None, :], 0.0)
        return slides, direction, c, c[:, :, None, None] * T

    def hessian(self, u: np.ndarray, geometric: bool) -> ContactHessian:
        """Of the energy with the lagged pressure."""
        _, gap, normal, curvature = self._distance(u)
        pressure = np.maximum(0.0, self.multiplier - self.penalty * gap)
        block = self._normal_block(pressure, normal, curvature, geometric)
        return self.surface.hessian(block + self._touching(self._tangent(self.surface.points(u))[3]))

    def _touching(self, block: np.ndarray) -> np.ndarray:
        return np.where((self.limit > 0.0)[:, :, None, None], block, 0.0)

    def unsymmetric(self, u: np.ndarray) -> np.ndarray:
        """(B, Q, 3, 3) Pa/m; what -d(traction)/dx of the true law has beyond the blocks of `hessian(u, False)`.

        After `lag(u)`.  With kappa = Hess g, q = X - X_0 - tau_0 / eps_t:  dz = (T - (n.q) kappa - n (kappa q)^T) dx,
        and where it slides d(mu t)/dx = -mu eps n.
        """
        x, gap, n, kappa = self._distance(u)
        pressure = np.maximum(0.0, self.multiplier - self.penalty * gap)
        slides, e, c, _ = self._tangent(x)
        q = self._way(x) - self.base @ self.pose.rotation.T / self.tangential_penalty
        depth = np.einsum("bqi,bqi->bq", n, q)[:, :, None, None]
        bend = -depth * kappa - n[:, :, :, None] * np.einsum("bqij,bqj->bqi", kappa, q)[:, :, None, :]
        along = e[:, :, :, None] * np.einsum("bqi,bqij->bqj", e, bend)[:, :, None, :]
        bend = c[:, :, None, None] * (bend - np.where(slides[:, :, None, None], along, 0.0))
        rise = -self.friction * self.penalty * e[:, :, :, None] * n[:, :, None, :]
        block = bend + np.where(slides[:, :, None, None], rise, 0.0)
        return self._touching(block) - pressure[:, :, None, None] * kappa

    def check(self, u: np.ndarray, state: ContactState) -> FrictionCheck:
        """Hold a state at u against Coulomb's law anew: gaps and normals of u, the state's own tractions."""
        x, _, n, _ = self._distance(u)
        pressure = np.einsum("bqi,bqi->bq", state.traction, n)
        tau = state.traction - pressure[:, :, None] * n
        limit = self.friction * np.maximum(pressure, 0.0)
        largest = max(float(limit.max()), 1e-300)
        way = self._way(x) + (tau - self.base @ self.pose.rotation.T) / self.tangential_penalty
        slip = way - np.einsum("bqi,bqi->bq", way, n)[:, :, None] * n
        gamma = np.linalg.norm(slip, axis=2)
        size = np.linalg.norm(tau, axis=2)
        # a slip below rounding of the elastic give has no direction
        slides = (gamma > 1e-6 * largest / self.tangential_penalty) & (limit > 0.0)
        against = np.einsum("bqi,bqi->bq", slip, tau) / np.maximum(gamma, 1e-300)
        w = self.surface.weight
        return FrictionCheck(
            float(max(0.0, -pressure.min())),
            float((size - limit).max() / largest),
            # power lost against -mu t |slip|: zero where tau is opposed and full
            float(np.where(slides, limit + against, 0.0).max() / largest),
            float(w[slides].sum() / max(w[limit > 0.0].sum(), 1e-300)),
            float(np.sum(w * np.where(slides, 0.5 * (self.reached + limit) * gamma, 0.0))),
        )
