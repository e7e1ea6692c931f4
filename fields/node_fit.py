# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""From press arrays to response nodes: Phi, f, B, k and mu of every press on shared knots.

Tool reference at depth d: q = c + (rho - d) n.

    B(d) = - tangential force in the frictionless press = Phi(d) (g0 + g1 d/D + g2 (d/D)^2)

because a smooth surface gives Phi = A(c) d^p (...), whose gradient along the surface is of the order of Phi.
(A press that misses the normal by w radians adds f w; it cannot be told from g, DECISIONS.md.)

    k(d) = r(d) Phi''(d),   r = (tangential stiffness of the sticking contact) / (normal stiffness)

because r hardly changes with depth (Mindlin 1949: 2 (1 - nu) / (2 - nu) on a half space), so a few lateral ladders
are enough.  The sticking tool moves along a straight line, on which U itself curves by -f H (H = dn/dq: a convex
organ falls away from the tool); the field's U has that already, so it is taken out of the spring's stiffness.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from palpate.fields.depth_curve import FLOOR_NOISE, RELATIVE_NOISE, DepthCurve, fit_depth_curve
from palpate.fields.response_field import ContactGeometry, ResponseNodes
from palpate.fields.surface_curvature import normal_derivative

__all__ = [
    "LateralLadder",
    "PressArrays",
    "fit_nodes",
    "friction_at",
    "relative_gradient",
    "uniform_knots",
    "why_unusable",
]

LEAST_DEPTH_SHARE = 0.3
"""A press that stopped above this share of depth_max says too little about the rest."""
GRADIENT_SPREAD = (1000.0, 40.0, 40.0)
"""1/m; expected |g0|, |g1|, |g2|: no more than a stop for what the data do not determine."""


@dataclass(frozen=True)
class LateralLadder:
    """Tangential moves from one depth with sticking contact.

    Attributes:
        depth: m.
        deflection: (M, 3) m, along the surface, from the state before the move.
        force_change: (M, 3) N; force on the tool minus that before the move.
        energy_change: (M,) J; stored energy minus that before the move.
    """

    depth: float
    deflection: np.ndarray
    force_change: np.ndarray
    energy_change: np.ndarray


@dataclass(frozen=True)
class PressArrays:
    """One press as plain arrays; converged states only.

    Attributes:
        contact: (3,) m, point c on the organ's surface.
        normal: (3,) outward unit normal n; the tool moves along -n.
        depth: (K,) m, rising from 0.
        force: (K, 3) N, on the tool.
        energy: (K,) J, stored.
        lateral: lateral ladders, possibly none.
        friction_coefficient: as a sliding tool feels it; a number, or (J, 2) rows (depth m, coefficient), interpolated
            and held at its ends.
        hash: the press record's hash.
    """

    contact: np.ndarray
    normal: np.ndarray
    depth: np.ndarray
    force: np.ndarray
    energy: np.ndarray
    lateral: Sequence[LateralLadder] = field(default_factory=tuple)
    friction_coefficient: float | np.ndarray = 0.0
    hash: str = ""


def uniform_knots(depth_max: float, count: int = 13) -> np.ndarray:
    """(count,) m, shared depth knots from 0 to `depth_max`.

    Raises:
        ValueError: fewer than two knots, or no depth above 0.
    """
    if count < 2 or not 0.0 < depth_max < np.inf:
        raise ValueError(
            f"depth knots: {count} up to {depth_max:g} m; at least 2, depth 0 and a deepest one above it, are right"
        )
    return np.linspace(0.0, depth_max, count)


def why_unusable(press: PressArrays, depth_max: float) -> str | None:
    """The reason why a press cannot become a node, in words, or None when it can."""
    if press.depth.max() < LEAST_DEPTH_SHARE * depth_max:
        return f"stopped at {press.depth.max() * 1e3:.2f} mm of {depth_max * 1e3:.2f} mm"
    try:
        fit_depth_curve(press.depth, press.force @ press.normal, press.energy)
    except ValueError as reason:
        return str(reason)
    return None


def fit_nodes(
    presses: Sequence[PressArrays],
    depth_knots: np.ndarray,
    offset: float,
    geometry: ContactGeometry | None = None,
) -> ResponseNodes:
    """Node curves from presses.

    Args:
        presses: usable presses (see `why_unusable`).
        depth_knots: (K,) m, rising from 0 to the depth asked for.
        offset: rho of the tool, m.
        geometry: contact geometry; corrects k for the surface's curvature, left out when None.

    Returns:
        Nodes in the order of the presses.  Beyond a press's depth its curves follow the mean of the presses that
        got there, scaled to its own last force (the last slope where nobody did); `depth_reached` tells.
        A press without lateral ladder takes the median stiffness ratio r of the others; without any, k = 0.

    Raises:
        ValueError: no press, or an unusable one (named by its number and reason).
    """
    if not len(presses):
        raise ValueError("response nodes: no press")
    knots = np.asarray(depth_knots, dtype=float)
    for i, press in enumerate(presses):
        reason = why_unusable(press, knots[-1])
        if reason:
            raise ValueError(f"response nodes: press {i}: {reason}")
    contact = np.array([p.contact for p in presses], dtype=float)
    normal = np.array([p.normal for p in presses], dtype=float)
    curves = [fit_depth_curve(p.depth, p.force @ n, p.energy) for p, n in zip(presses, normal, strict=True)]
    reached = np.array([c.depth_reached for c in curves])
    energy, force, second = np.moveaxis(np.array([c(knots) for c in curves]), 1, 0)
    energy, force, second = continue_short_presses(knots, reached, energy, force, second)

    lateral, lateral_residual = np.zeros((len(presses), len(knots), 3)), np.zeros(len(presses))
    for i, (press, curve, n) in enumerate(zip(presses, curves, normal, strict=True)):
        lateral[i], lateral_residual[i] = fit_lateral_gradient(press, curve, n, knots, energy[i])

    ratio = stiffness_ratios(presses, curves, contact, normal, knots, offset, geometry)
    residual = np.maximum([max(c.force_residual, c.energy_residual) for c in curves], lateral_residual)
    return ResponseNodes(
        position=contact,
        normal=normal,
        depth_knots=knots,
        stored_energy=energy,
        normal_force=force,
        lateral_gradient=lateral,
        friction_stiffness=ratio * np.maximum(second, 0.0),
        friction_coefficient=np.array([friction_at(p.friction_coefficient, knots) for p in presses]),
        depth_reached=np.minimum(reached, knots[-1]),
        pressed=np.ones(len(presses), dtype=bool),
        residual=residual,
        press_hash=np.array([p.hash for p in presses], dtype=str),
    )


def continue_short_presses(
    knots: np.ndarray, reached: np.ndarray, energy: np.ndarray, force: np.ndarray, second: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Replace what lies beyond each press's depth by the mean shape of those that reached the last knot."""
    full = reached >= knots[-1] * (1 - 1e-6)
    if full.all() or not full.any():
        return energy, force, second
    shape = np.exp(np.mean(np.log(np.maximum(force[full][:, 1:], 1e-30)), axis=0))
    shape = np.concatenate([[0.0], shape])
    shape_second = np.mean(second[full] / force[full][:, -1:], axis=0) * shape[-1]
    shape_energy = np.mean(energy[full] / force[full][:, -1:], axis=0) * shape[-1]
    energy, force, second = energy.copy(), force.copy(), second.copy()
    for i in np.flatnonzero(~full):
        beyond = knots > reached[i]
        at = [np.interp(reached[i], knots, a[i]) for a in (energy, force)]
        mean = [np.interp(reached[i], knots, a) for a in (shape_energy, shape)]
        scale = at[1] / mean[1]
        force[i, beyond] = scale * shape[beyond]
        second[i, beyond] = scale * shape_second[beyond]
        energy[i, beyond] = at[0] + scale * (shape_energy[beyond] - mean[0])
    return energy, force, second


def gradient_terms(energy: np.ndarray, share: np.ndarray) -> np.ndarray:
    """(n, 3) columns Phi, Phi d/D, Phi (d/D)^2 at depths with `share` = d/D."""
    return np.stack([energy, energy * share, energy * share**2], axis=-1)


def solve_gradient_terms(terms: np.ndarray, B: np.ndarray, force: np.ndarray) -> np.ndarray:
    """(3, 3) g0..g2 from B (n, 3) N, each state weighted by the noise of its `force` (n,) N."""
    noise = RELATIVE_NOISE * np.abs(force) + FLOOR_NOISE * np.abs(force).max()
    A = np.vstack([terms / noise[:, None], np.diag(1.0 / np.array(GRADIENT_SPREAD))])
    y = np.vstack([B / noise[:, None], np.zeros((3, 3))])
    return np.linalg.lstsq(A, y, rcond=None)[0]


def fit_lateral_gradient(
    press: PressArrays, curve: DepthCurve, n: np.ndarray, knots: np.ndarray, energy: np.ndarray
) -> tuple[np.ndarray, float]:
    """B (K, 3) N at the knots, and the largest misfit as a share of the deepest force."""
    keep = press.depth > 0
    d = press.depth[keep]
    B = -(press.force[keep] - (press.force[keep] @ n)[:, None] * n)
    phi, f, _ = curve(d)
    terms = gradient_terms(phi, d / knots[-1])
    solution = solve_gradient_terms(terms, B, f)
    misfit = np.linalg.norm(terms @ solution - B, axis=1).max() / f.max()
    share = np.minimum(knots, d[-1]) / knots[-1]  # a short press does not extrapolate its polynomial
    return gradient_terms(energy, share) @ solution, float(misfit)


def relative_gradient(nodes: ResponseNodes) -> tuple[np.ndarray, np.ndarray]:
    """b = B / Phi and its slope.

    Returns:
        b: (N, K, 3) 1/m at the knots (finite at depth 0), and db/dd: (N, K, 3) 1/m^2.
    """
    share = nodes.depth_knots / nodes.depth_knots[-1]
    b, slope = np.zeros((2, nodes.node_count, len(share), 3))
    for i in range(nodes.node_count):
        terms = gradient_terms(nodes.stored_energy[i, 1:], share[1:])
        g0, g1, g2 = solve_gradient_terms(terms, nodes.lateral_gradient[i, 1:], nodes.normal_force[i, 1:])
        b[i] = g0 + share[:, None] * g1 + share[:, None] ** 2 * g2
        slope[i] = (g1 + 2 * share[:, None] * g2) / nodes.depth_knots[-1]
    return b, slope


def stiffness_ratios(
    presses: Sequence[PressArrays],
    curves: Sequence[DepthCurve],
    contact: np.ndarray,
    normal: np.ndarray,
    knots: np.ndarray,
    offset: float,
    geometry: ContactGeometry | None,
) -> np.ndarray:
    """r (N, K) at the knots, linear between the lateral ladders' depths, held beyond them."""
    ratio = np.full((len(presses), len(knots)), np.nan)
    for i, (press, curve) in enumerate(zip(presses, curves, strict=True)):
        found = []
        for ladder in sorted(press.lateral, key=lambda item: item.depth):
            s = np.asarray(ladder.deflection, dtype=float)
            s = s - (s @ normal[i])[:, None] * normal[i]
            pull = -np.sum(np.asarray(ladder.force_change) * s, axis=1)  # = k s^2 in total
            square = np.sum(s * s)
            _, f, second = curve(np.array([ladder.depth]))
            stiffness = pull.sum() / square
            if geometry is not None:
                q = contact[i] + (offset - ladder.depth) * normal[i]
                H = normal_derivative(geometry, q[None])[0]
                stiffness += f[0] * np.einsum("ma,ab,mb->", s, H, s) / square
            if stiffness > 0 and second[0] > 0:
                found.append((ladder.depth, stiffness / second[0]))
        if found:
            ratio[i] = np.interp(knots, *np.array(found).T)
    missing = np.isnan(ratio[:, 0])
    ratio[missing] = 0.0 if missing.all() else np.median(ratio[~missing], axis=0)
    return ratio


def friction_at(coefficient: float | np.ndarray, knots: np.ndarray) -> np.ndarray:
    """mu (K,) from a number or (J, 2) rows (depth, coefficient).

    Raises:
        ValueError: a coefficient is negative or not finite.
    """
    table = np.asarray(coefficient, dtype=float)
    if not np.all(table >= 0.0):
        raise ValueError(f"response nodes: friction coefficients {table.tolist()}; none below 0 is right")
    return (
        np.full(len(knots), float(table)) if table.ndim == 0 else np.interp(knots, table[:, 0], table[:, 1])
    )
