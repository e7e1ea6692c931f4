# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a user can turn between speed and accuracy, and which values a sweep tries.

Fidelity, organ mesh size, patch radius and patch refinement change what is pressed (`Pressing`).  Node count, knot
count, response and float width change what is made of the presses (`Setting`), so their rows press nothing anew.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from typing import Any

from palpate.author.scene import Scene

__all__ = [
    "NOT_SWEPT",
    "Pressing",
    "Setting",
    "changed",
    "node_counts",
    "pressings",
    "scene_s_pressing",
    "scene_with",
    "setting_of",
    "settings_of",
]

PATCH_RADIUS = 20e-3
"""m; the mechanics' own (fem_offline/site.py)."""
NODES_AT_LEAST = 4
COUNT_STEPS = (1 / 3, 0.5, 1 / math.sqrt(2.0), 1.0, math.sqrt(2.0))
"""Node counts over what the scene's reach and tolerance ask for."""
KNOT_COUNTS = (5, 13, 25)
"""Beside the scene's own, which "auto" takes from the presses."""
MESH_STEPS = (1.5,)
RADIUS_STEPS = (0.7, 1.4)
REFINEMENT_STEPS = (0.7,)
"""Meshes are tried coarser only: held-out presses are as fine as the scene asks, and do not tell what is finer yet."""
FIDELITIES = ("linear", "near_field", "full")
NOT_SWEPT = {
    "tilt": "one way of touching at a time is weighed: the tool upright, or at the one tilt that the scene names",
}


@dataclass(frozen=True)
class Pressing:
    """How nodes are pressed: fidelity, and edges and radius in m; refinement divides the edges around the contact."""

    fidelity: str
    mesh_size: float
    patch_radius: float
    patch_refinement: float

    @property
    def name(self) -> str:
        """Names a folder."""
        return (
            f"{self.fidelity}-mesh{1e3 * self.mesh_size:.4g}mm-patch{1e3 * self.patch_radius:.4g}mm"
            f"-x{self.patch_refinement:.3g}"
        )


@dataclass(frozen=True)
class Setting:
    """One row: how it is pressed, how many nodes and knots, which response, how many bits an amplitude has."""

    pressing: Pressing
    nodes: int
    knots: int | str = "auto"
    response: str = "potential"
    float_bits: int = 32

    @property
    def offered(self) -> bool:
        """Whether `palpate author` makes it and the runtime renders it."""
        return self.response == "potential" and self.float_bits == 32

    def as_json(self) -> dict[str, Any]:
        own = asdict(self)
        return {**own.pop("pressing"), **own}


def setting_of(values: dict[str, Any]) -> Setting:
    """The setting whose `as_json` is `values`."""
    pressing = Pressing(**{name: values[name] for name in Pressing.__dataclass_fields__})
    own = {name: values[name] for name in Setting.__dataclass_fields__ if name != "pressing"}
    return Setting(pressing, **own)


def changed(setting: Setting, base: Setting) -> list[str]:
    """Knobs at which a setting differs from another."""
    a, b = setting.as_json(), base.as_json()
    return [knob for knob in a if a[knob] != b[knob]]


def scene_s_pressing(scene: Scene, mesh_size: float) -> Pressing:
    """What the scene itself asks for; `mesh_size` (m) is that of the organ's tetrahedra."""
    own = scene.accuracy
    return Pressing(own.fidelity, mesh_size, own.patch_radius or PATCH_RADIUS, own.patch_refinement or 1.0)


def pressings(base: Pressing) -> list[Pressing]:
    """The others that are tried, one knob turned at a time, cheapest first."""
    coarser = [replace(base, mesh_size=step * base.mesh_size) for step in MESH_STEPS]
    radii = [replace(base, patch_radius=step * base.patch_radius) for step in RADIUS_STEPS]
    rough = [replace(base, patch_refinement=step * base.patch_refinement) for step in REFINEMENT_STEPS]
    linear, near, full = (replace(base, fidelity=fidelity) for fidelity in FIDELITIES)
    return [one for one in (*rough, linear, *coarser, *radii, near, full) if one != base]


def node_counts(planned: int) -> list[int]:
    """Node counts that are tried, rising, where a plan says `planned`."""
    return sorted({max(NODES_AT_LEAST, round(step * planned)) for step in COUNT_STEPS})


def settings_of(pressing: Pressing, counts: list[int], base: Setting) -> list[Setting]:
    """Rows of one pressing at `counts` nodes; of the scene's own also knots, response and float widths in turn."""
    rows = [replace(base, pressing=pressing, nodes=count) for count in counts]
    if pressing == base.pressing and base in rows:
        rows += [replace(base, knots=knots) for knots in KNOT_COUNTS if knots != base.knots]
        rows += [replace(base, response="axial"), *(replace(base, float_bits=bits) for bits in (16, 64))]
    return rows


def scene_with(scene: Scene, setting: Setting) -> Scene:
    """The scene as it would ask for a setting that is `offered`."""
    how = setting.pressing
    own = scene_s_pressing(scene, how.mesh_size)
    accuracy = {"fidelity": how.fidelity, "nodes": setting.nodes, "knots": setting.knots}
    if how.patch_radius != own.patch_radius:
        accuracy["patch_radius"] = how.patch_radius
    if how.patch_refinement != own.patch_refinement:
        accuracy["patch_refinement"] = how.patch_refinement
    return scene.model_copy(
        update={
            "accuracy": scene.accuracy.model_copy(update=accuracy),
            "organ": scene.organ.model_copy(update={"mesh_size": how.mesh_size}),
        }
    )
