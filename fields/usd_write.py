# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Write an organ and its response fields as one folder of USD layers with relative paths.

    <folder>/<organ>.usda          interface: variant set "tool", one payload per tool; what people read
    <folder>/geometry.usdc         surface, tets, supports, regions, reach
    <folder>/contact.usdc          signed distance, shared by all tools
    <folder>/fields/<tool>.usdc    response nodes, depth curves, amplitudes of one tool; on request curves per vertex

Each file is replaced whole, the interface last; a tool's file is touched by that tool alone.  One writer at a
time: two that add tools to one folder at once may lose one entry of the variant set, never a field file.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from pxr import Sdf

from palpate.fields.field_error import FieldError
from palpate.fields.organ_geometry import OrganGeometry, organ_hash
from palpate.fields.response_field import ResponseField
from palpate.fields.surface_response import surface_response
from palpate.fields.usd_failed_presses import author_failed_presses
from palpate.fields.usd_layer import apply_apis, author, new_layer, prim_name, replace_file
from palpate.fields.usd_organ import organ_layer
from palpate.fields.usd_read import interface_path, read_organ, stored_hashes, tools
from palpate.fields.usd_response import contact_hash, contact_layer, field_layer
from palpate.fields.usd_surface_response import author_surface_response

__all__ = ["add_tool", "write_asset"]


def write_asset(
    folder: str | Path,
    organ: OrganGeometry,
    field: ResponseField,
    replace: bool = False,
    per_vertex: bool = False,
) -> Path:
    """Write an asset with one tool; into a folder that holds the same organ, add or replace that tool.

    Args:
        folder: made where it does not exist.
        organ: geometry that `field` was pressed on.
        field: the first tool.
        replace: allow another organ or contact geometry; the other tools' fields are then deleted.
        per_vertex: resample the field at the surface's vertices too (surface_response.py).

    Returns:
        path of the interface layer.

    Raises:
        FieldError: organ or field break their contracts, or the folder holds another asset.
        OSError: a file cannot be written.
    """
    folder = Path(folder)
    _check_name("organ", organ.name)
    _check_name("tool", field.tool.name)
    root = prim_name(organ.name)
    layers = (organ_layer(organ), contact_layer(root, field.geometry))
    tool_layer = _tool_layer(root, organ, organ_hash(organ), field, per_vertex)
    if any(not path.name.startswith(".") for path in folder.glob("*.usda")):  # a killed writer leaves .part
        old = interface_path(folder)
        new_hashes = (organ_hash(organ), contact_hash(field.geometry))
        if old.stem == organ.name and stored_hashes(old) == new_hashes:
            return add_tool(folder, field, per_vertex)
        if not replace:
            raise FieldError(
                f"{old} holds another organ or contact geometry; another folder, or replace=True, is right"
            )
        _remove_asset(old)
    replace_file(layers[0], folder / "geometry.usdc")
    replace_file(layers[1], folder / "contact.usdc")
    replace_file(tool_layer, _field_path(folder, field.tool.name))
    interface = folder / f"{organ.name}.usda"
    replace_file(_interface(organ, [field.tool.name], field.tool.name), interface)
    return interface


def add_tool(folder: str | Path, field: ResponseField, per_vertex: bool = False) -> Path:
    """Add or replace one tool of the asset in `folder`; other tools' files are not touched.

    Args:
        per_vertex: resample the field at the surface's vertices too.

    Returns:
        path of the interface layer.

    Raises:
        FieldError: no asset there, the field breaks its contract, or its contact geometry is not the asset's.
        OSError: a file cannot be written.
    """
    folder = Path(folder)
    interface = interface_path(folder)
    name = field.tool.name
    _check_name("tool", name)
    organ, contact = stored_hashes(interface)
    if contact_hash(field.geometry) != contact:
        raise FieldError(
            f"field {name!r} has another contact geometry than {interface}; "
            "all tools of an asset share one, fit this field on read_contact()"
        )
    layer = Sdf.Layer.OpenAsAnonymous(str(interface))
    geometry = read_organ(interface) if per_vertex else None
    made = _tool_layer(layer.defaultPrim, geometry, organ, field, per_vertex)
    replace_file(made, _field_path(folder, name))
    if name not in tools(interface):
        _add_variant(layer.GetPrimAtPath(f"/{layer.defaultPrim}"), name)
        replace_file(layer, interface)
    return interface


def _tool_layer(
    root: str, organ: OrganGeometry | None, organ_hash: str, field: ResponseField, per_vertex: bool
) -> Sdf.Layer:
    layer = field_layer(root, field, organ_hash)
    author_failed_presses(layer, field.provenance.get("failed_presses", []))
    if per_vertex:
        assert organ is not None
        author_surface_response(layer, surface_response(organ, field))
    return layer


def _check_name(kind: str, name: str) -> None:
    if not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_-]*", name):
        raise FieldError(f"{kind} name {name!r} cannot name a file; letters, digits, '_' and '-' are right")


def _field_path(folder: Path, tool: str) -> Path:
    return folder / "fields" / f"{tool}.usdc"


def _interface(organ: OrganGeometry, names: list[str], selected: str) -> Sdf.Layer:
    comment = f'{organ.name}: an organ that can be felt. Choose a tool in the variant set "tool".'
    layer, root = new_layer(prim_name(organ.name), comment=comment)
    root.SetInfo("kind", "component")
    root.SetInfo("assetInfo", {"name": organ.name, "identifier": Sdf.AssetPath(f"./{organ.name}.usda")})
    apply_apis(root, ["GeomModelAPI"])
    points = np.asarray(organ.vertices, np.float32)
    author(root, "extentsHint", "float3[]", [points.min(axis=0), points.max(axis=0)])
    root.payloadList.prependedItems = [Sdf.Payload("./geometry.usdc"), Sdf.Payload("./contact.usdc")]
    root.variantSetNameList.prependedItems = ["tool"]
    Sdf.VariantSetSpec(root, "tool")
    root.variantSelections["tool"] = selected
    for name in names:
        _add_variant(root, name)
    return layer


def _add_variant(root: Sdf.PrimSpec, tool: str) -> None:
    variant = Sdf.VariantSpec(root.variantSets["tool"], tool)
    variant.primSpec.payloadList.prependedItems = [Sdf.Payload(f"./fields/{tool}.usdc")]


def _remove_asset(interface: Path) -> None:
    names = tools(interface)
    interface.unlink()
    for name in names:
        _field_path(interface.parent, name).unlink(missing_ok=True)
