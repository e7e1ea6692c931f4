# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Finds and loads the shared library that the wheel carries, and declares its functions."""

from __future__ import annotations

import ctypes
import sys
from functools import cache
from pathlib import Path

from palpate.runtime.layout import ABI_VERSION

__all__ = ["RuntimeFailure", "cmake_folder", "include_folder", "library", "version"]


class RuntimeFailure(Exception):
    """A call into the runtime that failed.  `status` is its palpate_status; the message is one sentence."""

    def __init__(self, status: int, sentence: str):
        super().__init__(sentence)
        self.status = status


def _installed(relative: str) -> Path:
    import palpate.runtime

    folders = [Path(p) for p in palpate.runtime.__path__]
    for folder in folders:
        if (folder / relative).exists():
            return folder / relative
    raise RuntimeFailure(2, f"{relative} is not in {', '.join(map(str, folders))}: install palpate again.")


def shared_library(name: str) -> Path:
    """Path of a shared library of this package."""
    pattern = {"win32": "{}.dll", "darwin": "lib{}.dylib"}.get(sys.platform, "lib{}.so")
    return _installed(pattern.format(name))


def include_folder() -> Path:
    """The folder to put on a compiler's include path: it holds palpate/palpate.h."""
    return _installed("include")


def cmake_folder() -> Path:
    """The folder to name in CMAKE_PREFIX_PATH so that find_package(palpate) works."""
    return _installed("share/cmake/palpate").parents[2]


@cache
def library() -> ctypes.CDLL:
    """The runtime, loaded once.

    Raises:
        RuntimeFailure: not installed, or another ABI than this view was written for.
    """
    lib = ctypes.CDLL(str(shared_library("palpate")))
    pointer, size, text = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_char_p
    out = ctypes.POINTER(ctypes.c_void_p)
    for name, result, arguments in (
        ("palpate_abi_version", ctypes.c_uint32, []),
        ("palpate_version", text, []),
        ("palpate_status_text", text, [ctypes.c_int]),
        ("palpate_tick_text", text, [ctypes.c_uint32]),
        ("palpate_abi_table", pointer, [ctypes.POINTER(size)]),
        ("palpate_field_open", ctypes.c_int, [text, size, ctypes.c_uint32, out, text, size]),
        ("palpate_field_open_file", ctypes.c_int, [text, out, text, size]),
        ("palpate_field_close", None, [pointer]),
        ("palpate_field_describe", ctypes.c_int, [pointer, pointer]),
        ("palpate_field_sample", ctypes.c_int, [pointer, pointer, size, pointer]),
        (
            "palpate_field_sample_tilted",
            ctypes.c_int,
            [pointer, pointer, ctypes.c_double, size, pointer],
        ),
        ("palpate_config_default", None, [pointer]),
        ("palpate_session_size", size, []),
        ("palpate_session_init", ctypes.c_int, [pointer, size, pointer, pointer, out]),
        ("palpate_session_reset", ctypes.c_int, [pointer]),
        ("palpate_session_snapshot", ctypes.c_int, [pointer, pointer, size, out]),
        ("palpate_session_transient", ctypes.c_int, [pointer, pointer]),
        ("palpate_session_set_field", ctypes.c_int, [pointer, pointer]),
        ("palpate_session_set_organ", ctypes.c_int, [pointer, pointer]),
        ("palpate_organ_size", size, []),
        ("palpate_organ_init", ctypes.c_int, [pointer, size, out]),
        ("palpate_organ_move", ctypes.c_int, [pointer, pointer, pointer, ctypes.c_double]),
        ("palpate_texture_describe", ctypes.c_int, [pointer, pointer]),
        ("palpate_session_set_texture_limits", ctypes.c_int, [pointer, pointer]),
        ("palpate_session_texture", ctypes.c_int, [pointer, pointer]),
        ("palpate_deformation_describe", ctypes.c_int, [pointer, pointer]),
        ("palpate_deformation", ctypes.c_int, [pointer, pointer, pointer, pointer, size, pointer, pointer]),
        ("palpate_tick", ctypes.c_uint32, [pointer, pointer, pointer]),
        ("palpate_tick_batch", ctypes.c_uint32, [pointer, pointer, pointer, size]),
    ):
        function = getattr(lib, name)
        function.restype, function.argtypes = result, arguments
    if lib.palpate_abi_version() != ABI_VERSION:
        raise RuntimeFailure(
            6,
            f"The library's ABI is {lib.palpate_abi_version()}, this view's {ABI_VERSION}: install again.",
        )
    return lib


def check(status: int) -> None:
    """Raise RuntimeFailure unless `status` is PALPATE_OK."""
    if status != 0:
        raise RuntimeFailure(status, library().palpate_status_text(status).decode())


def version() -> str:
    """Version of the library."""
    return library().palpate_version().decode()
