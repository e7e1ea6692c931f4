# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""An asset is one folder: units on every layer, relative paths, whole files, one file for each tool."""

from __future__ import annotations

import dataclasses
import hashlib
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, UsdShade, UsdUtils

from palpate.fields.field_error import FieldError
from palpate.fields.organ_geometry import organ_hash
from palpate.fields.usd_read import read_field, read_organ, tools
from palpate.fields.usd_validators import asset_errors
from palpate.fields.usd_write import add_tool, write_asset

FILES = ("block.usda", "contact.usdc", "fields/ball_2mm.usdc", "fields/ball_5mm.usdc", "geometry.usdc")


def digests(folder: Path) -> dict[str, str]:
    files = sorted(p for p in folder.rglob("*") if p.is_file())
    return {str(p.relative_to(folder)): hashlib.sha256(p.read_bytes()).hexdigest() for p in files}


def test_an_asset_is_these_files_and_no_more(asset):
    assert tuple(sorted(digests(asset.parent))) == FILES


@pytest.mark.parametrize("file", FILES)
def test_every_layer_has_units_a_default_prim_and_opens_alone(asset, file):
    stage = Usd.Stage.Open(str(asset.parent / file), Usd.Stage.LoadNone)
    assert UsdGeom.StageHasAuthoredMetersPerUnit(stage) and UsdGeom.GetStageMetersPerUnit(stage) == 1
    assert stage.GetMetadata("kilogramsPerUnit") == 1 and stage.HasAuthoredMetadata("kilogramsPerUnit")
    assert UsdGeom.GetStageUpAxis(stage) == "Z" and stage.HasAuthoredMetadata("upAxis")
    assert stage.GetDefaultPrim().GetPath() == "/block"


def test_the_folder_may_be_moved(asset, make_field, tmp_path):
    for layer in asset.parent.rglob("*.usd?"):
        found = UsdUtils.ExtractExternalReferences(str(layer))
        assert all(path.startswith("./") for paths in found for path in paths), layer
    asset.parent.rename(tmp_path / "elsewhere")
    back = read_field(tmp_path / "elsewhere" / "block.usda", "ball_5mm")
    assert np.array_equal(back.nodes.stored_energy, make_field().nodes.stored_energy)
    assert str(tmp_path).encode() not in b"".join(
        p.read_bytes() for p in (tmp_path / "elsewhere").rglob("*.usd?")
    )


def test_a_tool_added_or_replaced_touches_no_other_file(asset, make_field):
    folder = asset.parent
    before = digests(folder)
    stamps = {file: os.stat(folder / file) for file in FILES}
    add_tool(folder, make_field("ball_2mm", seed=9, radius=0.002))
    after = digests(folder)
    assert {file for file in FILES if before[file] != after[file]} == {"fields/ball_2mm.usdc"}
    add_tool(folder, make_field("cone", seed=4))
    assert {file for file in FILES if after[file] != digests(folder)[file]} == {"block.usda"}
    for file in ("contact.usdc", "geometry.usdc", "fields/ball_5mm.usdc"):
        now = os.stat(folder / file)
        assert (now.st_mtime_ns, now.st_ino) == (stamps[file].st_mtime_ns, stamps[file].st_ino)
    assert tools(folder) == ["ball_2mm", "ball_5mm", "cone"]


def test_what_people_add_to_the_interface_survives_a_new_tool(asset, make_field):
    layer = Sdf.Layer.OpenAsAnonymous(str(asset))
    layer.GetPrimAtPath("/block").SetInfo("documentation", "by hand")
    layer.Export(str(asset))
    add_tool(asset.parent, make_field("cone"))
    assert Sdf.Layer.OpenAsAnonymous(str(asset)).GetPrimAtPath("/block").documentation == "by hand"


def test_an_open_stage_sees_the_new_tool(asset, make_field):
    stage = Usd.Stage.Open(str(asset))
    add_tool(asset.parent, make_field("ball_5mm", seed=11))
    stored = stage.GetPrimAtPath("/block/Response/Nodes").GetAttribute("primvars:palpate:residual").Get()
    assert np.array_equal(stored, make_field("ball_5mm", seed=11).nodes.residual)


WRITE = """
import sys
sys.path.insert(0, {tests!r})
from conftest import box_organ, random_field
if {register}:
    from palpate.fields.usd_schema import register
    register()
from palpate.fields.usd_write import add_tool, write_asset
for tool in {tools}:
    write_asset({folder!r}, box_organ(), random_field(tool, seed=len(tool)))
"""


def test_the_same_arrays_give_the_same_bytes(tmp_path):
    """In any process, with any hash seed, registered or not; the tools' order decides the default alone."""
    found = []
    for i, register in enumerate((False, True, False)):
        folder = str(tmp_path / str(i))
        order = ["ball", "large_ball"][:: -1 if i == 2 else 1]
        program = WRITE.format(
            tests=str(Path(__file__).parent), register=register, folder=folder, tools=order
        )
        environment = {**os.environ, "PYTHONHASHSEED": str(i + 1)}
        subprocess.run([sys.executable, "-c", program], check=True, env=environment)
        found.append(digests(Path(folder)))
    assert found[0] == found[1]
    assert {k for k in found[0] if found[0][k] != found[2][k]} == {"block.usda"}


def test_a_write_that_fails_leaves_the_old_asset_whole(asset, make_field, monkeypatch):
    before = digests(asset.parent)

    def no_space(*paths):
        raise OSError("no space left")

    monkeypatch.setattr(os, "replace", no_space)
    with pytest.raises(OSError, match="no space left"):
        add_tool(asset.parent, make_field("ball_5mm", seed=8))
    assert digests(asset.parent) == before


def test_a_folder_that_cannot_be_written_is_an_os_error(tmp_path, organ, make_field):
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError):
        write_asset(tmp_path / "file" / "asset", organ, make_field())


def test_the_same_organ_again_keeps_the_other_tools(asset, organ, make_field):
    write_asset(asset.parent, organ, make_field("cone"))
    assert tools(asset) == ["ball_2mm", "ball_5mm", "cone"]


def test_another_organ_is_refused_unless_it_may_replace(asset, organ, make_field):
    before = digests(asset.parent)
    moved = dataclasses.replace(organ, vertices=organ.vertices + 1e-12)
    with pytest.raises(FieldError, match="holds another organ or contact geometry"):
        write_asset(asset.parent, moved, make_field("cone"))
    assert digests(asset.parent) == before
    write_asset(asset.parent, moved, make_field("cone"), replace=True)
    assert sorted(digests(asset.parent)) == [
        "block.usda",
        "contact.usdc",
        "fields/cone.usdc",
        "geometry.usdc",
    ]
    assert tools(asset) == ["cone"]


def test_tools_share_one_contact_geometry(asset, make_field):
    field = make_field("cone")
    other = dataclasses.replace(field.geometry, band=field.geometry.band + 1e-9)
    with pytest.raises(FieldError, match=r"another contact geometry .* fit this field on read_contact"):
        add_tool(asset.parent, dataclasses.replace(field, geometry=other))
    assert tools(asset) == ["ball_2mm", "ball_5mm"]


@pytest.mark.parametrize(
    ("member", "change", "sentence"),
    [
        ("stored_energy", lambda a: a[:, :-1], r"stored_energy has shape \(7, 4\); \(7, 5\) is right"),
        ("stored_energy", lambda a: a + 1, "stored_energy.* at depth 0; 0 is right"),
        ("depth_knots", lambda a: a[::-1], "rising from 0 is right"),
        ("normal", lambda a: a * 2, r"normal\[0\] has length 2; 1 is right"),
        ("residual", lambda a: a * np.inf, "residual is inf .* finite"),
    ],
)
def test_a_field_that_breaks_its_contract_is_not_written(
    tmp_path, organ, make_field, member, change, sentence
):
    field = make_field()
    nodes = dataclasses.replace(field.nodes, **{member: change(getattr(field.nodes, member))})
    with pytest.raises(FieldError, match=sentence):
        write_asset(tmp_path / "asset", organ, dataclasses.replace(field, nodes=nodes))
    assert not (tmp_path / "asset").exists()


def test_energy_curves_start_flat(tmp_path, organ, make_field):
    field = make_field()
    curves = dataclasses.replace(field.energy_curves, coefficients=field.energy_curves.coefficients + 1e-3)
    with pytest.raises(FieldError, match=r"value 0.001 J and slope 0.001 N at depth 0; 0 and 0 are right"):
        write_asset(tmp_path, organ, dataclasses.replace(field, energy_curves=curves))


@pytest.mark.parametrize("value", [{"a": np.arange(2)}, {"a": float("nan")}, {1: "a"}, {"a": (1, 2)}])
def test_provenance_has_to_be_json(tmp_path, organ, make_field, value):
    with pytest.raises(FieldError, match=r"field 'ball_5mm': provenance .* right"):
        write_asset(tmp_path, organ, dataclasses.replace(make_field(), provenance=value))


@pytest.mark.parametrize("name", ["", "../ball", "ball 5", "ball.5", "-x"])
def test_a_name_that_cannot_name_a_file_is_refused(tmp_path, organ, make_organ, make_field, name):
    with pytest.raises(FieldError, match="letters, digits"):
        write_asset(tmp_path, organ, make_field(name))
    with pytest.raises(FieldError, match="letters, digits"):
        write_asset(tmp_path, make_organ(name), make_field())


def test_any_viewer_sees_colours_normals_and_extents(asset):
    stage = Usd.Stage.Open(str(asset))
    surface = UsdGeom.Mesh.Get(stage, "/block/Surface")
    points, normals = np.array(surface.GetPointsAttr().Get()), np.array(surface.GetNormalsAttr().Get())
    assert surface.GetNormalsInterpolation() == "vertex" and len(normals) == len(points)
    assert np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-6)
    assert ((normals * (points - points.mean(axis=0))).sum(axis=1) > 0).all()
    for prim in stage.TraverseAll():
        if prim.IsA(UsdGeom.Gprim):
            colour = UsdGeom.Gprim(prim).GetDisplayColorPrimvar()
            assert colour.HasAuthoredValue(), prim
            bound = UsdGeom.Boundable(prim)
            authored = np.array(bound.GetExtentAttr().Get())
            computed = np.array(UsdGeom.Boundable.ComputeExtentFromPlugins(bound, Usd.TimeCode.Default()))
            assert np.allclose(authored, computed, atol=1e-7), prim
    cells = UsdGeom.TetMesh.Get(stage, "/block/Tetrahedra")
    faces = np.array(UsdGeom.TetMesh.ComputeSurfaceFaces(cells, Usd.TimeCode.Default()))
    stored = np.array(cells.GetSurfaceFaceVertexIndicesAttr().Get())

    def turned(triangles):
        return sorted(tuple(np.roll(t, -int(np.argmin(t)))) for t in triangles)

    assert turned(faces) == turned(stored)


def test_simulators_see_a_deformable(asset):
    """The tokens of OpenUSD-proposals 111, and the stiffness: E = 2 (1 + nu) mu = 2 * 1.49 * 1800 Pa."""
    stage = Usd.Stage.Open(str(asset))

    def apis(prim):
        return set(prim.GetPrimTypeInfo().GetAppliedAPISchemas())

    root, cells = stage.GetDefaultPrim(), stage.GetPrimAtPath("/block/Tetrahedra")
    assert {"PhysicsBodyAPI", "PhysicsDeformableBodyAPI"} <= apis(root)
    assert root.GetAttribute("physics:bodyEnabled").Get() is True
    assert "PhysicsVolumeDeformableSimAPI" in apis(cells)
    material, _ = UsdShade.MaterialBindingAPI(cells).ComputeBoundMaterial("physics")
    assert {"PhysicsMaterialAPI", "PhysicsVolumeDeformableMaterialAPI"} <= apis(material.GetPrim())
    assert material.GetPrim().GetAttribute("physics:youngsModulus").Get() == pytest.approx(2 * 1.49 * 1800)
    assert material.GetPrim().GetAttribute("physics:density").Get() == 1060
    nodule = stage.GetPrimAtPath("/block/Tetrahedra/Region_1_stiff_nodule")
    material, _ = UsdShade.MaterialBindingAPI(nodule).ComputeBoundMaterial("physics")
    assert material.GetPrim().GetAttribute("physics:youngsModulus").Get() == 4e4


def test_an_organ_of_unknown_stiffness_claims_no_simulation(tmp_path, organ, make_field):
    path = write_asset(tmp_path, dataclasses.replace(organ, material={"model": "unknown"}), make_field())
    stage = Usd.Stage.Open(str(path))
    applied = stage.GetDefaultPrim().GetPrimTypeInfo().GetAppliedAPISchemas()
    assert "PhysicsDeformableBodyAPI" not in applied


def test_importing_the_room_imports_no_usd():
    program = (
        "import sys, palpate.fields.organ_geometry, palpate.fields.field_check, palpate.fields.usd_schema"
    )
    program += "; palpate.fields.usd_schema.schema_path(); assert 'pxr' not in sys.modules"
    subprocess.run([sys.executable, "-c", program], check=True)


def test_what_a_killed_writer_leaves_behind_is_ignored(asset, make_field):
    (asset.parent / ".block.77.part.usda").write_text("#usda 1.0\n")
    (asset.parent / "fields/.ball_5mm.77.part.usdc").write_bytes(b"PXR-USDC")
    add_tool(asset.parent, make_field("cone"))
    assert tools(asset.parent) == ["ball_2mm", "ball_5mm", "cone"]


def test_zeros_of_either_sign_hash_alike(tmp_path, organ, make_field):
    """USD keeps one zero, so that what is read back has to hash as what was written."""
    whole = np.round(organ.vertices * 50) * np.array([-1.0, -1.0, 1.0])
    whole = dataclasses.replace(organ, vertices=whole, tet_points=organ.tet_points - organ.tet_points[0])
    assert np.signbit(whole.vertices[whole.vertices == 0]).any()
    path = write_asset(tmp_path, whole, make_field())
    assert organ_hash(read_organ(path)) == organ_hash(whole) and asset_errors(path) == []


def test_the_interface_is_short_enough_to_read(asset):
    text = asset.read_text()
    assert len(text.splitlines()) < 50 and "./fields/ball_2mm.usdc" in text


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"region_materials": {"bone": {}}}, "region_materials names 'bone'; one of"),
        ({"region_materials": {"tissue": {"mu": np.ones(2)}}}, "region 'tissue': material is not JSON-clean"),
        ({"region_names": ("tissue", "tissue")}, "unique, non-empty names are right"),
        ({"region_label": np.zeros(3, np.int32)}, r"region_label has shape \(3,\); \(10,\) is right"),
        ({"reach_triangles": np.array([0.5])}, "reach_triangles is float64; int32 is right"),
        ({"vertices": np.full((12, 3), np.nan)}, r"vertices\[0\] is not finite"),
    ],
)
def test_an_organ_that_breaks_its_contract_is_not_written(tmp_path, organ, make_field, change, sentence):
    with pytest.raises(FieldError, match=sentence):
        write_asset(tmp_path / "asset", dataclasses.replace(organ, **change), make_field())
    assert not (tmp_path / "asset").exists()
