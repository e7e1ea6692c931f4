# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Quantities: numbers are SI, strings carry their unit, a wrong unit is told by its dimension."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.author.units import DIMENSIONS, QuantityError, quantity


@pytest.mark.parametrize(
    ("text", "dimension", "expected"),
    [
        ("3 mm", "length", 3e-3),
        ("50 um", "length", 50e-6),
        ("50 µm", "length", 50e-6),
        ("5 kPa", "pressure", 5e3),
        ("1e-2 MPa", "pressure", 1e4),
        ("2 N/m^2", "pressure", 2.0),
        ("2 kPa/mm", "pressure per length", 2e6),
        ("2 N/cm^3", "pressure per length", 2e6),
        ("30 deg", "angle", math.pi / 6),
        ("30°", "angle", math.pi / 6),
        ("20 min", "time", 1200.0),
        ("3.5 %", "fraction", 0.035),
        ("3.5%", "fraction", 0.035),
        ("0.035", "fraction", 0.035),
        ("1 kHz", "frequency", 1000.0),
        ("5 N s/m", "damping", 5.0),
        ("5 N*s/m", "damping", 5.0),
        ("-3 mm", "length", -3e-3),
        (".5 m", "length", 0.5),
    ],
)
def test_strings_become_si(text: str, dimension: str, expected: float) -> None:
    assert quantity(text, dimension) == pytest.approx(expected, rel=1e-15)


@given(st.floats(allow_nan=False, allow_infinity=False), st.sampled_from(sorted(DIMENSIONS)))
def test_numbers_are_si(number: float, dimension: str) -> None:
    assert quantity(number, dimension) == number


@pytest.mark.parametrize("dimension", sorted(DIMENSIONS))
def test_every_example_reads_as_its_own_dimension_and_as_no_other(dimension: str) -> None:
    example = DIMENSIONS[dimension][2]
    assert quantity(example, dimension) > 0
    for other in DIMENSIONS:
        if other != dimension:
            with pytest.raises(QuantityError, match="not an? " + other):
                quantity(example, other)


@pytest.mark.parametrize(
    ("value", "dimension", "what"),
    [
        ("3 kPa", "length", "is a pressure, not a length"),
        ("3 s", "angle", "is a time, not an angle"),
        ("3 m/s", "length", "is a velocity, not a length"),
        ("3 m^2/s", "length", "is a quantity in m^2 s^-1, not a length"),
        ("3", "length", "carries no unit"),
        ("3 parsec", "length", 'unknown unit "parsec"'),
        ("3 kpa", "pressure", 'did you mean "kPa"'),
        ("3 mm/", "length", "incomplete unit"),
        ("three mm", "length", "is not a number with a unit"),
        ("", "length", "is not a number with a unit"),
        (True, "length", "is not a quantity"),
        ([3], "length", "is not a quantity"),
        (float("nan"), "length", "is not finite"),
        (float("inf"), "length", "is not finite"),
        ("1e999 m", "length", "is not finite"),
    ],
)
def test_a_wrong_quantity_is_told_with_what_would_be_right(value: object, dimension: str, what: str) -> None:
    with pytest.raises(QuantityError) as caught:
        quantity(value, dimension)
    assert what in caught.value.what
    assert DIMENSIONS[dimension][2] in caught.value.expected
