# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The organ in USD: surface Mesh and TetMesh as siblings, supports, regions and reach as subsets, materials.

/<organ>                 PalpateOrganAPI, deformable-body tokens
    Surface              Mesh; subsets: reach, faces of each support
    Tetrahedra           TetMesh (purpose guide); subsets: regions (partition), points of each support
    Materials/...        what the deformable-body tokens can say of each material
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdGeom

from palpate.fields import usd_deformable
from palpate.fields.field_error import FieldError
from palpate.fields.foot_points import vertex_normals
from palpate.fields.organ_geometry import OrganGeometry, Support, check_organ, organ_hash
from palpate.fields.usd_layer import (
    apply_apis,
    author,
    author_schema,
    author_some,
    child,
    json_text,
    new_layer,
    prim_name,
    read_attribute,
    schema_values,
)
from palpate.fields.usd_schema.attributes import APIS

__all__ = ["exact_points", "organ_from_prim", "organ_layer", "point_attributes"]

TISSUE, REACHABLE, HELD = (0.72, 0.38, 0.33), (0.86, 0.53, 0.45), (0.45, 0.50, 0.58)
"""Preview colours, linear RGB: organ, where a tool can touch, where the organ is held."""


def organ_layer(organ: OrganGeometry) -> Sdf.Layer:
    """The geometry layer of an asset.  Raises FieldError where `organ` breaks its contract."""
    check_organ(organ)
    layer, root = new_layer(prim_name(organ.name), comment=f"{organ.name}: geometry, supports, regions")
    for name, material in organ.region_materials.items():
        json_text(material, f"region {name!r}: material")
    values = {
        "name": organ.name,
        "material": json_text(organ.material, f"organ {organ.name}: material"),
        "provenance": json_text(organ.provenance, f"organ {organ.name}: provenance"),
        "hash": organ_hash(organ),
    }
    author_schema(root, "PalpateOrganAPI", values)
    _surface(root, organ)
    tetrahedra = _tetrahedra(root, organ)
    _deformable(root, tetrahedra, organ)
    return layer


def organ_from_prim(root: Usd.Prim) -> OrganGeometry:
    """The organ on an asset's root prim.  Raises FieldError where something is missing or broken."""
    values = schema_values(root, "PalpateOrganAPI")
    surface, tetrahedra = (root.GetChild(name) for name in ("Surface", "Tetrahedra"))
    for name, prim, kind in (("Surface", surface, UsdGeom.Mesh), ("Tetrahedra", tetrahedra, UsdGeom.TetMesh)):
        if not prim or not prim.IsA(kind):
            raise FieldError(f"{root.GetPath()} has no {kind.__name__} {name}; one below an organ is right")
    mesh = UsdGeom.Mesh(surface)
    if set(mesh.GetFaceVertexCountsAttr().Get()) - {3}:
        raise FieldError(f"{surface.GetPath()} has faces that are no triangles; three corners each are right")
    faces, cells = _subsets(surface), _subsets(tetrahedra)
    regions = sorted((s for s in cells if s["role"] == "region"), key=lambda s: s["label"])
    tet_indices = np.array(UsdGeom.TetMesh(tetrahedra).GetTetVertexIndicesAttr().Get()).reshape(-1, 4)
    label = np.full(len(tet_indices), -1, np.int32)
    tets = np.concatenate([region["indices"] for region in regions]) if regions else np.zeros(0, np.int32)
    if not np.array_equal(np.sort(tets), np.arange(len(tet_indices))):
        raise FieldError(f"{tetrahedra.GetPath()}: regions do not cover each tet once; a partition is right")
    for region in regions:
        label[region["indices"]] = region["label"]
    held = {s["label"]: s["indices"] for s in faces if s["role"] == "support"}
    reach = [s["indices"] for s in faces if s["role"] == "reach"]
    cell_labels = {s["label"] for s in cells if s["role"] == "support"}
    if len(reach) != 1 or held.keys() != cell_labels:
        raise FieldError(
            f"{surface.GetPath()} has {len(reach)} reach subsets and faces of supports {sorted(held)}; "
            f"one reach and supports {sorted(cell_labels)} are right"
        )
    supports = tuple(
        Support(s["name"], s["indices"], held[s["label"]], s["kind"], s["stiffness"])
        for s in sorted((s for s in cells if s["role"] == "support"), key=lambda s: s["label"])
    )
    organ = OrganGeometry(
        name=values["name"],
        vertices=exact_points(surface),
        triangles=np.array(mesh.GetFaceVertexIndicesAttr().Get(), np.int32).reshape(-1, 3),
        tet_points=exact_points(tetrahedra),
        tet_indices=tet_indices,
        supports=supports,
        region_names=tuple(region["name"] for region in regions),
        region_label=label,
        reach_triangles=reach[0],
        material=json.loads(values["material"]),
        region_materials={r["name"]: json.loads(r["material"]) for r in regions if r["material"]},
        provenance=json.loads(values["provenance"]),
        paint=_paint(surface),
    )
    check_organ(organ)
    return organ


def _paint(surface: Usd.Prim) -> dict[str, np.ndarray]:
    if "PalpatePaintAPI" not in surface.GetPrimTypeInfo().GetAppliedAPISchemas():
        return {}
    rows = APIS["PalpatePaintAPI"].attributes
    return {
        kind: read_attribute(surface, row)
        for kind, row in rows.items()
        if surface.HasAttribute(row.name) and surface.GetAttribute(row.name).HasAuthoredValue()
    }


def point_attributes(prim: Sdf.PrimSpec, points: np.ndarray, width: float = 0.0) -> None:
    """Author points (N, 3) m twice, in float for viewers and exactly, with the extent that encloses them."""
    rounded = np.asarray(points, np.float32)
    author(prim, "points", "point3f[]", rounded)
    author_schema(prim, "PalpateExactPointsAPI", {"points": points})
    half = np.float32(width / 2)
    extent = [rounded.min(axis=0) - half, rounded.max(axis=0) + half]
    author(prim, "extent", "float3[]", extent)


def exact_points(prim: Usd.Prim) -> np.ndarray:
    """(N, 3) m; raises FieldError where `points` was edited and the exact points were not."""
    exact = schema_values(prim, "PalpateExactPointsAPI")["points"].reshape(-1, 3)
    rounded = np.array(UsdGeom.PointBased(prim).GetPointsAttr().Get()).reshape(-1, 3)
    if len(exact) != len(rounded):
        raise FieldError(
            f"{prim.GetPath()}: palpate:exactPoints has {len(exact)} points; "
            f"{len(rounded)}, as in points, is right"
        )
    if not np.array_equal(exact.astype(np.float32), rounded):
        raise FieldError(
            f"{prim.GetPath()}: points and palpate:exactPoints differ; "
            "points moved by hand are not what the field was pressed on, author the organ again"
        )
    return exact


def _surface(root: Sdf.PrimSpec, organ: OrganGeometry) -> None:
    prim = child(root, "Surface", "Mesh")
    point_attributes(prim, organ.vertices)
    author(prim, "faceVertexCounts", "int[]", np.full(len(organ.triangles), 3))
    author(prim, "faceVertexIndices", "int[]", organ.triangles.reshape(-1))
    author(prim, "subdivisionScheme", "token", "none", uniform=True)
    author(prim, "orientation", "token", "rightHanded", uniform=True)
    normals = vertex_normals(organ.vertices, organ.triangles)
    author(prim, "normals", "normal3f[]", normals, interpolation="vertex")
    colour = np.zeros(len(organ.triangles), int)
    colour[organ.reach_triangles] = 1
    for support in organ.supports:
        colour[support.triangle_indices] = 2
    if organ.paint:
        author_some(prim, "PalpatePaintAPI", organ.paint)
    shades = (TISSUE, REACHABLE, HELD)
    author(prim, "primvars:displayColor", "color3f[]", shades, interpolation="uniform")
    author(prim, "primvars:displayColor:indices", "int[]", colour)
    _subset(prim, "Reach", "face", "palpateReach", organ.reach_triangles, role="reach")
    for i, support in enumerate(organ.supports):
        _support_subset(prim, i, support, "face", support.triangle_indices)
    _family(prim, "palpateReach", "unrestricted")
    if any(len(support.triangle_indices) for support in organ.supports):
        _family(prim, "palpateSupport", "unrestricted")


def _tetrahedra(root: Sdf.PrimSpec, organ: OrganGeometry) -> Sdf.PrimSpec:
    prim = child(root, "Tetrahedra", "TetMesh")
    point_attributes(prim, organ.tet_points)
    author(prim, "tetVertexIndices", "int4[]", organ.tet_indices)
    author(prim, "orientation", "token", "rightHanded", uniform=True)
    author(prim, "surfaceFaceVertexIndices", "int3[]", _surface_faces(organ))
    author(prim, "purpose", "token", "guide", uniform=True)
    author(prim, "primvars:displayColor", "color3f[]", [TISSUE], interpolation="constant")
    for i, name in enumerate(organ.region_names):
        material = organ.region_materials.get(name)
        text = "" if material is None else json_text(material, name)
        tets = np.nonzero(np.asarray(organ.region_label) == i)[0]
        subset = _subset(
            prim,
            f"Region_{i}_{prim_name(name)}",
            "tetrahedron",
            "materialBind",
            tets,
            role="region",
            name=name,
            label=i,
            material=text,
        )
        _bind(subset, root, i)
    _family(prim, "materialBind", "partition")
    for i, support in enumerate(organ.supports):
        _support_subset(prim, i, support, "point", support.tet_point_indices)
    _family(prim, "palpateSupport", "unrestricted")
    return prim


def _deformable(root: Sdf.PrimSpec, tetrahedra: Sdf.PrimSpec, organ: OrganGeometry) -> None:
    materials = child(root, "Materials", "Scope")
    for i, name in enumerate(organ.region_names):
        prim = child(materials, f"Region_{i}", "Material")
        attributes = usd_deformable.material_attributes(organ.region_materials.get(name, organ.material))
        apply_apis(prim, usd_deformable.MATERIAL_APIS if attributes else ())
        for attribute, usd_type, value in attributes:
            author(prim, attribute, usd_type, value)
    _bind(tetrahedra, root, 0)
    if usd_deformable.material_attributes(organ.material):
        apply_apis(root, usd_deformable.BODY_APIS)
        for attribute, usd_type, value in usd_deformable.BODY_ATTRIBUTES:
            author(root, attribute, usd_type, value)
        apply_apis(tetrahedra, usd_deformable.SIMULATION_APIS)


def _bind(prim: Sdf.PrimSpec, root: Sdf.PrimSpec, label: int) -> None:
    apply_apis(prim, ["MaterialBindingAPI"])
    binding = Sdf.RelationshipSpec(prim, "material:binding:physics", custom=False)
    binding.targetPathList.explicitItems = [root.path.AppendPath(f"Materials/Region_{label}")]


def _support_subset(prim: Sdf.PrimSpec, i: int, support: Support, element: str, indices: np.ndarray) -> None:
    _subset(
        prim,
        f"Support_{i}_{prim_name(support.name)}",
        element,
        "palpateSupport" if len(indices) else "",  # USD refuses a family without a single index
        indices,
        role="support",
        name=support.name,
        label=i,
        kind=support.kind,
        stiffness=support.stiffness,
    )


def _subset(
    parent: Sdf.PrimSpec, prim: str, element: str, family: str, indices: np.ndarray, **values: Any
) -> Sdf.PrimSpec:
    subset = child(parent, prim, "GeomSubset")
    author(subset, "elementType", "token", element, uniform=True)
    if family:
        author(subset, "familyName", "token", family, uniform=True)
    author(subset, "indices", "int[]", indices)
    plain = {"name": "", "label": 0, "kind": "", "stiffness": 0.0, "material": ""}
    author_schema(subset, "PalpateSubsetAPI", {**plain, **values})
    return subset


def _family(prim: Sdf.PrimSpec, family: str, family_type: str) -> None:
    author(prim, f"subsetFamily:{family}:familyType", "token", family_type, uniform=True)


def _subsets(prim: Usd.Prim) -> list[dict[str, Any]]:
    found = []
    for subset in prim.GetChildren():
        if "PalpateSubsetAPI" in subset.GetPrimTypeInfo().GetAppliedAPISchemas():
            indices = UsdGeom.Subset(subset).GetIndicesAttr().Get()
            found.append(
                {**schema_values(subset, "PalpateSubsetAPI"), "indices": np.array(indices, np.int32)}
            )
    return found


def _surface_faces(organ: OrganGeometry) -> np.ndarray:
    """(S, 3) faces of one tet only, in the order of the tets, counter-clockwise seen from outside."""
    corners = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])
    faces = np.asarray(organ.tet_indices)[:, corners].reshape(-1, 3)
    _, inverse, count = np.unique(np.sort(faces, axis=1), axis=0, return_inverse=True, return_counts=True)
    return faces[count[inverse.reshape(-1)] == 1]
