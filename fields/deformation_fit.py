# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""From the surface displacements of presses to `Deformation`: profiles, shared tables, kriged amplitudes.

1. Each press, at each depth, becomes profiles of R by least squares over its surface points: 2 of harmonic 0, 3 along
   each tangent of harmonic 1, 3 for each of the two traceless tangent tensors of harmonic 2.  Second differences along
   R are held small where points are few, and values where there are none.
2. A singular value decomposition over all presses leaves a few shared tables for each harmonic (Eckart and Young,
   1936), each press weighing the same.
3. Amplitudes are kriged; the covariance's length is the one that predicts left-out presses best (Dubrule 1983).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from palpate.fields.deformation import (
    COMPONENTS,
    SQRT5,
    Deformation,
    ToolGap,
    knots,
    local_axes,
    radial_weights,
)
from palpate.fields.field_error import FieldError

__all__ = ["SurfacePress", "fit_deformation"]

RADIAL_KNOTS = 48
SMOOTHING, HOLD = 1e-3, 1e-9
"""Weights of second differences and of values against one point; only where points are silent."""
LEVEL = 1.0
"""Weight of the first difference of what is even in R, at R = 0."""
TABLES_LOSE = 0.003
"""Share of the deepest displacement (root of squares) that shared tables may lose of a harmonic's sum."""
RANK_LIMITS = (6, 4, 3)
LENGTHS = (8e-3, 12e-3, 18e-3, 27e-3, 40e-3, 60e-3, 90e-3, 150e-3)
"""m."""
NOISE = 1e-4
"""Of an amplitude's variance; presses at neighbouring places have other meshes."""
NORMAL_LENGTH = 20e-3
"""m a unit of normal, as in the response's kriging."""
ENDS = 0.7
"""Share of the radius from which tables fall to zero."""


@dataclass(frozen=True)
class SurfacePress:
    """What a press says of the surface.

    Attributes:
        contact_point, normal: (3,) m, (3,).
        depth: (K,) m, even steps from 0.
        point: (V, 3) m at rest.  displacement: (K, V, 3) m.
        stuck_depth: (S,) m, among `depth`.  stuck: (S, V, 3, 3); displacement over the tool's tangential move.
    """

    contact_point: np.ndarray
    normal: np.ndarray
    depth: np.ndarray
    point: np.ndarray
    displacement: np.ndarray
    stuck_depth: np.ndarray
    stuck: np.ndarray


def fit_deformation(
    presses: Sequence[SurfacePress], scale: float, radius: float, gap: ToolGap, harmonics: int = 3
) -> Deformation:
    """The deformation that `presses` tell of.

    Args:
        scale: m; about the contact's radius.  radius: m; beyond it nothing moves.
        gap: of the tool.
        harmonics: how many are used (1 to 3); fewer only for comparison.

    Raises:
        FieldError: no press, or presses at different depths.
    """
    if not presses:
        raise FieldError("deformation: no press reached all depths; at least one is needed")
    depth = presses[0].depth
    if any(len(p.depth) != len(depth) or not np.allclose(p.depth, depth, rtol=1e-9, atol=0) for p in presses):
        raise FieldError("deformation: presses at different depths; one ladder for all is right")
    K, J = len(depth), RADIAL_KNOTS
    solved = [_profiles(p, scale, radius, harmonics) for p in presses]
    tables, amplitudes = [], []
    deepest = np.sqrt(sum(np.sum(s[0][-1] ** 2) for s in solved) / len(solved))
    for h in range(3):
        rows = np.array([s[h] for s in solved])  # (N, K, J, components, copies)
        copies = rows.shape[-1]
        flat = np.moveaxis(rows, -1, 1).reshape(-1, K * J * COMPONENTS[h])
        rank = 0 if h >= harmonics else _rank(flat, TABLES_LOSE * deepest * np.sqrt(K), RANK_LIMITS[h])
        left, size, right = np.linalg.svd(flat, full_matrices=False)
        tables.append((size[:rank, None] * right[:rank]).reshape(rank, K, J, COMPONENTS[h]))
        amplitudes.append(left[:, :rank].reshape(len(presses), copies, rank))
    columns = _columns(presses, amplitudes)
    node = np.array([p.contact_point for p in presses])
    normal = np.array([p.normal for p in presses])
    r0 = len(tables[0])
    mean = np.concatenate([columns[:, :r0].mean(axis=0), np.zeros(columns.shape[1] - r0)])
    size = [np.sqrt(np.sum(t**2, axis=(1, 2, 3))) for t in tables]
    weigh = np.concatenate([size[0], np.repeat(size[1], 3), np.repeat(size[2], 6)])
    lengths, weights, begin = [], [], 0
    for table, copies in zip(tables, (1, 3, 6), strict=True):
        own = slice(begin, begin := begin + copies * len(table))
        length, weight = _kriged(node, normal, (columns - mean)[:, own], weigh[own])
        lengths.append(length)
        weights.append(weight)
    return Deformation(
        float(depth[-1]), scale, radius, (tables[0], tables[1], tables[2]),
        np.mean([s[3] for s in solved], axis=0), node, normal, (lengths[0], lengths[1], lengths[2]),
        NORMAL_LENGTH, mean[:r0], np.concatenate(weights, axis=1), gap,
    )  # fmt: skip


def _profiles(press: SurfacePress, scale: float, radius: float, harmonics: int):
    """Tables (K, J, components, copies) of harmonics 0, 1, 2, and (K, J, 3) of the stuck tool."""
    c, n, J = press.contact_point, press.normal, RADIAL_KNOTS
    use = np.linalg.norm(press.point - c, axis=1) < radius
    points = press.point[use]
    R, t, b, w = local_axes(points, c, n)
    seen = w > 0.0
    R, t, b, w, use = R[seen], t[seen], b[seen], w[seen], np.flatnonzero(use)[seen]
    j, weights = radial_weights(R, scale, radius, J)
    radial = np.zeros((len(R), J + 2))
    np.put_along_axis(radial, j, weights, axis=1)
    radial[:, 1] += 2.0 * radial[:, 0]
    radial[:, 2] -= radial[:, 0]
    radial = radial[:, 1:-1]
    e1, e2 = _frame(n)
    one = np.ones(len(R))
    cases = [[(one, n), (one, t)], *([(t @ e, n), (t @ e, t), (one, e)] for e in (e1, e2))]
    for G in _tensors(e1, e2):
        tGt = np.einsum("vx,xy,vy->v", t, G, t)
        cases.append([(tGt, n), (tGt, t), (np.einsum("vx,xy,vy->v", b, G, t), b)])
    area = np.sqrt(
        _area(R)
    )  # points are dense around the contact; every ring counts by its width, not by its points

    def matrix(cases):
        """(3 V, J) of each function: rows x, y, z of each point."""
        columns = []
        for value, direction in (pair for case in cases for pair in case):
            towards = np.broadcast_to(direction, t.shape)
            column = (area * w * value)[:, None, None] * towards[:, :, None] * radial[:, None, :]
            columns.append(column.reshape(-1, J))
        return columns

    at = knots(scale, radius, J)
    fade = _fade(at / radius)
    reach = float(R.max())
    cases = cases[: (1, 3, 5)[harmonics - 1]]
    blocks = matrix(cases)
    right = press.displacement[:, use].astype(float)
    right = (area[None, :, None] * right).reshape(len(right), -1).T
    # what depends on t has nowhere to point to at R = 0 and is zero there
    zero = [
        not ((i == 0 and k == 0) or (i in (1, 2) and k == 2))
        for i, case in enumerate(cases)
        for k in range(len(case))
    ]
    solution = _solved(blocks, right, zero, at, reach)
    tables = [
        np.zeros((len(press.depth), J, 2, 1)),
        np.zeros((len(press.depth), J, 3, 2)),
        np.zeros((len(press.depth), J, 3, 2)),
    ]
    tables[0][:, :, 0, 0], tables[0][:, :, 1, 0] = solution[0], solution[1]
    place = 2
    for h in range(1, harmonics):
        for copy in range(2):
            for k in range(3):
                tables[h][:, :, k, copy] = solution[place]
                place += 1
    for table in tables:
        table *= fade[None, :, None, None]
    return *tables, _stuck(press, use, n, t, (e1, e2), matrix, area, at, reach) * fade[None, :, None]


def _stuck(press, use, n, t, tangents, matrix, area, at, reach):
    """(K, J, 3): one profile for both tangents, at the depths that are known; between and before, linear."""
    known = []
    for stuck in press.stuck:
        both = [matrix([[(t @ e, n), (t @ e, t), (np.ones(len(t)), e)]]) for e in tangents]
        blocks = [np.concatenate(pair) for pair in zip(*both, strict=True)]
        right = [(area[:, None] * (stuck[use].astype(float) @ e)).reshape(-1, 1) for e in tangents]
        solution = _solved(blocks, np.concatenate(right), [True, True, False], at, reach)
        known.append(np.stack([s[0] for s in solution], axis=-1))
    out = np.zeros((len(press.depth), len(at), 3))
    if known:
        first = np.concatenate([[0.0], press.stuck_depth])
        values = np.concatenate([np.zeros((1, len(at), 3)), known])
        for j in range(len(at)):
            for k in range(3):
                out[:, j, k] = np.interp(press.depth, first, values[:, j, k])
    return out


def _solved(blocks, right, at_zero, at, reach):
    """(len(blocks), K, J): least squares of right (rows, K)."""
    J = len(at)
    A = np.concatenate(blocks, axis=1)
    normal = A.T @ A
    load = A.T @ right
    second = np.diff(np.eye(J), 2, axis=0)
    ridge = np.diag(np.where(at > reach, 1.0, HOLD))
    rule = SMOOTHING * second.T @ second + ridge
    unit = np.trace(normal) / len(normal)
    level = np.zeros((J, J))
    level[:2, :2] = LEVEL * np.array(
        [[1.0, -1.0], [-1.0, 1.0]]
    )  # few points tell what is right below the tool
    for i, vanishes in enumerate(at_zero):
        normal[i * J : (i + 1) * J, i * J : (i + 1) * J] += unit * (rule if vanishes else rule + level)
    zero = [i * J for i, vanishes in enumerate(at_zero) if vanishes]
    keep = np.setdiff1d(np.arange(len(normal)), zero)
    out = np.zeros_like(load)
    out[keep] = cho_solve(cho_factor(normal[np.ix_(keep, keep)]), load[keep])
    return np.moveaxis(out.reshape(len(blocks), J, -1), 2, 1)


def _area(R: np.ndarray) -> np.ndarray:
    """(V,) about 1 over how many points share a ring."""
    edges = np.linspace(0.0, R.max() * (1 + 1e-9), 40)
    ring = np.digitize(R, edges)
    count = np.bincount(ring, minlength=ring.max() + 1)
    return 1.0 / count[ring]


def _fade(x: np.ndarray) -> np.ndarray:
    y = np.clip((1.0 - x) / (1.0 - ENDS), 0.0, 1.0)
    out = y * y * (3.0 - 2.0 * y)
    out[-2:] = 0.0
    return out


def _frame(n: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    axis = np.eye(3)[np.argmin(np.abs(n))]
    first = axis - (axis @ n) * n
    first /= np.linalg.norm(first)
    return first, np.cross(n, first)


def _tensors(e1: np.ndarray, e2: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.outer(e1, e1) - np.outer(e2, e2), np.outer(e1, e2) + np.outer(e2, e1)


def _rank(flat: np.ndarray, lose: float, limit: int) -> int:
    """Fewest singular values that leave at most `lose` (root of the mean over rows of squares)."""
    size = np.linalg.svd(flat, compute_uv=False)
    left = np.sqrt(np.concatenate([np.cumsum(size[::-1] ** 2)[::-1], [0.0]]) / len(flat))
    return min(limit, int(np.argmax(left <= lose)))


def _columns(presses: Sequence[SurfacePress], amplitudes: list[np.ndarray]) -> np.ndarray:
    """(N, C) amplitudes in the organ's axes."""
    out = []
    for i, press in enumerate(presses):
        e1, e2 = _frame(press.normal)
        g = np.einsum("cr,cx->rx", amplitudes[1][i], np.stack([e1, e2]))
        G = np.einsum("cr,cxy->rxy", amplitudes[2][i], np.stack(_tensors(e1, e2)))
        six = np.stack([G[:, 0, 0], G[:, 1, 1], G[:, 2, 2], G[:, 1, 2], G[:, 0, 2], G[:, 0, 1]], axis=1)
        out.append(np.concatenate([amplitudes[0][i].ravel(), g.ravel(), six.ravel()]))
    return np.array(out)


def _kriged(node, normal, values, weigh) -> tuple[float, np.ndarray]:
    """Length (m) and weights (N, C)."""
    z = np.concatenate([node, NORMAL_LENGTH * normal], axis=1)
    distance = np.linalg.norm(z[:, None] - z[None], axis=2)
    best = (np.inf, LENGTHS[0])
    for length in LENGTHS:
        inverse = np.linalg.inv(_covariance(distance, length))
        left_out = (inverse @ values) / np.diag(inverse)[:, None]
        best = min(best, (float(np.sum((left_out * weigh) ** 2)), length))
    return best[1], np.linalg.solve(_covariance(distance, best[1]), values)


def _covariance(distance: np.ndarray, length: float) -> np.ndarray:
    h = SQRT5 * distance / length
    return (1.0 + h + h * h / 3.0) * np.exp(-h) + NOISE * np.eye(len(distance))
