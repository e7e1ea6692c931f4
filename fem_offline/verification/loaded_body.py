# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A body under given displacements and dead loads, without contact: what element-level checks solve.

small strain    K(0) u = f              with quadratic tetrahedra, or with linear ones (the negative control)
finite strain   dW/du (u) = f           by the same Newton method that presses use
"""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
from scipy import sparse

from palpate.fem_offline.assembly import ElementState, ElementSystem
from palpate.fem_offline.body import FreeMotion
from palpate.fem_offline.equilibrium import equilibrate
from palpate.fem_offline.hessian_pattern import hessian_pattern
from palpate.fem_offline.linear_solver import Factor
from palpate.fem_offline.material import FULL_SHARE, Material
from palpate.fem_offline.organ import boundary_faces
from palpate.fem_offline.quadratic_space import QuadraticSpace
from palpate.fem_offline.verification.linear_tetrahedra import linear_in_quadratic

__all__ = ["LoadedBody", "faces_where", "finite_strain", "small_strain", "uniform_load"]

TOLERANCE = 1.0e-9
"""Residual over load at finite strain; at nu = 0.4999 rounding alone is 1e-10."""


@dataclass(frozen=True)
class LoadedBody:
    """A body of one material.

    Attributes:
        space: nodes and elements.
        material: of all of it.
        held: (N, 3) bool; displacement components that are given.
        load: (N, 3) N.
        given: (N, 3) m; values of the held components (others are ignored); zero where not said.
        full_share: of kappa, see material_table.py; inf integrates all of it at four points.
    """

    space: QuadraticSpace
    material: Material
    held: np.ndarray
    load: np.ndarray
    given: np.ndarray | None = None
    full_share: float = FULL_SHARE

    @property
    def system(self) -> ElementSystem:
        one = np.ones((len(self.space.elements), 1))
        return ElementSystem(self.space, [self.material], one, full_share=self.full_share)

    @property
    def start(self) -> np.ndarray:
        """(N, 3) m; the given displacements, zero elsewhere."""
        return np.zeros(self.held.shape) if self.given is None else np.where(self.held, self.given, 0.0)

    def work(self, u: np.ndarray) -> float:
        """f . u, J."""
        return float(np.sum(self.load * u))


def small_strain(body: LoadedBody, linear: bool = False) -> np.ndarray:
    """(N, 3) m; solution of the linearised problem; `linear`: with linear tetrahedra on the same corners."""
    space, start = body.space, body.start
    pattern = hessian_pattern(space.elements, np.zeros(3 * space.node_count, bool), [])
    upper = pattern.matrix(body.system.hessian(np.zeros_like(space.nodes), pattern))
    K = (upper + sparse.triu(upper, 1).T).tocsr()
    free = ~body.held.ravel()
    Z = sparse.eye(len(free), format="csr")
    if linear:
        Z = linear_in_quadratic(space)
        free = free[: Z.shape[1]]
        start = (Z @ start.ravel()[: Z.shape[1]]).reshape(-1, 3)
    K, r = (Z.T @ K @ Z).tocsr(), Z.T @ (body.load.ravel() - K @ start.ravel())
    upper = sparse.triu(K[free][:, free]).tocsr()
    upper.sort_indices()
    factor = Factor(upper.indptr, upper.indices)
    factor.factorise(upper.data)
    step = np.zeros(len(free))
    step[free] = factor.solve(r[free])
    return start + (Z @ step).reshape(-1, 3)


def finite_strain(body: LoadedBody, start: np.ndarray | None = None, steps: int = 1) -> np.ndarray:
    """(N, 3) m; equilibrium at finite strain, the load raised in equal steps from `start` (default: at rest).

    Raises:
        EquilibriumError: no convergence.
    """
    u = body.start if start is None else start
    newton = _NewtonBody(body)
    for share in np.linspace(0.0, 1.0, steps + 1)[1:]:
        load = _DeadLoad(share * body.load)
        scale = float(np.linalg.norm(load.load))
        if not scale:  # moved at its held nodes alone
            scale = 1e-2 * body.material.shear_modulus * float(body.space.volumes.sum()) ** (2.0 / 3.0)
        u = equilibrate(newton, load, u, TOLERANCE, scale).u
    return u


def faces_where(space: QuadraticSpace, inside) -> np.ndarray:
    """(B, 3) boundary faces whose corners x (n, 3) m are all `inside(x)`."""
    faces = boundary_faces(space.elements[:, :4])
    return faces[inside(space.nodes)[faces].all(axis=1)]


def uniform_load(space: QuadraticSpace, faces: np.ndarray, traction: np.ndarray) -> np.ndarray:
    """(N, 3) N of a traction (3,) Pa: a third of each face's load to each mid-edge node, nothing to its corners."""
    x = space.nodes[faces]
    area = 0.5 * np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1)
    load = np.zeros_like(space.nodes)
    for mid in space.face_nodes(faces)[:, 3:].T:
        np.add.at(load, mid, area[:, None] / 3.0 * traction)
    return load


@dataclass
class _DeadLoad:
    """In the place of contact: energy -f . u."""

    load: np.ndarray

    def state(self, u: np.ndarray):
        return SimpleNamespace(energy=-float(np.sum(self.load * u)), gradient=-self.load, force=np.zeros(3))

    def hessian(self, u: np.ndarray, geometric: bool) -> None:
        return None


class _NewtonBody(FreeMotion):
    """What `equilibrate` asks of a body; a new factor in every step."""

    def __init__(self, body: LoadedBody) -> None:
        self.nodes, self.system = body.space.nodes, body.system
        self.pattern = hessian_pattern(body.space.elements, body.held.ravel(), [])
        self.equation, self.equation_count = self.pattern.equation, self.pattern.equation_count
        self.factor = Factor(self.pattern.row_start, self.pattern.column)
        self.rest = self.system.hessian(np.zeros_like(self.nodes), self.pattern)

    def state(self, u: np.ndarray) -> ElementState:
        return self.system.state(u)

    def linearise(self, u: np.ndarray, contact: None, shift: float, stuck: bool = False) -> None:
        self.factor.factorise(self.system.hessian(u, self.pattern) + shift * self.rest)

    def solve(self, b: np.ndarray, tolerance: float) -> np.ndarray:
        return self.factor.solve(b)
