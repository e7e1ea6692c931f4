# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A corner that is sunk into one wall of a reflex edge is met by the other one too."""

import numpy as np
import pytest

from palpate.author.rigid.cook import cooked_rigid
from palpate.author.rigid.law import LUO_XIAO
from palpate.author.rigid.polyhedron import box, polyhedron
from palpate.author.rigid.reflex import past_reflex_edges
from palpate.runtime.rigid import Rigid

EPS, DEEP = LUO_XIAO.threshold, LUO_XIAO.depth_max
BODY = box((0.02, 0.03, 0.04))


def ell(slope=0.0):
    """Extruded L, m: a floor z = 0 for x < 0 and a wall from x = 0 on that leans by `slope`: a reflex edge."""
    outline = np.array([(-0.1, -0.05), (0.1, -0.05), (0.1, 0.1), (0.1 * slope, 0.1), (0, 0), (-0.1, 0)])
    low, high = ([(x, y, z) for x, z in outline] for y in (-0.1, 0.1))
    n, triangles = len(outline), []
    for k in range(n):
        m = (k + 1) % n
        triangles += [(k, n + m, m), (k, n + k, n + m)]
    for a, b, c in ((4, 5, 0), (4, 0, 1), (4, 1, 2), (4, 2, 3)):
        triangles += [(a, b, c), (n + a, n + c, n + b)]
    return polyhedron(np.array(low + high), np.array(triangles))


def spike():
    """A four-sided spike, m; its tip at the origin points to +x and -z, all else of it is above and behind the tip."""
    axis, up = np.array([-1.0, 0, 1]) / np.sqrt(2), np.array([1.0, 0, 1]) / np.sqrt(2)
    sides = [
        0.04 * axis + 0.012 * (c * up + s * np.array([0, 1.0, 0]))
        for c, s in ((1, 0), (0, 1), (-1, 0), (0, -1))
    ]
    triangles = [(0, k, k % 4 + 1) for k in (1, 2, 3, 4)] + [(1, 4, 3), (1, 3, 2)]
    return polyhedron(np.array([np.zeros(3), *sides]), np.array(triangles))


@pytest.mark.parametrize("rises", [-0.5, 0.05, 0.5, 0.9])
@pytest.mark.parametrize("sunk", [0.0, 0.09, 0.11, 0.5, 1.0, 2.0])
def test_the_floor_is_met_however_far_the_wall_is_sunk_into(sunk, rises):
    """The tip `sunk` eps inside the wall and `rises` eps above the floor: a gap to each, by construction."""
    held = spike()
    at = held.centre + np.array([sunk * EPS, 0.0, rises * EPS])
    out = Rigid(cooked_rigid(held, ell(), 0.5)).identify([at], [[0, 0, 0, 1.0]])[0]
    met = out["contact"][: out["contact_count"]]
    up = [c["gap"] for c in met if c["normal"][2] > 0.99]
    aside = [c["gap"] for c in met if c["normal"][0] < -0.99]
    assert up == pytest.approx([rises * EPS], abs=1e-9)
    assert aside == pytest.approx([-sunk * EPS], abs=1e-9)


def test_a_convex_edge_is_no_floor_beyond_it():
    at = np.array(
        [-0.1 - 0.01 - 0.2 * EPS, 0.0, 0.02 + 0.5 * EPS]
    )  # beside the floor's outer rim, 0.2 eps off it
    out = Rigid(cooked_rigid(BODY, ell(), 0.5)).identify([at], [[0, 0, 0, 1.0]])[0]
    assert not any(c["normal"][2] > 0.99 for c in out["contact"][: out["contact_count"]])


@pytest.mark.parametrize("slope", [-0.5, 0.0, 0.5])
def test_a_face_goes_on_as_far_as_a_point_can_be_sunk(slope):
    """Of points up to depth_max deep in the wall and near the floor, none lies beyond the floor's lines, moved."""
    body = ell(slope)
    floor = max(
        (e for e in body.elements if e.kind == "polygon" and e.axis[2] > 0.99),
        key=lambda e: -abs(e.centre[2]),
    )
    lines, grown = past_reflex_edges(floor, DEEP)
    n = np.array([-1.0, slope]) / np.hypot(1.0, slope)  # out of the wall, in x and z
    corner = np.array([(x, z) for z in (-DEEP, DEEP) for x in [(DEEP + n[1] * z) / -n[0]]])
    other = np.cross(floor.axis, floor.across)
    ends = floor.centre + lines.reshape(-1, 2)[:, :1] * floor.across + lines.reshape(-1, 2)[:, 1:] * other
    assert ends[:, 0].max() >= corner[:, 0].max() - 1e-12
    assert ends[:, 0].min() == pytest.approx(-0.1) and np.abs(ends[:, 1]).max() == pytest.approx(0.1)
    assert 0 <= grown < 4 * DEEP
