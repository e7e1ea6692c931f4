# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Cooked synthetic fields, each with the ResponseField that holds exactly the numbers in the file."""

from typing import NamedTuple

import pytest
import synthetic_field

from palpate.fields.cook import cook
from palpate.fields.response_field import ResponseField
from palpate.fields.rfield_read import read_rfield
from palpate.runtime import Field


class Cooked(NamedTuple):
    data: bytes
    field: Field  # the runtime's
    truth: ResponseField  # NumPy's


def _cooked(name: str) -> Cooked:
    data = cook(synthetic_field.FIELDS[name]())
    return Cooked(data, Field.open(data), read_rfield(data))


@pytest.fixture(scope="session")
def plane() -> Cooked:
    """Half space z < 0, amplitude 1 to 6 over x = 0..5 mm; a ball of 5 mm pressed 5 mm deep."""
    return _cooked("plane")


@pytest.fixture(scope="session")
def sphere() -> Cooked:
    """Sphere organ of 30 mm about the origin, the same step."""
    return _cooked("sphere")


@pytest.fixture(scope="session")
def slab() -> Cooked:
    """Slab |z| < 3 mm."""
    return _cooked("slab")
