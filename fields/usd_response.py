# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A response field in USD: contact geometry in a layer that tools share, nodes and curves in one per tool.

/<organ>
    Contact                       PalpateContactAPI
        SignedDistance            PalpateLatticeAPI
    Response                      PalpateFieldAPI
        Nodes                     Points with PalpateResponseAPI: the authored truth
        Family                    of a tool family: the nodes under its other radii, PalpateFamilyMemberAPI too
        Ways/Tilt_1 ...           PalpateWayAPI: a further way of touching, with its own Nodes and Amplitudes
        EnergyCurves, StiffnessCurves, FrictionCurves     PalpateDepthCurvesAPI; the last two with friction only
        Amplitudes                PalpateLatticeAPI
        Deformation               PalpateDeformationAPI, where the scene asked for it (usd_deformation.py)
        Texture                   PalpateTextureAPI, likewise (usd_texture.py)
        Transient                 PalpateTransientAPI, likewise (usd_transient.py)
        Tool                      Sphere or Mesh (purpose guide), resting on the first node
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace

import numpy as np
from pxr import Sdf, Usd, UsdGeom

from palpate.fields.field_check import check_contact_geometry, check_field
from palpate.fields.field_error import FieldError
from palpate.fields.lattice import BLOCK_EDGE, Lattice
from palpate.fields.response_field import (
    ContactGeometry,
    DepthCurves,
    FamilyMember,
    ResponseField,
    ResponseNodes,
    TiltedWay,
    ToolReference,
)
from palpate.fields.usd_deformation import author_deformation, read_usd_deformation
from palpate.fields.usd_layer import (
    author,
    author_schema,
    author_some,
    child,
    json_text,
    new_layer,
    schema_values,
)
from palpate.fields.usd_organ import exact_points, point_attributes
from palpate.fields.usd_schema.attributes import APIS
from palpate.fields.usd_texture import author_texture, read_usd_texture
from palpate.fields.usd_transient import author_transient, read_usd_transient

__all__ = ["contact_from_prim", "contact_hash", "contact_layer", "field_from_prim", "field_layer"]

SOFT, STIFF, TOOL = np.array([0.15, 0.35, 0.85]), np.array([0.90, 0.25, 0.12]), (0.75, 0.77, 0.80)
"""Preview colours, linear RGB: nodes of least and most force at the last knot, and the tool."""
NODE_WIDTH_SHARE = 0.008
"""Width of a previewed node as a share of the nodes' bounding box diagonal."""


def contact_hash(geometry: ContactGeometry) -> str:
    """Hex sha256 of the signed distance and its band: two fields may share an asset when theirs agree."""
    lattice, digest = geometry.signed_distance, hashlib.sha256()
    for array, dtype in (
        (geometry.band, "<f8"),
        (lattice.origin, "<f8"),
        (lattice.spacing, "<f8"),
        (lattice.block_index, "<i4"),
        (lattice.coefficients, "<f8"),
    ):
        digest.update(repr(np.shape(array)).encode())
        values = np.ascontiguousarray(array).astype(dtype)
        digest.update((values + values.dtype.type(0)).tobytes())  # -0.0 is stored as 0.0
    return digest.hexdigest()


def contact_layer(root_name: str, geometry: ContactGeometry) -> Sdf.Layer:
    """The layer of the contact geometry.  Raises FieldError where it breaks its contract."""
    check_contact_geometry(geometry)
    layer, root = new_layer(root_name, comment="contact geometry, shared by all tools")
    contact = child(root, "Contact", "Scope")
    values = {
        "band": geometry.band,
        "error_p99": geometry.error_p99,
        "flagged_share": geometry.flagged_share,
        "hash": contact_hash(geometry),
    }
    author_schema(contact, "PalpateContactAPI", values)
    _lattice(child(contact, "SignedDistance", "Scope"), geometry.signed_distance, ["signed_distance"])
    return layer


def field_layer(root_name: str, field: ResponseField, organ_hash: str) -> Sdf.Layer:
    """The layer of one tool.  Raises FieldError where `field` breaks its contract."""
    check_field(field)
    tool = field.tool
    layer, root = new_layer(root_name, comment=f"response field for the tool {tool.name}")
    response = child(root, "Response", "Scope")
    where = f"field {tool.name!r}"
    values = {
        "tool_name": tool.name,
        "tool_shape": tool.shape,
        "tool_offset": tool.offset,
        "parameter_names": sorted(tool.parameters),
        "parameter_values": [tool.parameters[name] for name in sorted(tool.parameters)],
        "tool_axis": tool.axis,
        "tool_tip": tool.tip,
        "tool_tilt": tool.tilt,
        "tool_hash": tool.hash,
        "depth_max": field.depth_max,
        "band": field.own_band,
        "representation_names": sorted(field.representation),
        "representation_values": [field.representation[name] for name in sorted(field.representation)],
        "provenance": json_text(field.provenance, f"{where}: provenance"),
        "organ_hash": organ_hash,
        "contact_hash": contact_hash(field.geometry),
    }
    author_schema(response, "PalpateFieldAPI", values)
    _family(response, field, _nodes(response, "Nodes", field.nodes))
    for name, curves in _curve_groups(field).items():
        if not curves.curve_count:  # an effect that the field does not have
            continue
        rows = {
            "depth_end": curves.depth_end,
            "curve_count": curves.curve_count,
            "interval_count": curves.coefficients.shape[1],
            "coefficients": curves.coefficients,
        }
        author_schema(child(response, name, "Scope"), "PalpateDepthCurvesAPI", rows)
    letters = zip("abm", _curve_groups(field).values(), strict=True)
    channels = [f"{letter}_{r}" for letter, curves in letters for r in range(curves.curve_count)]
    _lattice(child(response, "Amplitudes", "Scope"), field.amplitudes, channels)
    _ways(response, field, channels)
    author_deformation(response, field.layers)
    author_texture(response, field.layers)
    author_transient(response, field.layers)
    _tool_preview(response, field)
    return layer


def contact_from_prim(root: Usd.Prim) -> ContactGeometry:
    """The contact geometry below an asset's root prim.  Raises FieldError where it is missing or broken."""
    contact = _child(root, "Contact")
    values = schema_values(contact, "PalpateContactAPI")
    geometry = ContactGeometry(
        signed_distance=_read_lattice(_child(contact, "SignedDistance")),
        band=values["band"],
        error_p99=values["error_p99"],
        flagged_share=values["flagged_share"],
    )
    check_contact_geometry(geometry, str(contact.GetPath()))
    return geometry


def field_from_prim(root: Usd.Prim) -> ResponseField:
    """The selected tool's field below an asset's root prim.

    Raises:
        FieldError: something is missing or broken, or was made for another organ or contact geometry.
    """
    response = _child(root, "Response")
    values = schema_values(response, "PalpateFieldAPI")
    for api, prim, own in (
        ("PalpateContactAPI", _child(root, "Contact"), "contact_hash"),
        ("PalpateOrganAPI", root, "organ_hash"),
    ):
        stored = schema_values(prim, api)["hash"]
        if stored != values[own]:
            raise FieldError(
                f"{response.GetPath()} was made for {own} {values[own][:12]}, the asset has {stored[:12]}; "
                "author this tool again"
            )
    energy = _read_curves(_child(response, _CURVES[0]))
    none = DepthCurves(energy.depth_end, np.zeros((0, *energy.coefficients.shape[1:])))
    stored = {name: response.GetChild(name) for name in _CURVES[1:]}
    curves = {
        _CURVES[0]: energy,
        **{name: _read_curves(prim) if prim else none for name, prim in stored.items()},
    }
    tool, nodes = _read_tool(response, values), _read_nodes(_child(response, "Nodes"))
    geometry = contact_from_prim(root)
    field = ResponseField(
        tool=tool,
        geometry=geometry,
        nodes=nodes,
        energy_curves=curves["EnergyCurves"],
        stiffness_curves=curves["StiffnessCurves"],
        friction_curves=curves["FrictionCurves"],
        amplitudes=_read_lattice(_child(response, "Amplitudes")),
        depth_max=values["depth_max"],
        band=None if np.array_equal(values["band"], geometry.band) else values["band"],
        representation=_pairs(response, values, "representation"),
        provenance=json.loads(values["provenance"]),
        family=_read_family(response, tool, nodes),
        ways=_read_ways(response, tool),
        layers=read_usd_deformation(response) | read_usd_texture(response) | read_usd_transient(response),
    )
    check_field(field)
    return field


_CURVES = ("EnergyCurves", "StiffnessCurves", "FrictionCurves")


def _curve_groups(field: ResponseField) -> dict[str, DepthCurves]:
    groups = (field.energy_curves, field.stiffness_curves, field.friction_curves)
    return dict(zip(_CURVES, groups, strict=True))


def _child(prim: Usd.Prim, name: str) -> Usd.Prim:
    found = prim.GetChild(name)
    if not found:
        raise FieldError(
            f"{prim.GetStage().GetRootLayer().identifier}: {prim.GetPath()} has no prim {name}; "
            "a palpate asset with payloads loaded and a tool selected is right"
        )
    return found


def _length(prim: Usd.Prim, name: str, found: int, right: int, why: str) -> None:
    if found != right:
        raise FieldError(f"{prim.GetPath()}: {name} has {found} values; {right}, {why}, is right")


def _nodes(parent: Sdf.PrimSpec, name: str, nodes: ResponseNodes) -> Sdf.PrimSpec:
    prim = child(parent, name, "Points")
    width = max(NODE_WIDTH_SHARE * float(np.linalg.norm(np.ptp(nodes.position, axis=0))), 1e-4)
    point_attributes(prim, nodes.position, width)
    author(prim, "widths", "float[]", np.full(nodes.node_count, width), interpolation="vertex")
    author(prim, "normals", "normal3f[]", nodes.normal, interpolation="vertex")
    force = nodes.normal_force[:, -1]
    share = ((force - force.min()) / max(float(np.ptp(force)), 1e-300))[:, None]
    colour = (1 - share) * SOFT + share * STIFF
    author(prim, "primvars:displayColor", "color3f[]", colour, interpolation="vertex")
    without = () if any(getattr(nodes, name).any() for name in _OF_FRICTION) else _OF_FRICTION
    values = {name: getattr(nodes, name) for name in _NODE_MEMBERS if name not in without}
    author_some(prim, "PalpateResponseAPI", values, element_size=len(nodes.depth_knots))
    return prim


def _family(response: Sdf.PrimSpec, field: ResponseField, own: Sdf.PrimSpec) -> None:
    """The other members' nodes; hidden from previews, where they would lie on the field's own."""
    if not field.family:
        return
    parent = child(response, "Family", "Scope")
    for i, member in enumerate(field.family):
        prim = own
        if member.tool.hash != field.tool.hash:
            prim = _nodes(parent, f"Radius_{i}", member.nodes)
            author(prim, "visibility", "token", "invisible")
        values = {"radius": member.radius, "tool_hash": member.tool.hash}
        author_schema(prim, "PalpateFamilyMemberAPI", values)


def _ways(response: Sdf.PrimSpec, field: ResponseField, channels: list[str]) -> None:
    if not field.ways:
        return
    parent = child(response, "Ways", "Scope")
    for i, way in enumerate(field.ways, 1):
        prim = child(parent, f"Tilt_{i}", "Scope")
        values = {"tilt": way.tool.tilt, "offset": way.tool.offset, "tool_hash": way.tool.hash}
        author_schema(prim, "PalpateWayAPI", values)
        author(_nodes(prim, "Nodes", way.nodes), "visibility", "token", "invisible")
        _lattice(child(prim, "Amplitudes", "Scope"), way.amplitudes, channels)


def _read_ways(response: Usd.Prim, tool: ToolReference) -> tuple[TiltedWay, ...]:
    parent = response.GetChild("Ways")
    ways = []
    for prim in parent.GetChildren() if parent else ():
        values = schema_values(prim, "PalpateWayAPI")
        held = replace(tool, tilt=values["tilt"], offset=values["offset"], hash=values["tool_hash"])
        nodes, amplitudes = _read_nodes(_child(prim, "Nodes")), _read_lattice(_child(prim, "Amplitudes"))
        ways.append(TiltedWay(held, nodes, amplitudes))
    return tuple(sorted(ways, key=lambda way: way.tool.tilt))


def _read_family(response: Usd.Prim, tool: ToolReference, nodes: ResponseNodes) -> tuple[FamilyMember, ...]:
    parent = response.GetChild("Family")
    if not parent:
        return ()
    members = [FamilyMember(tool, nodes)]
    for prim in parent.GetChildren():
        values = schema_values(prim, "PalpateFamilyMemberAPI")
        radius = values["radius"]
        ball = replace(tool, offset=radius, parameters={"radius": radius}, hash=values["tool_hash"])
        members.append(FamilyMember(ball, _read_nodes(prim)))
    return tuple(sorted(members, key=lambda member: member.radius))


_OF_FRICTION = ("friction_stiffness", "friction_coefficient")
"""Node curves that a field without friction does not have; both or none."""
_NODE_MEMBERS = (
    "depth_knots",
    "normal",
    "stored_energy",
    "normal_force",
    "lateral_gradient",
    "friction_stiffness",
    "friction_coefficient",
    "depth_reached",
    "pressed",
    "residual",
    "press_hash",
)


def _read_nodes(prim: Usd.Prim) -> ResponseNodes:
    rows = APIS["PalpateResponseAPI"].attributes
    frictionless = not any(prim.HasAttribute(rows[name].name) for name in _OF_FRICTION)
    values = schema_values(prim, "PalpateResponseAPI", absent=_OF_FRICTION if frictionless else ())
    position = exact_points(prim)
    n, k = len(position), len(values["depth_knots"])
    values |= {name: np.zeros(n * k) for name in _OF_FRICTION if frictionless}
    for member, name in (
        ("normal", "normal"),
        ("depth_reached", "depthReached"),
        ("pressed", "pressed"),
        ("residual", "residual"),
        ("press_hash", "pressHash"),
    ):
        _length(prim, name, len(values[member]), n, f"one for each of {n} nodes")
    for member, name in (
        ("stored_energy", "storedEnergy"),
        ("normal_force", "normalForce"),
        ("lateral_gradient", "lateralGradient"),
        ("friction_stiffness", "frictionStiffness"),
        ("friction_coefficient", "frictionCoefficient"),
    ):
        _length(prim, name, len(values[member]), n * k, f"{n} nodes x {k} knots")
        values[member] = values[member].reshape(n, k, *values[member].shape[1:])
    return ResponseNodes(position=position, **values)


def _lattice(prim: Sdf.PrimSpec, lattice: Lattice, channels: list[str]) -> None:
    values = {
        "origin": lattice.origin,
        "spacing": lattice.spacing,
        "block_shape": lattice.block_index.shape,
        "block_index": lattice.block_index.reshape(-1),
        "channels": channels,
        "coefficients": lattice.coefficients.reshape(-1),
    }
    author_schema(prim, "PalpateLatticeAPI", values)


def _read_lattice(prim: Usd.Prim) -> Lattice:
    values = schema_values(prim, "PalpateLatticeAPI")
    shape = tuple(int(v) for v in values["block_shape"])
    index, coefficients, channels = values["block_index"], values["coefficients"], len(values["channels"])
    if not channels:
        raise FieldError(f"{prim.GetPath()}: palpate:lattice:channels is empty; one name or more is right")
    per_block = BLOCK_EDGE**3 * channels
    blocks = max(int(index.max(initial=-1)) + 1, len(coefficients) // per_block)  # rows may be unused
    _length(
        prim, "blockIndex", len(index), int(np.prod(shape)), f"{shape[0]} x {shape[1]} x {shape[2]} blocks"
    )
    count = blocks * per_block
    _length(prim, "coefficients", len(coefficients), count, f"{blocks} blocks x 64 x {channels} channels")
    return Lattice(
        origin=values["origin"],
        spacing=values["spacing"],
        block_index=index.reshape(shape),
        coefficients=coefficients.reshape(blocks, *(BLOCK_EDGE,) * 3, channels),
    )


def _read_curves(prim: Usd.Prim) -> DepthCurves:
    values = schema_values(prim, "PalpateDepthCurvesAPI")
    curves, intervals = values["curve_count"], values["interval_count"]
    count = curves * intervals * 4
    _length(prim, "coefficients", len(values["coefficients"]), count, f"{curves} x {intervals} x 4")
    return DepthCurves(values["depth_end"], values["coefficients"].reshape(curves, intervals, 4))


def _pairs(prim: Usd.Prim, values: dict, stem: str) -> dict[str, float]:
    names, numbers = values[f"{stem}_names"], values[f"{stem}_values"]
    _length(prim, f"{stem}Values", len(numbers), len(names), f"one for each of {stem}Names")
    return {str(name): float(number) for name, number in zip(names, numbers, strict=True)}


def _read_tool(response: Usd.Prim, values: dict) -> ToolReference:
    parameters = _pairs(response, values, "parameter")
    geometry = {}
    prim = response.GetChild("Tool")
    if prim and prim.IsA(UsdGeom.Mesh):
        triangles = np.array(UsdGeom.Mesh(prim).GetFaceVertexIndicesAttr().Get(), np.int32).reshape(-1, 3)
        geometry = {"vertices": exact_points(prim), "triangles": triangles}
    return ToolReference(
        name=values["tool_name"],
        shape=values["tool_shape"],
        offset=values["tool_offset"],
        parameters=parameters,
        hash=values["tool_hash"],
        axis=tuple(map(float, values["tool_axis"])),
        tip=tuple(map(float, values["tool_tip"])),
        tilt=values["tool_tilt"],
        **geometry,
    )


def _tool_preview(parent: Sdf.PrimSpec, field: ResponseField) -> None:
    """The tool's own geometry, standing on the first node."""
    tool, normal = field.tool, field.nodes.normal[0]
    place = field.nodes.position[0] + tool.offset * normal
    if tool.shape == "sphere":
        radius = tool.parameters["radius"]
        prim = child(parent, "Tool", "Sphere")
        author(prim, "radius", "double", radius)
        author(prim, "extent", "float3[]", [[-radius] * 3, [radius] * 3])
        author(prim, "xformOp:translate", "double3", place)
        author(prim, "xformOpOrder", "token[]", ["xformOp:translate"], uniform=True)
    elif len(tool.vertices):
        prim = child(parent, "Tool", "Mesh")
        point_attributes(prim, tool.vertices)
        author(prim, "faceVertexCounts", "int[]", np.full(len(tool.triangles), 3))
        author(prim, "faceVertexIndices", "int[]", np.asarray(tool.triangles).reshape(-1))
        author(prim, "subdivisionScheme", "token", "none", uniform=True)
        author(prim, "orientation", "token", "rightHanded", uniform=True)
        transform = np.eye(4)
        transform[:3, :3], transform[3, :3] = tool.held_against(normal).T, place  # USD multiplies rows
        author(prim, "xformOp:transform", "matrix4d", transform)
        author(prim, "xformOpOrder", "token[]", ["xformOp:transform"], uniform=True)
    else:
        return
    author(prim, "purpose", "token", "guide", uniform=True)
    author(prim, "primvars:displayColor", "color3f[]", [TOOL], interpolation="constant")
