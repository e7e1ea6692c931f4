# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What is pressed: a refined patch with the rest of the organ behind it, at one of two fidelities.

`NearBody`: nonlinear patch, linear condensed far field (far_field.py).
`FullBody`: all tissue nonlinear.

Newton systems are solved by conjugate gradients with the current Hessian.  The near body's preconditioner is a
Cholesky factor of an earlier state, renewed when it takes too many iterations (a factor costs as much as some fifty
solves).  The full body's is the near body's factor and the far field's rest factor, block by block:

    y_f = K_ff0^-1 r_f,   (K_patch(u) + S) d_p = r_p - K_If0 y_f,   d_f = y_f - K_ff0^-1 K_fI0 d_I

which is exact where the far field has not moved, so a handful of iterations do.
Both number the patch's nodes first, in the same order.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy import sparse

from palpate.fem_offline.assembly import ElementState
from palpate.fem_offline.conjugate_gradients import StaleError, conjugate_gradients
from palpate.fem_offline.contact import ContactHessian, face_places
from palpate.fem_offline.far_field import FarField
from palpate.fem_offline.hessian_pattern import HessianPattern, hessian_pattern
from palpate.fem_offline.linear_solver import Factor
from palpate.fem_offline.organ import Organ, faces_held
from palpate.fem_offline.patch import Patch
from palpate.fem_offline.quadratic_space import QuadraticSpace, quadratic_space
from palpate.fem_offline.tissue import Tissue

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

    def support_reaction(self, u: np.ndarray, state: ElementState) -> np.ndarray: ...


def patch_space(organ: Organ, patch: Patch) -> tuple[QuadraticSpace, np.ndarray]:
    """Quadratic space of a patch and its held nodes."""
    space = quadratic_space(patch.points, patch.tets)
    held = patch.outer_faces[faces_held(patch.points, patch.outer_faces, organ.held)]
    return space, np.unique(space.face_nodes(held)) if len(held) else np.zeros(0, int)


class _Tangent(ABC):
    """A body's Newton systems: the current Hessian, and conjugate gradients with a factor that may be older.

    Args:
        tissue: what is nonlinear.
        held: node indices that do not move.
        groups: displacement components that couple all with all.
        contact_faces: (B, 6) faces that may touch.
    """

    iterations_max: int
    """Conjugate-gradient iterations allowed with a new factor."""

    def __init__(
        self, tissue: Tissue, held: np.ndarray, groups: list[np.ndarray], contact_faces: np.ndarray
    ) -> None:
        self.tissue, self.nodes, self.held = tissue, tissue.nodes, held
        fixed = np.zeros((len(self.nodes), 3), bool)
        fixed[held] = True
        self.pattern: HessianPattern = hessian_pattern(tissue.space.elements, fixed.ravel(), groups)
        self.equation, self.equation_count = self.pattern.equation, self.pattern.equation_count
        self.contact_faces = contact_faces
        self._contact_places = face_places(self.pattern, contact_faces)

    @abstractmethod
    def hessian(self, u: np.ndarray) -> np.ndarray:
        """Hessian values without contact, on the pattern, at u (N, 3) m."""

    @abstractmethod
    def renew(self) -> None:
        """Make the preconditioner anew, at the current Hessian.  Raises NotPositiveDefiniteError."""

    @abstractmethod
    def precondition(self, r: np.ndarray) -> np.ndarray: ...

    @property
    @abstractmethod
    def factors(self) -> dict[bool, Factor]:
        """One for the free (False) and one for the stuck contact (True).  Sticking holds the contact in three
        directions instead of one: a factor of its own stays useful longer."""

    def set_rest(self) -> None:
        """Keep the rest stiffness, which shifts a Hessian that is not positive definite."""
        self.rest_values = self.hessian(np.zeros_like(self.nodes))

    def assemble(self, u: np.ndarray, contact: ContactHessian, shift: float, stuck: bool = False) -> None:
        """Current Hessian at u, with contact and a share `shift` of the rest stiffness."""
        self.values = self.hessian(u)
        contact.add_to(self.values, self._contact_places)
        if shift:
            self.values += shift * self.rest_values
        self._upper = self.pattern.matrix(self.values)
        self._diagonal = self._upper.diagonal()
        self.stuck = stuck
        self.at = (u, contact, shift, stuck)

    def linearise(self, u: np.ndarray, contact: ContactHessian, shift: float, stuck: bool = False) -> None:
        """Assemble; factorise where there is no factor yet.  Raises NotPositiveDefiniteError."""
        self.assemble(u, contact, shift, stuck)
        if not self.factors[stuck].ready:
            self.renew()

    def apply(self, x: np.ndarray) -> np.ndarray:
        return self._upper @ x + self._upper.T @ x - self._diagonal * x

    def solve(self, b: np.ndarray, tolerance: float) -> np.ndarray:
        """Raises NegativeCurvatureError, NotPositiveDefiniteError, StaleError."""
        try:
            return conjugate_gradients(self.apply, self.precondition, b, tolerance, CG_ITERATIONS_STALE)
        except StaleError:
            self.renew()
        return conjugate_gradients(self.apply, self.precondition, b, tolerance, self.iterations_max)

    def support_force(self, u: np.ndarray, state: ElementState) -> np.ndarray:
        """(3,) N; force of the supports on the tissue, from their own side."""
        return self.support_reaction(u, state)[:3]

    def support_reaction(self, u: np.ndarray, state: ElementState) -> np.ndarray:
        """(6,) N, N m; force of the supports on the tissue and its moment about the origin, from their own side.

        Less the couple of linear materials, which nothing holds but the model.
        """
        force = state.force[self.held]
        moment = np.cross(self.nodes[self.held], force).sum(axis=0) - self.tissue.couple(u)
        held = np.concatenate([force.sum(axis=0), moment])
        return held + self.tissue.ground_reaction(u)


class NearBody(_Tangent):
    """Nonlinear patch on a linear far field.

    Args:
        organ, patch: where the patch was carved.
        space, held: from `patch_space`.
        interface: (I,) patch nodes of the far field's rows, in their order.
        far: condensed far field.
        contact_faces: (B, 6) faces that may touch.
    """

    iterations_max = CG_ITERATIONS_STALE

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
        fraction = organ.fractions_of(patch.points, patch.tets, patch.label)
        self.outer_faces = space.face_nodes(patch.outer_faces)
        dofs = (3 * interface[:, None] + np.arange(3)).ravel()
        tissue = organ.tissue(space, fraction, self.outer_faces)
        super().__init__(tissue, held, [dofs], contact_faces)
        self.interface, self.far = interface, far
        r, c = np.meshgrid(self.equation[dofs], self.equation[dofs], indexing="ij")
        upper = r <= c
        self._far_places = self.pattern.places(r[upper], c[upper])
        self._far_values = far.stiffness[upper]
        rows = self.pattern.row_start, self.pattern.column
        self._factors = {False: Factor(*rows), True: Factor(*rows)}
        self.set_rest()

    @property
    def factors(self) -> dict[bool, Factor]:
        return self._factors

    def state(self, u: np.ndarray) -> ElementState:
        near = self.tissue.state(u)
        moved = u[self.interface].ravel()
        force = self.far.stiffness @ moved
        near.force[self.interface] += force.reshape(-1, 3)
        return ElementState(near.energy + 0.5 * float(moved @ force), near.force, near.smallest_jacobian)

    def hessian(self, u: np.ndarray) -> np.ndarray:
        values = self.tissue.hessian(u, self.pattern)
        values[self._far_places] += self._far_values
        return values

    def renew(self) -> None:
        self._factors[self.stuck].factorise(self.values)

    def precondition(self, r: np.ndarray) -> np.ndarray:
        return self._factors[self.stuck].solve(r)

    def support_reaction(self, u: np.ndarray, state: ElementState) -> np.ndarray:
        """As of any body, less the couple sum u_I x f_I that a linear far field leaves: its forces act on nodes that
        have moved and balance about nodes that have not (second order, zero with `FullBody`)."""
        moved = u[self.interface]
        force = (self.far.stiffness @ moved.ravel()).reshape(-1, 3)
        couple = np.concatenate([np.zeros(3), np.cross(moved, force).sum(axis=0)])
        return super().support_reaction(u, state) + self.far.reaction @ moved.ravel() - couple


@dataclass(frozen=True)
class _FarRest:
    """The far field's rest stiffness, factored; blocks between far and patch equations."""

    factor: Factor
    coupling: sparse.csr_matrix  # (far, patch)
    far: np.ndarray
    near: np.ndarray


class FullBody(_Tangent):
    """All tissue nonlinear: the patch and the organ's own outside it.

    Args:
        near: the patch, and what preconditions it.
        organ, patch: where the patch was carved.
        shared: patch nodes and organ nodes on the interface, from `interface_nodes`.
    """

    iterations_max = CG_ITERATIONS_FULL

    def __init__(
        self, near: NearBody, organ: Organ, patch: Patch, shared: tuple[np.ndarray, np.ndarray]
    ) -> None:
        self.near = near
        outside, space = ~patch.carved, near.tissue.space
        far_nodes = np.unique(organ.space.elements[outside])
        index = _full_numbering(space.node_count, organ.space.node_count, far_nodes, shared)
        own = far_nodes[index[far_nodes] >= space.node_count]
        full_space = QuadraticSpace(
            np.concatenate([space.nodes, organ.space.nodes[own]]),
            np.concatenate([space.elements, index[organ.space.elements[outside]]]).astype(np.int32),
            np.concatenate([space.corner_gradients, organ.space.corner_gradients[outside]]),
            np.concatenate([space.volumes, organ.space.volumes[outside]]),
            space.edge_nodes,
        )
        fraction = np.concatenate([near.tissue.elements.fraction, organ.fractions[outside]])
        faces = np.concatenate([near.outer_faces, index[organ.surface_of(outside)]])
        held = np.union1d(near.held, index[np.intersect1d(organ.held_nodes, far_nodes)])
        super().__init__(organ.tissue(full_space, fraction, faces), held, [], near.contact_faces)
        self.set_rest()
        self._far = self._factor_far(space.node_count)

    def _factor_far(self, patch_node_count: int) -> _FarRest:
        upper = self.pattern.matrix(self.rest_values)
        full = (upper + sparse.triu(upper, 1).T).tocsr()
        node = np.repeat(np.arange(len(self.nodes)), 3)[self.equation >= 0]
        far = np.flatnonzero(node >= patch_node_count)
        near = np.flatnonzero(node < patch_node_count)
        block = sparse.triu(full[far][:, far]).tocsr()
        block.sort_indices()
        factor = Factor(block.indptr, block.indices)
        factor.factorise(block.data)
        return _FarRest(factor, full[far][:, near].tocsr(), far, near)

    @property
    def factors(self) -> dict[bool, Factor]:
        return self.near.factors

    def state(self, u: np.ndarray) -> ElementState:
        return self.tissue.state(u)

    def hessian(self, u: np.ndarray) -> np.ndarray:
        return self.tissue.hessian(u, self.pattern)

    def renew(self) -> None:
        u, contact, shift, stuck = self.at
        self.near.assemble(u[: len(self.near.nodes)], contact, shift, stuck)
        self.near.renew()

    def precondition(self, r: np.ndarray) -> np.ndarray:
        f = self._far
        y = f.factor.solve(r[f.far])
        out = np.empty_like(r)
        out[f.near] = self.factors[self.stuck].solve(r[f.near] - f.coupling.T @ y)
        out[f.far] = y - f.factor.solve(f.coupling @ out[f.near])
        return out


def _full_numbering(
    patch_count: int, organ_count: int, far_nodes: np.ndarray, shared: tuple[np.ndarray, np.ndarray]
) -> np.ndarray:
    """(N_organ,) number in the full body of each organ node outside the patch; -1 inside.  The patch's come first."""
    patch_nodes, organ_nodes = shared
    own = np.setdiff1d(far_nodes, organ_nodes)
    index = np.full(organ_count, -1)
    index[own] = patch_count + np.arange(len(own))
    index[organ_nodes] = patch_nodes
    return index
