# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""One press as a curve: stored energy Phi(d), force Phi'(d), stiffness Phi''(d), from a ladder of depths.

    Phi''(d) = sum_j c_j beta_j(sqrt(d)),   Phi'(d) = int_0^d Phi'',   Phi(d) = int_0^d (d - e) Phi''(e) de

beta_j are quadratic B-splines in sqrt(d), because a rounded tool starts as Hertz does, Phi'' ~ sqrt(d) (Johnson,
Contact Mechanics, 1985, eq. 4.23), which a spline in d cannot follow and a straight line in sqrt(d) is.
So Phi(0) = Phi'(0) = 0 by construction, Phi is C2 (C3 for d > 0), and c_j >= 0 makes Phi'' >= 0.

Force and energy are fitted at once: bounded least squares, second differences of c penalised, the penalty chosen
by generalised cross-validation (Golub, Heath and Wahba, 1979).  Convexity is given up only where data contradict it.
Limit: a tool whose Phi'' has a jump inside the range (a flat's edge touching late) is smoothed over.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import lsq_linear

__all__ = ["DepthCurve", "fit_depth_curve"]

RELATIVE_NOISE = 0.005
"""Weight of a sample: FEM contact forces scatter by about half a percent of themselves ..."""
FLOOR_NOISE = 0.002
"""... plus this share of the deepest value."""
CONVEXITY_DOUBT = 1.0
"""Rise of the root-mean-square residual, in units of the noise above, at which Phi'' >= 0 is given up."""
GAUSS_POINTS, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(
    3
)  # exact up to degree 5: what the integrals need


@dataclass(frozen=True)
class DepthCurve:
    """A fitted press.

    Attributes:
        knots: full knot vector of the quadratic B-splines, in sqrt(m).
        coefficients: c_j, N/m.
        depth_reached: m; beyond it Phi'' keeps its last value.
        convex: False where the data asked for a falling force.
        force_residual: largest |fit - data| over the ladder, share of the deepest force.
        energy_residual: the same for energy.
    """

    knots: np.ndarray
    coefficients: np.ndarray
    depth_reached: float
    convex: bool
    force_residual: float
    energy_residual: float

    def __call__(self, depth: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Energy (n,) J, force (n,) N and stiffness (n,) N/m at `depth` (n,) m; zero for depth <= 0."""
        depth = np.asarray(depth, dtype=float)
        d = np.clip(depth, 0.0, self.depth_reached)
        second, force, energy = (M @ self.coefficients for M in basis_integrals(self.knots, d))
        x = np.maximum(depth - self.depth_reached, 0.0)
        energy = energy + force * x + 0.5 * second * x**2
        force = force + second * x
        return energy, force, np.where(depth > 0, second, 0.0)


def fit_depth_curve(depth: np.ndarray, force: np.ndarray, energy: np.ndarray) -> DepthCurve:
    """Fit a ladder.

    Args:
        depth: (K,) m, rising; a state at depth 0 carries no information and may be there or not.
        force: (K,) N, along the outward normal, on the tool.
        energy: (K,) J, stored.

    Raises:
        ValueError: fewer than three depths above 0, values that are not finite, or no positive force.
    """
    depth, force, energy = (np.asarray(a, dtype=float) for a in (depth, force, energy))
    keep = depth > 0
    d, f, e = depth[keep], force[keep], energy[keep]
    if len(d) < 3:
        raise ValueError(f"depth curve: {len(d)} depths above 0, at least 3 needed")
    if not (np.isfinite([d, f, e]).all() and np.all(np.diff(d) > 0)):
        raise ValueError("depth curve: depths must rise, and depth, force and energy be finite")
    if f.max() <= 0 or e.max() <= 0:
        raise ValueError(
            f"depth curve: largest force {f.max():.3g} N, largest energy {e.max():.3g} J: both must be > 0"
        )

    end = np.sqrt(d[-1])
    intervals = int(np.clip(len(d) // 2, 2, 6))
    inner = np.linspace(0.0, end, intervals + 1)
    knots = np.concatenate([[0.0, 0.0], inner, [end, end]])
    _, to_force, to_energy = basis_integrals(knots, d)
    scale = f.max() / d[-1]  # N/m; makes c of order one
    A = (
        np.vstack(
            [
                to_force / (RELATIVE_NOISE * np.abs(f) + FLOOR_NOISE * f.max())[:, None],
                to_energy / (RELATIVE_NOISE * np.abs(e) + FLOOR_NOISE * e.max())[:, None],
            ]
        )
        * scale
    )
    y = np.concatenate(
        [
            f / (RELATIVE_NOISE * np.abs(f) + FLOOR_NOISE * f.max()),
            e / (RELATIVE_NOISE * np.abs(e) + FLOOR_NOISE * e.max()),
        ]
    )
    roughness = second_differences(knots)
    penalty = cross_validated_penalty(A, y, roughness)
    A_all = np.vstack([A, np.sqrt(penalty) * roughness])
    y_all = np.concatenate([y, np.zeros(len(roughness))])
    free = np.linalg.lstsq(A_all, y_all, rcond=None)[0]
    c = lsq_linear(A_all, y_all, bounds=(0.0, np.inf), method="bvls").x if free.min() < 0 else free

    def misfit(x: np.ndarray) -> float:
        return float(np.sqrt(np.mean((A @ x - y) ** 2)))

    convex = misfit(c) <= misfit(free) + CONVEXITY_DOUBT
    c = (c if convex else free) * scale
    return DepthCurve(
        knots,
        c,
        float(d[-1]),
        bool(convex),
        float(np.abs(to_force @ c - f).max() / f.max()),
        float(np.abs(to_energy @ c - e).max() / e.max()),
    )


def basis_integrals(knots: np.ndarray, depth: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Phi'', Phi' and Phi of every basis function, each (n, J), at `depth` (n,) m within the knots' range.

    With t = sqrt(e):  Phi'(d) = int beta(t) 2 t dt,  Phi(d) = int (d - t^2) beta(t) 2 t dt,  t from 0 to sqrt(d),
    polynomials of degree 3 and 5 on each knot interval, so three Gauss points are exact.
    """
    count = len(knots) - 3
    t_end = np.minimum(np.sqrt(depth), knots[-1])
    second = basis(knots, t_end)
    first, zeroth = np.zeros((2, len(depth), count))
    breaks = np.unique(knots)
    for a, b in pairwise(breaks):
        upper = np.clip(t_end, a, b)
        half = 0.5 * (upper - a)
        for x, weight in zip(GAUSS_POINTS, GAUSS_WEIGHTS, strict=True):
            t = a + half * (1 + x)
            term = basis(knots, t) * (weight * half * 2 * t)[:, None]
            first += term
            zeroth += term * (depth - t * t)[:, None]
    return second, first, zeroth


def basis(knots: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Quadratic B-splines (n, J) at t (n,), the right end included."""
    return BSpline.design_matrix(np.clip(t, knots[0], knots[-1]), knots, 2).toarray()


def second_differences(knots: np.ndarray) -> np.ndarray:
    """(J - 2, J) rows that vanish for a straight line in sqrt(d), at the splines' Greville points."""
    g = 0.5 * (knots[1:-2] + knots[2:-1])
    rows = np.zeros((len(g) - 2, len(g)))
    for j in range(len(rows)):
        a, b = g[j + 1] - g[j], g[j + 2] - g[j + 1]
        rows[j, j : j + 3] = np.array([b, -(a + b), a]) / (0.5 * (a + b))
    return rows


def cross_validated_penalty(A: np.ndarray, y: np.ndarray, roughness: np.ndarray) -> float:
    """lambda that minimises n |y - A c|^2 / (n - trace A (A^T A + lambda R^T R)^-1 A^T)^2 on a grid of decades."""
    best, best_score = 0.0, np.inf
    scale = np.trace(A.T @ A) / max(np.trace(roughness.T @ roughness), 1e-30)
    for penalty in scale * 10.0 ** np.arange(-8.0, 1.0):
        solve = np.linalg.solve(A.T @ A + penalty * roughness.T @ roughness, A.T)
        residual = y - A @ (solve @ y)
        freedom = len(y) - np.trace(A @ solve)
        score = residual @ residual / freedom**2
        if score < best_score:
            best, best_score = penalty, score
    return float(best)
