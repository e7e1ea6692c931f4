# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Eigenvalues and eigenvectors of a symmetric 3 x 3 matrix in float64, as a Warp function.

Cyclic Jacobi rotations (Golub and Van Loan, Matrix Computations, 2013, section 8.5): slower than a closed
form, but accurate to rounding and orthogonal to rounding for any gap between eigenvalues, zero included.
"""

from __future__ import annotations

import warp as wp

__all__ = ["Frame", "principal_frame"]

ROTATED_AWAY = wp.constant(wp.float64(1e-34))
"""Squared off-diagonal part over squared diagonal at which rotations stop: below the square of rounding."""

SWEEPS = wp.constant(12)
"""Three to five are used; convergence is quadratic."""


@wp.struct
class Frame:
    """G = axes diag(values) axes^T; eigenvectors are the columns of `axes`."""

    values: wp.vec3d
    axes: wp.mat33d


@wp.func
def principal_frame(symmetric: wp.mat33d) -> Frame:
    """Eigenvalues, in no order, with orthonormal eigenvectors."""
    zero = wp.float64(0.0)
    one = wp.float64(1.0)
    G = wp.mat33d()
    G += symmetric
    V = wp.identity(n=3, dtype=wp.float64)
    for _ in range(SWEEPS):
        off = G[0, 1] * G[0, 1] + G[0, 2] * G[0, 2] + G[1, 2] * G[1, 2]
        on = G[0, 0] * G[0, 0] + G[1, 1] * G[1, 1] + G[2, 2] * G[2, 2]
        if off > ROTATED_AWAY * on:
            for r in range(3):
                p = (r + 1) % 3
                q = (r + 2) % 3
                g = G[p, q]
                if g != zero:
                    cot = (G[q, q] - G[p, p]) / (wp.float64(2.0) * g)  # of twice the angle
                    t = one / (wp.abs(cot) + wp.sqrt(cot * cot + one))
                    if cot < zero:
                        t = -t
                    c = one / wp.sqrt(t * t + one)
                    s = t * c
                    G[p, p] = G[p, p] - t * g
                    G[q, q] = G[q, q] + t * g
                    G[p, q] = zero
                    G[q, p] = zero
                    g_p = G[r, p]
                    g_q = G[r, q]
                    G[r, p] = c * g_p - s * g_q
                    G[r, q] = s * g_p + c * g_q
                    G[p, r] = G[r, p]
                    G[q, r] = G[r, q]
                    for i in range(3):
                        v_p = V[i, p]
                        v_q = V[i, q]
                        V[i, p] = c * v_p - s * v_q
                        V[i, q] = s * v_p + c * v_q
    frame = Frame()
    frame.values = wp.vec3d(G[0, 0], G[1, 1], G[2, 2])
    frame.axes = V
    return frame
