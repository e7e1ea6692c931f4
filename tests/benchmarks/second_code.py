# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A press in palpate and in CalculiX, on the same quadratic tetrahedra, at the same depths, one thread each.

A sphere of 5 mm on neo-Hookean blocks on their base, and the scene's tool on its organ where they are a sphere and
neo-Hookean.  The small block is refined all over, as palpate refines a patch: both codes solve all of it, nonlinear.
The large one and the organ are refined around the contact alone, the mesh of a full press: CalculiX solves all of it,
palpate's near field has it linear and condensed outside the patch.

Counted, in CPU seconds: palpate's ladder (its sticking stiffness at every second depth included), once the mesh and the
far field are there; CalculiX' whole process (deck read, presses, forces written) with its package's solver (SPOOLES).
Set-up and the far field's one-off part of palpate stand beside it.
"""

from __future__ import annotations

import hashlib
import resource
import shutil
import time
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from measured import Measured
from setting import Setting

from palpate.author.organ_stage import OrganMesh
from palpate.author.press_executor import press_executor
from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.press import press
from palpate.fem_offline.site import Site, open_site, patch_size
from palpate.fem_offline.tool import Sphere
from palpate.fem_offline.verification.blocks import block_organ
from palpate.fem_offline.verification.calculix import run_calculix
from palpate.fem_offline.verification.calculix_press import SolidPress, forces_of, solid_deck

__all__ = ["calculix"]

TISSUE = NeoHookean(5400.0, 0.48)
BALL = Sphere(5e-3)


@dataclass(frozen=True)
class Block:
    """Its size, m, its cells, and the patch's radius, m: none, the usual one."""

    name: str
    size: tuple[float, float, float]
    cells: tuple[int, int, int]
    patch_radius: float | None
    radius: float = BALL.radius

    @property
    def key(self) -> Any:
        return asdict(self)

    def site(self, deepest: float, fidelity: str, refinement: float = 1.0) -> Site:
        organ = block_organ(self.size, self.cells, {0: TISSUE})
        chosen = {"radius": self.patch_radius} if self.patch_radius else {}
        size = patch_size(BALL, deepest, refinement=refinement, **chosen)
        return open_site(organ, np.zeros(3), BALL, size, fidelity)


@dataclass(frozen=True)
class OnOrgan:
    """The scene's organ (neo-Hookean, no capsule), a contact (m) and a sphere's radius (m)."""

    mesh: OrganMesh
    contact: tuple[float, float, float]
    radius: float

    @property
    def name(self) -> str:
        return f"the scene's organ of {len(self.mesh.tets)} tetrahedra"

    @property
    def key(self) -> Any:
        return [self.mesh.hash, self.contact, self.radius]

    def site(self, deepest: float, fidelity: str, refinement: float = 1.0) -> Site:
        ball = Sphere(self.radius)
        size = patch_size(ball, deepest, refinement=refinement)
        return open_site(self.mesh.organ, np.array(self.contact), ball, size, fidelity)


BLOCKS = (
    Block("block of 60 x 60 x 30 mm, all nonlinear", (0.06, 0.06, 0.03), (8, 8, 4), 1.0),
    Block("block of 120 x 120 x 60 mm, near field", (0.12, 0.12, 0.06), (12, 12, 6), None),
)
SECONDS_MAX = 3600.0


def calculix(setting: Setting, deepest: float = 0.5, count: int = 5) -> list[Measured]:
    """Rows; depths: `count`, evenly spaced, to `deepest` (in sphere radii)."""
    if shutil.which("ccx") is None:
        return [Measured("calculix", "CalculiX is not installed", float("nan"), "-", "at least 50")]
    rows = []
    for chosen in (*BLOCKS, *_on_organ(setting)):
        depths = tuple(map(float, chosen.radius * deepest * np.arange(1, count + 1) / count))
        found = setting.kept(
            "calculix",
            [chosen.key, depths],
            lambda chosen=chosen, depths=depths: _both(setting, chosen, depths),
        )
        rows += _rows(chosen, found, f"{count} depths to {deepest:g} R")
    return rows


def _on_organ(setting: Setting) -> list[OnOrgan]:
    """The setting's organ, where CalculiX' deck can say what it and its tool are."""
    mesh, tool = setting.mesh, setting.tool
    organ = mesh.organ
    plain = all(isinstance(m, NeoHookean) for m in organ.material.values()) and len(organ.material) == 1
    if not plain or organ.capsule or organ.elastic or tool.shape != "sphere":
        return []
    contact = tuple(map(float, setting.contacts[0]))
    return [OnOrgan(mesh, contact, dict(tool.parameters)["radius"])]


def _both(setting: Setting, chosen: Block | OnOrgan, depths: tuple[float, ...]) -> dict[str, Any]:
    with press_executor(1) as executor:
        executor.submit(press_block, BLOCKS[0], depths[:1], 0.6).result()  # compiles kernels
        ours = executor.submit(press_block, chosen, depths).result()
        setting.say(f"calculix: {chosen.name}, palpate's ladder {ours['ladder']:.1f} CPU s")
        deck, pressed = executor.submit(deck_of, chosen, depths).result()
    key = hashlib.sha256(deck.encode()).hexdigest()
    theirs = setting.store.kept("calculix", key, lambda: ({}, _timed(deck)))[1]
    setting.say(f"calculix: {chosen.name}, CalculiX {theirs['cpu_seconds']:.0f} CPU s")
    force = forces_of(pressed, theirs["dat"]) @ pressed.normal
    unknowns = 3 * (len(pressed.nodes) - len(pressed.held))
    return {
        "ours": ours,
        "theirs": theirs["cpu_seconds"],
        "their_force": force.tolist(),
        "their_unknowns": unknowns,
    }


def _rows(chosen: Block | OnOrgan, found: dict[str, Any], way: str) -> list[Measured]:
    part, ours, theirs = "calculix", found["ours"], found["theirs"]
    count = len(found["their_force"])
    ratio = theirs / ours["ladder"]
    worst = max(abs(a / b - 1.0) for a, b in zip(ours["force"][1:], found["their_force"], strict=True))
    text = f"{theirs:.0f} CPU s, {theirs / count:.0f} a depth, {found['their_unknowns']} unknowns"
    mine = f"{ours['ladder']:.1f} CPU s, {ours['ladder'] / count:.2f} a depth, {ours['unknowns']} unknowns"
    return [
        Measured(part, f"CalculiX, {chosen.name}: {way}", theirs, text),
        Measured(part, f"palpate, {chosen.name}: ladder of {way}", ours["ladder"], mine),
        Measured(
            part,
            f"palpate, {chosen.name}: mesh, one-off part and set-up",
            ours["set_up"],
            f"{ours['set_up']:.1f} CPU s",
        ),
        Measured(
            part,
            f"CalculiX over palpate's ladder, {chosen.name}",
            ratio,
            f"{ratio:.0f}",
            "at least 50",
            found,
        ),
        Measured(
            part, f"force against CalculiX, worst of all depths, {chosen.name}", worst, f"{100 * worst:.1f} %"
        ),
    ]


def press_block(
    chosen: Block | OnOrgan, depths: tuple[float, ...], refinement: float = 1.0
) -> dict[str, Any]:
    """A near-field press: CPU seconds and forces."""
    begun = time.process_time()
    site = chosen.site(depths[-1], "near_field", refinement)
    opened = time.process_time()
    found = press(site, Sphere(chosen.radius), np.array(depths))
    if not found.converged:
        raise RuntimeError(found.reason)
    estimate = float(found.far_field_error.max())
    return {
        "set_up": opened - begun,
        "ladder": time.process_time() - opened,
        "unknowns": found.unknowns,
        "force": found.force.tolist(),
        "estimate": estimate if np.isfinite(estimate) else None,
    }


def deck_of(chosen: Block | OnOrgan, depths: tuple[float, ...]) -> tuple[str, SolidPress]:
    """CalculiX' deck of the mesh that a full press has."""
    site = chosen.site(depths[-1], "full")
    space = site.body.tissue.space
    held = np.flatnonzero((site.body.equation[: 3 * space.node_count].reshape(-1, 3) < 0).all(axis=1))
    faces = site.surface.faces[:, :3]
    (material,) = chosen.mesh.organ.material.values() if isinstance(chosen, OnOrgan) else (TISSUE,)
    given = SolidPress(
        space.nodes,
        space.elements,
        faces,
        held,
        material,
        site.contact_point,
        site.normal,
        chosen.radius,
        depths,
    )
    return solid_deck(given), given


def _timed(deck: str) -> dict[str, Any]:
    """What CalculiX prints, and the CPU seconds of its process."""
    before = _children()
    dat = run_calculix(deck, SECONDS_MAX)
    return {"dat": dat, "cpu_seconds": _children() - before}


def _children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
