# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A patch's Hessian over its own nodes and the far field's modes, whose interface nodes follow the modes.

With J = du_I/dy, the slope of the interface's displacement in the modes' coordinates y,

    H_py = K_pI J,    H_yy = J^T K_II J + (the coordinates' further stiffness)

Every place is found once for a patch; a Newton step only moves numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from palpate.fem_offline.hessian_pattern import ELEMENT_ENTRIES, HessianPattern, hessian_pattern

__all__ = ["ModalReduction", "modal_reduction"]


@dataclass(frozen=True)
class ModalReduction:
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


def modal_reduction(
    elements: np.ndarray, count: int, held: np.ndarray, interface: np.ndarray, modes: int
) -> ModalReduction:
    """The reduction for a patch of `count` nodes.

    Args:
        elements: (E, 10) of the patch.
        held, interface: node indices that do not move, and that follow the modes.
        modes: coordinates; their equations come after the patch's.
    """
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
        equation, total, start, column[order].astype(np.int32), np.zeros((0, len(ELEMENT_ENTRIES)), np.int32)
    )
    ends = np.cumsum([np.count_nonzero(both), len(coupled) * modes])
    own_to, coupled_to, modal = np.split(place, ends)
    return ModalReduction(
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
