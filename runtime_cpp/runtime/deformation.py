# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""How the organ's surface moves under the tool, for graphics: palpate_deformation on NumPy arrays."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass

import numpy as np

from palpate.runtime.field import Field
from palpate.runtime.layout import DEFORMATION_INFO, DEFORMATION_INPUT, DEFORMATION_RESULT, Input
from palpate.runtime.library import check, library

__all__ = ["DeformationInfo", "deformation", "deformation_info"]


@dataclass(frozen=True)
class DeformationInfo:
    """palpate_deformation_info: lengths in m, shares of the depth; -1 where nobody judged."""

    node_count: int
    bytes: int
    radius: float
    depth_end: float
    error_p95: float
    error_max: float
    error_p95_length: float
    error_max_length: float
    error_within: float


def deformation_info(field: Field) -> DeformationInfo:
    """Raises RuntimeFailure where the field has no such effect."""
    raw = np.zeros((), DEFORMATION_INFO)
    raw["size"] = DEFORMATION_INFO.itemsize
    check(library().palpate_deformation_describe(field.handle, raw.ctypes.data))
    return DeformationInfo(
        **{name: raw[name].item() for name in DEFORMATION_INFO.names or () if name != "size"}
    )


def deformation(
    field: Field,
    reference_point: np.ndarray,
    vertices: np.ndarray,
    anchor: np.ndarray | None = None,
    surface_offset: float = 0.0,
    indices: np.ndarray | None = None,
    pose: tuple[np.ndarray, np.ndarray] | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Displacements (V, 3) m, float32, of surface vertices (V, 3) m at rest, and what palpate_deformation_result holds.

    Args:
        reference_point: (3,) m; the tool's.
        anchor: (3,) m; where friction holds, the tool's reference point when None.
        surface_offset: m; how far the surface has yielded.
        indices: of the vertices to look at; the others stay zero.
        pose: position (3,) m and orientation (x y z w) of the organ, for points in world axes.

    Raises:
        RuntimeFailure: the field has no such effect.
    """
    asked = np.zeros((), DEFORMATION_INPUT)
    asked["size"] = DEFORMATION_INPUT.itemsize
    asked["reference_point"] = reference_point
    asked["anchor"] = reference_point if anchor is None else anchor
    asked["surface_offset"] = surface_offset
    if pose is not None:
        asked["flags"] = Input.ORGAN_POSE
        asked["organ_position"], asked["organ_orientation"] = pose
    rest = np.ascontiguousarray(vertices, np.float32).reshape(-1, 3)
    moved = np.zeros_like(rest)
    chosen = None if indices is None else np.ascontiguousarray(indices, np.uint32)
    if chosen is not None and chosen.size and int(chosen.max()) >= len(rest):
        raise IndexError(f"index {int(chosen.max())} of {len(rest)} vertices")
    result = np.zeros((), DEFORMATION_RESULT)
    result["size"] = DEFORMATION_RESULT.itemsize
    check(
        library().palpate_deformation(
            field.handle,
            asked.ctypes.data,
            rest.ctypes.data,
            None if chosen is None else chosen.ctypes.data_as(ctypes.c_void_p),
            len(rest) if chosen is None else len(chosen),
            moved.ctypes.data,
            result.ctypes.data,
        )
    )
    return moved, result
