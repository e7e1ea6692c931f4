# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Every validator of pxr.UsdValidation passes on an asset, and each of palpate's own can fail."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdValidation, Vt

from palpate.fields.usd_read import read_organ
from palpate.fields.usd_validators import VALIDATORS, asset_errors, register_validators
from palpate.fields.usd_write import write_asset

FAMILIES = {
    "usdValidation",
    "usdGeomValidators",
    "usdLuxValidators",
    "usdMediaValidators",
    "usdPhysicsValidators",
    "usdShadeValidators",
    "usdSkelValidators",
    "usdUtilsValidators",
    "palpate",
}


def names() -> list[str]:
    register_validators()
    return sorted(m.name for m in UsdValidation.ValidationRegistry().GetAllValidatorMetadata())


def test_the_registry_holds_usds_validators_and_ours():
    """A new family is a new promise: look at it, then add it here."""
    found = names()
    print("\n".join(found))
    assert {name.partition(":")[0] for name in found} == FAMILIES
    assert set(VALIDATORS) <= set(found) and len(found) >= 30 + len(VALIDATORS)


def test_the_asset_passes_every_validator_with_every_tool(asset):
    errors = asset_errors(asset)
    assert not errors, "\n".join(errors)


@pytest.mark.parametrize("file", ["block.usda", "geometry.usdc", "contact.usdc", "fields/ball_5mm.usdc"])
def test_every_layer_alone_has_no_warning_either(asset, file):
    register_validators()
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    alone = [v for v in validators if v.GetMetadata().name != "palpate:Hashes"]  # needs the whole asset
    stage = Usd.Stage.Open(str(asset.parent / file))
    found = [e.GetErrorAsString() for e in UsdValidation.ValidationContext(alone).Validate(stage)]
    assert not found, "\n".join(found)


def edit(asset: Path, file: str, attribute: str, change) -> None:
    layer = Sdf.Layer.OpenAsAnonymous(str(asset.parent / file))
    spec = layer.GetAttributeAtPath(attribute)
    if callable(change):
        spec.default = change(spec.default)
    else:
        spec.SetInfo(*change)
    layer.Export(str(asset.parent / file))


FIELD, NODES = "fields/ball_5mm.usdc", "/block/Response/Nodes"
ENERGY = "/block/Response/EnergyCurves.palpate:depthCurves"
DISTANCE = "/block/Contact/SignedDistance.palpate:lattice"


def raised(values, place, value):
    changed = list(values)
    changed[place] = value
    return Vt.DoubleArray(changed)


@pytest.mark.parametrize(
    ("validator", "file", "attribute", "change"),
    [
        ("palpate:KnotsRising", FIELD, f"{NODES}.palpate:response:depthKnots", lambda v: raised(v, 1, 0.0)),
        ("palpate:KnotsRising", FIELD, f"{NODES}.palpate:response:depthKnots", lambda v: raised(v, 0, 1e-9)),
        (
            "palpate:ZeroAtContact",
            FIELD,
            f"{NODES}.primvars:palpate:storedEnergy",
            lambda v: raised(v, 5, 1e-3),
        ),
        (
            "palpate:ZeroAtContact",
            FIELD,
            f"{NODES}.primvars:palpate:lateralGradient",
            lambda v: Vt.Vec3dArray(len(v), [Gf.Vec3d(1)]),
        ),
        ("palpate:ZeroAtContact", FIELD, f"{ENERGY}:coefficients", lambda v: raised(v, 24, 1.0)),
        ("palpate:ZeroAtContact", FIELD, f"{ENERGY}:coefficients", lambda v: raised(v, 25, 9e9)),
        ("palpate:ElementCounts", FIELD, f"{NODES}.primvars:palpate:storedEnergy", lambda v: v[:-1]),
        ("palpate:ElementCounts", FIELD, f"{NODES}.primvars:palpate:storedEnergy", ("elementSize", 7)),
        ("palpate:ElementCounts", FIELD, f"{NODES}.primvars:palpate:residual", ("interpolation", "uniform")),
        ("palpate:ElementCounts", FIELD, f"{NODES}.palpate:exactPoints", lambda v: v[:-1]),
        (
            "palpate:ElementCounts",
            FIELD,
            "/block/Response/FrictionCurves.palpate:depthCurves:curveCount",
            lambda v: 2,
        ),
        ("palpate:ElementCounts", "contact.usdc", f"{DISTANCE}:blockShape", lambda v: Gf.Vec3i(2, 2, 3)),
        ("palpate:Hashes", "contact.usdc", f"{DISTANCE}:coefficients", lambda v: raised(v, 3, 1e-7)),
        ("palpate:Hashes", "geometry.usdc", "/block/Tetrahedra/Support_0_bench.indices", lambda v: v[:-1]),
        ("palpate:Hashes", FIELD, "/block/Response.palpate:field:organHash", lambda v: "0" * 64),
        (
            "usdGeomValidators:SubsetFamilies",
            "geometry.usdc",
            "/block/Tetrahedra/Region_1_stiff_nodule.indices",
            lambda v: v[:-1],
        ),
        (
            "usdGeomValidators:SubsetFamilies",
            "geometry.usdc",
            "/block/Surface/Reach.indices",
            lambda v: Vt.IntArray([1000]),
        ),
    ],
)
def test_what_is_broken_is_found(asset, validator, file, attribute, change):
    edit(asset, file, attribute, change)
    assert any(f"({validator}." in error for error in asset_errors(asset)), asset_errors(asset)


@pytest.mark.parametrize("file", ["geometry.usdc", "contact.usdc", FIELD])
@pytest.mark.parametrize("key", ["metersPerUnit", "kilogramsPerUnit", "upAxis"])
def test_a_layer_without_units_is_found_even_below_a_good_one(asset, file, key):
    layer = Sdf.Layer.OpenAsAnonymous(str(asset.parent / file))
    layer.pseudoRoot.ClearInfo(key)
    layer.Export(str(asset.parent / file))
    assert any("(palpate:Units." in error and key in error for error in asset_errors(asset))


def test_a_stage_in_centimetres_may_reference_the_asset(asset):
    """Units are judged on the layers that carry the data, not on the stage around them."""
    register_validators()
    stage = Usd.Stage.CreateInMemory()
    stage.SetMetadata("metersPerUnit", 0.01)
    stage.SetMetadata("upAxis", "Y")
    prim = stage.DefinePrim("/organ", "Xform")
    prim.GetReferences().AddReference(str(asset))
    stage.SetDefaultPrim(prim)
    registry = UsdValidation.ValidationRegistry()
    ours = [registry.GetOrLoadValidatorByName(name) for name in VALIDATORS]
    assert not [e.GetErrorAsString() for e in UsdValidation.ValidationContext(ours).Validate(stage)]


def test_a_foreign_stage_is_none_of_our_business():
    register_validators()
    stage = Usd.Stage.CreateInMemory()
    stage.DefinePrim("/mesh", "Mesh")
    registry = UsdValidation.ValidationRegistry()
    ours = [registry.GetOrLoadValidatorByName(name) for name in VALIDATORS]
    assert not UsdValidation.ValidationContext(ours).Validate(stage)


def test_an_organ_whose_supports_show_no_triangle_is_valid_too(tmp_path, organ, make_field):
    supports = tuple(dataclasses.replace(s, triangle_indices=np.zeros(0, np.int32)) for s in organ.supports)
    path = write_asset(tmp_path, dataclasses.replace(organ, supports=supports), make_field())
    assert asset_errors(path) == []
    assert [len(s.triangle_indices) for s in read_organ(path).supports] == [0, 0]
