# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Preconditioned conjugate gradients that refuse a matrix which is not positive definite.

(Hestenes and Stiefel 1952; Nocedal and Wright, Numerical Optimization, 2006, algorithm 5.3.)  The preconditioners
here are Cholesky factors of nearby states, so a handful of iterations do; more means that the factor is stale.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

__all__ = ["NegativeCurvatureError", "StaleError", "conjugate_gradients"]


class NegativeCurvatureError(ArithmeticError):
    """A direction was met in which the matrix is not positive."""


class StaleError(ArithmeticError):
    """The iteration limit was met: the preconditioner is too far from the matrix."""


def conjugate_gradients(
    apply: Callable[[np.ndarray], np.ndarray],
    precondition: Callable[[np.ndarray], np.ndarray],
    b: np.ndarray,
    tolerance: float,
    iterations_max: int,
) -> np.ndarray:
    """Solve A x = b to a reduction `tolerance` of the preconditioned residual norm.

    Raises:
        NegativeCurvatureError: p . A p <= 0 for some direction p.
        StaleError: not reached in `iterations_max` iterations.
    """
    x = np.zeros_like(b)
    r = b.copy()
    z = precondition(r)
    p = z.copy()
    rz = start = float(r @ z)
    if start == 0.0:
        return x
    for _ in range(iterations_max):
        Ap = apply(p)
        curvature = float(p @ Ap)
        if curvature <= 0.0:
            raise NegativeCurvatureError("the Hessian is not positive definite")
        step = rz / curvature
        x += step * p
        r -= step * Ap
        z = precondition(r)
        after = float(r @ z)
        if after <= tolerance**2 * start:
            return x
        p = z + (after / rz) * p
        rz = after
    raise StaleError(f"{iterations_max} iterations did not reach {tolerance:g}")
