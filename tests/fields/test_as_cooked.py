# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rounding as the runtime's file does: once, whatever is written and read in between."""

import numpy as np
from synthetic_field import synthetic_field

from palpate.fields.as_cooked import as_cooked
from palpate.fields.cook import cook
from palpate.fields.rfield_read import read_rfield
from palpate.fields.usd_response import contact_hash


def test_a_rounded_field_is_what_its_file_holds_and_rounding_it_again_changes_no_bit():
    field = synthetic_field()
    rounded = as_cooked(field)
    distance = rounded.geometry.signed_distance.coefficients
    assert 0.0 < np.abs(distance - field.geometry.signed_distance.coefficients).max() < 0.5e-6
    again = as_cooked(rounded)
    assert contact_hash(again.geometry) == contact_hash(rounded.geometry) != contact_hash(field.geometry)
    held = read_rfield(cook(rounded))
    assert np.abs(held.geometry.signed_distance.coefficients - distance).max() < 1e-15
    assert np.array_equal(held.amplitudes.coefficients, rounded.amplitudes.coefficients)
