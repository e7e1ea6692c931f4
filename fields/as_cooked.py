# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A field with exactly the numbers that the runtime will read.

Cooking rounds (geometry to 16-bit counts, amplitudes to float32).  Rounded first, an asset's USD holds the very
potential that the runtime renders, and energies recomputed from the USD balance to the last bits.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from palpate.fields.cook import cook, geometry_counts
from palpate.fields.response_field import ContactGeometry, ResponseField
from palpate.fields.rfield_read import read_rfield

__all__ = ["as_cooked", "rounded_geometry"]

ROUNDED_BEFORE = 1e-15
"""m; counts of 1e-9 m and more, and their products' last bits."""


def as_cooked(field: ResponseField) -> ResponseField:
    """`field` with rounded geometry, amplitudes and curves; nodes, errors and provenance as they are."""
    data = cook(field)
    rounded = read_rfield(data)
    ways = [replace(way, amplitudes=read_rfield(data, 1 + i).amplitudes) for i, way in enumerate(field.ways)]
    return replace(
        field,
        geometry=rounded_geometry(field.geometry),
        amplitudes=rounded.amplitudes,
        energy_curves=rounded.energy_curves,
        stiffness_curves=rounded.stiffness_curves,
        friction_curves=rounded.friction_curves,
        ways=tuple(ways),
    )


def rounded_geometry(geometry: ContactGeometry) -> ContactGeometry:
    """`geometry` with the distances that a file would hold; one that was rounded before stays as it is, bit by bit."""
    lattice = geometry.signed_distance
    counts, scale, bias = geometry_counts(lattice)
    distance = (bias + scale * counts.astype(float))[..., None]
    if np.abs(distance - lattice.coefficients).max() <= ROUNDED_BEFORE:
        return geometry
    return replace(geometry, signed_distance=replace(lattice, coefficients=distance))
