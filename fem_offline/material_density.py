# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""One material at many deformation gradients, in NumPy arrays: the kernels' own functions, for tests and checks."""

from __future__ import annotations

import numpy as np
import warp as wp

from palpate.fem_offline import constitutive as law
from palpate.fem_offline import material_table as t
from palpate.fem_offline.material_table import Tabulated, material_table
from palpate.fem_offline.tensor4 import mat9x9
from palpate.fem_offline.warp_session import start_warp

__all__ = ["density"]

wp.set_module_options({"enable_backward": False, "max_unroll": 1})


@wp.kernel
def evaluate(
    F: wp.array(dtype=wp.mat33d),
    table: wp.array2d(dtype=wp.float64),
    # outputs
    energy: wp.array(dtype=wp.float64),
    stress: wp.array(dtype=wp.mat33d),
    tangent: wp.array(dtype=mat9x9),
):
    i = wp.tid()
    kappa = table[0, t.KAPPA_FULL] + table[0, t.KAPPA_MEAN]
    psi, P = law.isochoric(F[i], table, 0)
    psi_vol, P_vol = law.volumetric(F[i], table, 0, kappa)
    energy[i] = psi + psi_vol
    stress[i] = P + P_vol
    tangent[i] = law.isochoric_tangent(F[i], table, 0) + law.volumetric_tangent(F[i], table, 0, kappa)


def density(
    material: Tabulated, F: np.ndarray, volumetric: bool = True
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Energy density, stress and tangent of a material.

    Args:
        F: (n, 3, 3) deformation gradients, det F > 0.
        volumetric: False leaves out the volumetric part.

    Returns:
        psi (n,) J/m3; P = d psi / dF (n, 3, 3) Pa; A (n, 3, 3, 3, 3) Pa, A[i, k, j, l] = d P_ik / d F_jl.
    """
    start_warp()
    F = np.ascontiguousarray(F, float)
    table = material_table([material])
    if not volumetric:
        table[:, [t.KAPPA_FULL, t.KAPPA_MEAN]] = 0.0
    kinds = (wp.float64, wp.mat33d, mat9x9)
    outputs = [wp.zeros(len(F), dtype=kind, device="cpu") for kind in kinds]
    inputs = [wp.array(F, dtype=wp.mat33d, device="cpu"), wp.array(table, dtype=wp.float64, device="cpu")]
    wp.launch(evaluate, dim=len(F), inputs=inputs, outputs=outputs, device="cpu")
    psi, P, A = (array.numpy() for array in outputs)
    return psi, P, A.reshape(-1, 3, 3, 3, 3)
