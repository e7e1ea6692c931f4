# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What this version can do of what a scene file can ask for.

CAPABILITIES is the one list: a feature that is built is switched on here.  What a scene asks beyond it is
refused by name before any work starts; nothing is ignored.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from palpate.author.deformation_rules import deformation_problems
from palpate.author.errors import InputError
from palpate.author.place import Place
from palpate.author.scene import Scene
from palpate.author.scene_tables import Material, Organ, Tool

__all__ = ["CAPABILITIES", "require_capabilities"]

CAPABILITIES: dict[str, Any] = {
    "effects": ("response", "friction", "texture", "transient", "deformation"),
    "material models": ("linear", "neo_hookean", "mooney_rivlin", "ogden", "yeoh", "veronda_westmann"),
    "smallest Poisson's ratio": 0.0,
    "largest Poisson's ratio": 0.4999,
    "USD organ surfaces": False,
    "regions": True,
    "capsule": True,
    "painted stiffness": True,
    "painted friction": True,
    "painted reach": True,
    "support kinds": ("fixed", "elastic"),
    "tool shapes": ("sphere", "flat_punch", "cylinder", "cone", "capsule", "mesh"),
    "several radii of a tool": ("sphere",),
    "several tilts of a tool": True,
    "most tilts of a tool": 4,
    "depth over tool radius": 1.2,
    "responses": ("potential",),
    "fidelities": ("linear", "near_field", "full"),
    "time budget": True,
    "chosen knots": True,
    "most nodes": 5000,
    "most nodes of a deformation": 4096,
    "device": True,
    "places": ("box", "sphere", "half_space", "surface"),
}

Unsupported = tuple[str, Any, str, str]
"""key, value, what is not there yet, what is supported."""


def require_capabilities(scene: Scene) -> None:
    """Raises InputError with everything that `scene` asks for and this version cannot do."""
    problems = [
        scene.problem(key, value, f"asks for {what}, not yet in this version", supported, "supported:")
        for key, value, what, supported in _unsupported(scene)
    ]
    if problems:
        raise InputError(problems)


def _unsupported(scene: Scene) -> Iterator[Unsupported]:
    for effect in scene.effects:
        yield from _one_of("scene.effects", effect, "effects", "the effect")
    yield from _organ(scene.organ)
    if scene.reach.is_given:
        yield from _place("reach", scene.reach)
    for i, tool in enumerate(scene.tool):
        yield from _tool(f"tool[{i}]", tool, scene)
    yield from _one_of("accuracy.response", scene.accuracy.response, "responses", "the response")
    yield from _one_of("accuracy.fidelity", scene.accuracy.fidelity, "fidelities", "the fidelity")
    if scene.accuracy.time_budget is not None:
        yield from _switch(
            "accuracy.time_budget", scene.accuracy.time_budget, "time budget", "no time_budget"
        )
    nodes, most = scene.accuracy.nodes or 0, CAPABILITIES["most nodes"]
    if nodes > most:
        yield "accuracy.nodes", nodes, f"more than {most} nodes", f"at most {most}"
    elif "deformation" in scene.effects and nodes > (most := CAPABILITIES["most nodes of a deformation"]):
        yield "accuracy.nodes", nodes, f"a deformation of more than {most} nodes", f"at most {most}"
    if scene.accuracy.knots != "auto":
        yield from _switch("accuracy.knots", scene.accuracy.knots, "chosen knots", '"auto"')
    if scene.device is not None:
        yield from _switch("device", None, "device", "a scene without [device]")


def _organ(organ: Organ) -> Iterator[Unsupported]:
    if organ.surface.suffix.lower() in (".usd", ".usda", ".usdc", ".usdz"):
        yield from _switch("organ.surface", organ.surface.name, "USD organ surfaces", "OBJ, STL, PLY, GLB")
    yield from _material("organ.material", organ.material)
    for i, region in enumerate(organ.region):
        yield from _switch(f"organ.region[{i}]", region.name, "regions", "one material")
        if CAPABILITIES["regions"]:
            yield from _place(f"organ.region[{i}]", region)
            yield from _material(f"organ.region[{i}].material", region.material)
    if organ.capsule is not None:
        yield from _switch("organ.capsule", None, "capsule", "an organ without a capsule")
        if CAPABILITIES["capsule"]:
            yield from _material("organ.capsule.material", organ.capsule.material)
    if organ.paint is not None:
        paint = organ.paint
        if paint.stiffness_scale is not None:
            yield from _switch(
                "organ.paint.stiffness_scale", paint.stiffness_scale, "painted stiffness", "one material"
            )
        if paint.friction is not None:
            yield from _switch("organ.paint.friction", paint.friction, "painted friction", "tool.friction")
        if paint.reach is not None:
            yield from _switch("organ.paint.reach", paint.reach, "painted reach", "[reach]")
    for i, support in enumerate(organ.support):
        yield from _place(f"organ.support[{i}]", support)
        yield from _one_of(f"organ.support[{i}].kind", support.kind, "support kinds", "the support kind")


def _material(key: str, material: Material) -> Iterator[Unsupported]:
    yield from _one_of(f"{key}.model", material.model, "material models", "the model")
    smallest, largest = CAPABILITIES["smallest Poisson's ratio"], CAPABILITIES["largest Poisson's ratio"]
    if not smallest <= material.poissons_ratio <= largest:
        what = "a Poisson's ratio outside the proven range"
        yield f"{key}.poissons_ratio", material.poissons_ratio, what, f"{smallest} to {largest}"


def _tool(key: str, tool: Tool, scene: Scene) -> Iterator[Unsupported]:
    yield from _one_of(f"{key}.shape", tool.shape, "tool shapes", "the shape")
    if tool.shape not in CAPABILITIES["tool shapes"]:
        return
    if "deformation" in scene.effects:
        yield from deformation_problems(key, tool)
    families = CAPABILITIES["several radii of a tool"] or ()
    if tool.radius is not None and len(tool.radius) > 1 and tool.shape not in families:
        supported = "one radius" + (f", or several of a {', '.join(families)}" if families else "")
        yield f"{key}.radius", list(tool.radius), f"several radii of a {tool.shape}", supported
    if tool.tilt is not None and len(tool.tilt) > 1:
        yield from _switch(f"{key}.tilt", list(tool.tilt), "several tilts of a tool", "one tilt")
        most = CAPABILITIES["most tilts of a tool"]
        if len(tool.tilt) > most:
            yield f"{key}.tilt", list(tool.tilt), f"{len(tool.tilt)} tilts of a tool", f"at most {most}"
    if tool.radius:
        ratio = CAPABILITIES["depth over tool radius"]
        limit = ratio * max(tool.radius)  # of several radii each presses to its own share
        if scene.depth_max(tool) > limit * (1.0 + 1e-9):
            which = "largest radius" if len(tool.radius) > 1 else "radius"
            what = f'presses deeper than {ratio:g} x the {which} of tool "{tool.name}"'
            yield "reach.depth_max", scene.depth_max(tool), what, f"at most {limit:g} m"


def _place(key: str, place: Place) -> Iterator[Unsupported]:
    for kind in ("box", "sphere", "half_space", "surface"):
        if getattr(place, kind) is not None and kind not in CAPABILITIES["places"]:
            yield f"{key}.{kind}", None, f'the place "{kind}"', ", ".join(CAPABILITIES["places"])


def _one_of(key: str, value: str, capability: str, noun: str) -> Iterator[Unsupported]:
    if value not in CAPABILITIES[capability]:
        yield key, value, f'{noun} "{value}"', ", ".join(CAPABILITIES[capability])


def _switch(key: str, value: Any, capability: str, instead: str) -> Iterator[Unsupported]:
    if not CAPABILITIES[capability]:
        yield key, value, capability, instead
