# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The deck of a sphere on tetrahedra: CalculiX gets the mesh, the tool, the material and the units that we press."""

import re
import shutil

import numpy as np
import pytest

from palpate.fem_offline.block import block
from palpate.fem_offline.body import patch_space
from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.organ import boundary_faces
from palpate.fem_offline.pose import tangents
from palpate.fem_offline.press import press
from palpate.fem_offline.quadratic_space import quadratic_space
from palpate.fem_offline.site import open_site, patch_size
from palpate.fem_offline.tool import Sphere
from palpate.fem_offline.verification.blocks import block_organ
from palpate.fem_offline.verification.calculix import CalculixError, run_calculix
from palpate.fem_offline.verification.calculix_press import SolidPress, forces_of, solid_deck

TISSUE = NeoHookean(5400.0, 0.48)
RADIUS, BOX = 5e-3, (0.02, 0.02, 0.01)
MIDS = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
"""Corners that nodes 5 to 10 of a C3D10 lie between (CalculiX's manual, ten-node tetrahedral element)."""
SIDES = {1: (0, 1, 2), 2: (0, 3, 1), 3: (1, 3, 2), 4: (2, 3, 0)}
"""Corners of its faces (the manual's list for *DLOAD)."""
BRICK_MIDS = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
"""Corners that nodes 9 to 20 of a C3D20 lie between."""


@pytest.fixture(scope="module")
def pressed() -> SolidPress:
    mesh = block(BOX, (2, 2, 2))
    space = quadratic_space(mesh.points, mesh.tets)
    triangles = boundary_faces(mesh.tets)
    top = triangles[(mesh.points[triangles][..., 2] == 0.0).all(axis=1)]
    low = triangles[(mesh.points[triangles][..., 2] == -BOX[2]).all(axis=1)]
    held = np.unique(space.face_nodes(low))
    centre, normal = np.zeros(3), np.array([0.0, 0.0, 1.0])
    return SolidPress(
        space.nodes, space.elements, top, held, TISSUE, centre, normal, RADIUS, (1e-3, 1.4e-3, 2.5e-3)
    )


def numbers(deck: str, card: str) -> list[float]:
    """All numbers under the card that starts with `card`."""
    text = re.search(rf"^{re.escape(card)}[^\n]*\n((?:[^*][^\n]*\n)+)", deck, re.MULTILINE)[1]
    return [float(x) for x in re.split(r"[,\s]+", text) if x]


def places_of(deck: str) -> np.ndarray:
    rows = np.reshape(numbers(deck, "*NODE"), (-1, 4))
    assert (rows[:, 0] == 1 + np.arange(len(rows))).all()
    return rows[:, 1:]


def elements_of(deck: str, kind: str, nodes: int) -> np.ndarray:
    """Node indices from 0."""
    return np.reshape(numbers(deck, f"*ELEMENT, TYPE={kind}"), (-1, nodes + 1))[:, 1:].astype(int) - 1


def test_tetrahedra_are_positive_in_calculixs_order_and_fill_the_block_in_tool_radii(pressed):
    deck = solid_deck(pressed)
    places, tets = places_of(deck), elements_of(deck, "C3D10", 10)
    assert len(tets) == len(pressed.elements)
    corners = places[tets[:, :4]]
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6.0
    assert volumes.min() > 0.0
    assert volumes.sum() == pytest.approx(np.prod(BOX) / RADIUS**3)
    for k, (a, b) in enumerate(MIDS):
        assert places[tets[:, 4 + k]] == pytest.approx(0.5 * (corners[:, a] + corners[:, b]))


@pytest.mark.parametrize("normal", [(0.0, 0.0, 1.0), (0.6, 0.0, -0.8), (1 / 3, 2 / 3, 2 / 3)])
def test_the_cap_is_a_sphere_that_touches_the_contact_point(pressed, normal):
    n = np.array(normal)
    deck = solid_deck(SolidPress(**{**vars(pressed), "normal": n}), bricks=6)
    places, bricks = places_of(deck), elements_of(deck, "C3D20", 20)
    assert len(bricks) == 36 and bricks.min() == len(pressed.nodes)
    outer = places[np.unique(bricks[:, [4, 5, 6, 7, 12, 13, 14, 15]])]
    assert np.linalg.norm(outer - n, axis=1) == pytest.approx(1.0)
    assert np.linalg.norm(outer, axis=1).min() == pytest.approx(0.0, abs=1e-12)
    assert ((outer @ n) > -1e-12).all()  # nothing of it is in the tissue yet
    assert (outer @ tangents(n).T).max() > 0.8


def test_bricks_are_right_handed_with_their_nodes_in_calculixs_order(pressed):
    deck = solid_deck(pressed, bricks=6)
    x = places_of(deck)[elements_of(deck, "C3D20", 20)]
    for corner, ends in {0: (1, 3, 4), 2: (3, 1, 6), 5: (4, 6, 1), 7: (6, 4, 3)}.items():
        assert np.linalg.det(np.stack([x[:, e] - x[:, corner] for e in ends], axis=1)).min() > 0.0
    for k, (a, b) in enumerate(BRICK_MIDS):
        away = np.linalg.norm(x[:, 8 + k] - 0.5 * (x[:, a] + x[:, b]), axis=1)
        assert (away < 0.12 * np.linalg.norm(x[:, a] - x[:, b], axis=1)).all()


def test_what_may_touch_is_the_top(pressed):
    deck = solid_deck(pressed)
    places, tets = places_of(deck), elements_of(deck, "C3D10", 10)
    text = re.search(r"\*SURFACE, NAME=SOFT\n((?:\d+, S\d\n)+)", deck)[1]
    pairs = [tuple(map(int, line.split(", S"))) for line in text.splitlines()]
    assert len(set(pairs)) == len(pressed.faces)
    area = 0.0
    for element, side in pairs:
        x = places[tets[element - 1, list(SIDES[side])]]
        assert x[:, 2] == pytest.approx(0.0)
        area += 0.5 * np.linalg.norm(np.cross(x[1] - x[0], x[2] - x[0]))
    assert area == pytest.approx(BOX[0] * BOX[1] / RADIUS**2)


def test_material_and_depths_are_in_youngs_moduli_and_radii(pressed):
    deck = solid_deck(pressed, step=0.1)
    c10, d1 = numbers(deck, "*HYPERELASTIC")
    assert 2.0 * c10 * TISSUE.youngs_modulus == pytest.approx(TISSUE.shear_modulus)
    assert 2.0 / d1 * TISSUE.youngs_modulus == pytest.approx(TISSUE.bulk_modulus)
    assert [float(x) for x in re.findall(r"TOOL, 3, 3, (\S+)", deck)] == pytest.approx([-0.2, -0.28, -0.5])
    assert [float(x) for x in re.findall(r"\*STATIC\n(\S+),", deck)] == pytest.approx([0.5, 1.0, 1.0 / 3.0])
    held = places_of(deck)[np.array(numbers(deck, "*NSET, NSET=BASE"), int) - 1]
    assert held[:, 2] == pytest.approx(-BOX[2] / RADIUS) and len(held) == 25


def test_no_number_is_longer_than_calculix_reads(pressed):
    tiny = pressed.nodes + RADIUS * np.array([-1.23456789012345678e-5, 0.0, 0.0])
    deck = solid_deck(SolidPress(**{**vars(pressed), "nodes": tiny}))
    rows = [line for line in deck.splitlines() if not line.startswith("*")]
    assert max(len(text) for row in rows for text in row.split(", ")) <= 20
    assert places_of(deck)[: len(tiny)] == pytest.approx(tiny / RADIUS, rel=1e-11)


def test_forces_come_back_in_newtons_and_all_of_them_have_to(pressed):
    one = " total force (fx,fy,fz) for set BASE and time  0.1E+01\n\n  1.0E-03  0.0E+00  2.0E-02\n\n"
    found = forces_of(pressed, 3 * one)
    assert found == pytest.approx(5400.0 * RADIUS**2 * np.tile([1e-3, 0.0, 2e-2], (3, 1)))
    with pytest.raises(CalculixError, match="2 of 3"):
        forces_of(pressed, 2 * one)


def test_a_face_of_no_tetrahedron_is_refused(pressed):
    stray = SolidPress(**{**vars(pressed), "faces": np.array([[0, 1, len(pressed.nodes) - 1]])})
    with pytest.raises(ValueError, match="no tetrahedron has a side"):
        solid_deck(stray)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("ccx") is None, reason="needs ccx (Debian: calculix-ccx)")
def test_calculix_finds_our_force_on_our_mesh():
    organ, ball, depths = block_organ(BOX, (4, 4, 2), {0: TISSUE}), Sphere(RADIUS), (0.5e-3, 1e-3)
    site = open_site(organ, np.zeros(3), ball, patch_size(ball, depths[-1], radius=1.0, refinement=0.7))
    assert site.patch.carved.all()
    space, held = patch_space(organ, site.patch)
    faces = site.surface.faces[:, :3]
    given = SolidPress(
        space.nodes, space.elements, faces, held, TISSUE, site.contact_point, site.normal, RADIUS, depths
    )
    theirs = forces_of(given, run_calculix(solid_deck(given))) @ site.normal
    assert press(site, ball, np.array(depths)).force[1:] == pytest.approx(theirs, rel=0.03)
