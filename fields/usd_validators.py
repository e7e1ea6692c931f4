# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What `pxr.UsdValidation` cannot know about an asset: registered with it, so that any host can run it.

    palpate:Units           layers that carry palpate data are in metres and kilograms, Z up
    palpate:ElementCounts   arrays have as many values as their counts say; elementSize is the knot count
    palpate:KnotsRising     depth knots rise from 0
    palpate:ZeroAtContact   energy, force and lateral gradient vanish at depth 0, and so do phi and its slope
    palpate:Hashes          organ and contact geometry are what hashes say, and what the field was made for

The checks read USD alone, not the reader of this package, and need no registered schema.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from pxr import Sdf, Usd, UsdGeom, UsdValidation

from palpate.fields.field_check import ZERO_AT_CONTACT
from palpate.fields.field_error import FieldError
from palpate.fields.lattice import BLOCK_EDGE
from palpate.fields.organ_geometry import organ_hash
from palpate.fields.usd_layer import check_units
from palpate.fields.usd_organ import organ_from_prim
from palpate.fields.usd_read import interface_path, tools
from palpate.fields.usd_response import contact_from_prim, contact_hash
from palpate.fields.usd_schema.attributes import APIS

__all__ = ["VALIDATORS", "asset_errors", "register_validators"]


CURVES_AT_POINTS = {
    "PalpateResponseAPI": ("palpate:response:depthKnots", "primvars:palpate:"),
    "PalpateSurfaceResponseAPI": ("palpate:surfaceResponse:depthKnots", "primvars:palpate:surface:"),
}
"""APIs of point-based prims that carry curves over depth; the names of their knots, and how their primvars begin."""


def register_validators() -> None:
    """Register palpate's validators with `UsdValidation.ValidationRegistry`; may be repeated."""
    registry = UsdValidation.ValidationRegistry()
    for name, (problems, doc) in VALIDATORS.items():
        if registry.HasValidator(name):
            continue
        metadata = UsdValidation.ValidatorMetadata(name=name, keywords=["palpate"], doc=doc)
        registry.RegisterPrimValidator(metadata, _task(name.partition(":")[2], problems))


def asset_errors(asset_path: str | Path) -> list[str]:
    """Errors of every registered validator, USD's own and palpate's, over every tool of the asset.

    Args:
        asset_path: the interface layer or its folder.

    Returns:
        one sentence for each error, with the tool and the validator that found it; empty where all is well.

    Raises:
        FieldError: no asset there.
    """
    register_validators()
    path = interface_path(asset_path)
    names = tools(path)
    context = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
    found = []
    for tool in names:
        layer = Sdf.Layer.FindOrOpen(str(path))
        session = Sdf.Layer.CreateAnonymous(".usda")
        Sdf.CreatePrimInLayer(session, f"/{layer.defaultPrim}").variantSelections["tool"] = tool
        stage = Usd.Stage.Open(layer, session, Usd.Stage.LoadAll)
        for error in context.Validate(stage):
            if error.GetType() == UsdValidation.ValidationErrorType.Error:
                found.append(f"{tool}: {error.GetErrorAsString()}")
    return found


def _units(prim: Usd.Prim) -> Iterator[str]:
    for spec in prim.GetPrimStack():
        apis = spec.GetInfo("apiSchemas").GetAddedOrExplicitItems() if spec.HasInfo("apiSchemas") else []
        if not APIS.keys().isdisjoint(apis):
            try:
                check_units(spec.layer)
            except FieldError as error:
                yield str(error)


def _frictionless(prim: Usd.Prim) -> tuple[str, ...]:
    """Names of curves that nodes without friction do not have; none where one of them is there."""
    rows = APIS["PalpateResponseAPI"].attributes
    names = tuple(rows[name].name for name in ("friction_stiffness", "friction_coefficient"))
    return () if any(prim.HasAttribute(name) for name in names) else names


def _element_counts(prim: Usd.Prim) -> Iterator[str]:
    if _has(prim, "PalpateExactPointsAPI"):
        yield from _count(
            prim, "palpate:exactPoints", len(UsdGeom.PointBased(prim).GetPointsAttr().Get() or ())
        )
    for api, (knots_name, _) in CURVES_AT_POINTS.items():
        if not _has(prim, api):
            continue
        nodes = len(UsdGeom.PointBased(prim).GetPointsAttr().Get() or ())
        knots = len(_array(prim, knots_name))
        without = _frictionless(prim)
        for row in APIS[api].attributes.values():
            if row.is_primvar and row.name not in without:
                size = knots if row.per_knot else 1
                yield from _count(prim, row.name, nodes * size)
                primvar = UsdGeom.Primvar(prim.GetAttribute(row.name))
                if primvar.GetElementSize() != size:
                    yield f"{row.name} has elementSize {primvar.GetElementSize()}; {size} is right"
                if primvar.GetInterpolation() != UsdGeom.Tokens.vertex:
                    yield f"{row.name} is {primvar.GetInterpolation()}; vertex is right"
    if _has(prim, "PalpatePaintAPI"):
        vertices = len(UsdGeom.PointBased(prim).GetPointsAttr().Get() or ())
        for row in APIS["PalpatePaintAPI"].attributes.values():
            if prim.GetAttribute(row.name).HasAuthoredValue():
                yield from _count(prim, row.name, vertices)
    if _has(prim, "PalpateLatticeAPI"):
        shape = _array(prim, "palpate:lattice:blockShape")
        yield from _count(prim, "palpate:lattice:blockIndex", int(np.prod(shape)))
        per_block = BLOCK_EDGE**3 * len(prim.GetAttribute("palpate:lattice:channels").Get() or "?")
        stored = len(_array(prim, "palpate:lattice:coefficients")) // per_block  # rows may be unused
        blocks = max(int(_array(prim, "palpate:lattice:blockIndex").max(initial=-1)) + 1, stored)
        yield from _count(prim, "palpate:lattice:coefficients", blocks * per_block)
    if _has(prim, "PalpateDepthCurvesAPI"):
        curves, intervals = (
            prim.GetAttribute(f"palpate:depthCurves:{name}").Get() or 0
            for name in ("curveCount", "intervalCount")
        )
        yield from _count(prim, "palpate:depthCurves:coefficients", curves * intervals * 4)


def _knots_rising(prim: Usd.Prim) -> Iterator[str]:
    for api, (name, _) in CURVES_AT_POINTS.items():
        knots = _array(prim, name)
        if _has(prim, api) and (len(knots) < 2 or knots[0] != 0 or not (np.diff(knots) > 0).all()):
            yield f"{name} are {knots.tolist()} m; two or more, rising from 0, are right"


def _zero_at_contact(prim: Usd.Prim) -> Iterator[str]:
    for api, (knots_name, begin) in CURVES_AT_POINTS.items():
        if not _has(prim, api):
            continue
        knots = len(_array(prim, knots_name))
        for name in ("storedEnergy", "normalForce", "lateralGradient"):
            values = np.abs(_array(prim, f"{begin}{name}"))
            first = values[::knots] if knots else values
            if first.max(initial=0.0) > ZERO_AT_CONTACT * values.max(initial=0.0):
                yield f"{begin}{name} is up to {first.max():.3g} at depth 0; 0 is right"
    if _has(prim, "PalpateDepthCurvesAPI") and prim.GetName() == "EnergyCurves":
        coefficients = _array(prim, "palpate:depthCurves:coefficients")
        intervals = prim.GetAttribute("palpate:depthCurves:intervalCount").Get() or 1
        step = prim.GetAttribute("palpate:depthCurves:depthEnd").Get() / intervals
        if len(coefficients) % (intervals * 4):
            return  # palpate:ElementCounts says so
        terms = np.abs(coefficients.reshape(-1, intervals, 4)) * step ** np.arange(4)
        scale = terms.sum(axis=2).max(axis=1, initial=0.0)
        for r in np.nonzero(terms[:, 0, :2].max(axis=1) > ZERO_AT_CONTACT * scale)[0]:
            yield f"energy curve {r} does not start with value 0 and slope 0 at depth 0; both are right"


def _hashes(prim: Usd.Prim) -> Iterator[str]:
    try:
        if _has(prim, "PalpateOrganAPI"):
            yield from _same(prim, "palpate:organ:hash", organ_hash(organ_from_prim(prim)), "its arrays")
        if _has(prim, "PalpateContactAPI"):
            contact = contact_hash(contact_from_prim(prim.GetParent()))
            yield from _same(prim, "palpate:contact:hash", contact, "its arrays")
        if _has(prim, "PalpateFieldAPI"):
            root = prim.GetParent()
            organ = root.GetAttribute("palpate:organ:hash").Get()
            contact = root.GetChild("Contact").GetAttribute("palpate:contact:hash").Get()
            yield from _same(prim, "palpate:field:organHash", organ, "the asset's organ")
            yield from _same(prim, "palpate:field:contactHash", contact, "the asset's contact geometry")
    except FieldError as error:
        yield str(error)


Problems = Callable[[Usd.Prim], Iterator[str]]

VALIDATORS: dict[str, tuple[Problems, str]] = {
    "palpate:Units": (_units, "Layers that carry palpate data are in metres and kilograms, Z up."),
    "palpate:ElementCounts": (_element_counts, "Arrays have as many values as their counts say."),
    "palpate:KnotsRising": (_knots_rising, "Depth knots rise from 0."),
    "palpate:ZeroAtContact": (_zero_at_contact, "Energy and force vanish at depth 0, phi and its slope too."),
    "palpate:Hashes": (_hashes, "Geometry is what its hash says, and what the field was made for."),
}
"""Validators by name: the check, which yields one sentence for each problem of a prim, and its doc."""


def _task(error_name: str, problems: Problems) -> Callable:
    def task(prim: Usd.Prim, time_range: UsdValidation.ValidationTimeRange) -> list:
        site = UsdValidation.ValidationErrorSite(prim.GetStage(), prim.GetPath())
        kind = UsdValidation.ValidationErrorType.Error
        return [
            UsdValidation.ValidationError(error_name, kind, [site], f"{prim.GetPath()}: {problem}")
            for problem in problems(prim)
        ]

    return task


def _has(prim: Usd.Prim, api: str) -> bool:
    return api in prim.GetPrimTypeInfo().GetAppliedAPISchemas()


def _array(prim: Usd.Prim, name: str) -> np.ndarray:
    value = prim.GetAttribute(name).Get()
    return np.zeros(0) if value is None else np.array(value)


def _count(prim: Usd.Prim, name: str, right: int) -> Iterator[str]:
    attribute = prim.GetAttribute(name)
    value = attribute.Get()
    if value is not None and UsdGeom.Primvar.IsPrimvar(attribute) and UsdGeom.Primvar(attribute).IsIndexed():
        value = UsdGeom.Primvar(attribute).GetIndices()
    found = 0 if value is None else len(value)
    if found != right:
        yield f"{name} has {found} values; {right} is right"


def _same(prim: Usd.Prim, name: str, right: str | None, of: str) -> Iterator[str]:
    found = prim.GetAttribute(name).Get()
    if found != right:
        yield f"{name} is {str(found)[:12]}...; {str(right)[:12]}..., that of {of}, is right"
