# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Curves per surface vertex, on request: what the field says there, in the tool's own file, validated as the rest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import synthetic_field
from pxr import Sdf, Usd, UsdGeom

from palpate.fields.field_error import FieldError
from palpate.fields.interpolation import evaluate
from palpate.fields.organ_geometry import OrganGeometry, Support
from palpate.fields.surface_response import surface_response
from palpate.fields.usd_read import read_field, read_surface_response
from palpate.fields.usd_validators import asset_errors
from palpate.fields.usd_write import add_tool, write_asset

SIDE = np.linspace(-8e-3, 12e-3, 11)
"""m; the surface's vertices along x and y."""


def flat_organ() -> OrganGeometry:
    """The top z = 0 of the half space that the synthetic field is pressed on, one tetrahedron below it."""
    n = len(SIDE)
    vertices = np.array([(x, y, 0.0) for x in SIDE for y in SIDE])
    a = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    triangles = np.concatenate([np.stack([a, a + n, a + n + 1], 1), np.stack([a, a + n + 1, a + 1], 1)])
    tets = np.array([[0.0, 0.0, 0.0], [0.0, 0.01, 0.0], [0.01, 0.0, 0.0], [0.0, 0.0, -0.01]])
    reach = np.flatnonzero(vertices[triangles][:, :, 1].max(axis=1) < 5e-3)
    below = Support("below", np.array([3], np.int32), np.array([0], np.int32))
    return OrganGeometry(
        "plane", vertices, triangles.astype(np.int32), tets, np.array([[0, 1, 2, 3]], np.int32),
        (below,), ("tissue",), np.zeros(1, np.int32), reach.astype(np.int32),
        {"model": "neo_hookean", "youngs_modulus": 7e3, "poissons_ratio": 0.49},
    )  # fmt: skip


@pytest.fixture(scope="module")
def field():
    made = synthetic_field.FIELDS["plane"]()
    knots = np.linspace(0.0, synthetic_field.DEPTH_MAX, 6)
    zero = np.zeros((1, 6))
    nodes = replace(
        made.nodes, depth_knots=knots, stored_energy=zero, normal_force=zero, lateral_gradient=np.zeros((1, 6, 3)),
        friction_stiffness=zero, friction_coefficient=zero,
    )  # fmt: skip
    return replace(made, nodes=nodes)


@pytest.fixture(scope="module")
def asset(field, tmp_path_factory):
    return write_asset(tmp_path_factory.mktemp("per_vertex"), flat_organ(), field, per_vertex=True)


def test_a_vertex_s_curves_are_the_field_s_at_its_depths(asset, field):
    organ, made = flat_organ(), read_surface_response(asset, "ball_5mm")
    in_reach = organ.vertices[:, 1] < 5e-3
    assert np.array_equal(made.reached, in_reach) and 0 < in_reach.sum() < len(in_reach)
    assert made.stored_energy.shape == (121, 6) and made.lateral_gradient.shape == (121, 6, 3)
    for k, depth in enumerate(field.nodes.depth_knots):
        q = organ.vertices[in_reach] + (0.0, 0.0, synthetic_field.RADIUS - depth)
        truth = evaluate(field, q)
        scale = 1e-6 * (1.0 if k else 0.0)  # float32; exactly 0 at first touch
        for found, right in (
            (made.stored_energy, truth.energy),
            (made.normal_force, truth.force[:, 2]),
            (made.lateral_gradient[..., 0], truth.gradient[:, 0]),
            (made.friction_stiffness, truth.friction_stiffness),
        ):
            np.testing.assert_allclose(
                found[in_reach, k], right, rtol=0, atol=scale * np.abs(right).max() + 1e-12
            )
    assert not made.normal_force[~in_reach].any() and not made.lateral_gradient[~in_reach].any()


def test_a_host_without_the_schema_reads_them_as_primvars_of_the_surface(asset):
    stage = Usd.Stage.Open(str(asset))
    surface = UsdGeom.PrimvarsAPI(stage.GetPrimAtPath("/plane/Surface"))
    force = surface.GetPrimvar("palpate:surface:normalForce")
    assert (force.GetElementSize(), force.GetInterpolation()) == (6, "vertex")
    assert len(force.Get()) == 6 * 121
    assert force.GetAttr().GetCustomDataByKey("unit") == "N"


def test_every_validator_passes_and_the_layer_alone_opens(asset):
    assert asset_errors(asset) == []
    layer = Usd.Stage.Open(str(asset.parent / "fields" / "ball_5mm.usdc"))
    surface = layer.GetPrimAtPath("/plane/Surface")
    assert surface.IsValid() and not surface.IsDefined()  # an over: a layer alone shows no surface


def test_they_belong_to_the_tool_that_asked_for_them(field, tmp_path):
    asset = write_asset(tmp_path, flat_organ(), field)
    geometry = (tmp_path / "geometry.usdc").read_bytes()
    with pytest.raises(FieldError, match="--per-vertex is right"):
        read_surface_response(asset, "ball_5mm")
    add_tool(tmp_path, replace(field, tool=replace(field.tool, name="other")), per_vertex=True)
    assert read_surface_response(asset, "other").reached.any()
    with pytest.raises(FieldError, match="--per-vertex is right"):
        read_surface_response(asset, "ball_5mm")
    assert (tmp_path / "geometry.usdc").read_bytes() == geometry
    assert read_field(asset, "other").tool.name == "other"


@pytest.mark.parametrize(
    ("name", "validator", "change"),
    [
        ("primvars:palpate:surface:normalForce", "ElementCounts", lambda v: v[:-1]),
        ("primvars:palpate:surface:reached", "ElementCounts", lambda v: v[:-1]),
        ("palpate:surfaceResponse:depthKnots", "KnotsRising", lambda v: [0.0, *list(v)[:-1]]),
        ("primvars:palpate:surface:storedEnergy", "ZeroAtContact", lambda v: [1.0] * len(v)),
    ],
)
def test_what_is_broken_is_refused_and_found(field, tmp_path, name, validator, change):
    asset = write_asset(tmp_path, flat_organ(), field, per_vertex=True)
    path = tmp_path / "fields" / "ball_5mm.usdc"
    layer = Sdf.Layer.OpenAsAnonymous(str(path))
    spec = layer.GetAttributeAtPath(f"/plane/Surface.{name}")
    spec.default = type(spec.default)(change(spec.default))
    layer.Export(str(path))
    assert any(f"(palpate:{validator}." in error for error in asset_errors(asset))
    if validator == "ElementCounts":
        with pytest.raises(FieldError, match=r"has \d+ values; \d+, 121 vertices x 6 knots, is right"):
            read_surface_response(asset, "ball_5mm")


def test_a_tool_without_a_sphere_s_offset_is_resampled_alike(field):
    """rho = 0: the reference point itself goes into the tissue."""
    low = synthetic_field.synthetic_field(band=(-6e-3, 3e-3))
    flat = replace(low, tool=replace(low.tool, offset=0.0), nodes=field.nodes)
    made = surface_response(flat_organ(), flat)
    assert made.reached.any() and (made.normal_force[made.reached][:, 1:] > 0).all()
