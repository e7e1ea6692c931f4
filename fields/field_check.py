# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Whether a response field keeps the contract of response_field.py; what is written or read passes here."""

from __future__ import annotations

import numpy as np

from palpate.fields.field_error import FieldError
from palpate.fields.lattice import ABSENT_UNREACHED, BLOCK_EDGE, Lattice
from palpate.fields.response_field import ContactGeometry, DepthCurves, ResponseField, ResponseNodes

__all__ = ["check_contact_geometry", "check_field"]

ZERO_AT_CONTACT = 1e-9
"""Largest energy, force or phi at depth 0, as a fraction of its largest value over depth: rounding of a fit.
Larger, and a misfit would pass that makes a force jump at first contact."""


def check_field(field: ResponseField) -> None:
    """Raise FieldError where `field` breaks a shape, a count, or a zero at first contact."""
    where = f"field {field.tool.name!r}"
    check_contact_geometry(field.geometry, where)
    _check_array(field.own_band, (2,), f"{where}: band")
    (low, high), (least, most) = field.own_band, field.geometry.band
    if not least <= low < high <= most:
        raise FieldError(
            f"{where}: band is {low}..{high} m; within the geometry's {least}..{most} m is right"
        )
    _check_nodes(field.nodes, where)
    _check_family(field, where)
    _check_ways(field, where)
    curves = (field.energy_curves, field.stiffness_curves, field.friction_curves)
    for name, group in zip(("energy_curves", "stiffness_curves", "friction_curves"), curves, strict=True):
        _check_curves(group, f"{where}: {name}")
    _check_zero_at_contact(field.energy_curves, f"{where}: energy_curves")
    count = sum(group.curve_count for group in curves)
    _check_lattice(field.amplitudes, f"{where}: amplitudes")
    if field.amplitudes.channel_count != count:
        raise FieldError(
            f"{where}: amplitudes has {field.amplitudes.channel_count} channels; "
            f"{count}, one for each curve, is right"
        )


def check_contact_geometry(geometry: ContactGeometry, where: str = "contact geometry") -> None:
    """Raise FieldError where the signed distance is no one-channel lattice or the band does not rise."""
    _check_lattice(geometry.signed_distance, f"{where}: signed_distance")
    if geometry.signed_distance.channel_count != 1:
        raise FieldError(
            f"{where}: signed_distance has {geometry.signed_distance.channel_count} channels; 1 is right"
        )
    _check_array(geometry.band, (2,), f"{where}: band")
    if not geometry.band[0] < geometry.band[1]:
        raise FieldError(f"{where}: band is {geometry.band} m; smallest before largest is right")


def _check_array(array: np.ndarray, shape: tuple[int, ...], where: str, finite: bool = True) -> None:
    if np.shape(array) != shape:
        raise FieldError(f"{where} has shape {np.shape(array)}; {shape} is right")
    if finite and not np.isfinite(array).all():
        place = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise FieldError(f"{where} is {np.asarray(array)[place]} at {place}; a finite number is right")


def _check_nodes(nodes: ResponseNodes, where: str) -> None:
    if np.ndim(nodes.depth_knots) != 1 or len(nodes.depth_knots) < 2:
        shape = np.shape(nodes.depth_knots)
        raise FieldError(f"{where}: depth_knots has shape {shape}; two or more knots are right")
    knots = np.asarray(nodes.depth_knots)
    if knots[0] != 0 or not (np.diff(knots) > 0).all() or not np.isfinite(knots).all():
        raise FieldError(f"{where}: depth_knots are {knots} m; rising from 0 is right")
    if np.ndim(nodes.position) != 2 or nodes.node_count == 0:
        raise FieldError(f"{where}: position has shape {np.shape(nodes.position)}; (nodes, 3) is right")
    n, k = nodes.node_count, len(knots)
    _check_array(nodes.position, (n, 3), f"{where}: position")
    _check_array(nodes.normal, (n, 3), f"{where}: normal")
    length = np.linalg.norm(nodes.normal, axis=1)
    if not (np.abs(length - 1) < 1e-6).all():
        worst = int(np.argmax(np.abs(length - 1)))
        raise FieldError(f"{where}: normal[{worst}] has length {length[worst]:.6g}; 1 is right")
    for name in ("stored_energy", "normal_force", "friction_stiffness", "friction_coefficient"):
        _check_array(getattr(nodes, name), (n, k), f"{where}: {name}")
    _check_array(nodes.lateral_gradient, (n, k, 3), f"{where}: lateral_gradient")
    for name in ("depth_reached", "residual"):
        _check_array(getattr(nodes, name), (n,), f"{where}: {name}")
    _check_array(nodes.pressed, (n,), f"{where}: pressed", finite=False)
    _check_array(nodes.press_hash, (n,), f"{where}: press_hash", finite=False)
    for name in ("stored_energy", "normal_force", "lateral_gradient"):
        values = np.abs(np.asarray(getattr(nodes, name)).reshape(n, k, -1))
        if values[:, 0].max() > ZERO_AT_CONTACT * values.max():
            worst = int(np.argmax(values[:, 0].max(axis=-1)))
            raise FieldError(
                f"{where}: {name}[{worst}] is {values[worst, 0].max():.3g} at depth 0; 0 is right"
            )


def _check_family(field: ResponseField, where: str) -> None:
    """The members' nodes are the field's, at rising radii, and the field's tool is one of them."""
    if not field.family:
        return
    radii = [member.tool.parameters.get("radius", np.nan) for member in field.family]
    if not (np.diff(radii) > 0).all() or len(radii) < 2:
        raise FieldError(f"{where}: family has radii {radii} m; two or more, rising, are right")
    if field.tool.hash not in [member.tool.hash for member in field.family]:
        raise FieldError(f"{where}: no radius of the family is the field's own tool; one is right")
    for member, radius in zip(field.family, radii, strict=True):
        here = f"{where}: radius {1e3 * radius:.4g} mm"
        _check_nodes(member.nodes, here)
        if len(member.nodes.depth_knots) != len(field.nodes.depth_knots):
            raise FieldError(
                f"{here}: {len(member.nodes.depth_knots)} depth knots; "
                f"{len(field.nodes.depth_knots)}, as at the field's own radius, is right"
            )
        if not np.array_equal(member.nodes.position, field.nodes.position):
            raise FieldError(f"{here}: its nodes lie elsewhere; the field's own places are right")


def _check_ways(field: ResponseField, where: str) -> None:
    """Further ways share the field's nodes and lattice, and tilt further and further from upright."""
    if not field.ways:
        return
    tilts = [field.tool.tilt, *(way.tool.tilt for way in field.ways)]
    if tilts[0] != 0.0 or not (np.diff(tilts) > 0).all() or not tilts[-1] < 0.5 * np.pi:
        raise FieldError(
            f"{where}: ways of touching tilt by {tilts} rad; 0, then rising below pi/2, is right"
        )
    for i, way in enumerate(field.ways, 1):
        here = f"{where}: way {i}"
        _check_nodes(way.nodes, here)
        if not np.array_equal(way.nodes.position, field.nodes.position):
            raise FieldError(f"{here}: its nodes lie elsewhere; the field's own places are right")
        if not np.array_equal(way.nodes.depth_knots, field.nodes.depth_knots):
            raise FieldError(f"{here}: its depth knots are others; the field's own are right")
        _check_lattice(way.amplitudes, f"{here}: amplitudes")
        a, b = field.amplitudes, way.amplitudes
        same = np.array_equal(a.origin, b.origin) and a.spacing == b.spacing
        if not same or a.block_index.shape != b.block_index.shape or a.channel_count != b.channel_count:
            raise FieldError(
                f"{here}: its amplitudes' lattice lies elsewhere; the field's own place is right"
            )


def _check_curves(curves: DepthCurves, where: str) -> None:
    shape = np.shape(curves.coefficients)
    if len(shape) != 3 or shape[1] < 1 or shape[2] != 4:
        raise FieldError(f"{where} has coefficients of shape {shape}; (curves, intervals, 4) is right")
    _check_array(curves.coefficients, shape, where)
    if not (np.isfinite(curves.depth_end) and curves.depth_end > 0):
        raise FieldError(f"{where} ends at depth {curves.depth_end} m; a positive depth is right")


def _check_zero_at_contact(curves: DepthCurves, where: str) -> None:
    step = curves.depth_end / curves.coefficients.shape[1]
    power = step ** np.arange(4)
    for r, terms in enumerate(np.abs(curves.coefficients) * power):
        scale = terms.sum(axis=1).max()
        if terms[0, 0] > ZERO_AT_CONTACT * scale or terms[0, 1] > ZERO_AT_CONTACT * scale:
            value, slope = curves.coefficients[r, 0, :2]
            raise FieldError(
                f"{where}[{r}] has value {value:.3g} J and slope {slope:.3g} N at depth 0; 0 and 0 are right"
            )


def _check_lattice(lattice: Lattice, where: str) -> None:
    shape = np.shape(lattice.coefficients)
    if len(shape) != 5 or shape[1:4] != (BLOCK_EDGE,) * 3 or shape[4] < 1:
        raise FieldError(f"{where} has coefficients of shape {shape}; (blocks, 4, 4, 4, channels) is right")
    _check_array(lattice.coefficients, shape, f"{where} coefficients")
    _check_array(lattice.origin, (3,), f"{where} origin")
    if not (np.isfinite(lattice.spacing) and lattice.spacing > 0):
        raise FieldError(f"{where} has spacing {lattice.spacing} m; a positive one is right")
    index = np.asarray(lattice.block_index)
    if index.ndim != 3 or not np.issubdtype(index.dtype, np.integer):
        raise FieldError(f"{where} has block_index {index.shape} {index.dtype}; (bx, by, bz) int32 is right")
    if index.size and (index.min() < ABSENT_UNREACHED or index.max() >= shape[0]):
        raise FieldError(
            f"{where} has block_index {index.min()}..{index.max()}; "
            f"{ABSENT_UNREACHED}..{shape[0] - 1} is right"
        )
