# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What holds between the keys of a scene file, without looking at any mesh.

Each rule looks at tables that were read well and yields (key, value, what, expected) for what breaks it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from palpate.author.place import Place
from palpate.author.scene_tables import Accuracy, Device, Material, Organ, Reach, SceneHead, Tool
from palpate.author.texture.texture_rules import textures
from palpate.author.transients.transient_rules import transients

__all__ = ["Broken", "broken_rules"]

Broken = tuple[str, Any, str, str]
"""key, value, what, expected."""

DEPTH_OVER_RADIUS = 10.0
"""Deepest press in radii of a round tool that is still believed; beyond it a unit is wrong somewhere."""

_MATERIAL_KEYS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "linear": ((), ()),
    "neo_hookean": ((), ()),
    "mooney_rivlin": (("c10", "c01"), ()),
    "ogden": (("mu", "alpha"), ()),
    "yeoh": (("c10",), ("c20", "c30")),
    "veronda_westmann": (("c1", "c2"), ()),
}
"""Model: keys it needs, further keys it may have; linear and neo_hookean need youngs_modulus or mu."""
_CONSTANTS = ("youngs_modulus", "mu", "alpha", "c10", "c01", "c20", "c30", "c1", "c2")

_SHAPE_KEYS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "sphere": (("radius",), ()),
    "flat_punch": (("radius",), ("edge_radius", "tip", "axis", "tilt")),
    "cylinder": (("radius", "length"), ("tip", "axis", "tilt")),
    "cone": (("half_angle",), ("edge_radius", "tip", "axis", "tilt")),
    "capsule": (("radius", "length"), ("tip", "axis", "tilt")),
    "mesh": (("surface", "tip", "axis"), ("units", "tilt")),
}
"""Shape: keys it needs, further keys it may have."""
_SHAPE_PARAMETERS = (
    "radius",
    "edge_radius",
    "half_angle",
    "length",
    "surface",
    "units",
    "tip",
    "axis",
    "tilt",
)


def broken_rules(tables: Mapping[str, Any]) -> Iterator[Broken]:
    """`tables`: those of scene, organ, reach, accuracy, device that could be read; tool: {index: Tool},
    texture: {index: Texture}."""
    head: SceneHead | None = tables.get("scene")
    organ: Organ | None = tables.get("organ")
    reach: Reach | None = tables.get("reach")
    device: Device | None = tables.get("device")
    tools: Mapping[int, Tool] = tables.get("tool", {})
    if head is not None and "response" not in head.effects:
        yield (
            "scene.effects",
            list(head.effects),
            "leaves out the response that the others need",
            '"response"',
        )
    painted = organ.paint.friction if organ is not None and organ.paint is not None else None
    if organ is not None:
        yield from _organ(organ)
    if painted is not None:
        yield from _painted_friction(painted, head, tools)
    if reach is not None:
        yield from _one_place("reach", reach, needed=False)
    yield from _tools(tools, head, reach, painted is not None)
    yield from transients(tools, head, device)
    yield from textures(tables.get("texture", {}), head, organ, device)
    if isinstance(tables.get("accuracy"), Accuracy):
        yield from _accuracy(tables["accuracy"])
    if device is not None:
        yield from _device(device)


def _organ(organ: Organ) -> Iterator[Broken]:
    if organ.units is not None and organ.surface.suffix.lower() in (".usd", ".usda", ".usdc", ".usdz"):
        yield "organ.units", organ.units, "contradicts the USD stage, which brings its own units", "no units"
    yield from _material("organ.material", organ.material)
    if organ.capsule is not None:
        yield from _material("organ.capsule.material", organ.capsule.material)
    names: dict[str, int] = {}
    for i, region in enumerate(organ.region):
        key = f"organ.region[{i}]"
        yield from _one_place(key, region)
        yield from _material(f"{key}.material", region.material)
        if region.name in names:
            first = names[region.name]
            yield f"{key}.name", region.name, f"is taken by organ.region[{first}]", "a name of its own"
        names.setdefault(region.name, i)
    for i, support in enumerate(organ.support):
        key = f"organ.support[{i}]"
        yield from _one_place(key, support)
        if support.kind == "elastic" and support.stiffness is None:
            yield f"{key}.stiffness", None, "is missing", 'the stiffness of the support, such as "2 kPa/mm"'
        if support.kind == "fixed" and support.stiffness is not None:
            yield f"{key}.stiffness", support.stiffness, "is not used by a fixed support", 'kind = "elastic"'
    if organ.paint is not None and not organ.paint.model_dump(exclude_none=True):
        yield "organ.paint", None, "paints nothing", "stiffness_scale, friction or reach"


def _one_place(key: str, place: Place, needed: bool = True) -> Iterator[Broken]:
    given = [name for name in ("box", "sphere", "half_space", "surface") if getattr(place, name) is not None]
    if len(given) > 1:
        yield key, " and ".join(given), "gives more than one place", "one of box, sphere, half_space, surface"
    if needed and not given:
        yield key, None, "gives no place", "one of box, sphere, half_space, surface"


def _material(key: str, material: Material) -> Iterator[Broken]:
    needed, optional = _MATERIAL_KEYS[material.model]
    allowed = {*needed, *optional}
    if not needed:
        allowed |= {"youngs_modulus", "mu"}
        given = [name for name in ("youngs_modulus", "mu") if getattr(material, name) is not None]
        if len(given) != 1:
            what = "gives no stiffness" if not given else "gives the stiffness twice"
            yield key, None, what, f"either youngs_modulus or mu for {material.model}"
        if material.mu is not None and len(material.mu) > 1:
            yield (
                f"{key}.mu",
                list(material.mu),
                f"has more than one term for {material.model}",
                "one shear modulus",
            )
    for name in needed:
        if getattr(material, name) is None:
            yield f"{key}.{name}", None, "is missing", f"{name} of {material.model}"
    for name in _CONSTANTS:
        if getattr(material, name) is not None and name not in allowed:
            yield (
                f"{key}.{name}",
                getattr(material, name),
                f"is not used by {material.model}",
                f"only {', '.join(sorted(allowed))} and poissons_ratio",
            )
    if material.model == "ogden" and material.mu is not None and material.alpha is not None:
        if len(material.mu) != len(material.alpha):
            yield (
                f"{key}.alpha",
                list(material.alpha),
                "has not one exponent for each mu",
                f"{len(material.mu)} numbers",
            )
        if any(alpha == 0 for alpha in material.alpha):
            yield f"{key}.alpha", list(material.alpha), "has a zero exponent", "numbers that are not 0"


def _tools(
    tools: Mapping[int, Tool], head: SceneHead | None, reach: Reach | None, painted: bool
) -> Iterator[Broken]:
    """`painted`: the organ's paint gives the friction."""
    names: dict[str, int] = {}
    for i, tool in tools.items():
        key = f"tool[{i}]"
        if tool.name in names:
            yield f"{key}.name", tool.name, f"is taken by tool[{names[tool.name]}]", "a name of its own"
        names.setdefault(tool.name, i)
        needed, optional = _SHAPE_KEYS[tool.shape]
        for name in needed:
            if getattr(tool, name) is None:
                yield f"{key}.{name}", None, "is missing", f"{name} of a {tool.shape}"
        for name in _SHAPE_PARAMETERS:
            if getattr(tool, name) is not None and name not in needed + optional:
                yield (
                    f"{key}.{name}",
                    getattr(tool, name),
                    f"is not used by a {tool.shape}",
                    "only " + ", ".join(needed + optional),
                )
        if tool.radius is not None and sorted(set(tool.radius)) != list(tool.radius):
            yield (
                f"{key}.radius",
                list(tool.radius),
                "is not a rising list",
                "each radius once, smallest first",
            )
        if tool.tilt is not None and len(tool.tilt) > 1:
            if tool.tilt[0] != 0.0 or sorted(set(tool.tilt)) != list(tool.tilt):
                what = "is not a list of tilts that rises from upright (rad)"
                yield f"{key}.tilt", list(tool.tilt), what, '"0 deg" first, then each tilt once, rising'
        if head is not None and "friction" in head.effects and tool.friction is None and not painted:
            yield (
                f"{key}.friction",
                None,
                "is missing",
                "a Coulomb coefficient, as scene.effects names friction",
            )
        if (
            reach is not None
            and reach.depth_max is not None
            and tool.radius
            and tool.shape in ("sphere", "capsule")
        ):
            limit = DEPTH_OVER_RADIUS * tool.radius[0]
            if reach.depth_max > limit:
                yield (
                    "reach.depth_max",
                    reach.depth_max,
                    f'is more than {DEPTH_OVER_RADIUS:g} radii of tool "{tool.name}" (m)',
                    f"at most {limit:g} m, or another unit",
                )


def _painted_friction(name: str, head: SceneHead | None, tools: Mapping[int, Tool]) -> Iterator[Broken]:
    if head is not None and "friction" not in head.effects:
        yield (
            "organ.paint.friction",
            name,
            "paints what scene.effects leaves out",
            'the effect "friction", or no paint',
        )
    for i, tool in tools.items():
        if tool.friction is not None:
            what = f'contradicts organ.paint.friction, "{name}", which is the coefficient of every tool'
            yield f"tool[{i}].friction", tool.friction, what, "one of the two"


def _accuracy(accuracy: Accuracy) -> Iterator[Broken]:
    if accuracy.time_budget is not None and accuracy.time_budget < 10.0:
        yield "accuracy.time_budget", accuracy.time_budget, "buys no press (s)", "at least 10 s"


def _device(device: Device) -> Iterator[Broken]:
    numbers = [
        name
        for name in ("damping", "friction", "resolution", "max_force")
        if getattr(device, name) is not None
    ]
    if device.profile is not None and numbers:
        yield (
            "device.profile",
            device.profile,
            f"is given beside {', '.join(numbers)}",
            "a profile or the numbers",
        )
    if device.profile is None and len(numbers) < 4:
        yield (
            "device",
            None,
            "does not say which device",
            "profile, or damping, friction, resolution and max_force",
        )
