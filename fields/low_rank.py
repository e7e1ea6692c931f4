# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Many curves of depth as a few shared ones times amplitudes: Phi_s(d) ~ sum_r phi_r(d) a_rs.

The split is a singular value decomposition of the forces Phi_s'(d), each site scaled by its own deepest force and
each depth by the usual force there, so that errors count relative to the force that is felt (Eckart and Young,
1936: no other R curves do better in this measure).  phi_r are then the least-squares curves of those amplitudes,
scaled so that amplitudes are near one or below.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from palpate.fields.response_field import DepthCurves
from palpate.fields.shared_curves import curves_from_second_derivative, curves_from_values, energy_basis

__all__ = ["LowRank", "low_rank_energy", "low_rank_values", "second_derivatives"]

FLOOR = 0.02
"""Share of the deepest force below which errors no longer count relative to the force at their own depth."""


@dataclass(frozen=True)
class LowRank:
    """Shared curves and amplitudes.

    Attributes:
        curves: R shared curves.
        amplitudes: (S, R).
        error_p95: 95th percentile over sites and depths of the error of what the curves stand for (force;
            value), relative to it, at depths where it exceeds 5 % of its deepest value.
    """

    curves: DepthCurves
    amplitudes: np.ndarray
    error_p95: float


def second_derivatives(
    depth: np.ndarray,
    energy: np.ndarray,
    force: np.ndarray,
    depth_end: float,
    intervals: int,
    *,
    convex: bool,
) -> np.ndarray:
    """Phi''(m h), (S, M + 1) N/m, of the C2 piecewise cubics nearest to curves given at J depths.

    Args:
        depth: (J,) m, in (0, depth_end].
        energy: (S, J) J.
        force: (S, J) N.
        depth_end: m.
        intervals: M.
        convex: hold Phi'' >= 0 at every interval end (hence everywhere).
    """
    value, slope = energy_basis(depth_end, intervals, depth)
    usual_force = np.exp(np.mean(np.log(np.maximum(force, 1e-30)), axis=0))
    usual_energy = np.exp(np.mean(np.log(np.maximum(energy, 1e-30)), axis=0))
    to_force = 1.0 / (usual_force + FLOOR * usual_force[-1])
    to_energy = 1.0 / (usual_energy + FLOOR * usual_energy[-1])
    bend = np.diff(np.eye(intervals + 1), n=2, axis=0) * (1e-3 * depth_end / usual_force[-1])
    A = np.vstack([slope * to_force[:, None], value * to_energy[:, None], bend])
    y = np.concatenate([force * to_force, energy * to_energy, np.zeros((len(force), len(bend)))], axis=1)
    second = y @ np.linalg.pinv(A).T
    if convex:
        unit = usual_force[-1] / depth_end
        for site in np.flatnonzero(second.min(axis=1) < 0):
            second[site] = nnls(A * unit, y[site])[0] * unit
    return second


def low_rank_energy(second: np.ndarray, depth_end: float, rank: int) -> LowRank:
    """Shared energy curves from `second` (S, M + 1) = Phi_s''(m h); phi_r(0) = phi_r'(0) = 0."""
    intervals = second.shape[1] - 1
    depth = depth_end * (np.arange(2 * intervals) + 1) / (2 * intervals)
    _, slope = energy_basis(depth_end, intervals, depth)
    force = second @ slope.T
    amplitudes, fitted = truncated(force, rank)
    shared = np.linalg.lstsq(amplitudes / force[:, -1:], second / force[:, -1:], rcond=None)[0]  # (R, M + 1)
    return LowRank(curves_from_second_derivative(depth_end, shared), amplitudes, error_p95(force, fitted))


def low_rank_values(values: np.ndarray, depth_end: float, rank: int) -> LowRank:
    """Shared curves from `values` (S, M + 1), not negative, at the ends of M uniform intervals."""
    amplitudes, fitted = truncated(values, rank)
    scale = values[:, -1:]
    shared = np.linalg.lstsq(amplitudes / scale, values / scale, rcond=None)[0]
    return LowRank(curves_from_values(depth_end, shared), amplitudes, error_p95(values, fitted))


def truncated(values: np.ndarray, rank: int) -> tuple[np.ndarray, np.ndarray]:
    """Amplitudes (S, R) and the values (S, J) that they stand for, by a scaled singular value decomposition."""
    site = values[:, -1:]
    usual = np.mean(values / site, axis=0) + FLOOR
    left, singular, right = np.linalg.svd(values / site / usual, full_matrices=False)
    rank = min(rank, len(singular))
    sign = np.where(right[:rank].sum(axis=1) < 0, -1.0, 1.0)
    left, right = left[:, :rank] * sign, right[:rank] * sign[:, None]
    share = left * np.sqrt(len(values))  # root mean square 1 in every column
    strength = singular[:rank] / np.sqrt(len(values))
    typical = np.exp(np.mean(np.log(site)))
    return share * site / typical * (strength / strength[0]), (share * strength) @ right * usual * site


def error_p95(values: np.ndarray, fitted: np.ndarray) -> float:
    felt = values > 0.05 * values[:, -1:]
    return float(np.quantile(np.abs(fitted / np.where(felt, values, 1.0) - 1.0)[felt], 0.95))
