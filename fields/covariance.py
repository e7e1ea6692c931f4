# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Covariance of values and gradients of a random field over embedded points: Matern-5/2, rougher where it is rough.

With r = |z - z'|, a = sqrt(5) / l, delta = z - z', covariance and derivatives are (Rasmussen and Williams, Gaussian
Processes for Machine Learning, 2006, eq. 4.17 and sec. 9.4)

    k = (1 + a r + a^2 r^2 / 3) e^(-a r)
    cov(F(z), v.grad F(z'))   =  (a^2 / 3) (1 + a r) e^(-a r) (delta . v)
    cov(u.grad F, v.grad F')  =  (a^2 / 3) e^(-a r) ((1 + a r) u.v - a^2 (delta . u)(delta . v))

The field is F = G + s rho S, with G of length l and S of the shorter length l_s, both of unit variance, and a known
function rho(z) >= 0 (roughness.py) that is zero where one length does for the field.  Values and gradients of rho S
follow from those of S by the product rule, a linear map at each point, so the sum is a covariance whatever rho is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import cdist

__all__ = ["KrigingSettings", "Pairs", "Sites", "covariance"]


@dataclass(frozen=True)
class KrigingSettings:
    """Covariance parameters.

    Attributes:
        length: l, m.
        value_noise: variance of value noise / variance of G.
        gradient_noise: variance of gradient noise / variance of G's directional derivatives a^2 / 3.
        short_length: l_s, m.
        short_variance: s^2, of S where rho is one, l_s^4 / 1 m^4 taken out (roughness.py); 0: no rough part.
    """

    length: float
    value_noise: float
    gradient_noise: float
    short_length: float = 0.0
    short_variance: float = 0.0

    @property
    def gradient_variance(self) -> float:
        """Variance of G's directional derivatives along unit directions, 1/m^2."""
        return 5.0 / (3.0 * self.length**2)


@dataclass(frozen=True)
class Sites:
    """Embedded points where values are known or asked for, and directions in which derivatives are.

    Attributes:
        z: (N, D) m.
        directions: (N, T, D), T = 0 for values alone.
        rough: (N,) 1/m^2, rho; None where the field has no rough part.
        rough_slope: (N, T) 1/m^3, its derivatives.
    """

    z: np.ndarray
    directions: np.ndarray
    rough: np.ndarray | None = None
    rough_slope: np.ndarray | None = None

    @property
    def block(self) -> int:
        """Data at each point (count)."""
        return 1 + self.directions.shape[1]

    def values(self) -> Sites:
        """The same points without derivatives."""
        slope = None if self.rough_slope is None else self.rough_slope[:, :0]
        return Sites(self.z, self.directions[:, :0], self.rough, slope)

    def __getitem__(self, part: slice | np.ndarray | list[int]) -> Sites:
        rough = (None, None) if self.rough is None else (self.rough[part], self.rough_slope[part])
        return Sites(self.z[part], self.directions[part], *rough)


@dataclass(frozen=True)
class Pairs:
    """What covariance needs to know of each pair of points, once for all settings."""

    left_sites: Sites
    right_sites: Sites
    r: np.ndarray  # (N, M)
    left: np.ndarray  # (N, T, M), delta . u_i
    right: np.ndarray  # (N, M, T'), delta . v_j
    dot: np.ndarray  # (N, T, M, T'), u_i . v_j
    bent: np.ndarray  # (N, T, M, T'), (delta . u_i)(delta . v_j)

    @staticmethod
    def of(a: Sites, b: Sites) -> Pairs:
        size = a.z.shape[1]
        u, v = a.directions.reshape(-1, size), b.directions.reshape(-1, size)
        own_u = np.einsum("itd,id->it", a.directions, a.z)
        own_v = np.einsum("jtd,jd->jt", b.directions, b.z)
        left = own_u[:, :, None] - (u @ b.z.T).reshape(len(a.z), a.block - 1, len(b.z))
        right = (a.z @ v.T).reshape(len(a.z), len(b.z), b.block - 1) - own_v[None]
        dot = (u @ v.T).reshape(len(a.z), a.block - 1, len(b.z), b.block - 1)
        return Pairs(a, b, cdist(a.z, b.z), left, right, dot, left[:, :, :, None] * right[:, None])


def matern(r: np.ndarray, length: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """k(r), (a^2/3) (1 + a r) e^(-a r), and (a^4/3) e^(-a r)."""
    a = np.sqrt(5.0) / length
    ar = a * r
    decay = np.exp(-ar)
    return (1 + ar + ar * ar / 3) * decay, a * a / 3 * (1 + ar) * decay, a**4 / 3 * decay


def covariance(pairs: Pairs, settings: KrigingSettings) -> np.ndarray:
    """(N (1 + T), M (1 + T')) covariance of the data at both sites, point by point, without noise."""
    K = _smooth(pairs, settings.length)
    a, b = pairs.left_sites, pairs.right_sites
    if settings.short_variance > 0 and a.rough is not None and b.rough is not None:
        part = _smooth(pairs, settings.short_length)
        scale = settings.short_variance * settings.short_length**4
        rows = a.rough[:, None, None, None] * part
        rows[:, 1:] += a.rough_slope[:, :, None, None] * part[:, :1]
        K += scale * rows * b.rough[None, None, :, None]
        K[..., 1:] += scale * rows[..., :1] * b.rough_slope[None, None]
    return K.reshape(K.shape[0] * K.shape[1], -1)


def _smooth(pairs: Pairs, length: float) -> np.ndarray:
    """(N, 1 + T, M, 1 + T') of a field with one length."""
    k, slope, bend = matern(pairs.r, length)
    K = np.empty((len(k), pairs.left_sites.block, k.shape[1], pairs.right_sites.block))
    K[:, 0, :, 0] = k
    K[:, 0, :, 1:] = slope[:, :, None] * pairs.right
    K[:, 1:, :, 0] = -slope[:, None, :] * pairs.left
    K[:, 1:, :, 1:] = slope[:, None, :, None] * pairs.dot - bend[:, None, :, None] * pairs.bent
    return K
