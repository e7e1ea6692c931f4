# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""All tissue nonlinear: the refined patch and the organ's own tetrahedra outside it.

Newton systems are preconditioned by a factor of the patch on the condensed far field (far_field.py) and the far field's
rest factor, block by block:

    y_f = K_ff0^-1 r_f,   (K_patch(u) + S) d_p = r_p - K_If0 y_f,   d_f = y_f - K_ff0^-1 K_fI0 d_I

which is exact where the far field has not moved, so a handful of iterations do.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from palpate.fem_offline.contact import ContactHessian
from palpate.fem_offline.far_field import FarField
from palpate.fem_offline.hessian_pattern import hessian_pattern
from palpate.fem_offline.linear_solver import Factor
from palpate.fem_offline.organ import Organ
from palpate.fem_offline.patch import Patch
from palpate.fem_offline.quadratic_space import QuadraticSpace
from palpate.fem_offline.tangent import FactoredTangent, Tangent
from palpate.fem_offline.tissue import Tissue

__all__ = ["FullBody"]

CG_ITERATIONS_FULL = 80


class _CondensedBody(FactoredTangent):
    """The patch's own Hessian on the condensed far field; it only preconditions.

    Args:
        tissue: of the patch.
        held: node indices that do not move.
        interface: (I,) patch nodes of the far field's rows, in their order.
        far: condensed far field.
        faces: (B, 6) faces that may touch.
    """

    def __init__(
        self, tissue: Tissue, held: np.ndarray, interface: np.ndarray, far: FarField, faces: np.ndarray
    ) -> None:
        dofs = (3 * interface[:, None] + np.arange(3)).ravel()
        pattern = hessian_pattern(tissue.space.elements, _fixed(tissue, held), [dofs])
        super().__init__(tissue, held, tissue.nodes, pattern, faces)
        r, c = np.meshgrid(self.equation[dofs], self.equation[dofs], indexing="ij")
        upper = r <= c
        self._far_places = self.pattern.places(r[upper], c[upper])
        self._far_values = far.stiffness[upper]
        self.set_rest()

    def hessian(self, u: np.ndarray) -> np.ndarray:
        values = self.tissue.hessian(u, self.pattern)
        values[self._far_places] += self._far_values
        return values


def _fixed(tissue: Tissue, held: np.ndarray) -> np.ndarray:
    fixed = np.zeros((len(tissue.nodes), 3), bool)
    fixed[held] = True
    return fixed.ravel()


@dataclass(frozen=True)
class _FarRest:
    """The far field's rest stiffness, factored; blocks between far and patch equations."""

    factor: Factor
    coupling: sparse.csr_matrix  # (far, patch)
    far: np.ndarray
    near: np.ndarray


class FullBody(Tangent):
    """All tissue nonlinear: the patch and the organ's own outside it.

    Args:
        near: tissue of the patch.
        held: nodes of the patch that do not move.
        organ, patch: where the patch was carved.
        shared: patch nodes and organ nodes on the interface, from `interface_nodes`.
        far: the condensed far field, whose rows are the organ's.
        faces: (B, 6) faces that may touch.
    """

    iterations_max = CG_ITERATIONS_FULL

    def __init__(
        self,
        near: Tissue,
        held: np.ndarray,
        organ: Organ,
        patch: Patch,
        shared: tuple[np.ndarray, np.ndarray],
        far: FarField,
        faces: np.ndarray,
    ) -> None:
        outside, space = ~patch.carved, near.space
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
        fraction = np.concatenate([near.elements.fraction, organ.fractions[outside]])
        skin = np.concatenate([space.face_nodes(patch.outer_faces), index[organ.surface_of(outside)]])
        held_all = np.union1d(held, index[np.intersect1d(organ.held_nodes, far_nodes)])
        tissue = organ.tissue(full_space, fraction, skin)
        pattern = hessian_pattern(full_space.elements, _fixed(tissue, held_all), [])
        super().__init__(tissue, held_all, tissue.nodes, pattern, faces)
        patch_at = index[far.organ_nodes]
        self.patch_tissue = near
        self._patch = _CondensedBody(near, held, patch_at, far, faces)
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
        factor = Factor(block.indptr, block.indices, single=True)  # it only preconditions
        factor.factorise(block.data)
        return _FarRest(factor, full[far][:, near].tocsr(), far, near)

    @property
    def factors(self) -> dict[bool, Factor]:
        return self._patch.factors

    def hessian(self, u: np.ndarray) -> np.ndarray:
        return self.tissue.hessian(u, self.pattern)

    def linearise(self, u: np.ndarray, contact: ContactHessian, shift: float, stuck: bool = False) -> None:
        """As every body's, with the patch's factor made anew: it costs as much as one iteration, and saves five.

        Two solves with the far field's factor make an iteration ten times as dear as near a near field.
        """
        self.assemble(u, contact, shift, stuck)
        self.renew()

    def renew(self) -> None:
        u, contact, shift, stuck = self.at
        self._patch.assemble(u[: len(self._patch.nodes)], contact, shift, stuck)
        self._patch.renew()

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
