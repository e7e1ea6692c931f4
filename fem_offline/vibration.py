# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Free vibration of an organ about its rest shape, without damping:

    K phi = omega^2 M phi,      phi_i . M phi_j = delta_ij

K is the rest stiffness of its quadratic tetrahedra, capsule and elastic supports, M their consistent mass, from

    int_V L0^a L1^b L2^c L3^d dV = 6 V a! b! c! d! / (a + b + c + d + 3)!

in barycentric coordinates (Zienkiewicz, Taylor and Zhu, 2013, section 6).  Eigenpairs nearest to -shift by Lanczos with
the factor of K + shift M, which is positive definite also where nothing holds the organ; its six rigid motions are then
left out.  Limits: one density; a capsule has no mass.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, eigsh

from palpate.fem_offline.linear_solver import Factor
from palpate.fem_offline.organ import Organ
from palpate.fem_offline.quadratic_space import EDGES, QuadraticSpace

__all__ = ["VibrationModes", "consistent_mass", "vibration_modes"]

RIGID = 1e-7
"""Eigenvalues below this share of the shift are rigid motions; those of a bar 100 times as long as thick are above."""


@dataclass(frozen=True)
class VibrationModes:
    """Attributes: frequency (n,) Hz, rising; shape (n, N, 3) kg^-1/2, of unit modal mass, at the quadratic nodes."""

    frequency: np.ndarray
    shape: np.ndarray


def consistent_mass(space: QuadraticSpace, density: float) -> sparse.csr_matrix:
    """(N, N) kg, of each component; density in kg/m3."""
    values = density * space.volumes[:, None, None] * _reference_mass()
    rows = np.repeat(space.elements, 10, axis=1).ravel()
    columns = np.tile(space.elements, (1, 10)).ravel()
    count = space.node_count
    return sparse.coo_matrix((values.ravel(), (rows, columns)), shape=(count, count)).tocsr()


def vibration_modes(organ: Organ, density: float, count: int, free: bool = False) -> VibrationModes:
    """The `count` slowest modes; `free`: as if nothing held the organ, rigid motions left out.

    Raises:
        ValueError: density or count is not above 0, or the organ has fewer degrees of freedom.
    """
    if not density > 0.0 or count < 1:
        raise ValueError("density and count have to be above 0")
    everything = np.ones(len(organ.tets), bool)
    stiffness = organ.rest_stiffness(everything)
    loose = np.ones((organ.space.node_count, 3), bool)
    if not free:
        stiffness = stiffness + organ.spring_stiffness(everything)
        loose[organ.held_nodes] = False
    loose = np.flatnonzero(loose.ravel())
    asked = count + 6 if free else count
    if asked >= len(loose):
        raise ValueError(f"{count} modes of {len(loose)} degrees of freedom")
    mass = sparse.kron(consistent_mass(organ.space, density), sparse.identity(3), format="csr")
    stiffness, mass = stiffness[loose][:, loose], mass[loose][:, loose]
    size = float(np.linalg.norm(np.ptp(organ.points, axis=0)))
    shift = min(material.shear_modulus for material in organ.materials) / (density * size**2)
    upper = sparse.triu(stiffness + shift * mass).tocsr()
    upper.sort_indices()
    factor = Factor(upper.indptr, upper.indices)
    factor.factorise(upper.data)
    inverse = LinearOperator(upper.shape, matvec=factor.solve, dtype=float)
    start = np.random.default_rng(0).standard_normal(len(loose))  # the same answer each time
    squared, vectors = eigsh(stiffness, asked, mass, sigma=-shift, OPinv=inverse, v0=start)
    order = np.argsort(squared)
    order = order[squared[order] > RIGID * shift][:count]
    shape = np.zeros((len(order), 3 * organ.space.node_count))
    shape[:, loose] = vectors[:, order].T
    return VibrationModes(
        np.sqrt(squared[order]) / (2.0 * np.pi), shape.reshape(len(order), organ.space.node_count, 3)
    )


def _reference_mass() -> np.ndarray:
    """(10, 10) of a tetrahedron of unit volume and density."""
    shapes: list[dict[tuple[int, ...], float]] = []
    unit = np.eye(4, dtype=int)
    for a in range(4):  # L (2 L - 1)
        shapes.append({tuple(2 * unit[a]): 2.0, tuple(unit[a]): -1.0})
    shapes += [{tuple(unit[a] + unit[b]): 4.0} for a, b in EDGES]
    return np.array(
        [
            [
                sum(
                    p * q * _integral(np.add(e, f))
                    for e, p in one.items()
                    for f, q in other.items()
                )
                for other in shapes
            ]
            for one in shapes
        ]
    )  # fmt: skip


def _integral(power: np.ndarray) -> float:
    """Of a barycentric monomial over a tetrahedron of unit volume."""
    return 6.0 * float(np.prod([factorial(int(p)) for p in power])) / factorial(int(power.sum()) + 3)
