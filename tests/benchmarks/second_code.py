# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A press in palpate and in CalculiX, on the very same quadratic tetrahedra, one thread each.

A block of 60 x 60 x 30 mm on its base, neo-Hookean, all of it refined under a sphere of 5 mm as palpate refines a
patch; both codes solve all of it, nonlinear, at the same depths.  Counted: palpate's ladder (its sticking stiffness at
every second depth included), after the mesh is there; CalculiX' whole process (deck read, presses, forces written),
with the solver that its package has by default.  Then the product's own way: a near-field press of the same block with
its usual patch, set-up and ladder.
"""

from __future__ import annotations

import hashlib
import resource
import shutil
import time
from typing import Any

import numpy as np
from measured import Measured
from setting import Setting

from palpate.author.press_executor import press_executor
from palpate.fem_offline.body import patch_space
from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.press import press
from palpate.fem_offline.site import Site, open_site, patch_size
from palpate.fem_offline.tool import Sphere
from palpate.fem_offline.verification.blocks import block_organ
from palpate.fem_offline.verification.calculix import run_calculix
from palpate.fem_offline.verification.calculix_press import SolidPress, forces_of, solid_deck

__all__ = ["calculix"]

TISSUE = NeoHookean(5400.0, 0.48)
SIZE, CELLS = (0.06, 0.06, 0.03), (8, 8, 4)
BALL = Sphere(5e-3)
WHOLE = 1.0
"""m; a patch's radius that leaves nothing outside."""
SECONDS_MAX = 3600.0


def calculix(
    setting: Setting, deepest: float = 0.5, count: int = 5, refinement: float = 1.0
) -> list[Measured]:
    """Rows.

    Args:
        deepest: in sphere radii.
        count: of depths, evenly spaced.
        refinement: divides edge lengths.
    """
    part = "calculix"
    if shutil.which("ccx") is None:
        return [Measured(part, "CalculiX is not installed", float("nan"), "-", "at least 50")]
    depths = tuple(BALL.radius * deepest * np.arange(1, count + 1) / count)

    def make() -> dict[str, Any]:
        with press_executor(1) as executor:
            executor.submit(press_block, depths[:1], WHOLE, 0.6).result()  # compiles kernels
            ours = executor.submit(press_block, depths, WHOLE, refinement).result()
            near = executor.submit(press_block, depths, None, refinement).result()
        setting.say(f"calculix: palpate's ladder {ours['ladder']:.1f} CPU s")
        deck = ours.pop("deck")
        key = hashlib.sha256(deck.encode()).hexdigest()
        theirs = setting.store.kept("calculix", key, lambda: ({}, _timed(deck)))[1]
        force = forces_of(_pressed(depths), theirs["dat"])[:, 2].tolist()
        return {"ours": ours, "near": near, "cpu_seconds": theirs["cpu_seconds"], "force": force}

    found = setting.kept(part, [depths, SIZE, CELLS, refinement], make)
    ours, near, theirs = found["ours"], found["near"], found["cpu_seconds"]
    what = f"{count} depths to {deepest:g} R, {ours['unknowns']} unknowns"
    ratio = theirs / ours["ladder"]
    off = [a / b - 1.0 for a, b in zip(ours["force"][1:], found["force"], strict=False)]
    worst = max(map(abs, off), default=float("nan"))
    usual = near["set_up"] + near["ladder"]
    same, way = "on the same tetrahedra", f"one-off part and set-up included, {near['unknowns']} unknowns"
    spent = f"{near['set_up']:.1f} + {near['ladder']:.1f} CPU s"
    return [
        Measured(part, f"CalculiX, {what}", theirs, f"{theirs:.0f} CPU s, {theirs / count:.0f} a depth"),
        Measured(part, f"palpate's ladder {same}, {what}", ours["ladder"], f"{ours['ladder']:.1f} CPU s"),
        Measured(part, f"CalculiX over palpate's ladder {same}", ratio, f"{ratio:.0f}", "at least 50", found),
        Measured(
            part,
            f"palpate against CalculiX {same}, force, worst of all depths",
            worst,
            f"{100 * worst:.1f} %",
        ),
        Measured(
            part,
            f"CalculiX over a near_field press, {way}",
            theirs / usual,
            f"{theirs / usual:.0f} ({spent})",
        ),
    ]


def press_block(depths: tuple[float, ...], radius: float | None, refinement: float) -> dict[str, Any]:
    """A near-field press into the block: CPU seconds and forces, with CalculiX' deck where the patch is all of it.

    Args:
        radius: m; of the patch; None: the usual one.
    """
    begun = time.process_time()
    organ = block_organ(SIZE, CELLS, {0: TISSUE})
    given = {} if radius is None else {"radius": radius}
    size = patch_size(BALL, depths[-1], refinement=refinement, **given)
    site = open_site(organ, np.zeros(3), BALL, size)
    opened = time.process_time()
    found = press(site, BALL, np.array(depths))
    if not found.converged:
        raise RuntimeError(found.reason)
    done = {
        "set_up": opened - begun,
        "ladder": time.process_time() - opened,
        "unknowns": found.unknowns,
        "tets": len(site.patch.tets),
        "force": found.force.tolist(),
    }
    if site.patch.carved.all():
        done["deck"] = solid_deck(_pressed(depths, site, patch_space(organ, site.patch)))
    return done


def _pressed(depths: tuple[float, ...], site: Site | None = None, space: Any = None) -> SolidPress:
    nothing = np.zeros((0, 3), int)
    nodes, elements, held = (
        (nothing, nothing, nothing) if space is None else (space[0].nodes, space[0].elements, space[1])
    )
    faces = nothing if site is None else site.surface.faces[:, :3]
    return SolidPress(
        nodes, elements, faces, held, TISSUE, np.zeros(3), np.array([0.0, 0.0, 1.0]), BALL.radius, depths
    )


def _timed(deck: str) -> dict[str, Any]:
    """What CalculiX prints, and the CPU seconds of its process."""
    before = _children()
    dat = run_calculix(deck, SECONDS_MAX)
    return {"dat": dat, "cpu_seconds": _children() - before}


def _children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
