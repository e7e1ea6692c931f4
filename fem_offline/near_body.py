# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A nonlinear patch with the rest of the organ behind it: linear, in a few modes, turning with the interface.

    Pi(u_p, y) = W_patch(u_p, u_I(y)) + y . S y / 2 + contact

u_p are the patch's free nodes, u_I those of the interface, which follow the modes' coordinates y (far_modes.py,
corotation.py).  With J = du_I/dy and f_I the patch's forces on the interface,

    r_y = J^T f_I + S y,    H_yy = J^T K_II J + f_I . d2u_I/dy2 + S,    H_py = K_pI J

The coordinates stand after the nodes, three to a row, so that equilibrium sees one array of displacements.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from palpate.fem_offline.assembly import ElementState
from palpate.fem_offline.corotation import corotation
from palpate.fem_offline.far_modes import FarModes
from palpate.fem_offline.hessian_pattern import HessianPattern, hessian_pattern
from palpate.fem_offline.linear_solver import Factor
from palpate.fem_offline.tangent import CG_ITERATIONS_STALE, Tangent
from palpate.fem_offline.tissue import Tissue

__all__ = ["NearBody"]


@dataclass(frozen=True)
class _Reduction:
    """From the Hessian over a patch's nodes to that over its own nodes and the modes' coordinates.

    Attributes:
        nodal: pattern over all free nodes of the patch.
        pattern: the reduced one.
        own: places in the nodal values that go straight to `own_to`.
        coupling: (p, i) CSR of places (+ 1) of the block between own and interface equations.
        inner: (i, i) CSR of places (+ 1) of the interface's upper block.
        coupled: rows of own equations that reach the interface; their places with every coordinate (rows, n).
        modal: (n (n + 1) / 2,) places of the coordinates' own upper triangle.
    """

    nodal: HessianPattern
    pattern: HessianPattern
    own: np.ndarray
    own_to: np.ndarray
    coupling: sparse.csr_matrix
    inner: sparse.csr_matrix
    coupled: np.ndarray
    coupled_to: np.ndarray
    modal: np.ndarray

    def __call__(self, values: np.ndarray, J: np.ndarray, modal: np.ndarray) -> np.ndarray:
        """Reduced values of nodal ones, with slope J (i, n) and the coordinates' further stiffness (n, n)."""
        out = np.empty(len(self.pattern.column))
        out[self.own_to] = values[self.own]
        block = sparse.csr_matrix(
            (values[self.coupling.data - 1], self.coupling.indices, self.coupling.indptr), self.coupling.shape
        )
        out[self.coupled_to] = (block @ J)[self.coupled]
        upper = sparse.csr_matrix(
            (values[self.inner.data - 1], self.inner.indices, self.inner.indptr), self.inner.shape
        )
        diagonal = upper.diagonal()[:, None]
        full = upper @ J + upper.T @ J - diagonal * J
        out[self.modal] = (J.T @ full + modal)[np.triu_indices(J.shape[1])]
        return out


def _reduction(
    elements: np.ndarray, count: int, held: np.ndarray, interface: np.ndarray, modes: int
) -> _Reduction:
    fixed = np.zeros((count, 3), bool)
    fixed[held] = True
    nodal = hessian_pattern(elements, fixed.ravel(), [])
    follows = np.zeros((count, 3), bool)
    follows[interface] = True
    own_component = ~fixed.ravel() & ~follows.ravel()
    own_count = int(np.count_nonzero(own_component))
    rows = -(-modes // 3)
    equation = np.full(3 * (count + rows), -1)
    equation[: 3 * count][own_component] = np.arange(own_count)
    equation[3 * count : 3 * count + modes] = own_count + np.arange(modes)

    free = np.flatnonzero(~fixed.ravel())
    to_own = equation[free]  # of each nodal equation; -1 on the interface
    place_of = np.full(3 * count, -1)
    place_of[(3 * interface[:, None] + np.arange(3)).ravel()] = np.arange(3 * len(interface))
    to_interface = place_of[free]
    r, c = nodal.rows, nodal.column.astype(np.int64)
    at = np.arange(len(c))
    both = (to_own[r] >= 0) & (to_own[c] >= 0)
    mixed = (to_own[r] >= 0) != (to_own[c] >= 0)
    neither = (to_own[r] < 0) & (to_own[c] < 0)
    p = np.where(to_own[r] >= 0, to_own[r], to_own[c])[mixed]
    i = np.where(to_own[r] >= 0, to_interface[c], to_interface[r])[mixed]
    size = 3 * len(interface)
    coupling = sparse.csr_matrix((at[mixed] + 1, (p, i)), (own_count, size))
    a, b = to_interface[r[neither]], to_interface[c[neither]]
    inner = sparse.csr_matrix((at[neither] + 1, (np.minimum(a, b), np.maximum(a, b))), (size, size))

    coupled = np.unique(p)
    y = own_count + np.arange(modes)
    yr, yc = np.triu_indices(modes)
    row = np.concatenate([to_own[r[both]], np.repeat(coupled, modes), y[yr]])
    column = np.concatenate([to_own[c[both]], np.tile(y, len(coupled)), y[yc]])
    total = own_count + modes
    order = np.lexsort((column, row))
    place = np.empty(len(order), np.int64)
    place[order] = np.arange(len(order))
    start = np.concatenate([[0], np.cumsum(np.bincount(row, minlength=total))]).astype(np.int32)
    pattern = HessianPattern(
        equation, total, start, column[order].astype(np.int32), np.zeros((0, 900), np.int32)
    )
    ends = np.cumsum([np.count_nonzero(both), len(coupled) * modes])
    own_to, coupled_to, modal = np.split(place, ends)
    return _Reduction(
        nodal,
        pattern,
        at[both],
        own_to,
        coupling,
        inner,
        coupled,
        coupled_to.reshape(len(coupled), modes),
        modal,
    )


class NearBody(Tangent):
    """Nonlinear patch on a linear far field.

    Args:
        tissue: of the patch.
        held: node indices that do not move.
        interface: (I,) patch nodes of the far field's rows, in their order.
        far: modes of the far field.
        faces: (B, 6) faces that may touch; none at the interface.
        turning: whether the far field turns with the interface.
    """

    iterations_max = CG_ITERATIONS_STALE

    def __init__(
        self,
        tissue: Tissue,
        held: np.ndarray,
        interface: np.ndarray,
        far: FarModes,
        faces: np.ndarray,
        turning: bool = True,
    ) -> None:
        count = tissue.space.node_count
        if np.isin(faces, interface).any():
            raise ValueError("the contact reaches the patch's interface; a larger patch is needed")
        self._reduce = _reduction(tissue.space.elements, count, held, interface, far.count)
        nodes = np.concatenate([tissue.nodes, np.zeros((-(-far.count // 3), 3))])
        super().__init__(tissue, held, nodes, self._reduce.pattern, faces)
        self.interface, self.far = interface, far
        self._turning = corotation(tissue.nodes[interface], far.trace, turning)
        rows = self.pattern.row_start, self.pattern.column
        self._factors = {False: Factor(*rows, single=True), True: Factor(*rows, single=True)}
        self.set_rest()

    @property
    def factors(self) -> dict[bool, Factor]:
        return self._factors

    def coordinates(self, u: np.ndarray) -> np.ndarray:
        """(n,) of the modes, behind the nodes of u (N, 3)."""
        return u[len(self.tissue.nodes) :].ravel()[: self.far.count]

    def angle(self, u: np.ndarray) -> float:
        """rad; how far the interface has turned at u (N, 3) m."""
        return self._turning.angle(self.coordinates(u))

    def far_field_error(self, u: np.ndarray, state: ElementState) -> float:
        """Share of the energy that the far field stores, times the angle (rad) by which its border has turned.

        Straining is no trouble so far from the contact; what one rotation for the whole far field leaves is, and counts
        as much as the far field's energy does (DECISIONS.md has the measurements).
        """
        y = self.coordinates(u)
        if not len(y) or not state.energy > 0.0:
            return 0.0
        return float(0.5 * y @ self.far.stiffness @ y / state.energy) * self.angle(u)

    def follow(self, u: np.ndarray) -> np.ndarray:
        """u (N, 3) m with the interface where the modes' coordinates put it."""
        out = u.copy()
        out[self.interface] = self._turning.displacement(self.coordinates(u))
        return out

    def tissue_state(self, u: np.ndarray) -> ElementState:
        """Of the patch alone, at displacements of its nodes."""
        return self.tissue.state(u)

    def state(self, u: np.ndarray) -> ElementState:
        count = len(self.tissue.nodes)
        near, y = self.tissue_state(u[:count]), self.coordinates(u)
        pull = self.far.stiffness @ y
        force = np.zeros_like(self.nodes)
        force[:count] = near.force
        at_interface = near.force[self.interface].ravel()
        force[count:].reshape(-1)[: len(y)] = self._turning.slope(y).T @ at_interface + pull
        return ElementState(near.energy + 0.5 * float(y @ pull), force, near.smallest_jacobian)

    def hessian(self, u: np.ndarray) -> np.ndarray:
        count, y = len(self.tissue.nodes), self.coordinates(u)
        values = self.tissue.hessian(u[:count], self._reduce.nodal)
        modal = self.far.stiffness
        if y.any():
            force = self.tissue_state(u[:count]).force[self.interface]
            modal = modal + self._turning.curvature(y, force)
        return self._reduce(values, self._turning.slope(y), modal)

    def renew(self) -> None:
        self._factors[self.stuck].factorise(self.values)

    def precondition(self, r: np.ndarray) -> np.ndarray:
        return self._factors[self.stuck].solve(r)

    def support_reaction(self, u: np.ndarray, state: ElementState) -> np.ndarray:
        """As of any body; the far field's part of the force from its own side (far_modes.py), of the moment from the
        patch's forces on the interface, which has moved: a linear far field balances moments where it was."""
        count = len(self.tissue.nodes)
        near = super().support_reaction(u[:count], ElementState(state.energy, state.force[:count], 0.0))
        force = self.far.reaction @ self.coordinates(u)
        moment = np.cross((self.nodes + u)[self.interface], state.force[self.interface]).sum(axis=0)
        return near + np.concatenate([force, moment])
