# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Even triangles on an implicit surface f(x) = 0, f > 0 outside: surface nets, projection, relaxation.

One vertex in each grid cell that the surface crosses, one quad around each grid edge that it crosses (Gibson,
Constrained Elastic Surface Nets, 1998); then each vertex alternately slides towards its neighbours' middle
and steps back onto the surface, x <- x - f grad f / |grad f|^2.  NumPy alone, no random numbers: the same
everywhere up to the last bits of the elementary functions.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

__all__ = ["surface_net"]

Implicit = Callable[[np.ndarray], np.ndarray]
"""(n, 3) m -> (n,) m, positive outside, close to a signed distance near the surface."""

_GRADIENT_STEP = 1e-6
"""m; central differences of f."""


def surface_net(
    f: Implicit, low: np.ndarray, high: np.ndarray, spacing: float, passes: int = 30
) -> tuple[np.ndarray, np.ndarray]:
    """The surface inside a box as vertices (V, 3) m and outward triangles (F, 3) int32.

    low, high (3,) m: a box that holds the whole surface; spacing m: the grid's, about the length of the
    edges.

    Raises:
        ValueError: the surface leaves the box, or does not meet the grid.
    """
    counts = np.ceil((np.asarray(high) - low) / spacing).astype(int) + 1
    index = np.stack(np.meshgrid(*[np.arange(n) for n in counts], indexing="ij"), axis=-1)
    inside = (f(low + spacing * index.reshape(-1, 3)) < 0.0).reshape(counts)
    faces = [inside.take(i, axis=k) for k in range(3) for i in (0, -1)]
    if any(face.any() for face in faces) or not inside.any():
        raise ValueError("the surface does not lie within its box")
    corners = sum(
        inside[a : counts[0] - 1 + a, b : counts[1] - 1 + b, c : counts[2] - 1 + c].astype(int)
        for a in (0, 1)
        for b in (0, 1)
        for c in (0, 1)
    )
    cells = np.argwhere((corners > 0) & (corners < 8))
    number = np.full(counts - 1, -1)
    number[tuple(cells.T)] = np.arange(len(cells))
    quads = np.concatenate([_quads(inside, number, axis) for axis in range(3)])
    x = low + spacing * (cells + 0.5)
    first, second = quads[:, [0, 1, 1, 2, 2, 3, 3, 0]].ravel(), quads[:, [1, 0, 2, 1, 3, 2, 0, 3]].ravel()
    degree = np.bincount(first, minlength=len(x))[:, None]
    for _ in range(passes):
        mean = np.stack([np.bincount(first, x[second, k], len(x)) for k in range(3)], axis=1) / degree
        x = _onto(f, 0.5 * (x + mean), 0.5 * spacing)
    for _ in range(3):
        x = _onto(f, x, 0.5 * spacing)
    return x, _split(x, quads)


def _quads(inside: np.ndarray, number: np.ndarray, axis: int) -> np.ndarray:
    """(Q, 4) cells around each grid edge along `axis` that the surface crosses, outward."""
    ahead = np.moveaxis(inside, axis, 0)
    here, there = ahead[:-1], ahead[1:]
    turned = np.moveaxis(number, axis, 0)  # cyclic order of the two other axes decides the sense of rotation
    crossed = np.argwhere(here != there)
    i, j, k = crossed.T
    around = np.stack(
        [turned[i, j - 1, k - 1], turned[i, j, k - 1], turned[i, j, k], turned[i, j - 1, k]], axis=1
    )
    leaves = here[i, j, k]  # inside here, outside there: the outward direction is +axis
    if axis == 1:  # (x, z) after y is a left-handed pair
        leaves = ~leaves
    return np.where(leaves[:, None], around, around[:, ::-1])


def _gradient(f: Implicit, x: np.ndarray) -> np.ndarray:
    step = _GRADIENT_STEP * np.eye(3)
    return np.stack([f(x + e) - f(x - e) for e in step], axis=1) / (2 * _GRADIENT_STEP)


def _onto(f: Implicit, x: np.ndarray, longest: float) -> np.ndarray:
    """One Newton step towards f = 0, at most `longest` (m)."""
    gradient = _gradient(f, x)
    step = -(f(x) / np.maximum(np.sum(gradient**2, axis=1), 1e-6))[:, None] * gradient
    length = np.linalg.norm(step, axis=1, keepdims=True)
    return x + step * np.minimum(1.0, longest / np.maximum(length, 1e-300))


def _split(x: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Each quad in two along its shorter diagonal."""
    a, b, c, d = quads.T
    short = np.linalg.norm(x[a] - x[c], axis=1) <= np.linalg.norm(x[b] - x[d], axis=1) * (1 + 1e-6)
    first = np.where(short[:, None], quads[:, [0, 1, 2]], quads[:, [0, 1, 3]])
    second = np.where(short[:, None], quads[:, [0, 2, 3]], quads[:, [1, 2, 3]])
    return np.concatenate([first, second]).astype(np.int32)
