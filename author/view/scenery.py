# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The organ, the tool and the force in the browser's 3-D scene.

The scene's length is UNITS over the organ's diagonal, so that a browser's near plane, gizmo and lights fit an organ of
any size; everything outside this file is in metres.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import trimesh

from palpate.author.report.palette import ERRORS, INK, MARK, ORGAN, RENDERED, VALUES
from palpate.author.report.viewpoint import viewpoints
from palpate.author.view.colours import colours, rgb
from palpate.author.view.place import Place, Surface
from palpate.author.view.viewed import ViewedTool

__all__ = ["Scenery", "start_place"]

UNITS = 2.0
"""Length of the organ's diagonal in the scene."""
LIFT = 0.006
"""Scene; height of marks above the surface, to be seen."""
ARROW = 0.45
"""Scene; length of the force arrow at the largest force of the map."""
SLIPPING = "#d55e00"


class Scenery:
    """Args: server: viser's.  on_drag(phase, origin, direction, screen, modifier): the mouse, with its ray in m.
    on_gizmo(position): (3,) m."""

    def __init__(
        self,
        server: Any,
        tool: ViewedTool,
        on_drag: Callable[[str, np.ndarray, np.ndarray, tuple[float, float], str | None], None],
        on_gizmo: Callable[[np.ndarray], None],
    ):
        self._scene, self._on_drag = server.scene, on_drag
        everything = np.concatenate([tool.reach.vertices, tool.reach.rest_vertices])
        self._per_metre = UNITS / max(float(np.linalg.norm(np.ptp(everything, axis=0))), 1e-6)
        self._middle = 0.5 * (everything.min(axis=0) + everything.max(axis=0))
        self._camera(server, tool, everything)
        self._scene.set_up_direction("+z")
        # Lamps of our own: making an environment map took a browser without a GPU a minute.
        self._scene.configure_environment_map(hdri=None)
        self._scene.configure_default_lights(True, cast_shadow=False)
        self._scene.add_light_hemisphere("/sky", intensity=1.0)
        self._parts: list[Any] = []
        self._nodes: Any = None
        self._held_out: Any = None
        start = np.zeros((1, 2, 3))
        self._arrow = self._scene.add_arrows(
            "/force", start, rgb(MARK), shaft_radius=0.008, head_radius=0.02, head_length=0.045, visible=False
        )
        self._gizmo = self._scene.add_transform_controls(
            "/probe", scale=0.18, disable_rotations=True, depth_test=False, opacity=0.7
        )

        @self._gizmo.on_update
        async def _(event: Any) -> None:
            if event.client is not None:
                on_gizmo(self._metres(np.asarray(event.target.position)))

        self.change(tool)

    def change(self, tool: ViewedTool) -> None:
        """Another tool: its own reach, nodes, held-out presses and shape."""
        reach = tool.reach
        self._tool_data = tool
        vertices = np.concatenate([reach.vertices, reach.rest_vertices])
        triangles = np.concatenate([reach.triangles, reach.rest_triangles + len(reach.vertices)])
        self.surface = Surface(vertices, triangles)
        self._force_max = max(float(reach.values["normal_force"].max(initial=0.0)), 1e-9)
        self._rest = self._scene.add_mesh_simple(
            "/organ", self._units(reach.rest_vertices), reach.rest_triangles, color=rgb(ORGAN), side="double"
        )
        self._make_draggable(self._rest)
        shape, triangles = _shape(tool)
        self._tool = self._scene.add_mesh_simple(
            "/tool", self._per_metre * shape, triangles, color=rgb(RENDERED), opacity=0.65
        )
        nodes = tool.field.nodes
        if nodes.node_count:
            self._nodes = self._scene.add_point_cloud(
                "/nodes", self._marks(nodes.position, nodes.normal), rgb(INK), point_size=0.007,
                point_shape="circle", precision="float32", point_shading="flat",
            )  # fmt: skip
        elif self._nodes is not None:
            self._nodes.remove()
            self._nodes = None
        judged = [row for row in tool.held_out if row["force_error_max"] is not None]
        if judged:
            errors = np.array([row["force_error_max"] for row in judged])
            self._held_out = self._scene.add_point_cloud(
                "/held_out",
                self._marks(*(np.array([row[key] for row in judged]) for key in ("contact_point", "normal"))),
                colours(errors, 0.0, float(errors.max()), ERRORS)[:, :3], point_size=0.016,
                point_shape="circle", precision="float32", point_shading="gradient",
            )  # fmt: skip
        elif self._held_out is not None:
            self._held_out.remove()
            self._held_out = None

    def paint(self, values: np.ndarray, low: float, high: float) -> None:
        """Colours of the reach's vertices; values (V,)."""
        self._colours = colours(values, low, high, VALUES)
        self._reach = self._scene.add_glb("/reach", self._reach_glb(None), cast_shadow=False)
        self._make_draggable(self._reach)

    def show_dimple(self, moved: np.ndarray) -> None:
        """moved: (V, 3) m; displacement of the reach's vertices."""
        self._reach.glb_data = self._reach_glb(moved if moved.any() else None)

    def _reach_glb(self, moved: np.ndarray | None) -> bytes:
        """The reach in its colours, at rest when `moved` is None."""
        reach = self._tool_data.reach
        mesh = trimesh.Trimesh(
            self._units(reach.vertices if moved is None else reach.vertices + moved),
            reach.triangles,
            vertex_normals=reach.normals if moved is None else None,
            vertex_colors=self._colours,
            process=False,
        )
        return trimesh.exchange.gltf.export_glb(
            trimesh.Scene(mesh), include_normals=True, tree_postprocessor=_matt
        )

    def show_marks(self, nodes: bool, held_out: bool) -> None:
        for handle, shown in ((self._nodes, nodes), (self._held_out, held_out)):
            if handle is not None:
                handle.visible = shown

    def show_tool(self, position: np.ndarray, orientation: np.ndarray, slipping: bool) -> None:
        """position (3,) m, orientation (4,) x y z w."""
        self._tool.position = self._units(position)
        self._tool.wxyz = np.roll(orientation, 1)
        colour = rgb(SLIPPING if slipping else RENDERED)
        if self._tool.color != colour:
            self._tool.color = colour

    def show_force(self, position: np.ndarray, force: np.ndarray) -> None:
        """An arrow from the tool, (3,) m, as long as the force (3,) N says; none where there is none."""
        size = float(np.linalg.norm(force))
        felt = size > 1e-4 * self._force_max
        if felt:
            begin = self._units(position)
            self._arrow.points = np.stack([begin, begin + ARROW / self._force_max * force])[None].astype(
                np.float32
            )
        if self._arrow.visible != felt:
            self._arrow.visible = felt

    def move_gizmo(self, position: np.ndarray) -> None:
        self._gizmo.position = self._units(position)

    def _make_draggable(self, handle: Any) -> None:
        async def dragged(event: Any) -> None:
            eye = np.asarray(event.client.camera.position)
            to = np.asarray(event.end_position)
            self._on_drag(event.phase, self._metres(eye), to - eye, event.end_screen_pos, event.modifier)

        async def clicked(event: Any) -> None:
            origin, direction = np.asarray(event.ray_origin), np.asarray(event.ray_direction)
            self._on_drag("click", self._metres(origin), direction, event.screen_pos, event.modifier)

        handle.on_drag("left")(dragged)
        handle.on_drag("left", modifier="shift")(dragged)
        handle.on_click(clicked)

    def _marks(self, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
        return (self._units(points) + LIFT * normals).astype(np.float32)

    def _units(self, metres: np.ndarray) -> np.ndarray:
        return (np.asarray(metres) - self._middle) * self._per_metre

    def _metres(self, units: np.ndarray) -> np.ndarray:
        return units / self._per_metre + self._middle

    def _camera(self, server: Any, tool: ViewedTool, everything: np.ndarray) -> None:
        """Looks at the reach, with enough of the organ around it to know where it is."""
        eye, up = viewpoints(tool.reach)[0]
        seen = tool.reach.vertices if len(tool.reach.vertices) else everything
        near = self._per_metre * float(np.linalg.norm(np.ptp(seen, axis=0)))
        centre = self._units(0.5 * (seen.min(axis=0) + seen.max(axis=0)))
        camera = server.initial_camera
        camera.look_at = centre
        camera.position = centre + eye * min(max(1.25 * near, 0.6), 2.2)
        camera.up = up
        camera.near = 0.01


def start_place(tool: ViewedTool) -> Place:
    """The middle of the reach: its vertex nearest to the mean of them all."""
    reach = tool.reach
    nearest = int(np.argmin(np.linalg.norm(reach.vertices - reach.vertices.mean(axis=0), axis=1)))
    return Place(reach.feet[nearest], reach.normals[nearest])


def _matt(tree: dict[str, Any]) -> None:
    """A material for a glTF's meshes: without one they are of metal, which is black where nothing is mirrored."""
    tree["materials"] = [{"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.9}}]
    for mesh in tree["meshes"]:
        for primitive in mesh["primitives"]:
            primitive["material"] = 0


def _shape(tool: ViewedTool) -> tuple[np.ndarray, np.ndarray]:
    """The tool's surface, m, its reference point at the origin.

    A ball by its radius; a tool whose shape is not known (an .rfield alone) by a small mark at its reference point.
    """
    reference = tool.field.tool
    if len(reference.triangles):
        return reference.vertices, reference.triangles
    if reference.shape == "sphere":
        ball = trimesh.creation.icosphere(subdivisions=3, radius=reference.offset)
        return np.asarray(ball.vertices), np.asarray(ball.faces)
    mark = trimesh.creation.icosphere(subdivisions=0, radius=0.5e-3)
    return np.asarray(mark.vertices), np.asarray(mark.faces)
