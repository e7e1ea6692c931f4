# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The NumPy structs are the C structs, byte for byte; enums and header agree."""

import ctypes
import re

import pytest

from palpate.runtime import include_folder, layout, version
from palpate.runtime.library import library


class Row(ctypes.Structure):
    _fields_ = [
        ("struct_name", ctypes.c_char_p),
        ("field_name", ctypes.c_char_p),
        ("offset", ctypes.c_size_t),
        ("size", ctypes.c_size_t),
    ]


STRUCTS = {
    "palpate_field_info": layout.FIELD_INFO,
    "palpate_sample": layout.SAMPLE,
    "palpate_config": layout.CONFIG,
    "palpate_tool_state": layout.STATE,
    "palpate_tool_response": layout.RESPONSE,
    "palpate_deformation_info": layout.DEFORMATION_INFO,
    "palpate_deformation_input": layout.DEFORMATION_INPUT,
    "palpate_deformation_result": layout.DEFORMATION_RESULT,
    "palpate_texture_info": layout.TEXTURE_INFO,
    "palpate_texture_limits": layout.TEXTURE_LIMITS,
}


def c_table() -> dict[str, dict[str, tuple[int, int]]]:
    count = ctypes.c_size_t()
    start = library().palpate_abi_table(ctypes.byref(count))
    table: dict[str, dict[str, tuple[int, int]]] = {}
    for row in (Row * count.value).from_address(start):
        table.setdefault(row.struct_name.decode(), {})[row.field_name.decode()] = (row.offset, row.size)
    return table


@pytest.mark.parametrize("name", STRUCTS)
def test_numpy_structs_are_the_c_structs(name):
    dtype, rows = STRUCTS[name], c_table()[name]
    assert rows.pop("") == (0, dtype.itemsize)
    assert {f: (o, t.itemsize) for f, (t, o) in dtype.fields.items()} == rows


def test_enums_are_those_of_the_header():
    text = (include_folder() / "palpate" / "palpate.h").read_text()
    flags = {k: int(v) for k, v in re.findall(r"#define PALPATE_TICK_(\w+) (\d+)u", text)}
    assert flags == {t.name: t.value for t in layout.Tick}
    inputs = {k: int(v) for k, v in re.findall(r"#define PALPATE_INPUT_(\w+) (\d+)u", text)}
    assert inputs == {t.name: t.value for t in layout.Input}
    responses = {k: int(v) for k, v in re.findall(r"PALPATE_RESPONSE_(\w+) = (\d)", text)}
    assert responses == {r.name: r.value for r in layout.Response}
    regions = {k: int(v) for k, v in re.findall(r"PALPATE_REGION_(\w+) = (\d+)", text)}
    assert regions == {r.name: r.value for r in layout.Region}


def test_every_status_has_one_sentence():
    lib = library()
    texts = [lib.palpate_status_text(i).decode() for i in range(15)]
    texts += [lib.palpate_tick_text(1 << i).decode() for i in range(18)] + [lib.palpate_tick_text(0).decode()]
    assert all(t.endswith(".") and t.count(". ") == 0 for t in texts)
    assert "unknown" in texts[14] and "unknown" in texts[32]


def test_version_is_three_numbers():
    assert re.fullmatch(r"\d+\.\d+\.\d+", version())
