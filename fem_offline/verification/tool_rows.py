# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rows about tools other than a ball: punch and cone against Sneddon, and a tilted tool in a turned scene.

Tools have rounded edges and tips, so each is held against Sneddon's integral for its own profile; the note says how far
that is from the sharp tool's closed form.  The cone is blunt (80 degrees): the law is for small strains, and a cone's
do not fall with depth.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.organ import Organ
from palpate.fem_offline.press import PressRecord, press
from palpate.fem_offline.site import open_site, patch_size
from palpate.fem_offline.tool import Cone, FlatPunch, Tool, tangents
from palpate.fem_offline.verification import hertz, sneddon
from palpate.fem_offline.verification.blocks import block_organ, half_space
from palpate.fem_offline.verification.row import Row, against

__all__ = ["tool_rows"]

MATERIAL = NeoHookean(5400.0, 0.48)
PLACE = np.array([1.3e-3, 0.7e-3, 0.0])
COARSE = 0.7
"""Of two meshes the coarser, edges 1 / 0.7 times as long."""
PUNCH = FlatPunch(5e-3)
CONE = Cone(np.radians(80.0), 0.5e-3, length=2e-3)


def tool_rows() -> Iterator[Row]:
    """Turned scene, cone, punch."""
    yield turned_row()
    yield from cone_rows()
    yield from punch_rows()


def punch_rows() -> Iterator[Row]:
    """A flat punch of 5 mm with its default edge, 0.25 mm deep."""
    depth, effective = 0.25e-3, hertz.effective_modulus(MATERIAL.youngs_modulus, MATERIAL.poissons_ratio)
    profile = sneddon.punch_profile(PUNCH.radius, PUNCH.solid.rounding)
    expected = sneddon.profile_force(effective, *profile, depth)
    share = expected / sneddon.punch_force(effective, PUNCH.radius, depth)
    yield from _refined(
        "flat punch", PUNCH, depth, expected, 0.02, f"{share:.3f} of the sharp punch's 2 E* a d"
    )


def cone_rows() -> Iterator[Row]:
    """A cone of 80 degrees with a 0.5 mm tip, 0.8 mm deep."""
    depth, effective = 0.8e-3, hertz.effective_modulus(MATERIAL.youngs_modulus, MATERIAL.poissons_ratio)
    profile = sneddon.cone_profile(CONE.half_angle, CONE.tip_radius, 10e-3)
    expected = sneddon.profile_force(effective, *profile, depth)
    share = expected / sneddon.cone_force(effective, CONE.half_angle, depth)
    yield from _refined(
        "cone", CONE, depth, expected, 0.03, f"{share:.3f} of the sharp cone's 2/pi E* tan(a) d^2"
    )


def _refined(name: str, tool: Tool, depth: float, expected: float, bar: float, note: str) -> Iterator[Row]:
    organ = half_space(MATERIAL)
    force = [_pressed(organ, tool, depth, refinement).force[-1] for refinement in (COARSE, 1.0)]
    note += "; the block's size adds less than a/h = 1 %"
    yield against(name, "Sneddon 1965, its rounded profile", float(force[1]), expected, bar, note)
    coarse, fine = (abs(f / expected - 1.0) for f in force)
    ratio = fine / coarse
    note = f"{coarse:.2%} with edges {1 / COARSE:.2g} times as long, {fine:.2%} with the default ones"
    yield Row(f"{name}: error falls under refinement", "the same press, coarser", ratio, ratio, 1.0, note)


def _pressed(organ: Organ, tool: Tool, depth: float, refinement: float) -> PressRecord:
    size = patch_size(tool, depth, radius=14e-3, refinement=refinement)
    return _converged(press(open_site(organ, PLACE, tool, size), tool, np.array([0.5 * depth, depth])))


def _converged(record: PressRecord) -> PressRecord:
    if not record.converged:
        raise RuntimeError(record.reason)
    return record


def turned_row() -> Row:
    """A punch tilted by 20 degrees: the scene turned as a whole gives force and moment turned, up to the mesh."""
    tool, tilt, depth = FlatPunch(3e-3, 1e-3), np.radians(20.0), 0.8e-3
    upright = block_organ((0.04, 0.04, 0.02), (4, 4, 2), {0: MATERIAL})
    n = np.array([0.36, -0.48, 0.8])
    Q = np.stack([*tangents(n), n], axis=1)  # takes e_z and its tangents to n and its

    def project(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        on, normal = upright.project(points @ Q)
        return on @ Q.T, normal @ Q.T

    turned = replace(
        upright,
        points=upright.points @ Q.T,
        held=lambda x: upright.held(x @ Q),
        project=project,
        hash="turned",
    )
    size = patch_size(tool, depth, radius=8e-3, tilt=tilt)
    found = []
    for organ, place in ((upright, PLACE), (turned, Q @ PLACE)):
        site = open_site(organ, place, tool, size, tilt=tilt)
        record = _converged(press(site, tool, np.array([0.5 * depth, depth])))
        found.append(np.concatenate([record.force_vector[-1], record.moment[-1] / tool.radius]))
    here = np.concatenate([Q @ found[0][:3], Q @ found[0][3:]])
    error = float(np.linalg.norm(found[1] - here) / np.linalg.norm(here))
    name = "force and moment of a tilted punch in a turned scene"
    return Row(name, "the scene as it was, turned afterwards", error, error, 0.01, "two meshes of one size")
