# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Preconditioned GMRES for matrices that are nearly, but not, symmetric.

(Saad and Schultz, SIAM J. Sci. Stat. Comput. 7:856-869, 1986; right preconditioning, so that the residual that is
watched is the true one: Saad, Iterative Methods for Sparse Linear Systems, 2003, algorithm 9.5.)
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from palpate.fem_offline.conjugate_gradients import StaleError

__all__ = ["gmres"]


def gmres(
    apply: Callable[[np.ndarray], np.ndarray],
    precondition: Callable[[np.ndarray], np.ndarray],
    b: np.ndarray,
    tolerance: float,
    iterations_max: int,
) -> np.ndarray:
    """Solve A x = b (n,) to a reduction `tolerance` of the residual's 2-norm, without restarts.

    Raises:
        StaleError: not reached in `iterations_max` iterations.
    """
    beta = float(np.linalg.norm(b))
    if beta == 0.0:
        return np.zeros_like(b)
    basis, directions = [b / beta], []
    H = np.zeros((iterations_max + 1, iterations_max))
    for j in range(iterations_max):
        directions.append(precondition(basis[j]))
        w = apply(directions[j])
        for i in range(j + 1):
            H[i, j] = float(basis[i] @ w)
            w = w - H[i, j] * basis[i]
        H[j + 1, j] = float(np.linalg.norm(w))
        e = np.zeros(j + 2)
        e[0] = beta
        y = np.linalg.lstsq(H[: j + 2, : j + 1], e, rcond=None)[0]
        if np.linalg.norm(H[: j + 2, : j + 1] @ y - e) <= tolerance * beta:
            return np.einsum("k,kn->n", y, np.array(directions))
        basis.append(w / max(H[j + 1, j], 1e-300))
    raise StaleError(f"{iterations_max} iterations did not reach {tolerance:g}")
