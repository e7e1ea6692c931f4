# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Layers that do not lie in the file, or that nobody knows, are refused in words when the file is opened."""

import dataclasses
import zlib

import numpy as np
import pytest
import synthetic_field

from palpate.fields.cook import cook
from palpate.fields.rfield_layout import HEADER_DTYPE, LAYER_LIMIT, LAYERS
from palpate.runtime import Field, RuntimeFailure

ROW = LAYERS.index("rigid")


@pytest.fixture(scope="module")
def layered() -> bytes:
    return cook(dataclasses.replace(synthetic_field.small_plane(), layers={"rigid": bytes(64)}))


def with_table(data: bytes, row: int, offset: int, size: int) -> bytes:
    """`data` with another row in its table of layers, and a checksum that fits."""
    header = np.frombuffer(data[: HEADER_DTYPE.itemsize], dtype=HEADER_DTYPE)[0].copy()
    header["layer_offset"][row], header["layer_size"][row], header["checksum"] = offset, size, 0
    rest = data[HEADER_DTYPE.itemsize :]
    header["checksum"] = zlib.crc32(header.tobytes() + rest)
    return header.tobytes() + rest


@pytest.mark.parametrize(
    ("offset", "size"),
    [(64, 64), (0, 64), (1, 63), (2**63, 64), (2**64 - 64, 64)],
    ids=["among the sections", "nowhere", "not aligned", "far away", "around the end"],
)
def test_a_layer_that_does_not_lie_behind_the_sections_is_refused(layered, offset, size):
    with pytest.raises(RuntimeFailure, match=r"Layer 3 .* does not lie behind the sections"):
        Field.open(with_table(layered, ROW, offset, size))


def test_a_layer_longer_than_the_file_is_refused(layered):
    start = len(layered) - 64
    with pytest.raises(RuntimeFailure, match="does not lie behind"):
        Field.open(with_table(layered, ROW, start, 65))


def test_two_layers_in_one_place_are_refused(layered):
    start = len(layered) - 64
    with pytest.raises(RuntimeFailure, match=r"Layer 7|rigid"):
        Field.open(with_table(layered, LAYER_LIMIT - 1, start, 64))


def test_a_layer_that_only_a_later_runtime_knows_is_refused(layered):
    start = len(layered) - 64
    moved = with_table(with_table(layered, ROW, 0, 0), LAYER_LIMIT - 1, start, 64)
    with pytest.raises(RuntimeFailure, match="layer 7, which this runtime does not know"):
        Field.open(moved)
