# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Every objective model as a function of three logarithmic stretches, in NumPy: a second, short statement of the laws.

With x_a the logarithms of the principal stretches and y = dev x their isochoric part,

    I1bar = sum exp(2 y_a),   I2bar = sum exp(-2 y_a),   Ogden's sums are of exp(alpha y_a)
    tau_a = d psi / d x_a   (the isochoric principal Kirchhoff stresses),   h_ab = d^2 psi / d x_a d x_b

Used where a closed form or a scan of many states is wanted; the finite elements use the Warp functions
(constitutive.py), which know nothing of this file.
"""

from __future__ import annotations

import numpy as np

from palpate.fem_offline.material_table import LINEAR, OGDEN, VERONDA_WESTMANN, Tabulated

__all__ = ["principal_energy"]

DEVIATOR = np.eye(3) - 1.0 / 3.0


def principal_energy(material: Tabulated, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Isochoric energy density and its derivatives.

    Args:
        x: (n, 3) logarithms of the principal stretches.

    Returns:
        psi (n,), tau (n, 3), h (n, 3, 3), all Pa.

    Raises:
        ValueError: a linear material, whose energy is no function of stretches.
    """
    if material.model == LINEAR:
        raise ValueError("a linear material's energy depends on rotation, not on stretches alone")
    y = np.asarray(x, float) @ DEVIATOR
    if material.model == OGDEN:
        psi, slope, curvature = _ogden(np.reshape(material.constants, (-1, 2)), y)
    else:
        psi, slope, curvature = _of_invariants(material, y)
    return psi, slope @ DEVIATOR, DEVIATOR @ curvature @ DEVIATOR


def _ogden(terms: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    mu, alpha = terms.T
    powers = np.expm1(y[:, :, None] * alpha)  # (n, 3, terms)
    psi = (powers.sum(axis=1) * (2.0 * mu / alpha**2)).sum(axis=1)
    slope = (powers * (2.0 * mu / alpha)).sum(axis=2)  # up to a constant in a, which the deviator removes
    curvature = ((powers + 1.0) * (2.0 * mu)).sum(axis=2)
    return psi, slope, curvature[:, :, None] * np.eye(3)


def _of_invariants(material: Tabulated, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    up, down = np.exp(2.0 * y), np.exp(-2.0 * y)
    a, b = np.expm1(2.0 * y).sum(axis=1), np.expm1(-2.0 * y).sum(axis=1)
    if material.model == VERONDA_WESTMANN:
        c1, c2 = material.constants
        psi = c1 * np.expm1(c2 * a) - 0.5 * c1 * c2 * b
        d1, d2, d11 = c1 * c2 * np.exp(c2 * a), -0.5 * c1 * c2, c1 * c2**2 * np.exp(c2 * a)
    else:
        c10, c01, c20, c30 = material.constants
        psi = c10 * a + c01 * b + c20 * a**2 + c30 * a**3
        d1, d2, d11 = c10 + 2.0 * c20 * a + 3.0 * c30 * a**2, c01, 2.0 * c20 + 6.0 * c30 * a
    g1 = 2.0 * up
    slope = d1[:, None] * g1 - 2.0 * d2 * down
    diagonal = 4.0 * (d1[:, None] * up + d2 * down)
    return psi, slope, d11[:, None, None] * g1[:, :, None] * g1[:, None, :] + diagonal[:, :, None] * np.eye(3)
