# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Gradient-enhanced kriging with a Matern-5/2 covariance, many data columns sharing one operator.

With r = |z - z'|, a = sqrt(5) / l, delta = z - z', covariance and derivatives are (Rasmussen and Williams, Gaussian
Processes for Machine Learning, 2006, eq. 4.17 and sec. 9.4)

    k = (1 + a r + a^2 r^2 / 3) e^(-a r)
    cov(F(z), v.grad F(z'))   =  (a^2 / 3) (1 + a r) e^(-a r) (delta . v)
    cov(u.grad F, v.grad F')  =  (a^2 / 3) e^(-a r) ((1 + a r) u.v - a^2 (delta . u)(delta . v))

A surface point is embedded as z = (c, L n), so that the two sides of a thin lobe are 2 L apart; moving along the
surface by e moves z by v = (e, L W e) with the shape operator W.  Noise is a share of the variance on values and,
separately, of the gradient's variance on gradients; both and l maximise the likelihood, in which every column
has its own mean and variance.  One operator for all columns keeps what is smooth in depth smooth in depth.
Leaving a node out, value and gradient together, costs no refit (Dubrule, Math. Geology 15, 1983).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import minimize
from scipy.spatial.distance import cdist

__all__ = ["Kriging", "KrigingSettings", "embed", "fit_kriging"]

CHUNK = 4096
"""Prediction points handled at once (count); bounds memory."""


NOISE_BOUNDS = ((1e-6, 1.0), (1e-4, 10.0))
"""Least and largest noise shares, of values and of gradients.  A dozen presses cannot tell small noise from none;
below these floors, likelihood would trust FEM gradients more than any FEM gradient deserves."""


@dataclass(frozen=True)
class KrigingSettings:
    """Covariance parameters.

    Attributes:
        length: l, m.
        value_noise: variance of value noise / variance of the field.
        gradient_noise: variance of gradient noise / variance of the field's directional derivatives a^2 / 3.
    """

    length: float
    value_noise: float
    gradient_noise: float


def embed(position: np.ndarray, normal: np.ndarray, normal_length: float) -> np.ndarray:
    """z (n, 6) m of surface points: `position` (n, 3) m and `normal_length` L times the unit `normal` (n, 3)."""
    return np.concatenate([position, normal_length * normal], axis=1)


@dataclass(frozen=True)
class Kriging:
    """A fitted interpolator of C columns over N points.

    Attributes:
        z: (N, D) m, embedded points.
        directions: (N, T, D) embedded directions of the gradient data, T = 0 without.
        settings: covariance parameters.
        mean: (C,) trend.
        weights: (N (1 + T), C) operator's weights of the data.
        left_out: (N, C) data minus prediction with each point left out entirely.
        log_likelihood: of the columns that were used to find the settings.
    """

    z: np.ndarray
    directions: np.ndarray
    settings: KrigingSettings
    mean: np.ndarray
    weights: np.ndarray
    left_out: np.ndarray
    log_likelihood: float

    def predict(self, z: np.ndarray) -> np.ndarray:
        """(n, C) values at embedded points `z` (n, D)."""
        out = np.empty((len(z), len(self.mean)))
        for start in range(0, len(z), CHUNK):
            part = slice(start, start + CHUNK)
            out[part] = (
                cross_covariance(z[part], self.z, self.directions, self.settings.length) @ self.weights
            )
        return out + self.mean


def fit_kriging(
    z: np.ndarray,
    values: np.ndarray,
    directions: np.ndarray | None = None,
    gradients: np.ndarray | None = None,
    *,
    scored: np.ndarray | None = None,
    settings: KrigingSettings | None = None,
) -> Kriging:
    """Fit.

    Args:
        z: (N, D) m, distinct embedded points.
        values: (N, C).
        directions: (N, T, D) directions in which derivatives are given.
        gradients: (N, T, C) those derivatives, unit of the value per m.
        scored: columns whose likelihood chooses the settings; all when None.
        settings: use these instead of searching.

    Raises:
        ValueError: data are not finite or two points coincide.
    """
    z, values = np.asarray(z, dtype=float), np.asarray(values, dtype=float)
    count, columns = values.shape
    if directions is None or gradients is None:
        directions, gradients = np.zeros((count, 0, z.shape[1])), np.zeros((count, 0, columns))
    y = np.concatenate([values[:, None], gradients], axis=1).reshape(-1, columns)  # point by point
    if not (np.isfinite(y).all() and np.isfinite(z).all()):
        raise ValueError("kriging: data must be finite")
    pairs = Pairs.of(z, directions)
    apart = pairs.r[~np.eye(count, dtype=bool)]
    if count > 1 and apart.min() < 1e-9:
        raise ValueError("kriging: two points coincide")
    scored_y = y if scored is None else y[:, scored]
    if settings is None:
        settings = likeliest_settings(pairs, scored_y)
    solved = Solved.from_data(pairs, y, settings)
    return Kriging(
        z,
        directions,
        settings,
        solved.mean,
        solved.weights,
        solved.left_out(directions.shape[1] + 1),
        Solved.from_data(pairs, scored_y, settings).log_likelihood,
    )


def likeliest_settings(pairs: Pairs, y: np.ndarray) -> KrigingSettings:
    """Maximum likelihood within bounds: a coarse grid, then a local search from its best point."""
    count, tangents = pairs.left.shape[:2]
    span = pairs.r.max(initial=0.0)
    if count < 4 or np.ptp(y[:: tangents + 1], axis=0).max() == 0:
        return KrigingSettings(float(span) or 0.05, 1e-4, 1e-2)
    with_gradient = tangents > 0
    closest = np.median(np.min(pairs.r + np.diag(np.full(count, np.inf)), axis=1))
    bounds = [(np.log(0.5 * closest), np.log(4 * span)), *np.log(NOISE_BOUNDS)]
    if not with_gradient:
        bounds.pop()

    def settings_of(x: np.ndarray) -> KrigingSettings:
        return KrigingSettings(*np.exp(x[:2]).tolist(), float(np.exp(x[2])) if with_gradient else 1.0)

    def cost(x: np.ndarray) -> float:
        x = np.clip(x, [b[0] for b in bounds], [b[1] for b in bounds])
        try:
            return -Solved.from_data(pairs, y, settings_of(x)).log_likelihood
        except np.linalg.LinAlgError:
            return 1e30

    starts = [
        np.array([np.log(length), np.log(noise), np.log(100 * noise)][: len(bounds)])
        for length in np.geomspace(closest, 2 * span, 5)
        for noise in (1e-5, 1e-3, 1e-2)
    ]
    best = min(starts, key=cost)
    found = minimize(
        cost, best, method="Nelder-Mead", bounds=bounds, options={"xatol": 0.02, "fatol": 1e-3, "maxfev": 150}
    )
    return settings_of(found.x)


@dataclass(frozen=True)
class Solved:
    """The covariance's factor applied to data.

    K w = y - F m with the generalised-least-squares mean m; Q = K^-1 - K^-1 F (F^T K^-1 F)^-1 F^T K^-1.
    """

    mean: np.ndarray
    weights: np.ndarray
    log_likelihood: float
    factor: tuple[np.ndarray, bool]
    trend: np.ndarray  # K^-1 F / sqrt(F^T K^-1 F)

    @staticmethod
    def from_data(pairs: Pairs, y: np.ndarray, settings: KrigingSettings) -> Solved:
        K = covariance(pairs, settings)
        # Jitter far below any noise in FEM data; keeps the factor exact to 1e-6 or so.
        factor = cho_factor(K + 1e-10 * np.diag(np.diag(K)), lower=True)
        F = np.zeros(len(K))
        F[:: pairs.left.shape[1] + 1] = 1.0
        KF = cho_solve(factor, F)
        Ky = cho_solve(factor, y)
        information = F @ KF
        mean = F @ Ky / information
        weights = Ky - np.outer(KF, mean)
        n = len(K)
        variance = np.maximum(np.sum(y * weights, axis=0) / (n - 1), 1e-300)
        log_det = 2 * np.sum(np.log(np.diag(factor[0])))
        # Restricted likelihood with variance profiled out, averaged over columns (they are correlated).
        log_likelihood = -0.5 * (np.mean((n - 1) * np.log(variance)) + log_det + np.log(information))
        return Solved(mean, weights, float(log_likelihood), factor, KF / np.sqrt(information))

    def left_out(self, block: int) -> np.ndarray:
        """(N, C): value minus its prediction from the other points, e_I = Q_II^-1 (Q y)_I, and Q y = weights."""
        count = len(self.weights) // block
        if count < 2:
            return np.zeros((count, self.weights.shape[1]))
        w = self.weights.reshape(count, block, -1)
        Q = cho_solve(self.factor, np.eye(len(self.weights))) - np.outer(self.trend, self.trend)
        Q = Q.reshape(count, block, count, block)[np.arange(count), :, np.arange(count)]
        return np.linalg.solve(Q, w)[:, 0]


def matern(r: np.ndarray, length: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """k(r), (a^2/3) (1 + a r) e^(-a r), and (a^4/3) e^(-a r)."""
    a = np.sqrt(5.0) / length
    ar = a * r
    decay = np.exp(-ar)
    return (1 + ar + ar * ar / 3) * decay, a * a / 3 * (1 + ar) * decay, a**4 / 3 * decay


def cross_covariance(z: np.ndarray, nodes: np.ndarray, directions: np.ndarray, length: float) -> np.ndarray:
    """(n, N (1 + T)) covariance of values at `z` with the data at `nodes`, point by point."""
    k, slope, _ = matern(cdist(z, nodes), length)
    along = z @ directions.reshape(-1, z.shape[1]).T - np.einsum("ntd,nd->nt", directions, nodes).ravel()
    along = along.reshape(len(z), *directions.shape[:2])  # delta . v
    return np.concatenate([k[:, :, None], slope[:, :, None] * along], axis=2).reshape(len(z), -1)


@dataclass(frozen=True)
class Pairs:
    """What the data's covariance needs to know of each pair of points, once for all settings."""

    r: np.ndarray  # (N, N)
    left: np.ndarray  # (N, T, N), delta . u_i
    right: np.ndarray  # (N, N, T), delta . v_j
    dot: np.ndarray  # (N, T, N, T), u_i . v_j
    bent: np.ndarray  # (N, T, N, T), (delta . u_i)(delta . v_j)

    @staticmethod
    def of(z: np.ndarray, directions: np.ndarray) -> Pairs:
        count, tangents, size = directions.shape
        flat = directions.reshape(-1, size)
        own = np.einsum("itd,id->it", directions, z)
        across = (flat @ z.T).reshape(count, tangents, count)  # u_i . z_j
        left = own[:, :, None] - across
        right = across.transpose(2, 0, 1) - own[None]
        dot = (flat @ flat.T).reshape(count, tangents, count, tangents)
        return Pairs(cdist(z, z), left, right, dot, left[:, :, :, None] * right[:, None])


def covariance(pairs: Pairs, settings: KrigingSettings) -> np.ndarray:
    """(N (1 + T))^2 covariance of the data, noise included, for unit variance."""
    count, tangents = pairs.left.shape[:2]
    k, slope, bend = matern(pairs.r, settings.length)
    block = 1 + tangents
    K = np.empty((count, block, count, block))
    K[:, 0, :, 0] = k + settings.value_noise * np.eye(count)
    if tangents:
        K[:, 0, :, 1:] = slope[:, :, None] * pairs.right
        K[:, 1:, :, 0] = -slope[:, None, :] * pairs.left
        K[:, 1:, :, 1:] = slope[:, None, :, None] * pairs.dot - bend[:, None, :, None] * pairs.bent
        noise = settings.gradient_noise * 5.0 / (3.0 * settings.length**2)
        for t in range(tangents):
            K[np.arange(count), 1 + t, np.arange(count), 1 + t] += noise
    return K.reshape(count * block, count * block)
