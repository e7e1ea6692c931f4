# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Quadrature of any order on triangles and tetrahedra: the elements' own rule must not judge them.

A product of Gauss-Jacobi rules on the collapsed cube (Stroud, Approximate Calculation of Multiple Integrals, 1971,
section 2.4): n points each way are exact to degree 2 n - 1.
"""

from __future__ import annotations

import numpy as np
from scipy.special import roots_jacobi

__all__ = ["simplex_rule"]


def simplex_rule(dimension: int, n: int) -> tuple[np.ndarray, np.ndarray]:
    """(barycentric points (n^dimension, dimension + 1), weights that add up to one)."""
    rest = np.ones(1)  # what the coordinates chosen so far leave of 1
    weight = np.ones(1)
    coordinates = np.zeros((1, 0))
    for left in range(dimension - 1, -1, -1):
        x, w = roots_jacobi(n, left, 0)  # weight (1 - x)^left: the simplex narrows
        x = 0.5 * (1.0 + x)
        weight = np.outer(weight, w / w.sum()).ravel()
        new = np.outer(rest, x).ravel()
        coordinates = np.column_stack([np.repeat(coordinates, n, axis=0), new])
        rest = np.outer(rest, 1.0 - x).ravel()
    return np.column_stack([coordinates, rest]), weight
