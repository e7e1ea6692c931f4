# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The response per surface vertex in USD: primvars that a tool's layer lays over the surface Mesh it shares.

/<organ>/Surface        over, with PalpateSurfaceResponseAPI; selecting another tool brings that tool's curves
"""

from __future__ import annotations

import dataclasses

import numpy as np
from pxr import Sdf, Usd, UsdGeom

from palpate.fields.field_error import FieldError
from palpate.fields.surface_response import SurfaceResponse
from palpate.fields.usd_layer import author_schema, schema_values

__all__ = ["author_surface_response", "surface_response_from_prim"]

API = "PalpateSurfaceResponseAPI"


def author_surface_response(layer: Sdf.Layer, response: SurfaceResponse) -> None:
    """Adds `response` to the layer of a tool."""
    surface = Sdf.PrimSpec(layer.GetPrimAtPath(f"/{layer.defaultPrim}"), "Surface", Sdf.SpecifierOver)
    values = {field.name: getattr(response, field.name) for field in dataclasses.fields(response)}
    author_schema(surface, API, values, element_size=len(response.depth_knots))


def surface_response_from_prim(root: Usd.Prim) -> SurfaceResponse:
    """The selected tool's curves at the surface's vertices, float32 as stored.

    Raises:
        FieldError: the tool was authored without them, or an array has the wrong length.
    """
    surface = root.GetChild("Surface")
    if not surface or API not in surface.GetPrimTypeInfo().GetAppliedAPISchemas():
        raise FieldError(
            f"{root.GetPath()}/Surface has no curves per vertex for this tool; palpate author --per-vertex is right"
        )
    values = schema_values(surface, API)
    vertices = len(UsdGeom.Mesh(surface).GetPointsAttr().Get())
    knots = len(values["depth_knots"])
    for name, array in values.items():
        right = {"depth_knots": knots, "reached": vertices}.get(name, vertices * knots)
        if len(array) != right:
            raise FieldError(
                f"{surface.GetPath()}: {name} has {len(array)} values; {right}, "
                f"{vertices} vertices x {knots} knots, is right"
            )
        if name not in ("depth_knots", "reached"):
            values[name] = np.asarray(array).reshape(vertices, knots, *np.shape(array)[1:])
    return SurfaceResponse(**values)
