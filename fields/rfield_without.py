# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""An .rfield without some of its layers: what a response is judged by must not hold what plays on top of it."""

from __future__ import annotations

import zlib
from collections.abc import Iterable

from palpate.fields.rfield_layout import LAYERS
from palpate.fields.rfield_read import read_header

__all__ = ["rfield_without"]


def rfield_without(data: bytes, layers: Iterable[str] = ("texture", "transient")) -> bytes:
    """The file `data` with the rows of `layers` emptied; their bytes stay, unread.  Raises RFieldError."""
    header = read_header(data)
    rows = [LAYERS.index(name) for name in layers]
    if not any(header["layer_size"][i] for i in rows):
        return data
    for i in rows:
        header["layer_offset"][i] = header["layer_size"][i] = 0
    size = int(header["header_size"])
    header["checksum"] = 0
    blank = header.tobytes()[:size] + data[size:]
    header["checksum"] = zlib.crc32(blank)
    return header.tobytes()[:size] + data[size:]
