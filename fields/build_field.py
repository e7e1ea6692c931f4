# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""From response nodes and contact geometry to the field that the runtime reads.

1. Krige log(Phi / d^2.5) over the surface at every depth knot, B as gradient data (site_curves.py).
2. Sample tool positions through the band, predict a curve for each, find a few shared curves and amplitudes.
3. Fit the amplitudes to a lattice, constant along the normal; beyond the reach its coefficients end, so that
   amplitudes and their slopes fall to zero within the margin.
4. Measure what that lost, at the nodes and between them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import ndimage
from scipy.spatial import KDTree

from palpate.fields.band import kept_part
from palpate.fields.contact_geometry import ScalarField, known_cells
from palpate.fields.interpolation import evaluate
from palpate.fields.lattice import ABSENT_UNREACHED, BLOCK_EDGE, Lattice
from palpate.fields.lattice_fit import LatticeFit, blocks_of, lattice_from_values
from palpate.fields.lattice_stencil import sample_lattice, stencil
from palpate.fields.low_rank import low_rank_energy, low_rank_values, second_derivatives
from palpate.fields.response_field import (
    ContactGeometry,
    DepthCurves,
    ResponseField,
    ResponseNodes,
    TiltedWay,
    ToolReference,
)
from palpate.fields.site_curves import SiteCurves
from palpate.fields.surface_curvature import foot_points

__all__ = ["build_field"]

INTERVALS = 32
"""Uniform intervals of the shared curves (count); the first ends at 0.5 % of a Hertz contact's deepest force."""
LEAST_MARGIN = 3.75
"""Least margin, in amplitude spacings: 1.5 leave the reach alone, 2.125 are a coefficient's support, some slack."""
NODE_WEIGHT = 4.0
"""Weight of a sample at a node's own press against one between nodes."""
CHECKS = 5000
"""Samples between nodes at which the field is held against kriging (count, about)."""
SMOOTHING, HOLD = 1e-3, 1e-6
"""Second and first differences of amplitude coefficients against one sample; only where samples are silent."""


def build_field(
    nodes: ResponseNodes,
    geometry: ContactGeometry,
    tool: ToolReference,
    reach: ScalarField,
    *,
    amplitude_spacing: float = 4e-3,
    rank: int = 3,
    margin: float = 15e-3,
    normal_length: float = 20e-3,
    with_gradients: bool = True,
    provenance: dict[str, Any] | None = None,
    tilted: Sequence[tuple[ToolReference, ResponseNodes]] = (),
    band: np.ndarray | None = None,
) -> ResponseField:
    """Build the response field.

    Args:
        nodes: response nodes; their last depth knot is the field's depth_max.
        geometry: contact geometry that covers the reach plus `margin`.
        tool: the tool that pressed.
        reach: (n, 3) -> (n,) m; <= 0 where the scene lets the tool touch, metres beyond elsewhere.
        amplitude_spacing: m, of the amplitude lattice.
        rank: shared energy curves (count); one more with several ways of touching.
        margin: m beyond the reach within which the field ends; the geometry must cover it.  Below 3.75 amplitude
            spacings the end would be felt within the reach, so that is refused.
        normal_length: L of the embedding, m (kriging.py).
        with_gradients: krige with B; without it only for comparison, it costs twice the presses.
        provenance: copied to the field.
        tilted: further ways of touching, by rising tilt: the same tool held otherwise, its nodes at the same places
            and knots.  All ways share curves of depth and the lattice's place; amplitudes are each one's own.
        band: (2,) m that the tool needs; kept as far as the geometry's reaches, and all of that when None.

    Returns:
        The field; `representation` holds errors as fractions (see `representation_errors` and `SiteCurves.report`),
        those of a further way under "way1_..." and so on.

    Raises:
        ValueError: energy or force of a node is not positive at a depth knot above 0, nothing is in reach, or the
            margin is too small.
    """
    if margin < LEAST_MARGIN * amplitude_spacing:
        raise ValueError(
            f"response field: margin {margin} m: at least {LEAST_MARGIN} amplitude spacings of "
            f"{amplitude_spacing} m needed"
        )
    depth_end = float(nodes.depth_knots[-1])
    band = geometry.band if band is None else np.clip(band, *geometry.band)
    depth = depth_end * (np.arange(2 * INTERVALS) + 1) / (2 * INTERVALS)
    ways = []
    for held, own in ((tool, nodes), *tilted):
        sites = SiteCurves.from_nodes(
            own, geometry, held.offset, normal_length, with_gradients=with_gradients
        )
        samples = _samples(own, geometry, held.offset, reach, amplitude_spacing, margin, band)
        ways.append((held, own, sites, samples, sites.at(samples.surface, samples.normal, depth)))
    second = [
        second_derivatives(depth, curves.energy, curves.force, depth_end, INTERVALS, convex=sites.convex)
        for _, _, sites, _, curves in ways
    ]
    energy = low_rank_energy(np.concatenate(second), depth_end, rank + (len(ways) > 1))
    stiffness_curves, stiffness = shared_or_zero(
        np.concatenate([curves.friction_stiffness for *_, curves in ways]), depth_end, 2
    )
    friction_curves, friction = shared_or_zero(
        np.concatenate([curves.friction_coefficient for *_, curves in ways]), depth_end, 2
    )
    targets = np.concatenate([energy.amplitudes, stiffness, friction], axis=1)
    ends = np.cumsum([len(samples.q) for *_, samples, _ in ways])[:-1]
    frame = lattice_frame([a for *_, s, _ in ways for a in (s.q, s.cells)], amplitude_spacing)
    lattices = []
    for (*_, samples, curves), wanted in zip(ways, np.split(targets, ends), strict=True):
        deepest = curves.force[:, -1]
        weight = samples.weight * (np.exp(np.mean(np.log(deepest))) / deepest) ** 2
        lattices.append(
            amplitude_lattice(
                samples.q, wanted, weight, samples.cells, samples.beyond, amplitude_spacing, margin, frame
            )
        )
    field = ResponseField(
        tool,
        geometry,
        nodes,
        energy.curves,
        stiffness_curves,
        friction_curves,
        lattices[0],
        depth_end,
        {},
        dict(provenance or {}),
        ways=tuple(
            TiltedWay(held, own, lattice)
            for (held, own, *_), lattice in zip(ways[1:], lattices[1:], strict=True)
        ),
        band=band,
    )
    field.representation["low_rank_force_p95"] = energy.error_p95
    for i, ((_, _, sites, s, _), own) in enumerate(zip(ways, field.fields_by_way(), strict=True)):
        inside = s.inside
        errors = representation_errors(own, sites, s.q[inside], s.surface[inside], s.normal[inside])
        prefix = f"way{i}_" if i else ""
        field.representation.update(
            {prefix + name: value for name, value in (sites.report() | errors).items()}
        )
    return field


@dataclass(frozen=True)
class _Samples:
    """Tool positions of one way at which amplitudes are found, n of them.

    Attributes:
        q, surface: (n, 3) m, the tool's reference point and its surface point.  normal: (n, 3).
        weight: (n,).  inside: indices of those between nodes that lie within reach.
        cells: (m, 3) m, all positions that the field has to hold.  beyond: (m,) m, of each beyond the reach.
    """

    q: np.ndarray
    surface: np.ndarray
    normal: np.ndarray
    weight: np.ndarray
    inside: np.ndarray
    cells: np.ndarray
    beyond: np.ndarray


def _samples(
    nodes: ResponseNodes,
    geometry: ContactGeometry,
    offset: float,
    reach: ScalarField,
    spacing: float,
    margin: float,
    band: np.ndarray,
) -> _Samples:
    """Samples through the band, and at every knot of the nodes' own presses."""
    q, surface, normal, cells, beyond = band_samples(geometry, offset, reach, spacing, margin, band)
    inside = np.flatnonzero(reach(surface) <= 0)
    held = nodes.position[:, None] + (offset - nodes.depth_knots[None, 1:, None]) * nodes.normal[:, None]
    repeat = nodes.depth_knots.size - 1
    weight = np.concatenate([np.ones(len(q)), np.full(held.shape[0] * repeat, NODE_WEIGHT)])
    return _Samples(
        np.concatenate([q, held.reshape(-1, 3)]),
        np.concatenate([surface, np.repeat(nodes.position, repeat, axis=0)]),
        np.concatenate([normal, np.repeat(nodes.normal, repeat, axis=0)]),
        weight,
        inside,
        cells,
        beyond,
    )


def band_samples(
    geometry: ContactGeometry,
    offset: float,
    reach: ScalarField,
    spacing: float,
    margin: float,
    band: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Tool positions where the amplitudes are to be known.

    Returns:
        Of the samples, at most one in each (spacing / 2)^3 of the band: position (n, 3) m, surface point (n, 3) m,
        normal (n, 3).  Then all positions (m, 3) m that a file of `band` (2,) m knows, in contact or nearly, and not
        beyond the margin, and how far beyond the reach (m,) m each one's surface point lies.  Amplitudes that ended
        before what is known would pull a tool in that is deeper than any press.
    """
    lattice = kept_part(geometry, band)
    points = lattice.origin + (known_cells(lattice) + 0.5) * lattice.spacing
    phi = sample_lattice(lattice, points).value[:, 0]
    points, phi = points[phi < offset + lattice.spacing], phi[phi < offset + lattice.spacing]
    surface, normal = foot_points(geometry, points)
    beyond = reach(surface)
    if not (beyond <= 0).any():
        raise ValueError("response field: no tool position in contact lies within the reach")
    near = beyond < margin
    points, phi, surface, normal, beyond = (a[near] for a in (points, phi, surface, normal, beyond))
    sampled = phi > band[0] - 0.5 * spacing
    voxel = np.floor(points[sampled] / (0.5 * spacing)).astype(np.int64)
    _, first = np.unique(voxel, axis=0, return_index=True)
    chosen = np.flatnonzero(sampled)[np.sort(first)]
    return points[chosen], surface[chosen], normal[chosen], points, beyond


def shared_or_zero(values: np.ndarray, depth_end: float, rank: int) -> tuple[DepthCurves, np.ndarray]:
    """Shared curves and amplitudes of positive `values` (S, M + 1); a constant curve where depth does not matter, none
    where all is zero: what is not there is not stored, and not summed in a tick."""
    usual = values.mean(axis=0)
    if not values.any():
        return DepthCurves(depth_end, np.zeros((0, INTERVALS, 4))), np.zeros((len(values), 0))
    if np.ptp(values, axis=1).max() < 1e-9 * usual.max():
        constant = np.zeros((1, INTERVALS, 4))
        constant[..., 0] = 1.0
        return DepthCurves(depth_end, constant), values[:, :1].copy()
    result = low_rank_values(values, depth_end, rank)
    return result.curves, result.amplitudes


def lattice_frame(positions: Sequence[np.ndarray], spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Origin (3,) m and coefficients along each axis (3,) of a lattice that holds all `positions` (each (n, 3) m)."""
    low = np.min([q.min(axis=0) for q in positions], axis=0)
    high = np.max([q.max(axis=0) for q in positions], axis=0)
    origin = np.floor(low / spacing) * spacing - 4 * spacing
    return origin, BLOCK_EDGE * np.ceil((high + 5 * spacing - origin) / (BLOCK_EDGE * spacing)).astype(int)


def amplitude_lattice(
    q: np.ndarray,
    targets: np.ndarray,
    weight: np.ndarray,
    cells: np.ndarray,
    beyond: np.ndarray,
    spacing: float,
    margin: float,
    frame: tuple[np.ndarray, np.ndarray] | None = None,
) -> Lattice:
    """Fit channels `targets` (n, C) at `q` (n, 3) and end them within `margin` m of the reach.

    Every coefficient that the positions `cells` (m, 3) touch is solved for.  Then each is scaled by how far `beyond`
    the reach its nearest position is: 1 up to margin - 2.25 spacings, 0 from margin - 2.125 spacings on, where its
    support (1.5 spacings along the axes, 2.12 across) would leave the margin.  The spline stays C1 whatever its
    coefficients are; scaling them, rather than fitting tapered targets, keeps the steep edge from disturbing the
    reach.  Two more coefficients all round are stored as zeros, so that it does not matter whether a reader takes
    an absent block for zeros or takes every cell that touches one for zero.  `frame` as `lattice_frame` gives it.
    """
    origin, shape = frame or lattice_frame([q, cells], spacing)
    wanted = np.zeros(tuple(shape), dtype=bool)
    wanted[tuple(stencil(cells, origin, spacing).index.reshape(-1, 3).T)] = True
    fit = LatticeFit(origin, spacing, wanted)
    coefficients = fit.solve(q, targets, weight, smoothing=SMOOTHING, hold=HOLD)
    centre = origin + (fit.index - 0.5) * spacing  # coefficient j's B-spline is centred in cell j - 1
    _, nearest = KDTree(cells).query(centre)
    kept = np.clip((margin / spacing - 2.125 - beyond[nearest] / spacing) / 0.125, 0.0, 1.0)
    dense = np.zeros((*wanted.shape, targets.shape[1]))
    dense[tuple(fit.index.T)] = coefficients * kept[:, None]
    nonzero = np.zeros(wanted.shape, dtype=bool)
    nonzero[tuple(fit.index[kept > 0].T)] = True
    present = blocks_of(ndimage.binary_dilation(nonzero, np.ones((5, 5, 5))))
    return lattice_from_values(origin, spacing, dense, present, np.full(present.shape, ABSENT_UNREACHED))


def representation_errors(
    field: ResponseField, sites: SiteCurves, q: np.ndarray, surface: np.ndarray, normal: np.ndarray
) -> dict[str, float]:
    """What the lattice and the shared curves lost.

    At the nodes' own presses, as fractions of the node's deepest force: `node_force_*` (normal), `node_lateral_*`
    (against B), and of its deepest energy: `node_energy_*`.  At samples between, against the kriged curve at
    the same place and depth, relative to the force there: `site_force_*`.  `falling_force_share`: share of samples
    where Phi'' < 0 though no node has it.
    """
    nodes = field.nodes
    knots = nodes.depth_knots[1:]
    at = (
        nodes.position[:, None] + (field.tool.offset - knots[None, :, None]) * nodes.normal[:, None]
    ).reshape(-1, 3)
    said = evaluate(field, at)
    shape = (nodes.node_count, len(knots))
    deepest = nodes.normal_force[:, -1:]
    n = np.repeat(nodes.normal, len(knots), axis=0)
    normal_part = np.sum(said.force * n, axis=1)
    lateral = (said.gradient + normal_part[:, None] * n).reshape(*shape, 3)
    reached = knots[None] <= nodes.depth_reached[:, None] * (1 + 1e-6)
    measured = {
        "node_force": np.abs(normal_part.reshape(shape) - nodes.normal_force[:, 1:]) / deepest,
        "node_energy": np.abs(said.energy.reshape(shape) - nodes.stored_energy[:, 1:])
        / nodes.stored_energy[:, -1:],
        "node_lateral": np.linalg.norm(lateral - nodes.lateral_gradient[:, 1:], axis=-1) / deepest,
    }
    out: dict[str, float] = {}
    for name, error in measured.items():
        out[f"{name}_p95"] = float(np.quantile(error[reached], 0.95))
        out[f"{name}_max"] = float(error[reached].max())
    some = slice(None, None, max(1, len(q) // CHECKS))
    q, surface, normal = q[some], surface[some], normal[some]
    said = evaluate(field, q)
    depth = said.depth
    felt = said.valid & (depth > 0.15 * field.depth_max) & (depth <= field.depth_max)
    if felt.any():
        expected = sites.at_own_depth(surface[felt], normal[felt], depth[felt])
        error = np.abs(said.normal_force[felt] / expected - 1.0)
        out["site_force_p95"] = float(np.quantile(error, 0.95))
        out["site_force_max"] = float(error.max())
    return out
