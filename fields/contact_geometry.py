# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The organ's signed distance as a lattice, in the band of space that a tool's reference point can visit.

A point q counts as known when all blocks under its 27 coefficients are stored (response_field.py, lattice.py).
Wanted cells are those that meet the band and the reach; every block that they touch is stored, and every cell
that touches a stored block is sampled, so no stored coefficient is left to chance.  Outside the band the distance
of a real organ has creases (its medial axis); samples there weigh a tenth, to determine and not to disturb.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy import ndimage

from palpate.fields.lattice import ABSENT_INSIDE, ABSENT_OUTSIDE, ABSENT_UNREACHED, BLOCK_EDGE, Lattice
from palpate.fields.lattice_fit import LatticeFit, blocks_of, lattice_from_values
from palpate.fields.lattice_stencil import sample_lattice
from palpate.fields.response_field import ContactGeometry

__all__ = ["ScalarField", "contact_geometry", "known_cells"]

ScalarField = Callable[[np.ndarray], np.ndarray]
"""(n, 3) m -> (n,) m."""

HALF_DIAGONAL = np.sqrt(3.0) / 2.0
CREASE = 0.9
"""|grad phi| below this marks a crease or a thin lobe, where depth is not what it says."""


def contact_geometry(
    signed_distance: ScalarField,
    reach: ScalarField,
    bounds: np.ndarray,
    band: tuple[float, float],
    *,
    spacing: float = 1.5e-3,
    reach_margin: float = 15e-3,
    check_count: int = 4000,
    seed: int = 0,
) -> ContactGeometry:
    """Fit the signed distance near the reachable surface.

    Args:
        signed_distance: (n, 3) -> (n,) m, positive outside the tissue; the surface that FEM presses.
        reach: (n, 3) -> (n,) m; <= 0 where the scene lets the tool touch, metres beyond elsewhere.
        bounds: (2, 3) m; box that the lattice may use (space beyond it counts as free).
        band: (low, high) m; phi of the tool's reference point from deepest press to just outside contact.
        spacing: m.
        reach_margin: m beyond the reach that is still covered; at least the margin in which the
            response's amplitudes end (build_field).
        check_count: fresh points of the band within the reach, which measure the error.
        seed: of the check points.

    Raises:
        ValueError: nothing of the band lies within reach and bounds.
    """
    low, high = band
    if not (spacing > 0 and high > low):
        raise ValueError(
            f"contact geometry: spacing {spacing} m and band {band} m: spacing > 0 and low < high needed"
        )
    edge = BLOCK_EDGE * spacing
    origin = np.asarray(bounds[0], dtype=float) - spacing
    block_shape = np.maximum(np.ceil((np.asarray(bounds[1]) + spacing - origin) / edge).astype(int), 1)

    # Blocks that may meet the band, padded by one block for stencils.
    grid = np.stack(np.meshgrid(*[np.arange(n) for n in block_shape], indexing="ij"), axis=-1)
    centre = origin + (grid.reshape(-1, 3) + 0.5) * edge
    phi_block = signed_distance(centre).reshape(block_shape)
    reach_block = reach(centre).reshape(block_shape)
    slack = (HALF_DIAGONAL + 0.5) * edge
    near = (phi_block > low - slack) & (phi_block < high + slack)
    inspect = near & (reach_block < reach_margin + slack)

    cell = cells_in(ndimage.binary_dilation(inspect, np.ones((3, 3, 3))))
    where = origin + (cell + 0.5) * spacing
    phi, beyond = signed_distance(where), reach(where)
    half = HALF_DIAGONAL * spacing
    in_band = (phi > low - half) & (phi < high + half)
    wanted = in_band & (beyond <= reach_margin + half)
    shape = tuple(BLOCK_EDGE * block_shape)
    fits = np.all(cell + 2 < np.array(shape), axis=1)  # a stencil must lie in the grid
    wanted &= fits
    if not wanted.any():
        raise ValueError("contact geometry: no cell of the band lies within reach and bounds")
    present = blocks_of(stencil_coefficients(cell[wanted], shape))
    stored = np.repeat(np.repeat(np.repeat(present, BLOCK_EDGE, 0), BLOCK_EDGE, 1), BLOCK_EDGE, 2)

    # Sampled: all cells that touch a stored coefficient.  Coefficients that these cells touch beyond the stored
    # blocks are solved for too and dropped; leaving them out would bend the stored ones towards zero.
    padded = np.pad(stored, 2)
    all_cells = np.argwhere(stencil_cells(padded))
    fit = LatticeFit(origin - 2 * spacing, spacing, stencil_coefficients(all_cells, padded.shape))
    all_cells = all_cells - 2
    rng = np.random.default_rng(seed)
    points = origin + (all_cells + rng.uniform(0.25, 0.75, all_cells.shape)) * spacing
    extra = origin + (cell[wanted] + rng.uniform(0.0, 1.0, (int(wanted.sum()), 3))) * spacing
    points = np.concatenate([points, extra])
    value = signed_distance(points)
    weight = np.where((value > low - edge / 2) & (value < high + edge / 2), 1.0, 0.1)
    coefficients = fit.solve(points, value[:, None], weight, smoothing=1e-4, hold=1e-9)

    dense = np.zeros((*padded.shape, 1))
    dense[tuple(fit.index.T)] = coefficients
    absent = absent_labels(phi_block, cell[in_band & ~wanted], low, high)
    lattice = lattice_from_values(origin, spacing, dense[2:-2, 2:-2, 2:-2], present, absent)
    reached = cell[wanted & (beyond <= 0.0)] if (wanted & (beyond <= 0.0)).any() else cell[wanted]
    drawn = reached[rng.integers(0, len(reached), check_count)]
    check = origin + (drawn + rng.uniform(0, 1, (check_count, 3))) * spacing
    truth = signed_distance(check)
    keep = (truth >= low) & (truth <= high) & (reach(check) <= 0.0)
    if not keep.any():
        return ContactGeometry(lattice, np.array([low, high]))
    sample = sample_lattice(lattice, check[keep])
    error = np.abs(sample.value[:, 0] - truth[keep])
    slope = np.linalg.norm(sample.gradient[:, 0], axis=1)
    return ContactGeometry(
        lattice, np.array([low, high]), float(np.quantile(error, 0.99)), float(np.mean(slope < CREASE))
    )


def cells_in(blocks: np.ndarray) -> np.ndarray:
    """(m, 3) cells whose index lies in the marked `blocks` (bx, by, bz)."""
    offset = np.stack(np.meshgrid(*[np.arange(BLOCK_EDGE)] * 3, indexing="ij"), axis=-1).reshape(1, -1, 3)
    return (np.argwhere(blocks)[:, None, :] * BLOCK_EDGE + offset).reshape(-1, 3)


def stencil_cells(coefficients: np.ndarray) -> np.ndarray:
    """Cells that touch any of the marked `coefficients`, bool arrays of one shape; two free layers all round."""
    cells = np.zeros_like(coefficients)
    for x, y, z in np.ndindex(3, 3, 3):  # coefficient j is touched by cells j - 2, j - 1, j
        cells |= np.roll(coefficients, (-x, -y, -z), axis=(0, 1, 2))
    return cells


def stencil_coefficients(cells: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """Coefficients, bool of `shape`, that `cells` (m, 3) touch."""
    marked = np.zeros(shape, dtype=bool)
    for offset in np.ndindex(3, 3, 3):
        marked[tuple((cells + offset).T)] = True
    return marked


def absent_labels(phi_block: np.ndarray, unreached_cells: np.ndarray, low: float, high: float) -> np.ndarray:
    """Why a block is not stored: free space, deep tissue, or (any band cell in it) out of reach."""
    label = np.where(phi_block < 0.5 * (low + high), ABSENT_INSIDE, ABSENT_OUTSIDE)
    label[(phi_block >= low) & (phi_block <= high)] = ABSENT_UNREACHED
    label[tuple((unreached_cells // BLOCK_EDGE).T)] = ABSENT_UNREACHED
    return label


def known_cells(lattice: Lattice) -> np.ndarray:
    """(m, 3) cells of `lattice` whose 27 coefficients are all stored."""
    stored = lattice.block_index >= 0
    for axis in range(3):
        stored = np.repeat(stored, BLOCK_EDGE, axis=axis)
    for axis in range(3):  # cell i needs coefficients i, i + 1, i + 2
        n = stored.shape[axis]
        stored = (
            np.take(stored, range(n - 2), axis)
            & np.take(stored, range(1, n - 1), axis)
            & np.take(stored, range(2, n), axis)
        )
    return np.argwhere(stored)
