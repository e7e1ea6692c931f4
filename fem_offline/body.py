# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What is pressed: a refined patch with the rest of the organ behind it, at one of two fidelities.

`NearBody`: nonlinear patch, linear condensed far field (far_field.py).
`FullBody`: every tetrahedron nonlinear.

Newton systems are solved by conjugate gradients with the current Hessian.  The near body's preconditioner is a
Cholesky factor of an earlier state, renewed when it takes too many iterations (a factor costs as much as some fifty
solves).  The full body's is the near body's factor and the far field's rest factor, block by block:

    y_f = K_ff0^-1 r_f,   (K_patch(u) + S) d_p = r_p - K_If0 y_f,   d_f = y_f - K_ff0^-1 K_fI0 d_I

which is exact where the far field has not moved, so a handful of iterations do.
Both number the patch's nodes first, in the same order.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy import sparse

from palpate.fem_offline.assembly import ElementState, ElementSystem, HessianPattern, hessian_pattern
from palpate.fem_offline.conjugate_gradients import StaleError, conjugate_gradients
from palpate.fem_offline.contact import ContactHessian, face_places
from palpate.fem_offline.far_field import FarField
from palpate.fem_offline.linear_solver import Factor
from palpate.fem_offline.organ import Organ, faces_held
from palpate.fem_offline.patch import Patch
from palpate.fem_offline.quadratic_space import QuadraticSpace, quadratic_space

__all__ = ["Body", "FullBody", "NearBody", "patch_space"]

CG_ITERATIONS_STALE = 16
"""More iterations than this cost more than a new factor."""
CG_ITERATIONS_FULL = 80


class Body(Protocol):
    """What equilibrium asks of a body."""

    nodes: np.ndarray
    equation: np.ndarray
    equation_count: int

    def state(self, u: np.ndarray) -> ElementState: ...

    def linearise(
        self, u: np.ndarray, contact: ContactHessian, shift: float, stuck: bool = False
    ) -> None: ...

    def renew(self) -> None: ...

    def solve(self, b: np.ndarray, tolerance: float) -> np.ndarray: ...

    def support_force(self, u: np.ndarray, state: ElementState) -> np.ndarray: ...


def patch_space(organ: Organ, patch: Patch) -> tuple[QuadraticSpace, np.ndarray]:
    """Quadratic space of a patch and its held nodes."""
    space = quadratic_space(patch.points, patch.tets)
    held = patch.outer_faces[faces_held(patch.points, patch.outer_faces, organ.held)]
    return space, np.unique(space.face_nodes(held)) if len(held) else np.zeros(0, int)


class NearBody:
    """Nonlinear patch on a linear far field.

    Args:
        organ, patch: where the patch was carved.
        space, held: from `patch_space`.
        interface: (I,) patch nodes of the far field's rows, in their order.
        far: condensed far field.
        contact_faces: (B, 6) faces that may touch.
    """

    def __init__(
        self,
        organ: Organ,
        patch: Patch,
        space: QuadraticSpace,
        held: np.ndarray,
        interface: np.ndarray,
        far: FarField,
        contact_faces: np.ndarray,
    ) -> None:
        self.nodes = space.nodes
        self.system = ElementSystem(
            space, organ.materials, organ.fractions_of(patch.points, patch.tets, patch.label)
        )
        self.interface = interface
        self.far = far
        self.contact_faces = contact_faces
        self._held = held
        fixed = np.zeros((space.node_count, 3), bool)
        fixed[held] = True
        dofs = (3 * interface[:, None] + np.arange(3)).ravel()
        self.pattern: HessianPattern = hessian_pattern(space.elements, fixed.ravel(), [dofs])
        self.equation, self.equation_count = self.pattern.equation, self.pattern.equation_count
        rows = self.equation[dofs]
        r, c = np.broadcast_arrays(rows[:, None], rows[None, :])
        upper = r <= c
        self._far_places = self.pattern.places(r[upper], c[upper])
        self._far_values = far.stiffness[upper]
        self._contact_places = face_places(self.pattern, contact_faces)
        # Sticking holds the contact in three directions instead of one: a factor of its own stays useful longer.
        self._factors = {
            stuck: Factor(self.pattern.row_start, self.pattern.column) for stuck in (False, True)
        }
        self._factored: set[bool] = set()
        self._rest_values = self.values(np.zeros_like(self.nodes))

    def state(self, u: np.ndarray) -> ElementState:
        elastic = self.system.state(u)
        moved = u[self.interface].ravel()
        force = self.far.stiffness @ moved
        elastic.force[self.interface] += force.reshape(-1, 3)
        return ElementState(
            elastic.energy + 0.5 * float(moved @ force), elastic.force, elastic.smallest_jacobian
        )

    def values(self, u: np.ndarray) -> np.ndarray:
        """Hessian values of patch and far field, without contact."""
        values = self.system.hessian(u, self.pattern)
        values[self._far_places] += self._far_values
        return values

    def linearise(self, u: np.ndarray, contact: ContactHessian, shift: float, stuck: bool = False) -> None:
        values = self.values(u)
        contact.add_to(values, self._contact_places)
        if shift:
            values += shift * self._rest_values
        self._values = values
        self._upper = self.pattern.matrix(values)
        self._diagonal = self._upper.diagonal()
        self._stuck = stuck
        if stuck not in self._factored:
            self.renew()

    def renew(self) -> None:
        """Factorise the current Hessian.  Raises NotPositiveDefiniteError."""
        self._factored.discard(self._stuck)
        self._factors[self._stuck].factorise(self._values)
        self._factored.add(self._stuck)

    def precondition(self, r: np.ndarray) -> np.ndarray:
        return self._factors[self._stuck].solve(r)

    def apply(self, x: np.ndarray) -> np.ndarray:
        return self._upper @ x + self._upper.T @ x - self._diagonal * x

    def solve(self, b: np.ndarray, tolerance: float) -> np.ndarray:
        try:
            return conjugate_gradients(self.apply, self.precondition, b, tolerance, CG_ITERATIONS_STALE)
        except StaleError:
            self.renew()
        return conjugate_gradients(self.apply, self.precondition, b, tolerance, CG_ITERATIONS_STALE)

    def support_force(self, u: np.ndarray, state: ElementState) -> np.ndarray:
        """(3,) N; force of the supports on the tissue, from their own side."""
        far = self.far.reaction[:3] @ u[self.interface].ravel()
        return far + state.force[self._held].sum(axis=0)


@dataclass(frozen=True)
class _FarRest:
    """The far field's rest stiffness, factored; blocks between far and patch equations."""

    factor: Factor
    coupling: sparse.csr_matrix  # (far, patch)
    far: np.ndarray
    near: np.ndarray


class FullBody:
    """Every tetrahedron nonlinear: the patch and the organ's own outside it."""

    def __init__(
        self, near: NearBody, organ: Organ, patch: Patch, shared: tuple[np.ndarray, np.ndarray]
    ) -> None:
        patch_nodes, organ_nodes = shared
        outside = ~patch.carved
        space = near.system.space
        far_nodes = np.unique(organ.space.elements[outside])
        own = np.setdiff1d(far_nodes, organ_nodes)
        index = np.full(organ.space.node_count, -1)
        index[own] = space.node_count + np.arange(len(own))
        index[organ_nodes] = patch_nodes
        self.near = near
        self.nodes = np.concatenate([space.nodes, organ.space.nodes[own]])
        full_space = QuadraticSpace(
            self.nodes,
            np.concatenate([space.elements, index[organ.space.elements[outside]]]).astype(np.int32),
            np.concatenate([space.corner_gradients, organ.space.corner_gradients[outside]]),
            np.concatenate([space.volumes, organ.space.volumes[outside]]),
            space.edge_nodes,
        )
        fraction = np.concatenate([near.system.fraction, organ.fractions[outside]])
        self.system = ElementSystem(full_space, organ.materials, fraction)
        held = np.union1d(near._held, index[np.intersect1d(organ.held_nodes, far_nodes)])
        self._held = held
        fixed = np.zeros((len(self.nodes), 3), bool)
        fixed[held] = True
        self.pattern = hessian_pattern(full_space.elements, fixed.ravel(), [])
        self.equation, self.equation_count = self.pattern.equation, self.pattern.equation_count
        self._contact_places = face_places(self.pattern, near.contact_faces)
        self._rest_values = self.system.hessian(np.zeros_like(self.nodes), self.pattern)
        self._far = self._factor_far(space.node_count)

    def _factor_far(self, patch_node_count: int) -> _FarRest:
        upper = self.pattern.matrix(self._rest_values)
        full = (upper + sparse.triu(upper, 1).T).tocsr()
        node = np.repeat(np.arange(len(self.nodes)), 3)[self.equation >= 0]
        far = np.flatnonzero(node >= patch_node_count)
        near = np.flatnonzero(node < patch_node_count)
        block = sparse.triu(full[far][:, far]).tocsr()
        block.sort_indices()
        factor = Factor(block.indptr, block.indices)
        factor.factorise(block.data)
        return _FarRest(factor, full[far][:, near].tocsr(), far, near)

    def state(self, u: np.ndarray) -> ElementState:
        return self.system.state(u)

    def linearise(self, u: np.ndarray, contact: ContactHessian, shift: float, stuck: bool = False) -> None:
        values = self.system.hessian(u, self.pattern)
        contact.add_to(values, self._contact_places)
        if shift:
            values += shift * self._rest_values
        self._upper = self.pattern.matrix(values)
        self._diagonal = self._upper.diagonal()
        self._at = (u, contact, shift, stuck)
        self.near._stuck = stuck
        if stuck not in self.near._factored:
            self.renew()

    def renew(self) -> None:
        """Factorise the near body's current Hessian.  Raises NotPositiveDefiniteError."""
        u, contact, shift, stuck = self._at
        self.near._factored.discard(stuck)
        self.near.linearise(u[: len(self.near.nodes)], contact, shift, stuck)

    def precondition(self, r: np.ndarray) -> np.ndarray:
        f = self._far
        y = f.factor.solve(r[f.far])
        out = np.empty_like(r)
        out[f.near] = self.near.precondition(r[f.near] - f.coupling.T @ y)
        out[f.far] = y - f.factor.solve(f.coupling @ out[f.near])
        return out

    def apply(self, x: np.ndarray) -> np.ndarray:
        return self._upper @ x + self._upper.T @ x - self._diagonal * x

    def solve(self, b: np.ndarray, tolerance: float) -> np.ndarray:
        try:
            return conjugate_gradients(self.apply, self.precondition, b, tolerance, CG_ITERATIONS_STALE)
        except StaleError:
            self.renew()
        return conjugate_gradients(self.apply, self.precondition, b, tolerance, CG_ITERATIONS_FULL)

    def support_force(self, u: np.ndarray, state: ElementState) -> np.ndarray:
        return state.force[self._held].sum(axis=0)
