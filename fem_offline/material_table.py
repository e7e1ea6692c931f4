# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Materials as rows of numbers, which is what Warp kernels take.

    column   0      1           2             3           4 ...
             model  kappa_full  kappa_mean  term count  constants
             (-)    Pa          Pa            (-)         of the model

The volumetric part is split for quadratic tetrahedra: a share `kappa_full` of the order of mu is integrated at the
same four points as the isochoric part, the rest acts on the element's mean volume (mean_dilatation.py).  Without that
share an element has 4 x 5 + 1 = 21 strain measures for 24 deforming modes; with kappa alone at four points it locks.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
import warp as wp

__all__ = [
    "CONSTANTS",
    "FULL_SHARE",
    "KAPPA_FULL",
    "KAPPA_MEAN",
    "LINEAR",
    "MODEL",
    "OGDEN",
    "POLYNOMIAL",
    "TERM_COUNT",
    "VERONDA_WESTMANN",
    "Tabulated",
    "kappa_split",
    "material_table",
]

MODEL, KAPPA_FULL, KAPPA_MEAN, TERM_COUNT, CONSTANTS = (wp.constant(k) for k in range(5))
"""Columns of a material table."""

LINEAR, POLYNOMIAL, VERONDA_WESTMANN, OGDEN = (wp.constant(k) for k in range(4))
"""Values of the column MODEL."""

FULL_SHARE = 2.0
"""kappa_full over mu.  Measured on a ball over a thin soft layer (5 mm ball, 4 mm deep, a stiff nodule 6.5 mm down):
with 1, elements hourglassed (smallest J 0.55 at 4 mm); with 2 it stays at 0.85, with 4 at 0.80.  Force on the same
coarse mesh rises by 0.2 % from 1 to 2, 0.5 % to 4, 0.8 % to 8: the locking that full integration would bring."""


class Tabulated(Protocol):
    """What a material tells its row of the table."""

    @property
    def model(self) -> int:
        """One of LINEAR, POLYNOMIAL, VERONDA_WESTMANN, OGDEN."""
        ...

    @property
    def constants(self) -> tuple[float, ...]:
        """What the model's Warp functions read from CONSTANTS on."""
        ...

    @property
    def shear_modulus(self) -> float: ...

    @property
    def bulk_modulus(self) -> float: ...


def kappa_split(material: Tabulated, full_share: float = FULL_SHARE) -> tuple[float, float]:
    """(kappa_full, kappa_mean), Pa; full_share = inf integrates all of kappa at four points."""
    kappa = material.bulk_modulus
    full = min(full_share * material.shear_modulus, kappa)
    return full, kappa - full


def material_table(materials: Sequence[Tabulated], full_share: float = FULL_SHARE) -> np.ndarray:
    """(M, C) float64, one row for each material, padded with zeros."""
    width = max(len(material.constants) for material in materials)
    table = np.zeros((len(materials), int(CONSTANTS) + width))
    for row, material in zip(table, materials, strict=True):
        row[MODEL] = material.model
        row[KAPPA_FULL], row[KAPPA_MEAN] = kappa_split(material, full_share)
        row[TERM_COUNT] = len(material.constants) // 2  # Ogden's; others do not read it
        row[CONSTANTS : CONSTANTS + len(material.constants)] = material.constants
    return table
