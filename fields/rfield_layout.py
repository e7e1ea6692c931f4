# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The one list of what an .rfield file holds; the C++ side is generated from it and checked against it.

File = header | sections, little-endian, each section aligned to 64 bytes, zero bytes in between, nothing after.
The header begins with magic, version and the layout's hash, and ends with the section table (one row for each
entry of `SECTIONS`, in order), followed by what versions have added.  A field with several ways of touching (tilts)
has one block of `channel_stride` amplitudes for each, on the same curves and the same geometry.  After the sections lie
the layers that the scene's effects need, each one block of bytes with a layout of its own (fields/<layer>_layout.py).
The checksum is CRC-32 (zlib) of the whole file with the checksum itself taken as zero.

`python -m palpate.fields.rfield_layout` prints `runtime_cpp/src/rfield_layout.h`.  A changed list needs a new VERSION,
the old one in OLDER_VERSIONS where it is still read, and a golden file (tests/golden/regenerate.py).
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import numpy as np

__all__ = [
    "CHANNEL_LIMIT",
    "HEADER",
    "HEADER_DTYPE",
    "LAYERS",
    "LAYER_LIMIT",
    "LAYOUT_HASH",
    "MAGIC",
    "OLDER_VERSIONS",
    "SECTIONS",
    "SECTION_ALIGNMENT",
    "VERSION",
    "WAY_LIMIT",
    "Entry",
    "Section",
    "cpp_header",
]

MAGIC = b"PALPRFLD"
VERSION = 3
OLDER_VERSIONS = {1: (0xC7F09AB8C07D2981, 680), 2: (0x7F38E7C7022E4F4A, 752)}
"""Layout hash and header size of versions whose header is the beginning of this one's: they are still read.  Entries
that an old header lacks are zero; 0 ways means 1."""
SECTION_ALIGNMENT = 64
"""Bytes; one cache line, so that a block of 64 int16 is exactly two lines."""
CHANNEL_LIMIT = 16
"""Largest number of amplitude channels of a way, padding included; the tick's stack arrays have this size."""
WAY_LIMIT = 4
"""Largest number of ways of touching."""

LAYERS = ("texture", "transient", "deformation", "rigid")
"""Effects beyond response and friction that a file may carry, by their row in the header's table of layers."""
LAYER_LIMIT = 8
"""Rows of that table."""

_NUMPY = {"char": "S1", "u32": "<u4", "i32": "<i4", "u64": "<u8", "f64": "<f8", "i16": "<i2", "f32": "<f4"}
_CPP = {"char": "char", "u32": "std::uint32_t", "i32": "std::int32_t", "u64": "std::uint64_t",
        "f64": "double", "i16": "std::int16_t", "f32": "float"}  # fmt: skip


@dataclass(frozen=True)
class Entry:
    """One header field: `count` values of `kind`, in `unit`."""

    name: str
    kind: str
    count: int
    unit: str
    meaning: str


@dataclass(frozen=True)
class Section:
    """One array after the header, of elements of `kind`, with `shape` in words of the header."""

    name: str
    kind: str
    shape: str
    meaning: str


SECTIONS = (
    Section("geometry_index", "i32", "geometry_blocks", "block row; -1 free, -2 deeper than the band, -3 unreached"),
    Section("geometry_coefficients", "i16", "geometry_stored, 4, 4, 4",
            "phi coefficient = geometry_bias + geometry_scale * value"),
    Section("amplitude_index", "i32", "amplitude_blocks", "block row; 0 (the zero block) where nothing is stored"),
    Section("amplitude_coefficients", "f32", "amplitude_stored, 4, 4, 4, way_count, channel_stride",
            "row 0 is all zero; channels a_r, b_r, m_r, then zero padding"),
    Section("energy_curves", "f64", "energy_intervals + 1, energy_curve_count, 4",
            "c0..c3 by interval [J/m^j]; the last row continues beyond depth_end with c3 = 0"),
    Section("stiffness_curves", "f64", "stiffness_intervals + 1, stiffness_curve_count, 4", "the same, N/m"),
    Section("friction_curves", "f64", "friction_intervals + 1, friction_curve_count, 4", "the same, dimensionless"),
    Section("provenance", "char", "bytes", "JSON text, UTF-8, keys sorted"),
)  # fmt: skip

HEADER = (
    Entry("magic", "char", 8, "", "PALPRFLD"),
    Entry("version", "u32", 1, "", "of the layout"),
    Entry("header_size", "u32", 1, "byte", "section table included"),
    Entry("layout_hash", "u64", 1, "", "of this list; a file written by another list is refused"),
    Entry("file_size", "u64", 1, "byte", ""),
    Entry("checksum", "u32", 1, "", "CRC-32 of the file with this field zero"),
    Entry("section_count", "u32", 1, "", ""),
    Entry("tool_name", "char", 64, "", "NUL-terminated UTF-8"),
    Entry("tool_shape", "char", 32, "", "NUL-terminated UTF-8"),
    Entry("tool_hash", "char", 80, "", "NUL-terminated hex digest"),
    Entry("field_hash", "char", 80, "", "NUL-terminated sha256 of every section before provenance"),
    Entry("tool_offset", "f64", 1, "m", "rho: depth = rho - phi(q); the largest of the ways'"),
    Entry("depth_max", "f64", 1, "m", "deepest press; beyond it the curves continue and the status says so"),
    Entry(
        "stiffness_max",
        "f64",
        1,
        "N/m",
        "sigma: largest stiffness of energy and friction spring up to depth_max",
    ),
    Entry("band", "f64", 2, "m", "smallest and largest phi meant to be read"),
    Entry("geometry_error_p99", "f64", 1, "m", "99th percentile of |lattice - mesh distance|"),
    Entry("geometry_flagged_share", "f64", 1, "fraction", "share of the band where |grad phi| < 0.9"),
    Entry("geometry_origin", "f64", 3, "m", "organ axes"),
    Entry("geometry_spacing", "f64", 1, "m", ""),
    Entry("geometry_scale", "f64", 1, "m", "one count of the int16 coefficients"),
    Entry("geometry_bias", "f64", 1, "m", "phi coefficient of count zero"),
    Entry("geometry_blocks", "u32", 3, "", "blocks along x, y, z"),
    Entry("geometry_stored", "u32", 1, "", "stored blocks"),
    Entry("amplitude_origin", "f64", 3, "m", "organ axes"),
    Entry("amplitude_spacing", "f64", 1, "m", ""),
    Entry("amplitude_blocks", "u32", 3, "", "blocks along x, y, z"),
    Entry("amplitude_stored", "u32", 1, "", "stored blocks, the zero block included"),
    Entry("channel_stride", "u32", 1, "", "floats from one way to the next; a multiple of 4"),
    Entry("energy_curve_count", "u32", 1, "", ""),
    Entry("stiffness_curve_count", "u32", 1, "", ""),
    Entry("friction_curve_count", "u32", 1, "", ""),
    Entry("energy_intervals", "u32", 1, "", ""),
    Entry("stiffness_intervals", "u32", 1, "", ""),
    Entry("friction_intervals", "u32", 1, "", ""),
    Entry("reserved", "u32", 1, "", "zero"),
    Entry("energy_depth_end", "f64", 1, "m", ""),
    Entry("stiffness_depth_end", "f64", 1, "m", ""),
    Entry("friction_depth_end", "f64", 1, "m", ""),
    Entry("section_offset", "u64", len(SECTIONS), "byte", "from the start of the file"),
    Entry("section_elements", "u64", len(SECTIONS), "", "elements in the section"),
    Entry("section_element_size", "u32", len(SECTIONS), "byte", ""),
    Entry("way_count", "u32", 1, "", "ways of touching, 1 to WAY_LIMIT; since version 2, as all below"),
    Entry("reserved_2", "u32", 1, "", "zero"),
    Entry(
        "way_cosine",
        "f64",
        WAY_LIMIT,
        "",
        "of tool axis and outward normal, falling from way to way; then zeros",
    ),
    Entry("way_offset", "f64", WAY_LIMIT, "m", "rho of each way; then zeros"),
    Entry("layer_offset", "u64", LAYER_LIMIT, "byte", "0 where there is none; since version 3, as all below"),
    Entry("layer_size", "u64", LAYER_LIMIT, "byte", "0 where there is none"),
)


def _dtype() -> np.dtype:
    fields = []
    for e in HEADER:
        kind = f"S{e.count}" if e.kind == "char" else _NUMPY[e.kind]
        fields.append((e.name, kind) if e.kind == "char" or e.count == 1 else (e.name, kind, (e.count,)))
    packed, aligned = np.dtype(fields), np.dtype(fields, align=True)
    assert packed.itemsize == aligned.itemsize, "the header must need no padding"
    return packed


HEADER_DTYPE = _dtype()
"""NumPy structure of the header; packed and aligned are the same."""

_TEXT = "".join(f"{e.name} {e.kind} {e.count}\n" for e in HEADER)
_TEXT += "".join(f"{s.name} {s.kind} {s.shape}\n" for s in SECTIONS)
LAYOUT_HASH = int.from_bytes(hashlib.sha256(_TEXT.encode()).digest()[:8], "little")


def section_element_size(section: Section) -> int:
    """Bytes of one element of `section`."""
    return np.dtype(_NUMPY[section.kind]).itemsize


def cpp_header() -> str:
    """The text of runtime_cpp/src/rfield_layout.h."""
    lines = [
        "// SPDX-FileCopyrightText: 2026 The palpate authors",
        "// SPDX-License-Identifier: Apache-2.0",
        "// Generated from fields/rfield_layout.py: python -m palpate.fields.rfield_layout > this file. Do not edit.",
        "#ifndef PALPATE_SRC_RFIELD_LAYOUT_H",
        "#define PALPATE_SRC_RFIELD_LAYOUT_H",
        "",
        "#include <cstddef>",
        "#include <cstdint>",
        "",
        "namespace palpate {",
        "",
        f'constexpr char rfield_magic[9] = "{MAGIC.decode()}";',
        f"constexpr std::uint32_t rfield_version = {VERSION};",
        f"constexpr std::uint64_t rfield_layout_hash = 0x{LAYOUT_HASH:016x}u;",
        f"constexpr std::uint32_t rfield_way_limit = {WAY_LIMIT};",
        f"constexpr std::uint64_t rfield_section_alignment = {SECTION_ALIGNMENT};",
        f"constexpr std::uint32_t rfield_channel_limit = {CHANNEL_LIMIT};",
        f"constexpr std::uint32_t rfield_section_count = {len(SECTIONS)};",
        f"constexpr std::uint32_t rfield_layer_limit = {LAYER_LIMIT};",
        "",
        "// Older versions that are read: their header is the beginning of this one.",
        "struct rfield_older_version {",
        "    std::uint32_t version;",
        "    std::uint64_t layout_hash;",
        "    std::uint32_t header_size;",
        "};",
        "constexpr rfield_older_version rfield_older_versions[] = {",
        *(f"    {{{v}, 0x{h:016x}u, {size}}}," for v, (h, size) in OLDER_VERSIONS.items()),
        "};",
        "",
        "enum rfield_section : std::uint32_t {",
    ]
    for i, s in enumerate(SECTIONS):
        lines.append(f"    section_{s.name} = {i},  // ({s.shape}) {s.kind}: {s.meaning}")
    lines += ["};", "", "enum rfield_layer : std::uint32_t {"]
    lines += [f"    layer_{name} = {i}," for i, name in enumerate(LAYERS)]
    lines += [f"    layer_count = {len(LAYERS)}"]
    lines += ["};", "", "constexpr std::uint32_t rfield_element_size[rfield_section_count] = {"]
    lines.append("    " + ", ".join(str(section_element_size(s)) for s in SECTIONS) + "};")
    lines += ["", "struct rfield_header {"]
    for e in HEADER:
        size = f"[{e.count}]" if e.count > 1 else ""
        note = " ".join(x for x in (f"({e.unit})" if e.unit else "", e.meaning) if x)
        lines.append(f"    {_CPP[e.kind]} {e.name}{size};" + (f"  // {note}" if note else ""))
    lines += ["};", ""]
    for e in HEADER:
        offset = HEADER_DTYPE.fields[e.name][1]
        lines.append(f'static_assert(offsetof(rfield_header, {e.name}) == {offset}, "rfield layout");')
    lines.append(f'static_assert(sizeof(rfield_header) == {HEADER_DTYPE.itemsize}, "rfield layout");')
    lines += ["", "}  // namespace palpate", "", "#endif", ""]
    return "\n".join(lines)


if __name__ == "__main__":
    print(cpp_header(), end="")
