# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What was written comes back bit by bit, and what is broken is refused with one sentence."""

from __future__ import annotations

import dataclasses
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pxr import Gf, Sdf, Usd, UsdGeom, Vt

from palpate.fields.field_error import FieldError
from palpate.fields.usd_read import field_at, read_contact, read_field, read_organ, tools
from palpate.fields.usd_validators import asset_errors
from palpate.fields.usd_write import add_tool, write_asset


def assert_same(a, b, where: str = "") -> None:
    """Equal types, shapes, dtypes and bits, all the way down."""
    if dataclasses.is_dataclass(a):
        assert type(a) is type(b), where
        for item in dataclasses.fields(a):
            assert_same(getattr(a, item.name), getattr(b, item.name), f"{where}.{item.name}")
    elif isinstance(a, np.ndarray):
        assert a.shape == b.shape and a.dtype == b.dtype, (where, a.dtype, b.dtype, a.shape, b.shape)
        assert a.tobytes() == b.tobytes(), where
    elif isinstance(a, tuple | list):
        assert len(a) == len(b), where
        for i, (x, y) in enumerate(zip(a, b, strict=True)):
            assert_same(x, y, f"{where}[{i}]")
    else:
        assert a == b and type(a) is type(b), (where, a, b)


def test_a_field_comes_back_bit_by_bit(asset, make_field):
    assert tools(asset) == ["ball_2mm", "ball_5mm"]
    assert_same(make_field("ball_5mm"), read_field(asset, "ball_5mm"))
    assert_same(make_field("ball_2mm", seed=3, radius=0.002), read_field(asset.parent, "ball_2mm"))
    assert_same(make_field().geometry, read_contact(asset))


def test_an_organ_comes_back_bit_by_bit(asset, organ):
    assert_same(organ, read_organ(asset))


@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    seed=st.integers(0, 2**32 - 1),
    nodes=st.integers(1, 40),
    knots=st.integers(2, 30),
    exponent=st.integers(-290, 290),
)
def test_any_shape_and_any_magnitude_comes_back(
    tmp_path_factory, make_field, make_organ, seed, nodes, knots, exponent
):
    field = make_field("ball", seed, nodes, knots)
    scaled = dataclasses.replace(field.nodes, stored_energy=field.nodes.stored_energy * 10.0**exponent)
    field = dataclasses.replace(field, nodes=scaled)
    path = write_asset(tmp_path_factory.mktemp("asset"), make_organ(), field)
    assert_same(field, read_field(path, "ball"))


def test_rows_that_no_block_uses_come_back_too(tmp_path, organ, make_field):
    field = make_field()
    index = np.where(field.amplitudes.block_index == 1, np.int32(-1), field.amplitudes.block_index)
    field = dataclasses.replace(field, amplitudes=dataclasses.replace(field.amplitudes, block_index=index))
    path = write_asset(tmp_path, organ, field)
    assert_same(field, read_field(path, "ball_5mm"))
    assert asset_errors(path) == []


def test_a_negative_zero_comes_back_as_zero(tmp_path, organ, make_field):
    """Crate files keep no sign of zero in arrays of whole numbers; a stated limit, not a surprise."""
    field = make_field()
    friction = np.where(field.nodes.friction_coefficient < 0.5, -0.0, 1.0)
    field = dataclasses.replace(field, nodes=dataclasses.replace(field.nodes, friction_coefficient=friction))
    back = read_field(write_asset(tmp_path, organ, field), "ball_5mm").nodes.friction_coefficient
    assert np.array_equal(back, friction) and not np.signbit(back).any()


def test_values_that_repeat_are_indexed_and_come_back_bit_by_bit(tmp_path, organ, make_field):
    made = make_field()
    normal, depth = made.nodes.normal.copy(), np.full(7, 5e-3 / 3)
    normal[[1, 4]], depth[2] = normal[0], 1e-3
    nodes = dataclasses.replace(made.nodes, normal=normal, depth_reached=depth)
    path = write_asset(tmp_path, organ, dataclasses.replace(made, nodes=nodes))
    back = read_field(path, "ball_5mm").nodes
    assert back.normal.tobytes() == normal.tobytes() and back.depth_reached.tobytes() == depth.tobytes()
    assert back.press_hash.tolist() == made.nodes.press_hash.tolist()
    stage = Usd.Stage.Open(str(path))
    points = UsdGeom.PrimvarsAPI(stage.GetPrimAtPath("/block/Response/Nodes"))
    stored = points.GetPrimvar("palpate:depthReached")
    assert len(stored.Get()) == 2 and np.array_equal(np.array(stored.ComputeFlattened()), depth)
    assert not points.GetPrimvar("palpate:normalForce").IsIndexed()  # one element a node, elementSize > 1
    del stage, points, stored  # so that the changed file is read
    edit(
        tmp_path / "fields" / "ball_5mm.usdc",
        "/block/Response/Nodes.primvars:palpate:depthReached:indices",
        lambda v: Vt.IntArray([2] * len(v)),
    )
    with pytest.raises(FieldError, match=r"depthReached:indices span 2\.\.2; 0\.\.1 is right"):
        read_field(path, "ball_5mm")


def test_every_array_is_readable_without_the_schema(asset):
    """A host that knows nothing of palpate sees the same bits, by USD's own means."""
    program = f"""
import sys
import numpy as np
from pxr import Usd, UsdGeom
from palpate.fields.usd_read import read_field
field = read_field({str(asset)!r}, "ball_5mm")
assert not Usd.SchemaRegistry().FindAppliedAPIPrimDefinition("PalpateResponseAPI")
stage = Usd.Stage.Open({str(asset)!r})
nodes = stage.GetPrimAtPath("/block/Response/Nodes")
assert "PalpateResponseAPI" in nodes.GetPrimTypeInfo().GetAppliedAPISchemas()
primvar = UsdGeom.PrimvarsAPI(nodes).GetPrimvar("palpate:lateralGradient")
assert primvar.GetElementSize() == len(field.nodes.depth_knots) and primvar.GetInterpolation() == "vertex"
flat = np.array(primvar.ComputeFlattened())
assert flat.tobytes() == field.nodes.lateral_gradient.tobytes()
knots = nodes.GetAttribute("palpate:response:depthKnots")
assert not knots.IsCustom() and knots.GetCustomDataByKey("unit") == "m"
print("read", flat.shape)
"""
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    assert run.stdout.split() == ["read", "(35,", "3)"]


def test_two_tools_are_two_references_in_a_stage_of_other_units(asset, make_field):
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    UsdGeom.SetStageUpAxis(stage, "Y")
    for hand, tool in (("left", "ball_2mm"), ("right", "ball_5mm")):
        prim = stage.DefinePrim(f"/{hand}")
        prim.GetReferences().AddReference(str(asset))
        prim.GetVariantSet("tool").SetVariantSelection(tool)
        UsdGeom.XformCommonAPI(prim).SetScale(Gf.Vec3f(100))
    assert_same(make_field("ball_5mm"), field_at(stage.GetPrimAtPath("/right")))
    assert field_at(stage.GetPrimAtPath("/left")).tool.name == "ball_2mm"


def edit(path: Path, prim_attribute: str, change) -> None:
    """Rewrite one attribute's value in the layer at `path`."""
    layer = Sdf.Layer.OpenAsAnonymous(str(path))
    spec = layer.GetAttributeAtPath(prim_attribute)
    spec.default = change(spec.default)
    layer.Export(str(path))


FIELD, NODES = "fields/ball_5mm.usdc", "/block/Response/Nodes"
AMPLITUDES = "/block/Response/Amplitudes.palpate:lattice"
ENERGY = "/block/Response/EnergyCurves.palpate:depthCurves"
DISTANCE = "/block/Contact/SignedDistance.palpate:lattice"


@pytest.mark.parametrize(
    ("file", "attribute", "change", "sentence"),
    [
        (
            FIELD,
            f"{NODES}.primvars:palpate:storedEnergy",
            lambda v: v[:-1],
            "storedEnergy has 34 .* 35, 7 nodes x 5 knots",
        ),
        (FIELD, f"{NODES}.primvars:palpate:lateralGradient", lambda v: v[:5], "lateralGradient has 5 .* 35"),
        (FIELD, f"{NODES}.primvars:palpate:pressed", lambda v: v[:3], "pressed has 3 .* 7"),
        (
            FIELD,
            f"{NODES}.palpate:response:depthKnots",
            lambda v: Vt.DoubleArray([0, 2, 1, 3, 4]),
            "depth_knots .* rising from 0",
        ),
        (
            FIELD,
            f"{AMPLITUDES}:coefficients",
            lambda v: v[:-2],
            "coefficients has 766 values; 768, 2 blocks x 64 x 6 channels",
        ),
        (FIELD, f"{ENERGY}:curveCount", lambda v: 4, "coefficients has 72 values; 96"),
        (
            FIELD,
            "/block/Response.palpate:field:contactHash",
            lambda v: "0" * 64,
            "made for contact_hash 0+, the asset has",
        ),
        (FIELD, f"{NODES}.points", lambda v: Vt.Vec3fArray(len(v)), "points and palpate:exactPoints differ"),
        (
            FIELD,
            f"{NODES}.primvars:palpate:normalForce",
            lambda v: Vt.DoubleArray([float("nan")] * len(v)),
            "normal_force is nan",
        ),
        (
            "contact.usdc",
            f"{DISTANCE}:blockIndex",
            lambda v: v[:-1],
            "blockIndex has 7 values; 8, 2 x 2 x 2 blocks",
        ),
        (
            "contact.usdc",
            "/block/Contact.palpate:contact:band",
            lambda v: Gf.Vec2d(1, 0),
            "band is .* smallest before largest",
        ),
    ],
)
def test_a_broken_field_is_refused(asset, file, attribute, change, sentence):
    edit(asset.parent / file, attribute, change)
    with pytest.raises(FieldError, match=sentence) as error:
        read_field(asset, "ball_5mm")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("attribute", "change", "sentence"),
    [
        ("/block/Surface.palpate:exactPoints", lambda v: v[:-1], "exactPoints has 11 points; 12"),
        (
            "/block/Tetrahedra/Region_1_stiff_nodule.indices",
            lambda v: v[:-1],
            "regions do not cover each tet once",
        ),
        ("/block/Surface/Reach.indices", lambda v: Vt.IntArray([99]), "reach_triangles spans 99..99"),
        ("/block/Surface/Reach.palpate:subset:role", lambda v: "else", "0 reach subsets"),
        (
            "/block/Tetrahedra.tetVertexIndices",
            lambda v: Vt.Vec4iArray([(t[0], t[2], t[1], t[3]) for t in v]),
            "has volume -",
        ),
        ("/block/Surface.faceVertexCounts", lambda v: Vt.IntArray([4] * 15), "no triangles"),
    ],
)
def test_a_broken_organ_is_refused(asset, attribute, change, sentence):
    edit(asset.parent / "geometry.usdc", attribute, change)
    with pytest.raises(FieldError, match=sentence):
        read_organ(asset)


@pytest.mark.parametrize("file", ["block.usda", "geometry.usdc", "contact.usdc", "fields/ball_5mm.usdc"])
@pytest.mark.parametrize("key", ["metersPerUnit", "kilogramsPerUnit", "upAxis"])
def test_a_layer_without_units_is_refused(asset, file, key):
    path = asset.parent / file
    layer = Sdf.Layer.OpenAsAnonymous(str(path))
    layer.pseudoRoot.ClearInfo(key)
    layer.Export(str(path))
    with pytest.raises(FieldError, match=rf"{file}: {key} is missing; .* is right"):
        read_field(asset, "ball_5mm")


def test_a_missing_tool_is_named_with_those_there_are(asset):
    with pytest.raises(
        FieldError, match=re.escape("has no tool 'scalpel'; one of ['ball_2mm', 'ball_5mm'] is right")
    ):
        read_field(asset, "scalpel")


def test_a_missing_attribute_is_named_with_what_it_means(asset):
    path = asset.parent / "fields/ball_5mm.usdc"
    layer = Sdf.Layer.OpenAsAnonymous(str(path))
    nodes = layer.GetPrimAtPath(NODES)
    nodes.RemoveProperty(nodes.properties["primvars:palpate:residual"])
    layer.Export(str(path))
    with pytest.raises(FieldError, match="has no primvars:palpate:residual; a double"):
        read_field(asset, "ball_5mm")


def test_missing_files_and_foreign_files_are_refused(asset, tmp_path):
    with pytest.raises(FieldError, match="does not exist"):
        read_field(tmp_path / "nothing.usda", "ball_5mm")
    with pytest.raises(FieldError, match=r"holds no .usda file"):
        tools(asset.parent / "fields")
    foreign = tmp_path / "foreign.usda"
    foreign.write_text('#usda 1.0\n(\n defaultPrim = "a"\n metersPerUnit = 1\n)\ndef Xform "a" {}\n')
    with pytest.raises(FieldError, match="has no tool"):
        read_field(foreign, "ball_5mm")
    foreign.write_text("not usd at all")
    with pytest.raises(FieldError, match="no readable USD layer"):
        tools(foreign)
    (asset.parent / "contact.usdc").unlink()
    with pytest.raises(FieldError, match="does not compose"):
        read_field(asset, "ball_5mm")
    (asset.parent / "fields/ball_5mm.usdc").write_bytes(b"PXR-USDC" + bytes(80))
    with pytest.raises(FieldError):
        read_field(asset, "ball_5mm")


def test_a_tool_with_a_geometry_of_its_own_comes_back_exactly(asset, make_field):
    field = make_field("wedge", seed=5)
    rng = np.random.default_rng(2)
    tool = dataclasses.replace(
        field.tool,
        shape="mesh",
        parameters={},
        axis=(0.6, 0.0, 0.8),
        tip=(1e-3, -2e-3, 3e-4),
        tilt=0.3,
        vertices=rng.normal(size=(4, 3)) * 1e-2,
        triangles=np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], np.int32),
    )
    add_tool(asset.parent, dataclasses.replace(field, tool=tool))
    read = read_field(asset, "wedge").tool
    assert read == tool
    assert np.array_equal(read.vertices, tool.vertices)
    assert np.array_equal(read.triangles, tool.triangles)


def test_a_previewed_tool_stands_on_the_first_node_along_its_normal(asset, make_field):
    field = make_field("rod", seed=6)
    vertices = np.array([[0.0, 0.0, 0.0], [1e-3, 0.0, 5e-2], [0.0, 1e-3, 5e-2], [-1e-3, 0.0, 5e-2]])
    triangles = np.array([[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]], np.int32)
    tool = dataclasses.replace(field.tool, shape="cone", offset=0.0, vertices=vertices, triangles=triangles)
    add_tool(asset.parent, dataclasses.replace(field, tool=tool))
    stage = Usd.Stage.Open(str(asset))
    root = stage.GetDefaultPrim()
    root.GetVariantSet("tool").SetVariantSelection("rod")
    prim = root.GetPrimAtPath("Response/Tool")
    world = UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(0.0)
    tip = np.array(world.Transform(Gf.Vec3d(0, 0, 0)))
    above = np.array(world.Transform(Gf.Vec3d(0, 0, 1)))
    assert tip == pytest.approx(field.nodes.position[0])
    assert above - tip == pytest.approx(field.nodes.normal[0])
