# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Fourth-order tensors as 9 x 9 matrices: A[3 i + k, 3 j + l] = A_ikjl, so that dP_ik = A_ikjl dF_jl."""

from __future__ import annotations

import warp as wp

__all__ = ["applied", "inverse_transpose", "mat9x9"]

mat9x9 = wp.types.matrix(shape=(9, 9), dtype=wp.float64)


@wp.func
def inverse_transpose(F: wp.mat33d) -> wp.mat33d:
    """F^-T."""
    return wp.transpose(wp.inverse(F))


@wp.func
def applied(A: mat9x9, H: wp.mat33d) -> wp.mat33d:
    """A : H."""
    out = wp.mat33d()
    for i in range(3):
        for k in range(3):
            total = wp.float64(0.0)
            for j in range(3):
                for l in range(3):
                    total += A[3 * i + k, 3 * j + l] * H[j, l]
            out[i, k] = total
    return out
