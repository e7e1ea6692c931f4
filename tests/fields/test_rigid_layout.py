# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The NumPy structs of cooked rigid objects are the C++ structs, field by field."""

import re
from pathlib import Path

import pytest

from palpate.fields import rigid_layout

SOURCE = (Path(__file__).parents[2] / "runtime_cpp/src/layers/rigid_layout.h").read_text()
LETTERS = {
    "std::uint16_t": "<u2",
    "std::uint32_t": "<u4",
    "std::int32_t": "<i4",
    "std::uint64_t": "<u8",
    "double": "<f8",
}


def c_fields(struct):
    body = re.search(rf"struct {struct} \{{(.*?)\n\}};", SOURCE, re.S).group(1)
    for line in re.sub(r"//.*", "", body).split(";"):
        found = re.match(r"\s*(\S+)\s+(.*)", line, re.S)
        if not found:
            continue
        for name in found.group(2).split(","):
            shape = tuple(int(n) for n in re.findall(r"\[(\d)\]", name))
            yield name.split("[")[0].strip(), LETTERS[found.group(1)], shape


@pytest.mark.parametrize("struct", ["header", "element", "pair", "merge", "formation"])
def test_structs_are_the_same(struct):
    dtype = getattr(rigid_layout, struct.upper())
    ours = [(n, t.base.str, t.shape) for n, (t, _) in dtype.fields.items()]
    assert ours == [(n, t if t != "<u2" else "<u2", s) for n, t, s in c_fields(f"rigid_{struct}")]
    size = re.search(rf"sizeof\(rigid_{struct}\) == (\d+)", SOURCE).group(1)
    assert dtype.itemsize == int(size)


def test_kinds_are_in_the_same_order():
    body = re.search(r"enum rigid_kind : std::uint32_t \{(.*?)\};", SOURCE, re.S).group(1)
    names = [n.strip().removeprefix("rigid_") for n in body.split(",")]
    assert tuple(names[:-1]) == rigid_layout.KINDS
