# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a cooked field's bytes are for, section by section."""

from __future__ import annotations

from pathlib import Path
from typing import Any

__all__ = ["SECTION_WORDS", "rfield_sections"]

SECTION_WORDS = {
    "header": "header",
    "padding": "alignment to cache lines",
    "texture": "layer: texture",
    "transient": "layer: transients",
    "deformation": "layer: deformation for graphics",
    "rigid": "layer: rigid parts",
}
"""Words for what is no section of its own; sections keep their names."""


def rfield_sections(path: Path) -> list[dict[str, Any]]:
    """Rows {name, bytes, share} of the .rfield `path`, largest first; they add up to the file.  Empty without a file.

    Raises:
        RFieldError: the file is damaged or of another version.
    """
    from palpate.fields.rfield_layout import LAYERS, SECTIONS, section_element_size
    from palpate.fields.rfield_read import read_header

    if not path.is_file():
        return []
    header = read_header(path)
    parts = {"header": int(header["header_size"])}
    for section, count in zip(SECTIONS, header["section_elements"], strict=True):
        parts[section.name] = int(count) * section_element_size(section)
    for name, size in zip(LAYERS, header["layer_size"], strict=False):
        parts[name] = int(size)
    whole = path.stat().st_size
    parts["padding"] = whole - sum(parts.values())
    rows = [
        {
            "name": name,
            "what": SECTION_WORDS.get(name, name.replace("_", " ")),
            "bytes": size,
            "share": size / whole,
        }
        for name, size in parts.items()
        if size
    ]
    return sorted(rows, key=lambda row: -row["bytes"])
