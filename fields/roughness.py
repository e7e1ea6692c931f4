# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Where a field changes faster than elsewhere, told by its own values and gradients at scattered points.

A point's gradient predicts its neighbours; what it misses by is curvature.  With neighbours j of point i at r_ij,

    kappa_i^2 = mean_j w_ij 4 (y_j - y_i - g_i . (z_j - z_i))^2 / r_ij^4,      w_ij = 1 / r_ij^2

(noise taken out of the square).  Most of an organ has the curvature of the median; what is above ORDINARY times
that is rough:  rho_i = sqrt(max(0, kappa_i^2 - (ORDINARY median kappa)^2)).  Between points rho is a mean with Gaussian
weights as wide as a point's neighbours are far, so it is smooth, and sharper where points are dense.

The idea of gradient disagreement as an indicator of nonlinearity: Crombecq et al., A Novel Hybrid Sequential Design
Strategy for Global Surrogate Modeling of Computer Experiments (LOLA-Voronoi), SIAM J. Sci. Comput. 33, 2011.
Limit: curvature between points farther apart than a feature is wide says that there is one, not how sharp it is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree
from scipy.spatial.distance import cdist

from palpate.fields.covariance import Sites

__all__ = ["Roughness", "curvatures", "roughness"]

NEIGHBOURS = 6
"""Points that a point's gradient is held against (count): a ring on a surface."""
ORDINARY = 1.0
"""Times the median curvature that is still ordinary."""
NOISE = 0.003
"""Share of a value that two presses differ by for no reason."""
WIDTH = 3
"""A point's weight reaches as far as its WIDTH-th neighbour."""
CHUNK = 4096
"""Points evaluated at once (count); bounds memory."""


@dataclass(frozen=True)
class Roughness:
    """rho(z).

    Attributes:
        centre: (N, D) m.  width: (N,) m.  value: (N,) 1/m^2.
    """

    centre: np.ndarray
    width: np.ndarray
    value: np.ndarray

    def sites(self, z: np.ndarray, directions: np.ndarray) -> Sites:
        """Points with rho and its derivatives along `directions` (n, T, D)."""
        value, slope = np.empty(len(z)), np.empty(directions.shape[:2])
        for start in range(0, len(z), CHUNK):
            part = slice(start, start + CHUNK)
            value[part], slope[part] = self._at(z[part], directions[part])
        return Sites(z, directions, value, slope)

    def _at(self, z: np.ndarray, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        distance = cdist(z, self.centre, "sqeuclidean") / (2 * self.width**2)
        weight = np.exp(distance.min(axis=1, keepdims=True) - distance)
        weight /= weight.sum(axis=1, keepdims=True)
        rho = weight @ self.value
        # d rho = sum_i w_i (rho_i - rho) (z_i - z) / h_i^2
        pull = weight * (self.value[None] - rho[:, None]) / self.width**2
        gradient = pull @ self.centre - pull.sum(axis=1)[:, None] * z
        return rho, np.einsum("ntd,nd->nt", directions, gradient)


def curvatures(
    z: np.ndarray, values: np.ndarray, directions: np.ndarray, gradients: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """kappa (N,) 1/m^2, root mean square over columns, and how far neighbours are (N, k) m, rising.

    Args:
        z: (N, D) m.  values: (N, C).
        directions: (N, T, D), orthogonal at each point as far as it matters.  gradients: (N, T, C), per m.
    """
    r, j = KDTree(z).query(z, min(NEIGHBOURS + 1, len(z)))
    r, j = r[:, 1:], j[:, 1:]
    step = np.einsum("nkd,ntd->nkt", z[j] - z[:, None], directions)
    step /= np.sum(directions**2, axis=2)[:, None]
    missed = values[j] - values[:, None] - np.einsum("nkt,ntc->nkc", step, gradients)
    square = np.maximum(np.mean(missed**2, axis=2) - 2 * NOISE**2, 0.0) * 4.0 / r**4
    weight = (r[:, :1] / r) ** 2
    return np.sqrt(np.sum(weight * square, axis=1) / weight.sum(axis=1)), r


def roughness(
    z: np.ndarray, values: np.ndarray, directions: np.ndarray, gradients: np.ndarray
) -> Roughness | None:
    """rho of data as in `curvatures`; None where the field is equally rough everywhere, or there are too few points."""
    if len(z) <= NEIGHBOURS or directions.shape[1] == 0:
        return None
    kappa, r = curvatures(z, values, directions, gradients)
    value = np.sqrt(np.maximum(kappa**2 - (ORDINARY * np.median(kappa)) ** 2, 0.0))
    return Roughness(z, r[:, min(WIDTH, r.shape[1]) - 1], value) if value.any() else None
