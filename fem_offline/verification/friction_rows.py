# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rows about Coulomb friction: partial slip in closed form, a press that sticks, drags both ways.

Partial slip begins, as Cattaneo and Mindlin have it, from a press without friction: a ladder whose friction is next to
nothing, and gets its coefficient when it has arrived.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from palpate.fem_offline.dragging import DragRecord, drag
from palpate.fem_offline.ladder import DEFAULT_SETTINGS, Ladder, reaction_error
from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.press import press
from palpate.fem_offline.site import open_site, patch_size
from palpate.fem_offline.tool import Sphere
from palpate.fem_offline.verification import cattaneo_mindlin, hertz
from palpate.fem_offline.verification.blocks import half_space, two_stiffnesses
from palpate.fem_offline.verification.half_space import PLACE, RADIUS
from palpate.fem_offline.verification.row import Row, against

__all__ = ["drag_rows", "no_slip_rows", "partial_slip_rows"]

FRICTION = 0.3
NEXT_TO_NOTHING = 1e-7
TOOL = Sphere(RADIUS)
BESIDE = np.array([2e-3, 0.7e-3, 0.0])
"""m; 8 mm before the border.  From 3 mm the tool left the contact that is solved before its force
was steady."""
AHEAD, ACROSS = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])


def partial_slip_rows(refinement: float = 2.5) -> Iterator[Row]:
    """Force and stick radius on the way to gross slip, and gross slip itself, at d = 0.025 R."""
    material, depth = NeoHookean(5400.0, 0.48), 0.025 * RADIUS
    site = open_site(
        half_space(material), PLACE, TOOL, patch_size(TOOL, depth, radius=14e-3, refinement=refinement)
    )
    ladder = Ladder.above(site, TOOL, DEFAULT_SETTINGS, depth, NEXT_TO_NOTHING)
    found = ladder.go_to(depth)
    ladder.contact.friction = FRICTION
    ladder.contact.commit(found.u)
    a, load = hertz.contact_radius(RADIUS, depth), float(found.contact.force @ site.normal)
    way = cattaneo_mindlin.gross_slip_way(material.shear_modulus, 0.48, a, FRICTION * load)
    home = ladder.contact.pose
    dragged = ladder.turn(lambda way: home.at(home.position + way * AHEAD))
    worst = 0.0
    for share in (0.25, 0.5, 0.75, 1.2):
        found = dragged.go_to(share * way)
        worst = max(worst, reaction_error(site, found, dragged.contact.pose))
        force = -float(found.contact.force @ AHEAD) / (FRICTION * float(found.contact.force @ site.normal))
        law = float(cattaneo_mindlin.tangential_force(share))
        reference = "Cattaneo 1938, Mindlin 1949"
        if share > 1.0:
            yield against("gross slip, Q / (mu P)", "Coulomb", force, 1.0, 0.03)
            continue
        yield against(f"partial slip, Q at {share:g} of the way", reference, force, law, 0.05)
        stuck = np.sqrt(1.0 - dragged.check.sliding)
        expected = float(cattaneo_mindlin.stick_radius(law))
        name = f"partial slip, stick radius at {share:g} of the way"
        yield against(name, reference, stuck, expected, 0.05, "from the share of the pressed area")
    yield Row(
        "action and reaction with friction", "support forces, computed on their own side", worst, worst, 1e-8
    )


def no_slip_rows(poissons_ratio: float = 0.2) -> Iterator[Row]:
    """A press with so much friction that nothing slides against one with next to none, small depths."""
    material, depths = NeoHookean(5400.0, poissons_ratio), RADIUS * np.array([0.02, 0.04])
    site = open_site(half_space(material), PLACE, TOOL, patch_size(TOOL, float(depths[-1]), radius=14e-3))
    forces = []
    for friction in (NEXT_TO_NOTHING, 10.0):
        record = press(site, TOOL, depths, friction=friction)
        if not record.converged:
            raise RuntimeError(record.reason)
        forces.append(record.force[1:])
    ratio = forces[1] / forces[0]
    rest = float(ratio[0] - (ratio[1] - ratio[0]) * depths[0] / (depths[1] - depths[0]))
    expected = cattaneo_mindlin.no_slip_factor(poissons_ratio)
    note = f"extrapolated from {ratio[0]:.4f} and {ratio[1]:.4f} at d = 0.02 and 0.04 R; the law is {expected:.4f}"
    name = f"press without slip over press without friction, nu = {poissons_ratio:g}"
    yield against(name, "Mossakovskii 1954, Spence 1968", rest, expected, 0.005, note)


def drag_rows() -> Iterator[Row]:
    """Both ways on one material and beside a border behind which the block is five times as stiff, d = 0.1 R."""
    soft, stiff = NeoHookean(5400.0, 0.48), NeoHookean(27000.0, 0.48)
    depth = 0.1 * RADIUS
    alike = _dragged(two_stiffnesses(soft, soft, 10e-3), depth, np.stack([AHEAD, ACROSS]))
    beside = _dragged(two_stiffnesses(soft, stiff, 10e-3), depth, AHEAD[None])
    name = "drag both ways, mu_eff / mu"
    note = "a sphere ploughs: its pressure moves forward, by more the deeper it is"
    yield against(name, "Coulomb", float(alike.effective[0, 0]), FRICTION, 0.05, note)
    along, across = alike.effective[0]
    yield against("drag along against across", "the same block, turned", float(along), float(across), 0.01)
    one_way = beside.one_way[0, 0] / alike.effective[0, 0] - 1.0
    note = f"one way alone is off by {one_way[0]:+.1%} and {one_way[1]:+.1%}"
    name = "drag both ways beside a stiff part"
    yield against(name, "the block of one material", float(beside.effective[0, 0]), float(along), 0.02, note)
    paths = alike.paths + beside.paths
    error = max(path.energy_error for path in paths)
    yield Row(
        "work of a drag is energy and dissipation", "trapezoids along the way", 1.0 + error, error, 0.02
    )


def _dragged(organ, depth: float, directions: np.ndarray) -> DragRecord:
    site = open_site(organ, BESIDE, TOOL, patch_size(TOOL, depth))
    record = drag(site, TOOL, [depth], FRICTION, directions)
    if not record.converged:
        raise RuntimeError(record.reason)
    return record
