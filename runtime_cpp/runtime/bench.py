# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Timing of whole ticks on one field."""

from __future__ import annotations

import ctypes
import json
import os
from typing import Any

from palpate.runtime.library import RuntimeFailure, library, shared_library

__all__ = ["bench"]


def bench(path: str | os.PathLike) -> dict[str, Any]:
    """Time the runtime on the .rfield at `path` (about ten seconds).

    Returns:
        stick_ns, slide_ns, free_ns, first_contact_ns, cold_ns (6 MB touched between ticks),
        adversarial_ns (a million ticks made to be slow), each
        {p50, p99, p999, max, count} in ns (None where the field offers no such tick); load_ms; bytes; machine.

    Raises:
        RuntimeFailure: the file does not open.
    """
    library()
    timing = ctypes.CDLL(str(shared_library("palpate_bench")))
    timing.palpate_bench.restype = ctypes.c_int
    timing.palpate_bench.argtypes = [ctypes.c_char_p, ctypes.c_char_p, ctypes.c_size_t]
    answer = ctypes.create_string_buffer(4096)
    status = timing.palpate_bench(os.fsencode(path), answer, len(answer))
    text = answer.value.decode(errors="replace")
    if status != 0:
        raise RuntimeFailure(status, f"{os.fspath(path)}: {text}")
    return json.loads(text)
