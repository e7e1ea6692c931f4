# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Functions of numbers near one, exact to rounding: Warp has no expm1, log1p, nor det F - 1.

expm1 and log1p after Kahan (Higham, Accuracy and Stability of Numerical Algorithms, 2002, section 1.14.1): the
rounding of u = exp(x) or u = 1 + x is undone by a quotient in which it appears twice.
"""

from __future__ import annotations

import warp as wp

__all__ = ["expm1", "jacobian_less_one", "log1p"]


@wp.func
def expm1(x: wp.float64) -> wp.float64:
    """exp(x) - 1."""
    one = wp.float64(1.0)
    u = wp.exp(x)
    result = u - one
    if wp.abs(x) < one and u != one:
        result = (u - one) * x / wp.log(u)
    if u == one:
        result = x
    return result


@wp.func
def log1p(x: wp.float64) -> wp.float64:
    """ln(1 + x)."""
    one = wp.float64(1.0)
    u = one + x
    if u == one:
        return x
    return wp.log(u) * x / (u - one)


@wp.func
def jacobian_less_one(F: wp.mat33d) -> wp.float64:
    """det F - 1 = tr D + (tr^2 D - tr D D)/2 + det D,  D = F - 1."""
    D = F - wp.identity(n=3, dtype=wp.float64)
    trace = wp.trace(D)
    second = wp.float64(0.5) * (trace * trace - wp.ddot(D, wp.transpose(D)))
    return trace + second + wp.determinant(D)
