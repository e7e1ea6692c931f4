# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Where the entries of a Hessian lie: compressed rows of its upper triangle, and each element's places in them.

Built from pairs of nodes, whose blocks of 3 x 3 have places that can be computed: a sixth of the time that sorting
single entries takes (12,000 quadratic tetrahedra).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse

__all__ = ["ELEMENT_ENTRIES", "HessianPattern", "hessian_pattern"]


ELEMENT_ENTRIES = [
    (i, j, a, b)
    for i in range(3)
    for j in range(i, 3)
    for a in range(10)
    for b in range(a if i == j else 0, 10)
]
"""K_ai,bj of a quadratic tetrahedron, each pair once, in the order in which the kernel adds them (assembly.py)."""


@dataclass(frozen=True)
class HessianPattern:
    """Upper triangle, in compressed rows, of a symmetric matrix over the free equations.

    Attributes:
        equation: (3 N,) int; equation of each displacement component, -1 where fixed.
        equation_count: number of free equations.
        row_start: (n + 1,) int; column: (nnz,) int; diagonal present in every row.
        entry: (T, 465) int32; place of each entry of an element's Hessian in `ELEMENT_ENTRIES`, -1 where fixed.
    """

    equation: np.ndarray
    equation_count: int
    row_start: np.ndarray
    column: np.ndarray
    entry: np.ndarray

    def places(self, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """Places of entries (rows <= columns) in the value array; every entry must exist."""
        key = rows.astype(np.int64) * self.equation_count + columns
        at = np.searchsorted(self._keys, key)
        if np.any(self._keys[np.minimum(at, len(self._keys) - 1)] != key):
            raise KeyError("an entry lies outside the pattern")
        return at

    @property
    def rows(self) -> np.ndarray:
        """(nnz,) row of each entry."""
        return np.repeat(np.arange(self.equation_count, dtype=np.int64), np.diff(self.row_start))

    @property
    def _keys(self) -> np.ndarray:
        return self.rows * self.equation_count + self.column

    def matrix(self, values: np.ndarray) -> sparse.csr_matrix:
        """Upper triangle as a SciPy matrix that shares its arrays."""
        shape = (self.equation_count, self.equation_count)
        return sparse.csr_matrix((values, self.column, self.row_start), shape=shape)


@dataclass(frozen=True)
class _NodePairs:
    """Pairs of nodes (low <= high) that couple, sorted; every node with itself.

    Attributes:
        keys: (P,) low * count + high.  start: (count + 1,) first pair of each node.
    """

    count: int
    keys: np.ndarray
    start: np.ndarray

    @property
    def row_start(self) -> np.ndarray:
        """(3 count + 1,) of the three rows of each node: its own upper block, then three columns for each neighbour."""
        neighbours = np.diff(self.start) - 1
        lengths = 3 * neighbours[:, None] + np.array([3, 2, 1])
        return np.concatenate([[0], np.cumsum(lengths.ravel())])

    def column(self) -> np.ndarray:
        """(nnz,) of all rows."""
        low, high = self.keys // self.count, self.keys % self.count
        blocks = []  # of components 0, 1, 2 of the low node: which columns each pair adds
        for i in range(3):
            columns = 3 * high[:, None] + np.arange(3)
            wanted = (high != low)[:, None] | (np.arange(3) >= i)
            pair, _ = np.nonzero(wanted)
            blocks.append((3 * low[pair] + i, columns[wanted]))
        row = np.concatenate([block[0] for block in blocks])
        column = np.concatenate([block[1] for block in blocks])
        return column[np.lexsort((column, row))]

    def positions(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """How many pairs of the low node come before each pair; 0: the node itself."""
        return np.searchsorted(self.keys, low * self.count + high) - self.start[low]


def _node_pairs(elements: np.ndarray, count: int, groups: Sequence[np.ndarray]) -> _NodePairs:
    first, second = np.triu_indices(elements.shape[1])
    a, b = elements[:, first].astype(np.int64), elements[:, second].astype(np.int64)
    keys = [
        np.arange(count, dtype=np.int64) * (count + 1),
        (np.minimum(a, b) * count + np.maximum(a, b)).ravel(),
    ]
    for group in groups:
        nodes = np.unique(np.asarray(group) // 3)
        i, j = np.triu_indices(len(nodes))
        keys.append(nodes[i] * count + nodes[j])
    unique = np.unique(np.concatenate(keys))
    return _NodePairs(count, unique, np.searchsorted(unique, np.arange(count + 1, dtype=np.int64) * count))


def hessian_pattern(
    elements: np.ndarray, fixed: np.ndarray, dense_groups: Sequence[np.ndarray]
) -> HessianPattern:
    """Pattern of the Hessian.

    Args:
        elements: (T, 10) node indices.
        fixed: (3 N,) bool; displacement components that are held.
        dense_groups: index arrays of displacement components whose nodes couple all with all (a condensed far field).
    """
    count = len(fixed) // 3
    pairs = _node_pairs(elements, count, dense_groups)
    row_start, column = pairs.row_start, pairs.column()
    free = ~fixed
    equation = np.where(free, np.cumsum(free) - 1, -1)
    row = np.repeat(np.arange(len(fixed)), np.diff(row_start))
    kept = free[row] & free[column]
    place = np.where(kept, np.cumsum(kept) - 1, -1).astype(np.int32)
    n = int(np.count_nonzero(free))
    starts = np.concatenate([[0], np.cumsum(np.bincount(equation[row[kept]], minlength=n))])
    entry = _entries(elements, pairs, row_start, place)
    return HessianPattern(
        equation, n, starts.astype(np.int32), equation[column[kept]].astype(np.int32), entry
    )


def _entries(elements: np.ndarray, pairs: _NodePairs, row_start: np.ndarray, place: np.ndarray) -> np.ndarray:
    """(T, 465) int32.  Each goes to the global upper triangle."""
    entry = np.full((len(elements), len(ELEMENT_ENTRIES)), -1, np.int32)
    position: dict[tuple[int, int], np.ndarray] = {}
    for n, (i, j, a, b) in enumerate(ELEMENT_ENTRIES):
        A, B = elements[:, a].astype(np.int64), elements[:, b].astype(np.int64)
        if a == b:
            at = row_start[3 * A + i] + (j - i)
        else:  # the row is the lower node's component
            between = min(a, b), max(a, b)
            if between not in position:
                position[between] = pairs.positions(np.minimum(A, B), np.maximum(A, B))
            swapped = A > B
            row = np.where(swapped, 3 * B + j, 3 * A + i)
            own, other = np.where(swapped, j, i), np.where(swapped, i, j)
            at = row_start[row] + (3 - own) + 3 * (position[between] - 1) + other
        entry[:, n] = place[at]
    return entry
