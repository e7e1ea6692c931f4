# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A field with exactly the numbers that the runtime will read.

Cooking rounds (geometry to 16-bit counts, amplitudes to float32).  Rounded first, an asset's USD holds the very
potential that the runtime renders, and energies recomputed from the USD balance to the last bits.
"""

from __future__ import annotations

from dataclasses import replace

from palpate.fields.cook import cook
from palpate.fields.response_field import ResponseField
from palpate.fields.rfield_read import read_rfield

__all__ = ["as_cooked"]


def as_cooked(field: ResponseField) -> ResponseField:
    """`field` with rounded geometry, amplitudes and curves; nodes, errors and provenance as they are."""
    rounded = read_rfield(cook(field))
    lattice = replace(
        field.geometry.signed_distance, coefficients=rounded.geometry.signed_distance.coefficients
    )
    return replace(
        field,
        geometry=replace(field.geometry, signed_distance=lattice),
        amplitudes=rounded.amplitudes,
        energy_curves=rounded.energy_curves,
        stiffness_curves=rounded.stiffness_curves,
        friction_curves=rounded.friction_curves,
    )
