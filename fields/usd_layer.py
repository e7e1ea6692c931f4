# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Writing and reading single USD layers: units, prims, attributes by the schema's table, whole files.

Layers are authored as specs, not through a stage, so what is written never depends on whether the schema
is registered in the process.  Negative zeros become zeros: crate files store the two alike.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Tf, Usd, UsdGeom, Vt

from palpate.fields.field_error import FieldError
from palpate.fields.usd_schema.attributes import APIS, SchemaAttribute

__all__ = [
    "UNITS",
    "author",
    "author_schema",
    "author_some",
    "check_units",
    "child",
    "json_text",
    "new_layer",
    "prim_name",
    "read_attribute",
    "replace_file",
    "schema_values",
]

UNITS = {"metersPerUnit": 1.0, "kilogramsPerUnit": 1.0, "upAxis": "Z"}
"""Layer metadata that every layer of an asset carries."""


def new_layer(root: str, type_name: str = "Xform", comment: str = "") -> tuple[Sdf.Layer, Sdf.PrimSpec]:
    """An empty layer in memory with units and a default prim, and that prim."""
    layer = Sdf.Layer.CreateAnonymous(".usda")
    for key, value in UNITS.items():
        layer.pseudoRoot.SetInfo(key, value)
    layer.comment = comment
    layer.defaultPrim = root
    return layer, Sdf.PrimSpec(layer, root, Sdf.SpecifierDef, type_name)


def child(parent: Sdf.PrimSpec, name: str, type_name: str = "", apis: Iterable[str] = ()) -> Sdf.PrimSpec:
    """A new prim under `parent`; `type_name` "" makes it typeless."""
    prim = Sdf.PrimSpec(parent, name, Sdf.SpecifierDef, type_name)
    apply_apis(prim, apis)
    return prim


def apply_apis(prim: Sdf.PrimSpec, apis: Iterable[str]) -> None:
    """Add API schemas to `prim`, after those that it has."""
    old = prim.GetInfo("apiSchemas").prependedItems if prim.HasInfo("apiSchemas") else []
    new = [*old, *(api for api in apis if api not in old)]
    if new:
        prim.SetInfo("apiSchemas", Sdf.TokenListOp.Create(prependedItems=new))


def author(
    prim: Sdf.PrimSpec, name: str, usd_type: str, value: Any, uniform: bool = False, **metadata: Any
) -> Sdf.AttributeSpec:
    """Author one attribute; NumPy arrays go into arrays of `usd_type` with their leading axes flattened."""
    value_type = Sdf.ValueTypeNames.Find(usd_type)
    variability = Sdf.VariabilityUniform if uniform else Sdf.VariabilityVarying
    attribute = Sdf.AttributeSpec(prim, name, value_type, variability)
    attribute.default = _to_usd(value, usd_type)
    for key, item in metadata.items():
        attribute.SetInfo(key, item)
    return attribute


def author_schema(prim: Sdf.PrimSpec, api: str, values: Mapping[str, Any], element_size: int = 1) -> None:
    """Apply `api` and author all of its attributes; by member; `element_size` is for per-knot primvars.

    Primvars of one value an element are indexed where values repeat, as USD would have it; per-knot ones never are.
    """
    missing = set(values) ^ set(APIS[api].attributes)
    if missing:
        raise KeyError(f"{api}: {sorted(missing)}")
    author_some(prim, api, values, element_size)


def author_some(prim: Sdf.PrimSpec, api: str, values: Mapping[str, Any], element_size: int = 1) -> None:
    """As author_schema, for an API whose attributes may be absent."""
    apply_apis(prim, [api])
    for member, row in APIS[api].attributes.items():
        if member not in values:
            continue
        metadata: dict[str, Any] = {"customData": {"unit": row.unit}}
        if row.is_primvar:
            metadata["interpolation"] = "vertex"
        if row.per_knot:
            metadata["elementSize"] = element_size
        value = values[member]
        if row.is_primvar and not row.per_knot and row.usd_type != "bool[]":
            value = _indexed(prim, row.name, np.asarray(value))
        author(prim, row.name, row.usd_type, value, uniform=not row.is_primvar, **metadata)


def _indexed(prim: Sdf.PrimSpec, name: str, values: np.ndarray) -> np.ndarray:
    """The distinct values of (N, ...), in order of appearance; authors the indices where they are fewer than N."""
    values = values + values.dtype.type(0) if values.dtype.kind == "f" else values  # -0.0 + 0.0 is 0.0
    rows = values.reshape(len(values), -1)
    _, first, back = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    if len(first) == len(values):
        return values
    order = np.argsort(first)
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    author(prim, f"{name}:indices", "int[]", place[back.reshape(-1)])
    return values[first[order]]


def schema_values(prim: Usd.Prim, api: str, absent: Sequence[str] = ()) -> dict[str, Any]:
    """All attributes of `api` on `prim`, by member, but `absent` ones; needs no registered schema.

    Raises:
        FieldError: the API is not applied, or an attribute is missing or of another type.
    """
    applied = prim.GetPrimTypeInfo().GetAppliedAPISchemas()
    if api not in applied:
        raise FieldError(f"{_place(prim)} carries {list(applied)}; {api} is right")
    rows = APIS[api].attributes.items()
    return {member: read_attribute(prim, row) for member, row in rows if member not in absent}


def read_attribute(prim: Usd.Prim, row: SchemaAttribute) -> Any:
    """One attribute's value: arrays and vectors as NumPy (float64, int32, bool or str), else plain.

    Raises:
        FieldError: it has no value, or the value is of another type than the schema says.
    """
    attribute = prim.GetAttribute(row.name)
    value = attribute.Get() if attribute else None
    if value is None:
        raise FieldError(f"{_place(prim)} has no {row.name}; a {row.usd_type} is right ({row.doc})")
    if str(attribute.GetTypeName()) != row.usd_type:
        raise FieldError(
            f"{_place(prim)} has {row.name} as {attribute.GetTypeName()}; {row.usd_type} is right"
        )
    if row.is_primvar and UsdGeom.Primvar(attribute).IsIndexed():
        indices = np.array(UsdGeom.Primvar(attribute).GetIndices())
        if len(indices) and not 0 <= indices.min() <= indices.max() < len(value):
            span, below = f"{indices.min()}..{indices.max()}", len(value) - 1
            raise FieldError(f"{_place(prim)}: {row.name}:indices span {span}; 0..{below} is right")
        value = [value[int(i)] for i in indices]
    if row.usd_type in ("string[]", "token[]"):
        return np.array(list(value), dtype=str)
    if row.usd_type.endswith("[]") or row.usd_type[-1].isdigit():
        return np.array(value)
    return value


def check_units(layer: Sdf.Layer) -> None:
    """Raise FieldError where a layer's units are missing or not SI with Z up."""
    for key, right in UNITS.items():
        has = layer.pseudoRoot.HasInfo(key)
        if not has or layer.pseudoRoot.GetInfo(key) != right:
            found = layer.pseudoRoot.GetInfo(key) if has else "missing"
            raise FieldError(f"{layer.identifier}: {key} is {found}; {right} is right")


def json_text(value: dict[str, Any], where: str) -> str:
    """Canonical JSON of `value`; raises FieldError unless it comes back equal from JSON."""
    try:
        text = json.dumps(value, sort_keys=True, allow_nan=False, ensure_ascii=False)
        same = json.loads(text) == value
    except (TypeError, ValueError) as error:
        raise FieldError(
            f"{where} is not JSON-clean ({error}); plain words, numbers, lists are right"
        ) from error
    if not same:
        raise FieldError(f"{where} changes on its way through JSON; lists for tuples, string keys are right")
    return text


def prim_name(name: str) -> str:
    """`name` as a prim's name: anything but ASCII letters, digits and "_" becomes "_"."""
    clean = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return clean if clean and not clean[0].isdigit() else f"_{clean}"


def replace_file(layer: Sdf.Layer, path: Path) -> None:
    """Write `layer` to `path` (usda or usdc by its suffix): whole or not at all; open stages see it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
    try:
        layer.Export(str(temporary))
        with open(temporary, "rb") as file:
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except Tf.ErrorException as error:
        raise OSError(f"{path} could not be written: {error}") from error
    finally:
        temporary.unlink(missing_ok=True)
    opened = Sdf.Layer.Find(str(path))
    if opened:
        opened.Reload(force=True)


def _place(prim: Usd.Prim) -> str:
    return f"{prim.GetStage().GetRootLayer().identifier}: {prim.GetPath()}"


_ARRAYS = {
    "double[]": (Vt.DoubleArray, "<f8", ()),
    "float[]": (Vt.FloatArray, "<f4", ()),
    "int[]": (Vt.IntArray, "<i4", ()),
    "bool[]": (Vt.BoolArray, "?", ()),
    "point3d[]": (Vt.Vec3dArray, "<f8", (3,)),
    "vector3d[]": (Vt.Vec3dArray, "<f8", (3,)),
    "normal3d[]": (Vt.Vec3dArray, "<f8", (3,)),
    "point3f[]": (Vt.Vec3fArray, "<f4", (3,)),
    "vector3f[]": (Vt.Vec3fArray, "<f4", (3,)),
    "normal3f[]": (Vt.Vec3fArray, "<f4", (3,)),
    "color3f[]": (Vt.Vec3fArray, "<f4", (3,)),
    "float3[]": (Vt.Vec3fArray, "<f4", (3,)),
    "int3[]": (Vt.Vec3iArray, "<i4", (3,)),
    "int4[]": (Vt.Vec4iArray, "<i4", (4,)),
}


def _to_usd(value: Any, usd_type: str) -> Any:
    if usd_type in _ARRAYS:
        maker, dtype, tail = _ARRAYS[usd_type]
        array = np.ascontiguousarray(value).astype(dtype).reshape(-1, *tail)
        if dtype.startswith("<f"):
            array = array + array.dtype.type(0)  # -0.0 + 0.0 is 0.0
        return maker.FromNumpy(array) if len(array) else maker()
    if usd_type in ("string[]", "token[]"):
        return (Vt.StringArray if usd_type == "string[]" else Vt.TokenArray)([str(v) for v in value])
    if usd_type in ("double", "float"):
        return float(value) + 0.0
    if usd_type in ("double2", "double3"):
        maker = Gf.Vec2d if usd_type == "double2" else Gf.Vec3d
        return maker(*(float(v) + 0.0 for v in value))
    if usd_type == "matrix4d":
        return Gf.Matrix4d(*(np.asarray(value, float) + 0.0).ravel().tolist())
    if usd_type in ("int2", "int3"):
        return (Gf.Vec2i if usd_type == "int2" else Gf.Vec3i)(*(int(v) for v in value))
    return {"int": int, "bool": bool}.get(usd_type, str)(value)
