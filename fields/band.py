# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The part of a contact geometry that one tool needs.

Tools of an asset share its geometry, and each needs a band of its own: the distances between its deepest press and
free space, of a reference point that is a ball's centre or a punch's tip.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from palpate.fields.contact_geometry import HALF_DIAGONAL, known_cells, stencil_coefficients
from palpate.fields.lattice import (
    ABSENT_INSIDE,
    ABSENT_OUTSIDE,
    ABSENT_UNREACHED,
    BLOCK_EDGE,
    Lattice,
)
from palpate.fields.lattice_fit import blocks_of
from palpate.fields.lattice_stencil import sample_lattice
from palpate.fields.response_field import ContactGeometry

__all__ = ["KeptBlocks", "blocks_in_band", "kept_part", "tool_band"]

OUTSIDE = 3e-3
"""m of free space above the surface in which depth is known before contact."""
DEEPER, LEAST_DEEPER = 0.3, 1.5e-3
"""The band goes this share of the depth deeper than any press, at least so many m."""


@dataclass(frozen=True)
class KeptBlocks:
    """Blocks of a lattice that are kept: index (bx, by, bz) int32 of what remains; rows (n,) of the old rows."""

    index: np.ndarray
    rows: np.ndarray


def tool_band(held: Iterable[tuple[float, float]]) -> np.ndarray:
    """(2,) m of phi that a tool needs, `held` in each of its ways and sizes: (offset, deepest press) m."""
    ends = [(offset - depth - max(DEEPER * depth, LEAST_DEEPER), offset + OUTSIDE) for offset, depth in held]
    low, high = zip(*ends, strict=True)
    return np.array([min(low), max(high)])


def blocks_in_band(geometry: ContactGeometry, band: np.ndarray) -> KeptBlocks:
    """Of the signed distance, the blocks below `band` (2,) m; a block that goes says on which side of it it lay."""
    lattice = geometry.signed_distance
    if np.array_equal(band, geometry.band):
        return KeptBlocks(lattice.block_index, np.arange(lattice.block_count))
    low, high = band
    cells = known_cells(lattice)
    phi = sample_lattice(lattice, lattice.origin + (cells + 0.5) * lattice.spacing).value[:, 0]
    half = HALF_DIAGONAL * lattice.spacing
    shape = tuple(BLOCK_EDGE * n for n in lattice.block_index.shape)
    wanted = cells[(phi > low - half) & (phi < high + half)]
    kept = blocks_of(stencil_coefficients(wanted, shape)) & (lattice.block_index >= 0)
    rows = np.unique(lattice.block_index[kept])
    new_row = np.full(lattice.block_count, -1)
    new_row[rows] = np.arange(len(rows))
    index = lattice.block_index.copy()
    index[kept] = new_row[index[kept]]
    gone = ~kept & (lattice.block_index >= 0)
    index[gone] = _side(lattice, lattice.block_index[gone], low, high)
    return KeptBlocks(index, rows)


def kept_part(geometry: ContactGeometry, band: np.ndarray) -> Lattice:
    """The signed distance as a file of `band` (2,) m holds it."""
    lattice, kept = geometry.signed_distance, blocks_in_band(geometry, band)
    return replace(lattice, block_index=kept.index, coefficients=lattice.coefficients[kept.rows])


def _side(lattice: Lattice, rows: np.ndarray, low: float, high: float) -> np.ndarray:
    """Why blocks `rows` (n,) are not there: deeper than the band, free, or in it and reached by no known cell."""
    values = lattice.coefficients[rows].reshape(len(rows), BLOCK_EDGE**3)
    side = np.full(len(rows), ABSENT_UNREACHED)
    side[values.max(axis=1) < low] = ABSENT_INSIDE
    side[values.min(axis=1) > high] = ABSENT_OUTSIDE
    return side
