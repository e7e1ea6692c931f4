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

import numpy as np

from palpate.fem_offline.assembly import ElementState
from palpate.fem_offline.corotation import corotation
from palpate.fem_offline.far_modes import FarModes
from palpate.fem_offline.modal_reduction import modal_reduction
from palpate.fem_offline.tangent import FactoredTangent
from palpate.fem_offline.tissue import Tissue

__all__ = ["NearBody"]


class NearBody(FactoredTangent):
    """Nonlinear patch on a linear far field.

    Args:
        tissue: of the patch.
        held: node indices that do not move.
        interface: (I,) patch nodes of the far field's rows, in their order.
        far: modes of the far field.
        faces: (B, 6) faces that may touch; none at the interface.
        turning: whether the far field turns with the interface.
    """

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
        self._reduce = modal_reduction(tissue.space.elements, count, held, interface, far.count)
        nodes = np.concatenate([tissue.nodes, np.zeros((-(-far.count // 3), 3))])
        super().__init__(tissue, held, nodes, self._reduce.pattern, faces)
        self.interface, self.far = interface, far
        self._turning = corotation(tissue.nodes[interface], far.trace, turning)
        self._pulled: tuple[np.ndarray, np.ndarray] | None = None
        self.set_rest()

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
        at_interface = near.force[self.interface]
        self._pulled = u, at_interface
        force[count:].reshape(-1)[: len(y)] = self._turning.slope(y).T @ at_interface.ravel() + pull
        return ElementState(near.energy + 0.5 * float(y @ pull), force, near.smallest_jacobian)

    def hessian(self, u: np.ndarray) -> np.ndarray:
        count, y = len(self.tissue.nodes), self.coordinates(u)
        values = self.tissue.hessian(u[:count], self._reduce.nodal)
        modal = self.far.stiffness
        if y.any():
            modal = modal + self._turning.curvature(y, self._interface_force(u))
        return self._reduce(values, self._turning.slope(y), modal)

    def _interface_force(self, u: np.ndarray) -> np.ndarray:
        """(I, 3) N; kept from the state at the same array u, which a Newton step looks at first and nobody changes."""
        if self._pulled is None or self._pulled[0] is not u:
            self.state(u)
        assert self._pulled is not None
        return self._pulled[1]

    def support_reaction(self, u: np.ndarray, state: ElementState) -> np.ndarray:
        """As of any body; the far field's part of the force from its own side (far_modes.py), of the moment from the
        patch's forces on the interface, which has moved: a linear far field balances moments where it was."""
        count = len(self.tissue.nodes)
        near = super().support_reaction(u[:count], ElementState(state.energy, state.force[:count], 0.0))
        force = self.far.reaction @ self.coordinates(u)
        moment = np.cross((self.nodes + u)[self.interface], state.force[self.interface]).sum(axis=0)
        return near + np.concatenate([force, moment])
