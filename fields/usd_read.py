# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Read an asset back into the arrays that were written, bit by bit; the schema need not be registered."""

from __future__ import annotations

from pathlib import Path

from pxr import Sdf, Tf, Usd

from palpate.fields.field_error import FieldError
from palpate.fields.organ_geometry import OrganGeometry
from palpate.fields.response_field import ContactGeometry, ResponseField
from palpate.fields.surface_response import SurfaceResponse
from palpate.fields.usd_layer import check_units, schema_values
from palpate.fields.usd_organ import organ_from_prim
from palpate.fields.usd_response import contact_from_prim, field_from_prim
from palpate.fields.usd_surface_response import surface_response_from_prim

__all__ = [
    "field_at",
    "interface_path",
    "read_contact",
    "read_field",
    "read_organ",
    "read_surface_response",
    "stored_hashes",
    "tools",
]


def tools(asset_path: str | Path) -> list[str]:
    """Names of the asset's tools, sorted.  `asset_path`: the interface layer or its folder.

    Raises:
        FieldError: no asset there.
    """
    stage = _open(asset_path)
    return sorted(_root(stage).GetVariantSet("tool").GetVariantNames())


def read_field(asset_path: str | Path, tool: str) -> ResponseField:
    """The field of one tool.  `asset_path`: the interface layer or its folder.

    Raises:
        FieldError: no asset, no such tool, wrong units, missing or broken attributes.
    """
    names = tools(asset_path)
    if tool not in names:
        raise FieldError(f"{asset_path} has no tool {tool!r}; one of {names} is right")
    stage = _open(asset_path, tool)
    _check_stage(stage)
    return field_at(_root(stage))


def read_organ(asset_path: str | Path) -> OrganGeometry:
    """The organ.  `asset_path`: the interface layer or its folder.  Raises FieldError as read_field does."""
    stage = _open(asset_path)
    _check_stage(stage)
    return organ_from_prim(_root(stage))


def read_contact(asset_path: str | Path) -> ContactGeometry:
    """The contact geometry that all tools share.  Raises FieldError as read_field does."""
    stage = _open(asset_path)
    _check_stage(stage)
    return contact_from_prim(_root(stage))


def field_at(prim: Usd.Prim) -> ResponseField:
    """The field of the tool that is selected on `prim`, an asset's root prim or one that references it.

    Values are in SI and in the organ's own axes, whatever the units and transforms of the stage around it.

    Raises:
        FieldError: missing or broken attributes.
    """
    return field_from_prim(prim)


def read_surface_response(asset_path: str | Path, tool: str) -> SurfaceResponse:
    """One tool's curves at the vertices of the surface.

    Raises:
        FieldError: as read_field does, or the tool was authored without them.
    """
    names = tools(asset_path)
    if tool not in names:
        raise FieldError(f"{asset_path} has no tool {tool!r}; one of {names} is right")
    stage = _open(asset_path, tool)
    _check_stage(stage)
    return surface_response_from_prim(_root(stage))


def stored_hashes(asset_path: str | Path) -> tuple[str, str]:
    """Hashes of the asset's organ and contact geometry, as stored."""
    stage = _open(asset_path)
    root = _root(stage)
    contact = root.GetChild("Contact")
    if not contact:
        raise FieldError(f"{asset_path} has no prim Contact; a palpate asset is right")
    return schema_values(root, "PalpateOrganAPI")["hash"], schema_values(contact, "PalpateContactAPI")["hash"]


def interface_path(asset_path: str | Path) -> Path:
    """The interface layer: `asset_path` itself, or the one .usda file in the folder that it names."""
    path = Path(asset_path)
    if path.is_dir():
        found = sorted(p for p in path.glob("*.usda") if not p.name.startswith("."))
        if len(found) != 1:
            names = [p.name for p in found]
            raise FieldError(f"{path} holds {names or 'no .usda file'}; one interface layer is right")
        return found[0]
    if not path.is_file():
        raise FieldError(f"{path} does not exist; the .usda file of an asset, or its folder, is right")
    return path


def _open(asset_path: str | Path, tool: str | None = None) -> Usd.Stage:
    """A stage on the asset, payloads loaded, `tool` selected in the session layer: no file is changed."""
    path = interface_path(asset_path)
    try:
        layer = Sdf.Layer.FindOrOpen(str(path))
    except Tf.ErrorException as error:
        raise FieldError(f"{path} is no readable USD layer ({str(error).strip()})") from error
    if not layer or not layer.defaultPrim:
        raise FieldError(f"{path} has no default prim; the interface layer of a palpate asset is right")
    session = Sdf.Layer.CreateAnonymous(".usda")
    if tool is not None:
        over = Sdf.CreatePrimInLayer(session, f"/{layer.defaultPrim}")
        over.variantSelections["tool"] = tool
    return Usd.Stage.Open(layer, session, Usd.Stage.LoadAll)


def _root(stage: Usd.Stage) -> Usd.Prim:
    prim = stage.GetDefaultPrim()
    if not prim:
        raise FieldError(f"{stage.GetRootLayer().identifier}: the default prim does not exist")
    return prim


def _check_stage(stage: Usd.Stage) -> None:
    for layer in sorted(stage.GetUsedLayers(), key=lambda layer: layer.identifier):
        if not layer.anonymous:
            check_units(layer)
    errors = stage.GetCompositionErrors()
    if errors:
        raise FieldError(f"{stage.GetRootLayer().identifier} does not compose: {str(errors[0]).strip()}")
