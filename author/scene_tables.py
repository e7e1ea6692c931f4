# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The tables of a scene file, one class each, in the order in which a file names them.

Here stands what a key means, its unit, range and default.  What holds between keys stands in `scene_rules`,
what this version cannot do yet in `capabilities`, what needs the organ's mesh in `organ_check`.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, Strict
from pydantic.functional_validators import AfterValidator
from pydantic.json_schema import WithJsonSchema

from palpate.author.place import Place
from palpate.author.scene_types import (
    Direction,
    Identifier,
    OneOrMore,
    Point,
    Quantity,
    SurfaceFile,
    Table,
    digest,
    refused,
)
from palpate.author.transients.transient_table import Transient

__all__ = [
    "EFFECTS",
    "Accuracy",
    "Capsule",
    "Device",
    "Material",
    "Organ",
    "Paint",
    "Reach",
    "Region",
    "SceneHead",
    "Support",
    "Tool",
]

Effect = Literal["response", "friction", "texture", "transient", "cutting", "rigid", "deformation"]
EFFECTS: tuple[Effect, ...] = (
    "response",
    "friction",
    "texture",
    "transient",
    "cutting",
    "rigid",
    "deformation",
)
Unit = Literal["m", "cm", "mm"]

Length = Annotated[float, Quantity("length", above=0)]
Pressure = Annotated[float, Quantity("pressure", above=0)]
Number = Annotated[float, Quantity("fraction")]
Factor = Annotated[float, Quantity("fraction", least=1, most=1e6)]


def _in_order(effects: tuple[Effect, ...]) -> tuple[Effect, ...]:
    return tuple(effect for effect in EFFECTS if effect in effects)


class SceneHead(Table):
    """[scene]"""

    name: Identifier = Field(description="names the asset: letters, digits and underscores")
    effects: Annotated[tuple[Effect, ...], Field(min_length=1), AfterValidator(_in_order)] = Field(
        default=("response",), description="only these are modelled: " + " ".join(EFFECTS)
    )


class Material(Table):
    """A hyperelastic material.

    Initial shear modulus: mu or E / (2 (1 + nu)) (linear, neo_hookean); the sum of mu (ogden, with
    psi = sum 2 mu_p / alpha_p^2 (l1^a + l2^a + l3^a - 3)); 2 (c10 + c01) (mooney_rivlin); 2 c10 (yeoh);
    c1 c2 (veronda_westmann).
    """

    model: Literal["linear", "neo_hookean", "mooney_rivlin", "ogden", "yeoh", "veronda_westmann"] = Field(
        description="linear neo_hookean mooney_rivlin ogden yeoh veronda_westmann"
    )
    youngs_modulus: Pressure | None = Field(default=None, description="Young's modulus at rest, above 0")
    mu: Annotated[tuple[Pressure, ...], OneOrMore] | None = Field(
        default=None, description="shear modulus, above 0; ogden: one for each term"
    )
    alpha: Annotated[tuple[Number, ...], OneOrMore] | None = Field(
        default=None, description="ogden exponents, not 0"
    )
    c10: Pressure | None = Field(default=None, description="mooney_rivlin, yeoh: first constant, above 0")
    c01: Annotated[float, Quantity("pressure", least=0)] | None = Field(
        default=None, description="mooney_rivlin: second constant, at least 0"
    )
    c20: Annotated[float, Quantity("pressure")] | None = Field(
        default=None, description="yeoh: second constant"
    )
    c30: Annotated[float, Quantity("pressure")] | None = Field(
        default=None, description="yeoh: third constant"
    )
    c1: Pressure | None = Field(
        default=None, description="veronda_westmann: psi = c1 (exp(c2 (I1 - 3)) - 1) - ..."
    )
    c2: Annotated[float, Quantity("fraction", above=0)] | None = Field(
        default=None, description="veronda_westmann: exponent, above 0"
    )
    poissons_ratio: Annotated[float, Quantity("fraction", least=0, below=0.5)] = Field(
        default=0.49, description="Poisson's ratio at rest, at least 0 and below 0.5"
    )

    @property
    def shear_modulus(self) -> float:
        """Initial shear modulus, Pa."""
        if self.youngs_modulus is not None:
            return self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))
        if self.mu is not None:
            return math.fsum(self.mu)
        if self.c1 is not None and self.c2 is not None:
            return self.c1 * self.c2
        return 2.0 * ((self.c10 or 0.0) + (self.c01 or 0.0))


LIVER_AT_REST = Material(model="neo_hookean", mu=(1800.0,), poissons_ratio=0.49)
"""Shear modulus of liver, 1.8 +- 0.4 kPa (PMC6925591, Table 1): what a scene without a material gets."""


class Region(Place):
    """[[organ.region]]: an inclusion."""

    name: Identifier = Field(description="an identifier")
    material: Material = Field(description="a material table")


class Capsule(Table):
    """[organ.capsule]: a thin stiff skin."""

    thickness: Length = Field(description="thickness, above 0")
    material: Material = Field(description="a material table")


class Support(Place):
    """[[organ.support]]: what holds the organ."""

    kind: Literal["fixed", "elastic"] = Field(default="fixed", description="fixed | elastic")
    stiffness: Annotated[float, Quantity("pressure per length", above=0)] | None = Field(
        default=None, description="of an elastic support, per area, above 0"
    )


class Paint(Table):
    """[organ.paint]: scalars per vertex of the surface file."""

    stiffness_scale: str | None = Field(
        default=None, min_length=1, description="name of the vertex attribute that scales stiffness"
    )
    friction: str | None = Field(
        default=None, min_length=1, description="name of the vertex attribute that is the Coulomb coefficient"
    )
    texture_amplitude: str | None = Field(
        default=None, min_length=1, description="name of the vertex attribute that scales textures, 0 to 1"
    )
    reach: str | None = Field(
        default=None,
        min_length=1,
        description="name of the vertex attribute that is 1 where a tool may touch and 0 where not",
    )


class Organ(Table):
    """[organ]"""

    surface: SurfaceFile = Field(description="a surface file (OBJ, STL, PLY, GLB, ...) or a USD mesh")
    units: Unit | None = Field(
        default=None, description="of the surface file: m (default), cm, mm; USD brings its own"
    )
    repair: Literal["auto", "wrap", "none"] = Field(default="auto", description="auto | wrap | none")
    mesh_size: Length | None = Field(
        default=None,
        description="target edge of the organ-wide tetrahedra; 1/32 of the organ's diagonal when absent",
    )
    material: Material = Field(
        default=LIVER_AT_REST, description="a material table; liver at rest when absent"
    )
    region: tuple[Region, ...] = Field(default=(), description="inclusions")
    capsule: Capsule | None = Field(default=None, description="a thin stiff skin")
    support: tuple[Support, ...] = Field(min_length=1, description="at least one place that holds the organ")
    paint: Paint | None = Field(default=None, description="scalars per vertex of the surface file")

    @property
    def metres_per_unit(self) -> float:
        """Length of one unit of the surface file, m."""
        return {"m": 1.0, "cm": 1e-2, "mm": 1e-3}[self.units or "m"]


class Reach(Place):
    """[reach]: the surface that a tool can touch, everything when no place is given."""

    depth_max: Length | None = Field(
        default=None, description="deepest press, above 0; the tool's smallest radius when absent"
    )


class Tool(Table):
    """[[tool]]"""

    name: Identifier = Field(description="an identifier, not used twice")
    shape: Literal["sphere", "flat_punch", "cylinder", "cone", "capsule", "mesh"] = Field(
        description="sphere flat_punch cylinder cone capsule mesh"
    )
    radius: Annotated[tuple[Length, ...], OneOrMore] | None = Field(
        default=None, description="above 0; several radii of a sphere make a family"
    )
    edge_radius: Length | None = Field(
        default=None, description="rounding of a flat punch's edge or a cone's tip, above 0"
    )
    half_angle: Annotated[float, Quantity("angle", above=0, below=math.pi / 2)] | None = Field(
        default=None, description="of a cone, between axis and flank, above 0 and below 90 deg"
    )
    length: Length | None = Field(default=None, description="of a cylinder or capsule, above 0")
    surface: SurfaceFile | None = Field(default=None, description="surface file of a mesh tool")
    units: Unit | None = Field(default=None, description="of the tool's surface file: m (default), cm, mm")
    tip: Point | None = Field(default=None, description="the tool point, in the tool's frame, m")
    axis: Direction | None = Field(default=None, description="points out of the tissue, in the tool's frame")
    tilt: (
        Annotated[
            tuple[Annotated[float, Quantity("angle", above=-math.pi / 2, below=math.pi / 2)], ...], OneOrMore
        ]
        | None
    ) = Field(
        default=None,
        description="ways of touching: one, or several of a round tool from 0 deg on, below 90 deg",
    )
    friction: Annotated[float, Quantity("fraction", least=0, most=2)] | None = Field(
        default=None, description="Coulomb coefficient between tool and tissue, 0 to 2"
    )
    transient: Transient | None = Field(default=None, description="what its contacts play: a table")

    def shape_digest(self) -> str:
        """Hex SHA-256 of the tool's geometry alone; the name, friction, tilt and transient do not enter."""
        inputs = self.hash_inputs()
        return digest(
            {key: value for key, value in inputs.items() if key not in ("friction", "tilt", "transient")}
        )


def _knots(value: object) -> Any:
    if value == "auto" or (isinstance(value, int) and not isinstance(value, bool) and 4 <= value <= 64):
        return value
    raise refused("is no knot count", '"auto" or a whole number from 4 to 64')


class Accuracy(Table):
    """[accuracy]"""

    force_tolerance: Annotated[float, Quantity("fraction", least=0.001, most=0.5)] = Field(
        default=0.035, description="of held-out force at the 95th percentile, 0.1 % to 50 %"
    )
    response: Literal["potential", "axial"] = Field(default="potential", description="potential | axial")
    fidelity: Literal["linear", "near_field", "full"] = Field(
        default="near_field", description="linear | near_field | full"
    )
    time_budget: Annotated[float, Quantity("time", above=0)] | None = Field(
        default=None, description="the best field that this buys, above 0"
    )
    nodes: Annotated[int, Strict(), Field(ge=3, le=100_000)] | None = Field(
        default=None,
        description="so many nodes, from 3; when absent, as many as errors ask for (author/effort.py)",
    )
    patch_radius: Length | None = Field(
        default=None,
        description="of the tissue that is meshed anew around a contact, at least 3.5 contact radii; 20 mm when absent",
    )
    patch_refinement: Annotated[float, Quantity("fraction", least=0.25, most=4)] | None = Field(
        default=None, description="divides the edges of those tetrahedra, 0.25 to 4; 1 when absent"
    )
    held_out: Annotated[int, Strict(), Field(ge=1, le=100_000)] = Field(
        default=40, description="fresh presses that judge the field and never build it: a whole number from 1"
    )
    seed: Annotated[int, Strict(), Field(ge=0)] = Field(default=1, description="a whole number from 0")
    knots: Annotated[
        int | Literal["auto"],
        BeforeValidator(_knots),
        WithJsonSchema({"anyOf": [{"const": "auto"}, {"type": "integer", "minimum": 4, "maximum": 64}]}),
    ] = Field(default="auto", description='"auto" or a count from 4 to 64')


class Device(Table):
    """[device]: a profile by name, or the numbers themselves."""

    profile: str | None = Field(default=None, min_length=1, description="name of a device")
    damping: Annotated[float, Quantity("damping", least=0)] | None = Field(
        default=None, description="viscous, at least 0"
    )
    friction: Annotated[float, Quantity("force", least=0)] | None = Field(
        default=None, description="Coulomb, at least 0"
    )
    resolution: Length | None = Field(default=None, description="of position, above 0")
    max_force: Annotated[float, Quantity("force", above=0)] | None = Field(
        default=None, description="above 0"
    )
    rate: Annotated[float, Quantity("frequency", above=0)] = Field(
        default=1000.0, description="of the servo loop, above 0"
    )
    force_resolution: Annotated[float, Quantity("force", least=0)] | None = Field(
        default=None, description="smallest force that it gives, for textures; at least 0"
    )
    stiffness_max: Annotated[float, Quantity("stiffness", above=0)] | None = Field(
        default=None, description="largest that it can hold, for textures; above 0"
    )
    structural_frequency: Annotated[float, Quantity("frequency", above=0)] | None = Field(
        default=None, description="of its first mode, for textures; above 0"
    )
    time_factor: Factor | None = Field(
        default=None, description="ticks within a wavelength of a texture at least, 1 or more; 2 when absent"
    )
    space_factor: Factor | None = Field(
        default=None, description="resolutions within a wavelength at least, 1 or more; 2 when absent"
    )
    force_factor: Factor | None = Field(
        default=None,
        description="a texture's force over force_resolution at least, 1 or more; 10 when absent",
    )
