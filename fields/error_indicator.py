# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""How far the force between presses may be off, where a press would help most, and how far off it turned out to be.

Kriging knows the variance of what it does not know.  For a column with data y and profile variance v = y.Q y / (n - 1),

    var(F(z) | data) = v (k(z, z) - k_z K^-1 k_z + (1 - k_z K^-1 1)^2 / (1.K^-1 1))

and since log f = log Phi + log(2.5 / d + y'), the relative error of force is the column y + y' d / p, p = d f / Phi.
Where one length does for the field this variance only tells how far the nodes are.  With the rough part
(roughness.py) it also tells where the field changes fast, and the surprise at the nodes around corrects it.

A press that is planned changes the variance whatever it will find, so places are chosen one after another, each given
those before it (Cholesky's factor grown block by block: value and gradients of each planned press).
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_triangular
from scipy.spatial import KDTree
from scipy.spatial.distance import cdist
from scipy.special import erf

from palpate.fields.covariance import Pairs, Sites, covariance
from palpate.fields.kriging import Kriging, embed, noise_of
from palpate.fields.response_field import ResponseNodes
from palpate.fields.site_curves import FELT, HERTZ, SiteCurves, embedded_directions
from palpate.fields.surface_curvature import tangent_frame

__all__ = ["ErrorIndicator", "error_quantile", "force_spread", "missed"]

AROUND, TRUST, LARGEST = 3, 1.0, 6.0
"""Nodes that count around a node, what expectation itself is worth among them (counts), and the largest surprise."""


class ErrorIndicator:
    """Standard deviation of the force's relative error at candidates, while presses are being planned.

    Args:
        sites: kriged nodes, with gradients.
        position: (n, 3) m, candidates.  normal: (n, 3).  shape: (n, 3, 3) 1/m, their shape operators.
    """

    def __init__(
        self, sites: SiteCurves, position: np.ndarray, normal: np.ndarray, shape: np.ndarray
    ) -> None:
        self._kriging = kriging = sites.response
        z = embed(position, normal, sites.normal_length)
        self._asked = kriging.asked(z, embedded_directions(normal, shape, sites.normal_length))
        self._values = self._asked.values()
        self._planned: list[tuple[Sites, np.ndarray, np.ndarray]] = []
        K = covariance(Pairs.of(self._values, kriging.sites), kriging.settings)
        self._known = [kriging.solved.whitened(K)]  # (data, n), then (1 + T, n) of each planned press
        trend = 1.0 / np.sqrt(kriging.solved.information) - K @ kriging.solved.trend
        self._variance = (
            prior_variance(self._values, kriging) - np.sum(self._known[0] ** 2, axis=0) + trend**2
        )
        self._scale = float(force_spread(sites).max()) * surprise(sites, z)

    @property
    def deviation(self) -> np.ndarray:
        """(n,) standard deviation, fraction of force, at the worst depth that is felt."""
        return self._scale * np.sqrt(np.maximum(self._variance, 0.0))

    def plan(self, i: int) -> None:
        """Takes for granted that candidate `i` is pressed."""
        kriging, one = self._kriging, self._asked[[i]]
        settings = kriging.settings
        known = [kriging.solved.whitened(covariance(Pairs.of(one, kriging.sites), settings))]
        for other, seen, factor in self._planned:
            rest = covariance(Pairs.of(other, one), settings) - seen.T @ np.concatenate(known)
            known.append(solve_triangular(factor, rest, lower=True))
        seen = np.concatenate(known)
        own = covariance(Pairs.of(one, one), settings) + np.diag(noise_of(one, settings)) - seen.T @ seen
        factor = np.linalg.cholesky(own)
        rest = covariance(Pairs.of(one, self._values), settings)
        rest = rest - sum(mine.T @ theirs for mine, theirs in zip(known, self._known, strict=True))
        learned = solve_triangular(factor, rest, lower=True)
        self._planned.append((one, seen, factor))
        self._known.append(learned)
        self._variance = self._variance - np.sum(learned**2, axis=0)


def surprise(sites: SiteCurves, z: np.ndarray) -> np.ndarray:
    """(n,) how much more than expected nodes around `z` (n, D) m differ from what the others predict for them.

    With t_i the force error of leaving node i out over its expected deviation (root mean square over felt depths),

        s^2 = (TRUST + sum_i w_i t_i^2) / (TRUST + sum_i w_i),    w_i Gaussian, as wide as three nodes are apart
    """
    kriging, count = sites.response, len(sites.knots)
    error = kriging.left_out[:, :count] + kriging.left_out[:, count:] * (sites.knots / sites.own_exponent)
    t = (
        np.sqrt(np.mean((error[:, sites.felt] / force_spread(sites)) ** 2, axis=1))
        / kriging.left_out_deviation
    )
    if len(t) <= AROUND:
        return np.ones(len(z))
    node = kriging.sites.z
    width = KDTree(node).query(node, AROUND + 1)[0][:, -1]
    weight = np.exp(-0.5 * cdist(z, node, "sqeuclidean") / width**2)
    return np.sqrt((TRUST + weight @ np.minimum(t, LARGEST) ** 2) / (TRUST + weight.sum(axis=1)))


def prior_variance(sites: Sites, kriging: Kriging) -> np.ndarray:
    """(n,) variance of the field's values where nothing is known, as a share of G's."""
    if sites.rough is None:
        return np.ones(len(sites.z))
    s = kriging.settings
    return 1.0 + s.short_variance * s.short_length**4 * sites.rough**2


def force_spread(sites: SiteCurves) -> np.ndarray:
    """(k,) standard deviation of log f by depth knot, those that are felt, where kriging's own is one."""
    solved, count = sites.response.solved, len(sites.knots)
    half = solved.factor.T @ (solved.scale[:, None] * solved.weights)  # half.half = y.Q y
    p = sites.own_exponent.mean(axis=0)
    half = half[:, :count] + half[:, count:] * (sites.knots / p)
    return np.sqrt(np.sum(half**2, axis=0) / (len(half) - 1))[sites.felt]


def error_quantile(deviation: np.ndarray, share: float = 0.95) -> float:
    """The error that `share` of normal errors with deviations (n,), one at each place, stay below."""
    low, high = 0.0, 6.0 * float(deviation.max(initial=0.0))
    scale = np.maximum(np.sqrt(2.0) * deviation, 1e-300)
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if erf(middle / scale).mean() < share else (low, middle)
    return high


def missed(sites: SiteCurves, nodes: ResponseNodes, shape: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Largest normal and lateral error (N,) of what was predicted where `nodes` have now been pressed.

    Over all depth knots whose force exceeds FELT of the deepest, relative to the force there: a test on presses that
    the prediction has not seen.  shape: (N, 3, 3) 1/m, shape operators at the nodes.
    """
    z = embed(nodes.position, nodes.normal, sites.normal_length)
    e = tangent_frame(nodes.normal)
    said = sites.response.predict(z, embedded_directions(nodes.normal, shape, sites.normal_length))
    knots = sites.knots
    y, y_slope = np.split(said[:, 0], 2, axis=1)
    phi = knots**HERTZ * np.exp(y)
    force, truth = phi * (HERTZ / knots + y_slope), nodes.normal_force[:, 1:]
    # B = Phi (I + s W)^-1 grad_c y
    gradient = np.einsum("ntk,nti->nki", said[:, 1:, : len(knots)], e)
    stretch = np.eye(3) + (sites.offset - knots)[None, :, None, None] * shape[:, None]
    lateral = phi[..., None] * np.linalg.solve(stretch, gradient[..., None])[..., 0]
    aside = np.linalg.norm(lateral - nodes.lateral_gradient[:, 1:], axis=2)
    judged = truth > FELT * truth[:, -1:]
    return tuple(np.max(np.where(judged, np.abs(a) / truth, 0.0), axis=1) for a in (force - truth, aside))
