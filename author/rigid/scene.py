# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A rigid scene file: what is held, what is fixed, and the law between them.

[scene]
name = "ball_on_bars"
effects = ["rigid"]

[rigid]                     # the law; Luo and Xiao's Table 1 where it says nothing
[rigid.held]
shape = "sphere"
radius = "20 mm"
mass = "0.5 kg"

[[rigid.fixed]]
shape = "cylinder"
radius = "20 mm"
length = "200 mm"
axis = [1.0, 0.0, 0.0]
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, ValidationError

from palpate.author.errors import InputError, InputProblem
from palpate.author.rigid import shapes
from palpate.author.rigid.body import Body, combined, frame_of
from palpate.author.rigid.law import Law
from palpate.author.rigid.polyhedron import box, plate_with_hole, polyhedron
from palpate.author.scene_problems import table_problems
from palpate.author.scene_tables import SceneHead
from palpate.author.scene_types import Direction, Point, Quantity, SurfaceFile, Table

__all__ = ["RigidScene", "is_rigid_scene", "load_rigid_scene"]

Length = Annotated[float, Quantity("length", above=0)]
Angle = Annotated[float, Quantity("angle", above=0, below=1.5)]
Edges = tuple[Length, Length, Length]

NEEDS: dict[str, tuple[str, ...]] = {
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
    "cone": ("radius", "length"),
    "torus": ("radius", "tube_radius"),
    "plane": ("size",),
    "paraboloid": ("radius", "length"),
    "bowl": ("radius", "length", "rim_width"),
    "tube": ("radius", "inner_radius", "length"),
    "pen": ("radius", "length", "tip_radius", "half_angle"),
    "box": ("size",),
    "plate": ("size", "hole"),
    "mesh": ("surface",),
}
"""Keys that a shape needs; all others of shapes are refused beside it."""
SHAPE_KEYS = sorted({key for keys in NEEDS.values() for key in keys})


class Part(Table):
    """A shape, and where it is: its z turned to `axis`, its origin at `position`."""

    shape: Literal[
        "sphere", "cylinder", "capsule", "cone", "torus", "plane", "paraboloid", "bowl", "tube", "pen", "box", "plate",
        "mesh",
    ] = Field(description=" ".join(NEEDS))  # fmt: skip
    radius: Length | None = Field(default=None, description="above 0")
    length: Length | None = Field(default=None, description="along the axis, above 0")
    tube_radius: Length | None = Field(default=None, description="of a torus, above 0")
    inner_radius: Length | None = Field(default=None, description="of a tube, above 0")
    rim_width: Length | None = Field(default=None, description="of a bowl, above 0")
    tip_radius: Length | None = Field(default=None, description="of a pen, above 0")
    half_angle: Angle | None = Field(default=None, description="of a pen's cone")
    size: Edges | None = Field(default=None, description="edge lengths of a box, plate, plane (third unread)")
    hole: tuple[Length, Length] | None = Field(default=None, description="edge lengths of a plate's hole")
    surface: SurfaceFile | None = Field(default=None, description="closed triangle mesh, in m")
    position: Point = Field(default=(0.0, 0.0, 0.0), description="of the shape's origin, m")
    axis: Direction = Field(default=(0.0, 0.0, 1.0), description="where the shape's z points")

    def body(self, key: str, file: str) -> Body:
        """Raises InputError: keys missing or too many, or what the shape itself refuses."""
        given = {k: getattr(self, k) for k in SHAPE_KEYS if getattr(self, k) is not None}
        problems = [
            InputProblem(
                file,
                f"{key}.{k}",
                None,
                f"is missing: a {self.shape} needs it",
                " and ".join(NEEDS[self.shape]),
            )
            for k in NEEDS[self.shape]
            if k not in given
        ]
        problems += [
            InputProblem(
                file, f"{key}.{k}", None, f"says nothing of a {self.shape}", " and ".join(NEEDS[self.shape])
            )
            for k in given
            if k not in NEEDS[self.shape]
        ]
        if self.shape == "torus" and not problems and given["tube_radius"] >= given["radius"]:
            problems.append(
                InputProblem(
                    file, f"{key}.tube_radius", self.tube_radius, "closes the torus' hole", "below radius"
                )
            )
        if self.shape == "tube" and not problems and given["inner_radius"] >= given["radius"]:
            problems.append(
                InputProblem(file, f"{key}.inner_radius", self.inner_radius, "leaves no wall", "below radius")
            )
        if (
            self.shape == "plate"
            and not problems
            and any(h >= s for h, s in zip(self.hole or (), self.size or (), strict=False))
        ):
            problems.append(InputProblem(file, f"{key}.hole", None, "is wider than the plate", "below size"))
        if problems:
            raise InputError(problems)
        z = np.array(self.axis)
        x = frame_of(z) if z[2] < 1 else np.array([1.0, 0, 0])
        return self._made(given, f"{file}: {key}").moved(
            np.stack([x, np.cross(z, x), z], axis=1), np.array(self.position)
        )

    def _made(self, g: dict[str, Any], name: str) -> Body:
        if self.shape == "mesh":
            import trimesh

            loaded = trimesh.load(g["surface"], force="mesh")
            return polyhedron(np.asarray(loaded.vertices), np.asarray(loaded.faces), name)
        if self.shape == "box":
            return box(g["size"])
        if self.shape == "plate":
            return plate_with_hole(g["size"], g["hole"])
        if self.shape == "plane":
            return shapes.plane(*g["size"][:2])
        if self.shape in ("paraboloid", "bowl"):
            curvature = g["length"] / g["radius"] ** 2
            return (
                shapes.bowl(curvature, g["length"], g["rim_width"])
                if self.shape == "bowl"
                else shapes.paraboloid(curvature, g["length"])
            )
        if self.shape == "tube":
            return shapes.tube(g["inner_radius"], g["radius"], g["length"])
        return getattr(shapes, self.shape)(*(g[k] for k in NEEDS[self.shape]))


class Held(Part):
    """[rigid.held]"""

    mass: Annotated[float, Quantity("mass", above=0)] = Field(description="above 0")


class RigidTable(Table):
    """[rigid]: the law's numbers, and the bodies."""

    threshold: Length = Field(default=Law.threshold, description="eps: contact where surfaces are nearer")
    stiffness: Annotated[float, Quantity("stiffness", above=0)] = Field(
        default=Law.stiffness, description="K, above 0"
    )
    damping: Annotated[float, Quantity("damping", least=0)] = Field(
        default=Law.damping, description="D, at least 0"
    )
    static_friction: Annotated[float, Quantity("fraction", least=0, most=10)] = Field(
        default=Law.static_friction, description="mu"
    )
    kinetic_friction: Annotated[float, Quantity("fraction", least=0, most=10)] = Field(
        default=Law.kinetic_friction, description="mu_D"
    )
    tangential_stiffness: Annotated[float, Quantity("stiffness", above=0)] = Field(
        default=Law.tangential_stiffness, description="K_p"
    )
    depth_max: Length = Field(default=Law.depth_max, description="contact deeper than this is released")
    gravity: tuple[float, float, float] = Field(default=Law.gravity, description="m/s2")
    held: Held = Field(description="what the hand holds")
    fixed: tuple[Part, ...] = Field(min_length=1, description="at least one fixed part")

    @property
    def law(self) -> Law:
        names = (
            "threshold",
            "stiffness",
            "damping",
            "static_friction",
            "kinetic_friction",
            "tangential_stiffness",
            "depth_max",
            "gravity",
        )
        return Law(**{name: getattr(self, name) for name in names})


class RigidScene(Table):
    """The whole file."""

    scene: SceneHead
    rigid: RigidTable
    file: Path = Field(default=Path("."), exclude=True)

    def bodies(self) -> tuple[Body, Body]:
        """Held and fixed."""
        held = self.rigid.held.body("rigid.held", str(self.file))
        return held, combined(
            [p.body(f"rigid.fixed[{i}]", str(self.file)) for i, p in enumerate(self.rigid.fixed)]
        )


def is_rigid_scene(path: Path) -> bool:
    """Whether the scene file asks for rigid contact and nothing else; False where it cannot be read."""
    try:
        head = tomllib.loads(path.read_text(encoding="utf-8")).get("scene", {})
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
        return False
    return isinstance(head, dict) and head.get("effects") == ["rigid"]


def load_rigid_scene(path: Path) -> RigidScene:
    """Raises InputError with all that is wrong in the tables."""
    try:
        raw = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(InputProblem(str(path), "", None, "does not exist", "a scene file")) from None
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(
            InputProblem(str(path), "", None, f"is not TOML: {error}", "a scene file in TOML")
        ) from None
    try:
        scene = RigidScene.model_validate(raw | {"file": path}, context={"folder": path.resolve().parent})
    except ValidationError as error:
        raise InputError([p for _, p in table_problems(error, RigidScene, raw, str(path), ())]) from None
    if scene.scene.effects != ("rigid",):
        what = "asks for more than rigid contact in a rigid scene"
        raise InputError(
            InputProblem(
                str(path),
                "scene.effects",
                list(scene.scene.effects),
                what,
                '["rigid"]; tissue in a scene of its own',
            )
        )
    return scene
