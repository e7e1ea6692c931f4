# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The layout is written down once; C++ reads what Python says."""

from pathlib import Path

from palpate.fields.rfield_layout import HEADER, HEADER_DTYPE, SECTION_ALIGNMENT, SECTIONS, cpp_header

GENERATED = Path(__file__).parents[2] / "runtime_cpp" / "src" / "rfield_layout.h"


def test_the_committed_cpp_header_is_what_the_list_generates():
    assert GENERATED.read_text() == cpp_header(), "run python -m palpate.fields.rfield_layout > " + str(
        GENERATED
    )


def test_every_entry_is_naturally_aligned_and_nothing_overlaps():
    end = 0
    for entry in HEADER:
        dtype, offset = HEADER_DTYPE.fields[entry.name][:2]
        assert offset == end
        unit = dtype.base.itemsize if entry.kind != "char" else 1
        assert offset % unit == 0
        end = offset + dtype.itemsize
    assert end == HEADER_DTYPE.itemsize


def test_names_are_unique_and_sections_are_cache_lines():
    names = [e.name for e in HEADER]
    assert len(set(names)) == len(names)
    assert len({s.name for s in SECTIONS}) == len(SECTIONS)
    assert SECTION_ALIGNMENT == 64
