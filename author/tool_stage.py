# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""From a scene's tool to one that presses, and to what an asset keeps of it.

A `ToolShape` is plain values: it travels to workers, and its hash stands in every record.  A mesh is taken into the
tool's frame (tip at the origin, z along the axis) at once, so that scene and asset describe it alike.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from palpate.author.errors import InputError
from palpate.author.scene import Scene
from palpate.author.scene_tables import Tool
from palpate.author.scene_types import digest
from palpate.author.tool_outline import outline_of
from palpate.fem_offline import tool as solids
from palpate.fem_offline.errors import ToolError
from palpate.fem_offline.pose import tilted
from palpate.fields.field_error import FieldError
from palpate.fields.response_field import ToolReference

__all__ = [
    "ToolShape",
    "contact_extent",
    "heading_matters",
    "offset_of",
    "reference_of",
    "shape_of",
    "shape_of_reference",
    "solid_tool",
]

ROUNDING = 1e-12
"""m; a tip that lies on the touching plane is found to lie there to this."""
E_Z = np.array([0.0, 0.0, 1.0])
PARAMETERS = ("radius", "edge_radius", "half_angle", "length")
"""A scene's names of a shape's numbers."""

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class ToolShape:
    """A rigid tool and how it is held, as plain values.

    Attributes:
        shape: as in the scene.
        parameters: (name, value) pairs, SI, by the scene's names.
        axis, tip: in the shape's own frame (fem_offline/placed_tool.py).
        tilt: rad.
        mesh_hash: of a mesh tool's surface.
        vertices, triangles: (V, 3) m, (F, 3); that surface, in the tool's frame.
        hash: hex digest of tool and tilt; what records and fields are valid for.
    """

    shape: str
    parameters: tuple[tuple[str, float], ...]
    axis: Vector = (0.0, 0.0, 1.0)
    tip: Vector | None = None
    tilt: float = 0.0
    mesh_hash: str = ""
    vertices: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)), compare=False)
    triangles: np.ndarray = field(default_factory=lambda: np.zeros((0, 3), np.int64), compare=False)

    @property
    def hash(self) -> str:
        solid = solid_tool(self).hash()
        return digest({"tool": solid, "tilt": self.tilt}) if self.tilt else solid


def shape_of(scene: Scene, tool: Tool) -> ToolShape:
    """Raises InputError where the numbers make no tool."""
    given = {name: getattr(tool, name) for name in PARAMETERS}
    given["radius"] = tool.radius[0] if tool.radius else None
    parameters = tuple((name, float(value)) for name, value in given.items() if value is not None)
    axis, tilt = tool.axis or (0.0, 0.0, 1.0), tool.tilt[0] if tool.tilt else 0.0
    key = f"tool[{scene.tool.index(tool)}]"
    try:
        if tool.shape == "mesh":
            shape = _meshed(*_read(tool), axis, tool.tip, tilt)
        else:
            shape = ToolShape(tool.shape, parameters, axis, tool.tip, tilt)
        offset = offset_of(shape)
    except ToolError as error:
        place = f"{key}.{error.where.removeprefix('tool.')}"
        raise InputError(scene.problem(place, None, error.what, error.expected)) from error
    except ValueError as error:
        raise InputError(scene.problem(key, None, f"is no {tool.shape}: {error}", "")) from error
    if offset < 0.0:
        what = f"lies {-1e3 * offset:.3g} mm outside the tool, on the tissue's side"
        raise InputError(scene.problem(f"{key}.tip", tool.tip, what, "a point of the tool, or above it"))
    return shape


def _read(tool: Tool) -> tuple[np.ndarray, np.ndarray]:
    """Vertices, m, and triangles of a mesh tool's file.  Raises ToolError."""
    import trimesh

    try:
        mesh = trimesh.load(tool.surface, force="mesh")
        vertices, triangles = np.array(mesh.vertices, float), np.array(mesh.faces, np.int64)
    except Exception as error:
        raise ToolError(f"cannot be read as a surface ({error})", "tool.surface", "STL, OBJ, PLY") from error
    return vertices * {"m": 1.0, "cm": 1e-2, "mm": 1e-3}[tool.units or "m"], triangles


def _meshed(
    vertices: np.ndarray, triangles: np.ndarray, axis: Vector, tip: Vector | None, tilt: float
) -> ToolShape:
    """A mesh tool, taken into its own frame.  Raises ToolError where it is no solid."""
    given = solids.MeshTool(vertices=vertices, triangles=triangles, axis=axis, tip=tip)
    own = solids.MeshTool(
        vertices=given.into_tool_frame(given.vertices), triangles=given.triangles, tip=(0.0, 0.0, 0.0)
    )
    arrays = own.vertices, own.triangles
    return ToolShape("mesh", (), tip=(0.0, 0.0, 0.0), tilt=tilt, mesh_hash=own.hash(),
                     vertices=arrays[0], triangles=arrays[1])  # fmt: skip


@lru_cache(maxsize=32)
def solid_tool(shape: ToolShape) -> solids.Tool:
    """The mechanics' tool.  Raises ValueError where the numbers make none."""
    p = dict(shape.parameters)
    held = {"axis": shape.axis, "tip": shape.tip}
    if shape.shape == "sphere":
        return solids.Sphere(p["radius"])
    if shape.shape == "flat_punch":
        return solids.FlatPunch(p["radius"], p.get("edge_radius"), **held)
    if shape.shape == "cylinder":
        return solids.Cylinder(p["radius"], p["length"], p.get("edge_radius"), **held)
    if shape.shape == "capsule":
        return solids.Capsule(p["radius"], p["length"], **held)
    if shape.shape == "cone":
        tip = {"tip_radius": p["edge_radius"]} if "edge_radius" in p else {}
        return solids.Cone(p["half_angle"], **tip, **held)
    if shape.shape == "mesh":
        return solids.MeshTool(vertices=shape.vertices, triangles=shape.triangles, **held)
    raise ValueError(f"there is no shape {shape.shape!r}")


def heading_matters(shape: ToolShape) -> bool:
    """Whether turning the tool about the surface's normal changes how it presses."""
    if shape.shape == "sphere":
        return False
    on_axis = shape.tip is None or not any(shape.tip[:2])
    return bool(shape.tilt) or shape.shape == "mesh" or shape.axis[2] < 1.0 - 1e-9 or not on_axis


def offset_of(shape: ToolShape) -> float:
    """rho, m: how far the tool, held as it is, reaches from its reference point towards the tissue."""
    offset = float(solid_tool(shape).offset_along(-E_Z @ tilted(E_Z, shape.tilt)))
    return 0.0 if abs(offset) < ROUNDING else offset


def contact_extent(shape: ToolShape, depth: float) -> float:
    """m; radius around the contact point that holds the contact at a depth (m)."""
    return solid_tool(shape).footprint(depth, tilted(E_Z, shape.tilt)).extent


def reference_of(name: str, shape: ToolShape) -> ToolReference:
    """What an asset keeps of a tool: enough to press with it again."""
    tool = solid_tool(shape)
    if isinstance(tool, solids.Sphere):
        return ToolReference(name, shape.shape, tool.radius, dict(shape.parameters), shape.hash)
    mesh = (shape.vertices, shape.triangles.astype(np.int32))
    vertices, triangles = mesh if shape.shape == "mesh" else outline_of(tool)
    return ToolReference(
        name,
        shape.shape,
        offset_of(shape),
        dict(shape.parameters),
        shape.hash,
        shape.axis,
        tuple(map(float, tool.reference_point)),
        shape.tilt,
        vertices,
        triangles,
    )


def shape_of_reference(reference: ToolReference) -> ToolShape:
    """The tool that an asset's field was pressed with.  Raises FieldError where its hash is not the field's."""
    shape = _shape_of(reference)
    if shape.hash != reference.hash:
        raise FieldError(
            f"tool {reference.name!r}: its shape, size, tip, axis and tilt hash to {shape.hash[:12]}, but the field "
            f"was pressed with {reference.hash[:12]}; the tool as it was pressed, or this tool authored again, is right"
        )
    return shape


def _shape_of(reference: ToolReference) -> ToolShape:
    if reference.shape == "mesh":
        return _meshed(reference.vertices, reference.triangles, reference.axis, reference.tip, reference.tilt)
    tip = None if reference.shape == "sphere" else reference.tip
    parameters = tuple(
        (name, reference.parameters[name]) for name in PARAMETERS if name in reference.parameters
    )
    return ToolShape(reference.shape, parameters, reference.axis, tip, reference.tilt)
