# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The organ as plain arrays: what an asset shows, and what its response fields were pressed on.

Units: SI.  Axes: the organ's own, right-handed; surface normals point out of the tissue.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from palpate.fields.field_error import FieldError

__all__ = ["OrganGeometry", "Support", "check_organ", "organ_hash"]

PAINTS = ("stiffness_scale", "friction", "reach")
"""Kinds of paint."""


@dataclass(frozen=True)
class Support:
    """What holds the organ.

    Attributes:
        name: scene name, or one made from its place in the scene; unique within the organ.
        tet_point_indices: (P,) int32; points of the tet mesh that are held.
        triangle_indices: (S,) int32; triangles of the surface that are held, for display; may be empty.
        kind: "fixed" or "elastic".
        stiffness: Pa/m; 0 where fixed.
    """

    name: str
    tet_point_indices: np.ndarray
    triangle_indices: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int32))
    kind: str = "fixed"
    stiffness: float = 0.0


@dataclass(frozen=True)
class OrganGeometry:
    """Surface, tets, and what is where on them.

    Attributes:
        name: scene name; letters, digits, "_" and "-".
        vertices: (V, 3) m; the smoothed surface that presses and contact geometry share.
        triangles: (F, 3) int32; counter-clockwise seen from outside.
        tet_points: (Q, 3) m; corners only.
        tet_indices: (T, 4) int32; det[b - a, c - a, d - a] > 0.
        supports: what holds the organ.
        region_names: name of each region, by label; label 0 is the organ's own tissue.
        region_label: (T,) int32; index into `region_names`.
        reach_triangles: (R,) int32; triangles that a tool can touch; all of them by default.
        material: the organ's material as JSON-clean data, SI ({"model": ..., "youngs_modulus": Pa, ...}).
        region_materials: the materials of regions that have their own, by name.
        provenance: hashes and sources of the surface, JSON-clean.
        paint: scalars painted on the surface by kind ("friction", "reach", "stiffness_scale"), (V,) at its vertices.
    """

    name: str
    vertices: np.ndarray
    triangles: np.ndarray
    tet_points: np.ndarray
    tet_indices: np.ndarray
    supports: tuple[Support, ...]
    region_names: tuple[str, ...]
    region_label: np.ndarray
    reach_triangles: np.ndarray
    material: dict[str, Any]
    region_materials: dict[str, dict[str, Any]] = field(default_factory=dict)
    provenance: dict[str, Any] = field(default_factory=dict)
    paint: dict[str, np.ndarray] = field(default_factory=dict)


def organ_hash(organ: OrganGeometry) -> str:
    """Hex sha256 of everything in `organ` that a press depends on (all but its name and provenance)."""
    digest = hashlib.sha256()

    def add(array: np.ndarray, dtype: str) -> None:
        digest.update(repr(np.shape(array)).encode())
        values = np.ascontiguousarray(array).astype(dtype)
        digest.update((values + values.dtype.type(0)).tobytes())  # -0.0 is stored as 0.0

    add(organ.vertices, "<f8")
    add(organ.triangles, "<i4")
    add(organ.tet_points, "<f8")
    add(organ.tet_indices, "<i4")
    add(organ.region_label, "<i4")
    add(organ.reach_triangles, "<i4")
    for support in organ.supports:
        add(support.tet_point_indices, "<i4")
        add(support.triangle_indices, "<i4")
    words = [organ.region_names, organ.material, organ.region_materials]
    words.append([(s.name, s.kind, float(s.stiffness)) for s in organ.supports])
    digest.update(json.dumps(words, sort_keys=True).encode())
    for kind in sorted(organ.paint):
        digest.update(kind.encode())
        add(organ.paint[kind], "<f8")
    return digest.hexdigest()


def check_organ(organ: OrganGeometry) -> None:
    """Raise FieldError where `organ` breaks the shapes, ranges or orientations that its docstring states."""
    for name, array in (("vertices", organ.vertices), ("tet_points", organ.tet_points)):
        if np.ndim(array) != 2 or np.shape(array)[1] != 3 or len(array) == 0:
            raise FieldError(f"organ {organ.name}: {name} has shape {np.shape(array)}; (count, 3) is right")
        if not np.isfinite(array).all():
            row = int(np.nonzero(~np.isfinite(array).all(axis=1))[0][0])
            raise FieldError(
                f"organ {organ.name}: {name}[{row}] is not finite; a position in metres is right"
            )
    vertex_count, point_count = len(organ.vertices), len(organ.tet_points)
    _check_indices(organ, "triangles", organ.triangles, (None, 3), vertex_count)
    _check_indices(organ, "tet_indices", organ.tet_indices, (None, 4), point_count)
    triangle_count, tet_count = len(organ.triangles), len(organ.tet_indices)
    _check_indices(organ, "reach_triangles", organ.reach_triangles, (None,), triangle_count)
    _check_indices(organ, "region_label", organ.region_label, (tet_count,), len(organ.region_names))
    for kind, values in organ.paint.items():
        if kind not in PAINTS:
            raise FieldError(f"organ {organ.name}: paint {kind!r}; one of {list(PAINTS)} is right")
        if np.shape(values) != (vertex_count,) or not np.isfinite(values).all():
            raise FieldError(
                f"organ {organ.name}: paint {kind!r} has shape {np.shape(values)} or is not finite; "
                f"({vertex_count},) finite numbers are right"
            )
    names = [support.name for support in organ.supports]
    for kind, words in (("support", names), ("region", list(organ.region_names))):
        if len(set(words)) != len(words) or "" in words:
            raise FieldError(
                f"organ {organ.name}: {kind} names are {words}; unique, non-empty names are right"
            )
    for support in organ.supports:
        where = f"support {support.name!r}"
        _check_indices(organ, f"{where} points", support.tet_point_indices, (None,), point_count)
        _check_indices(organ, f"{where} triangles", support.triangle_indices, (None,), triangle_count)
    for name in organ.region_materials:
        if name not in organ.region_names:
            raise FieldError(
                f"organ {organ.name}: region_materials names {name!r}; "
                f"one of {list(organ.region_names)} is right"
            )
    a, b, c, d = (organ.tet_points[organ.tet_indices[:, k]] for k in range(4))
    volume = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6.0
    if tet_count and not (volume > 0).all():
        worst = int(np.argmin(volume))
        raise FieldError(
            f"organ {organ.name}: tet {worst} has volume {volume[worst]:.3g} m3; "
            "a positive one is right (swap two of its corners)"
        )


def _check_indices(
    organ: OrganGeometry, name: str, array: np.ndarray, shape: tuple[int | None, ...], below: int
) -> None:
    actual = np.shape(array)
    right = ", ".join("count" if n is None else str(n) for n in shape) + ("," if len(shape) == 1 else "")
    if len(actual) != len(shape) or any(n is not None and n != m for n, m in zip(shape, actual, strict=True)):
        raise FieldError(f"organ {organ.name}: {name} has shape {actual}; ({right}) is right")
    if not np.issubdtype(np.asarray(array).dtype, np.integer):
        raise FieldError(f"organ {organ.name}: {name} is {np.asarray(array).dtype}; int32 is right")
    if np.size(array) and (np.min(array) < 0 or np.max(array) >= below):
        raise FieldError(
            f"organ {organ.name}: {name} spans {np.min(array)}..{np.max(array)}; 0..{below - 1} is right"
        )
