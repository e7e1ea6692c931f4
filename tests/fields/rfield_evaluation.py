# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""U, its gradient, k and mu of a ResponseField at points, straight from the definitions in lattice.py and
response_field.py.  It exists so that tests of the runtime do not trust the runtime; it shares no code with it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from palpate.fields.lattice import Lattice
from palpate.fields.response_field import DepthCurves, ResponseField


class Evaluation(NamedTuple):
    """n points; SI units."""

    depth: np.ndarray  # (n,) m
    normal: np.ndarray  # (n, 3) grad phi / |grad phi|
    energy: np.ndarray  # (n,) J
    gradient: np.ndarray  # (n, 3) N
    friction_stiffness: np.ndarray  # (n,) N/m
    friction_coefficient: np.ndarray  # (n,)


def lattice_at(lattice: Lattice, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All channels (n, c) and their gradients (n, 3, c); absent coefficients count as zero."""
    u = (q - lattice.origin) / lattice.spacing
    cell = np.floor(u).astype(int)
    t = u - cell
    w = [0.5 * (1 - t) ** 2, 0.5 + t * (1 - t), 0.5 * t**2]
    d = [(t - 1) / lattice.spacing, (1 - 2 * t) / lattice.spacing, t / lattice.spacing]
    value, gradient = 0.0, np.zeros((len(q), 3, lattice.channel_count))
    size = 4 * np.array(lattice.block_index.shape)
    for a, b, c in np.ndindex(3, 3, 3):
        j = cell + np.array([a, b, c])
        inside = np.all((j >= 0) & (j < size), axis=1)
        j = np.where(inside[:, None], j, 0)
        row = np.where(inside, lattice.block_index[j[:, 0] // 4, j[:, 1] // 4, j[:, 2] // 4], -1)
        C = lattice.coefficients[row, j[:, 0] % 4, j[:, 1] % 4, j[:, 2] % 4] * (row >= 0)[:, None]
        value = value + (w[a][:, 0] * w[b][:, 1] * w[c][:, 2])[:, None] * C
        gradient[:, 0] += (d[a][:, 0] * w[b][:, 1] * w[c][:, 2])[:, None] * C
        gradient[:, 1] += (w[a][:, 0] * d[b][:, 1] * w[c][:, 2])[:, None] * C
        gradient[:, 2] += (w[a][:, 0] * w[b][:, 1] * d[c][:, 2])[:, None] * C
    return np.asarray(value), gradient


def curves_at(curves: DepthCurves, depth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values and slopes (n, R); zero at depth <= 0, a quadratic beyond depth_end."""
    if curves.curve_count == 0:
        return np.zeros((len(depth), 0)), np.zeros((len(depth), 0))
    count = curves.coefficients.shape[1]
    h = curves.depth_end / count
    m = np.clip((depth / h).astype(int), 0, count - 1)
    x = np.minimum(depth, curves.depth_end) - m * h
    c = curves.coefficients[:, m].transpose(2, 1, 0)  # (4, n, R)
    x = x[:, None]
    value = c[0] + c[1] * x + c[2] * x**2 + c[3] * x**3
    slope = c[1] + 2 * c[2] * x + 3 * c[3] * x**2
    bend = 2 * c[2] + 6 * c[3] * x
    y = np.maximum(depth - curves.depth_end, 0)[:, None]
    on = (depth > 0)[:, None]
    return on * (value + slope * y + 0.5 * bend * y**2), on * (slope + bend * y)


def evaluate(field: ResponseField, q: np.ndarray) -> Evaluation:
    """Everything at reference points `q` (n, 3) m."""
    phi, dphi = lattice_at(field.geometry.signed_distance, q)
    depth, dphi = field.tool.offset - phi[:, 0], dphi[..., 0]
    a, da = lattice_at(field.amplitudes, q)
    r_u, r_k = field.energy_curves.curve_count, field.stiffness_curves.curve_count
    value, slope = curves_at(field.energy_curves, depth)
    energy = np.sum(value * a[:, :r_u], axis=1)
    gradient = np.einsum("nr,nir->ni", value, da[..., :r_u])
    gradient -= np.sum(slope * a[:, :r_u], axis=1)[:, None] * dphi
    k = np.sum(curves_at(field.stiffness_curves, depth)[0] * a[:, r_u : r_u + r_k], axis=1)
    mu = np.sum(curves_at(field.friction_curves, depth)[0] * a[:, r_u + r_k :], axis=1)
    normal = dphi / np.linalg.norm(dphi, axis=1, keepdims=True)
    return Evaluation(depth, normal, energy, gradient, np.maximum(k, 0), np.maximum(mu, 0))
