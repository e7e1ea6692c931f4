# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""An opened .rfield."""

from __future__ import annotations

import ctypes
import json
import os
import weakref
from dataclasses import dataclass
from typing import Any

import numpy as np

from palpate.runtime.layout import FIELD_INFO, SAMPLE
from palpate.runtime.library import RuntimeFailure, check, library

__all__ = ["Field", "FieldInfo"]


@dataclass(frozen=True)
class FieldInfo:
    """palpate_field_info: lengths in m, stiffness in N/m; see palpate.h for each."""

    tool_name: str
    tool_shape: str
    tool_hash: str
    field_hash: str
    tool_offset: float
    depth_max: float
    stiffness_max: float
    band: np.ndarray
    box_min: np.ndarray
    box_max: np.ndarray
    geometry_spacing: float
    amplitude_spacing: float
    geometry_error_p99: float
    geometry_flagged_share: float
    geometry_blocks_stored: int
    amplitude_blocks_stored: int
    channel_count: int
    way_count: int
    way_cosine: np.ndarray
    way_offset: np.ndarray
    bytes: int
    provenance: dict[str, Any]


class Field:
    """A field that the runtime has proven; share it between any number of sessions and threads."""

    def __init__(self, handle: int):
        self.handle = handle
        self._closer = weakref.finalize(self, library().palpate_field_close, handle)

    @classmethod
    def open(cls, source: bytes | str | os.PathLike) -> Field:
        """Open an .rfield from a path or from its bytes.

        Raises:
            RuntimeFailure: with the runtime's one sentence, when the file is not what a tick can rely on.
        """
        handle, message = ctypes.c_void_p(), ctypes.create_string_buffer(256)
        if isinstance(source, bytes | bytearray | memoryview):
            data = bytes(source)
            status = library().palpate_field_open(
                data, len(data), 0, ctypes.byref(handle), message, len(message)
            )
        else:
            status = library().palpate_field_open_file(
                os.fsencode(source), ctypes.byref(handle), message, len(message)
            )
        if status != 0:
            where = "" if isinstance(source, bytes | bytearray | memoryview) else f"{os.fspath(source)}: "
            raise RuntimeFailure(status, where + message.value.decode(errors="replace"))
        assert handle.value is not None
        return cls(handle.value)

    @property
    def info(self) -> FieldInfo:
        """What the field says about itself."""
        raw = np.zeros((), dtype=FIELD_INFO)
        raw["size"] = FIELD_INFO.itemsize
        check(library().palpate_field_describe(self.handle, raw.ctypes.data))
        values: dict[str, Any] = {}
        for name in FIELD_INFO.names or ():
            values[name] = raw[name].item() if raw[name].ndim == 0 else raw[name].copy()
        for name in ("tool_name", "tool_shape", "tool_hash", "field_hash"):
            values[name] = ctypes.string_at(values[name]).decode(errors="replace")
        text = ctypes.string_at(values["provenance"], values.pop("provenance_size")).decode()
        values["provenance"] = json.loads(text) if text else {}
        del values["size"], values["reserved"]
        for name in ("way_cosine", "way_offset"):
            values[name] = values[name][: values["way_count"]]
        return FieldInfo(**values)

    def sample(self, points: np.ndarray, cosine: float = 1.0) -> np.ndarray:
        """The field at reference points, without friction's history.

        Args:
            points: (n, 3) m, organ axes.
            cosine: of the angle between tool axis and outward normal; matters to fields with several ways of touching.

        Returns:
            (n,) structured array (`layout.SAMPLE`): region, depth m, normal, distance_gradient, stored_energy J,
            force N, normal_force N, stiffness N/m, friction_stiffness N/m, friction_coefficient.
        """
        q = np.ascontiguousarray(np.reshape(points, (-1, 3)), dtype=np.float64)
        samples = np.zeros(len(q), dtype=SAMPLE)
        samples["size"] = SAMPLE.itemsize
        check(
            library().palpate_field_sample_tilted(
                self.handle, q.ctypes.data, cosine, len(q), samples.ctypes.data
            )
        )
        return samples
