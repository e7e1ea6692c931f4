# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Gradient-enhanced kriging, many data columns sharing one operator (covariance.py says which).

A surface point is embedded as z = (c, L n), so that the two sides of a thin lobe are 2 L apart; moving along the
surface by e moves z by v = (e, L W e) with the shape operator W.  Noise is a share of the variance on values and,
separately, of the gradient's variance on gradients; these and the lengths maximise the likelihood, in which every
column has its own mean and variance.  One operator for all columns keeps what is smooth in depth smooth in depth.
A rough part is there only where likelihood asks for it.
Leaving a node out, value and gradient together, costs no refit (Dubrule, Math. Geology 15, 1983).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_factor, cho_solve, solve_triangular
from scipy.optimize import minimize

from palpate.fields.covariance import KrigingSettings, Pairs, Sites, covariance
from palpate.fields.roughness import Roughness, roughness

__all__ = ["Kriging", "KrigingSettings", "embed", "fit_kriging"]

CHUNK = 2048
"""Prediction points handled at once (count); bounds memory."""
NOISE_BOUNDS = ((1e-6, 1.0), (1e-4, 10.0))
"""Least and largest noise shares, of values and of gradients.  A dozen presses cannot tell small noise from none;
below these floors, likelihood would trust FEM gradients more than any FEM gradient deserves."""
SHORT_LENGTHS = (2e-3, 40e-3)
"""m, least and largest length of the rough part."""
SHORT_VARIANCES = (1e-4, 10.0)
"""Its variance where rho = 1 / l_s^2: a field of Matern's kind and unit curvature has 1 / 25."""
ROWS_MAX = 15_000
"""Values and derivatives in one covariance (count): a dense matrix of 1.8 GB, of which a fit holds a few."""
EVIDENCE = 3.0
"""Log-likelihood that a rough part's two parameters must bring to be believed."""


def embed(position: np.ndarray, normal: np.ndarray, normal_length: float) -> np.ndarray:
    """z (n, 6) m of surface points: `position` (n, 3) m and `normal_length` L times the unit `normal` (n, 3)."""
    return np.concatenate([position, normal_length * normal], axis=1)


@dataclass(frozen=True)
class Kriging:
    """A fitted interpolator of C columns over N points.

    Attributes:
        sites: the N points, with T directions of gradient data, T = 0 without.
        settings: covariance parameters.
        rough: rho of the rough part, or None.
        solved: the operator applied to the data.
        left_out: (N, C) data minus prediction with each point left out entirely.
        left_out_deviation: (N,) its standard deviation where a column's own is one.
        log_likelihood: of the columns that were used to find the settings.
    """

    sites: Sites
    settings: KrigingSettings
    rough: Roughness | None
    solved: Solved
    left_out: np.ndarray
    left_out_deviation: np.ndarray
    log_likelihood: float

    @property
    def mean(self) -> np.ndarray:
        """(C,) trend."""
        return self.solved.mean

    def asked(self, z: np.ndarray, directions: np.ndarray | None = None) -> Sites:
        """Points `z` (n, D) where values are asked for, and derivatives along `directions` (n, T, D)."""
        directions = np.zeros((len(z), 0, z.shape[1])) if directions is None else directions
        return Sites(z, directions) if self.rough is None else self.rough.sites(z, directions)

    def predict(self, z: np.ndarray, directions: np.ndarray | None = None) -> np.ndarray:
        """(n, C) values at embedded points `z` (n, D); (n, 1 + T, C) with derivatives along `directions` (n, T, D)."""
        sites = self.asked(z, directions)
        out = np.empty((len(z), sites.block, len(self.mean)))
        for start in range(0, len(z), CHUNK):
            part = slice(start, start + CHUNK)
            K = covariance(Pairs.of(sites[part], self.sites), self.settings)
            out[part] = (K @ self.solved.weights).reshape(-1, sites.block, len(self.mean))
        out[:, 0] += self.mean
        return out[:, 0] if directions is None else out


def fit_kriging(
    z: np.ndarray,
    values: np.ndarray,
    directions: np.ndarray | None = None,
    gradients: np.ndarray | None = None,
    *,
    scored: np.ndarray | None = None,
    settings: KrigingSettings | None = None,
    near: KrigingSettings | None = None,
) -> Kriging:
    """Fit.

    Args:
        z: (N, D) m, distinct embedded points.
        values: (N, C).
        directions: (N, T, D) directions in which derivatives are given.
        gradients: (N, T, C) those derivatives, unit of the value per m.
        scored: columns whose likelihood chooses the settings; all when None.
        settings: use these instead of searching.
        near: search only around these, which fitted most of the points.

    Raises:
        ValueError: data are not finite, two points coincide, or there are too many to be held.
    """
    z, values = np.asarray(z, dtype=float), np.asarray(values, dtype=float)
    count, columns = values.shape
    if directions is None or gradients is None:
        directions, gradients = np.zeros((count, 0, z.shape[1])), np.zeros((count, 0, columns))
    y = np.concatenate([values[:, None], gradients], axis=1).reshape(-1, columns)  # point by point
    if not (np.isfinite(y).all() and np.isfinite(z).all()):
        raise ValueError("kriging: data must be finite")
    if len(y) > ROWS_MAX:
        derivatives = directions.shape[1]
        raise ValueError(
            f"kriging: {count} points with {derivatives} derivatives each need a covariance of "
            f"{8e-9 * len(y) ** 2:.3g} GB; at most {ROWS_MAX // (1 + derivatives)} such points are right"
        )
    chosen = slice(None) if scored is None else scored
    plain = Sites(z, directions)
    pairs = Pairs.of(plain, plain)
    if count > 1 and pairs.r[~np.eye(count, dtype=bool)].min() < 1e-9:
        raise ValueError("kriging: two points coincide")
    rough = roughness(z, values[:, chosen], directions, gradients[:, :, chosen])
    if rough is not None:
        sites = rough.sites(z, directions)
        pairs = replace(pairs, left_sites=sites, right_sites=sites)
    if settings is None:
        settings = likeliest_settings(pairs, y[:, chosen], near)
    solved = Solved.from_data(pairs, y, settings)
    return Kriging(
        pairs.left_sites,
        settings,
        rough,
        solved,
        *solved.left_out(directions.shape[1] + 1),
        Solved.from_data(pairs, y[:, chosen], settings).log_likelihood,
    )


def likeliest_settings(pairs: Pairs, y: np.ndarray, near: KrigingSettings | None = None) -> KrigingSettings:
    """Maximum likelihood within bounds, with a rough part where the data have one and it is worth it."""
    count, tangents = len(pairs.r), pairs.left_sites.block - 1
    span = pairs.r.max(initial=0.0)
    if count < 4 or np.ptp(y[:: tangents + 1], axis=0).max() == 0:
        return KrigingSettings(float(span) or 0.05, 1e-4, 1e-2)
    closest = float(np.median(np.min(pairs.r + np.diag(np.full(count, np.inf)), axis=1)))
    may_be_rough = pairs.left_sites.rough is not None
    smooth = [(0.5 * closest, 4 * span), *NOISE_BOUNDS[: 2 if tangents else 1]]
    rough = [*smooth, SHORT_LENGTHS, SHORT_VARIANCES]

    def search(bounds: list[tuple[float, float]], starts: list[tuple[float, ...]]):
        low, high = np.log(np.array(bounds)).T

        def settings_of(x: np.ndarray) -> KrigingSettings:
            x = np.exp(np.clip(x, low, high)).tolist()
            return KrigingSettings(*(x if tangents else [*x, 1.0]))

        def cost(x: np.ndarray) -> float:
            try:
                return -Solved.from_data(pairs, y, settings_of(x)).log_likelihood
            except np.linalg.LinAlgError:
                return 1e30

        best = min((np.clip(np.log(start), low, high) for start in starts), key=cost)
        simplex = np.vstack([best, best + np.where(best + 0.4 > high, -0.4, 0.4) * np.eye(len(best))])
        options = {
            "xatol": 0.02,
            "fatol": 1e-3 if near is None else 0.1,
            "maxfev": 150 if near is None else 60,
        }
        found = minimize(
            cost, best, method="Nelder-Mead", bounds=list(zip(low, high, strict=True)),
            options={**options, "initial_simplex": simplex},
        )  # fmt: skip
        return settings_of(found.x), -found.fun

    def values_of(s: KrigingSettings) -> tuple[float, ...]:
        return s.length, s.value_noise, s.gradient_noise

    if near is not None and near.short_variance > 0 and may_be_rough:
        start = (*values_of(near), near.short_length, near.short_variance)
        return search(rough, [start])[0]
    starts = [
        (length, noise, 100 * noise)[: len(smooth)]
        for length in np.geomspace(closest, 2 * span, 5)
        for noise in (1e-5, 1e-3, 1e-2)
    ]
    if near is not None:
        starts = [values_of(near)[: len(smooth)]]
    settings, likelihood = search(smooth, starts)
    if may_be_rough:
        starts = [
            (length, noise, 100 * noise, short, variance)
            for length in (settings.length, np.sqrt(settings.length * span), span)
            for noise in (1e-5, 1e-3)
            for short in np.geomspace(0.5 * closest, 2 * closest, 2)
            for variance in (0.01, 0.1)
        ]
        other, gained = search(rough, starts)
        if gained > likelihood + EVIDENCE:
            return other
    return settings


@dataclass(frozen=True)
class Solved:
    """The covariance's factor applied to data.

    K w = y - F m with the generalised-least-squares mean m; Q = K^-1 - K^-1 F (F^T K^-1 F)^-1 F^T K^-1.
    Rows and columns are scaled by the data's standard deviations before K is factored.

    Attributes:
        mean: (C,) m.  weights: (N (1 + T), C) w.  log_likelihood: restricted, averaged over columns.
        factor: lower Cholesky factor of the scaled K.  scale: (N (1 + T),) standard deviations.
        trend: K^-1 F / sqrt(F^T K^-1 F).  information: F^T K^-1 F.
    """

    mean: np.ndarray
    weights: np.ndarray
    log_likelihood: float
    factor: np.ndarray
    scale: np.ndarray
    trend: np.ndarray
    information: float

    @staticmethod
    def from_data(pairs: Pairs, y: np.ndarray, settings: KrigingSettings) -> Solved:
        K = covariance(pairs, settings) + np.diag(noise_of(pairs.left_sites, settings))
        scale = np.sqrt(np.diag(K))
        # Jitter far below any noise in FEM data; keeps the factor exact to 1e-6 or so.
        K = K / scale[:, None] / scale
        factor = cho_factor(K + 1e-10 * np.eye(len(K)), lower=True)
        F = np.zeros(len(K))
        F[:: pairs.left_sites.block] = 1.0
        KF = cho_solve(factor, F / scale) / scale
        Ky = cho_solve(factor, y / scale[:, None]) / scale[:, None]
        information = F @ KF
        mean = F @ Ky / information
        weights = Ky - np.outer(KF, mean)
        n = len(K)
        variance = np.maximum(np.sum(y * weights, axis=0) / (n - 1), 1e-300)
        log_det = 2 * np.sum(np.log(np.diag(factor[0]))) + 2 * np.sum(np.log(scale))
        # Restricted likelihood with variance profiled out, averaged over columns (they are correlated).
        likelihood = -0.5 * (np.mean((n - 1) * np.log(variance)) + log_det + np.log(information))
        return Solved(
            mean,
            weights,
            float(likelihood),
            np.tril(factor[0]),
            scale,
            KF / np.sqrt(information),
            information,
        )

    def whitened(self, K: np.ndarray) -> np.ndarray:
        """(N (1 + T), n) factor^-1 K^T for covariances K (n, N (1 + T)) of other values with the data."""
        return solve_triangular(self.factor, (K / self.scale).T, lower=True)

    def left_out(self, block: int) -> tuple[np.ndarray, np.ndarray]:
        """Value minus its prediction from the other points (N, C), and that difference's standard deviation (N,).

        e_I = Q_II^-1 (Q y)_I with covariance Q_II^-1, and Q y = weights.
        """
        count = len(self.weights) // block
        if count < 2:
            return np.zeros((count, self.weights.shape[1])), np.ones(count)
        w = self.weights.reshape(count, block, -1)
        inverse = cho_solve((self.factor, True), np.eye(len(self.weights)))
        Q = inverse / self.scale[:, None] / self.scale - np.outer(self.trend, self.trend)
        Q = np.linalg.inv(Q.reshape(count, block, count, block)[np.arange(count), :, np.arange(count)])
        return (Q @ w)[:, 0], np.sqrt(Q[:, 0, 0])


def noise_of(sites: Sites, settings: KrigingSettings) -> np.ndarray:
    """(N (1 + T),) variance of noise on the data."""
    noise = np.full((len(sites.z), sites.block), settings.gradient_noise * settings.gradient_variance)
    noise[:, 0] = settings.value_noise
    return noise.ravel()
