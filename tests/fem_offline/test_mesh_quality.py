# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline.mesh_quality import QualityLimits, gate, tet_quality

REGULAR = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], float)
TETS = np.array([[0, 1, 2, 3]])


def outward(points: np.ndarray) -> np.ndarray:
    return TETS if tet_quality(points, TETS).volume[0] > 0 else TETS[:, [0, 2, 1, 3]]


def test_regular_tetrahedron_is_perfect():
    quality = tet_quality(REGULAR, outward(REGULAR))
    assert quality.volume[0] == pytest.approx(8.0 / 3.0)
    assert quality.radius_ratio[0] == pytest.approx(1.0)
    assert quality.volume_ratio[0] == pytest.approx(1.0)
    assert quality.dihedral_min[0] == pytest.approx(np.degrees(np.arccos(1.0 / 3.0)))
    assert quality.dihedral_max[0] == pytest.approx(np.degrees(np.arccos(1.0 / 3.0)))


def test_corner_of_a_cube_has_its_known_figures():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    quality = tet_quality(points, TETS)
    inradius = 3.0 * (1.0 / 6.0) / (1.5 + np.sqrt(3.0) / 2.0)
    assert quality.radius_ratio[0] == pytest.approx(3.0 * inradius / (np.sqrt(3.0) / 2.0))
    assert quality.dihedral_max[0] == pytest.approx(90.0)
    assert quality.dihedral_min[0] == pytest.approx(np.degrees(np.arctan(np.sqrt(2.0))))


def test_quality_does_not_depend_on_size_place_or_turning():
    points = np.random.default_rng(1).normal(size=(4, 3))
    tets = outward(points)
    turn = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    here, there = tet_quality(points, tets), tet_quality(1e-3 * points @ turn.T + 5.0, tets)
    for name in ("dihedral_min", "dihedral_max", "radius_ratio", "volume_ratio"):
        assert getattr(there, name)[0] == pytest.approx(getattr(here, name)[0], rel=1e-8)
    assert there.volume[0] == pytest.approx(1e-9 * here.volume[0], rel=1e-8)


def test_gate_names_inverted_elements_and_slivers_and_lets_good_ones_pass():
    good = tet_quality(REGULAR, outward(REGULAR))
    assert gate(good) == []
    inverted = tet_quality(REGULAR, outward(REGULAR)[:, [0, 2, 1, 3]])
    assert any("inverted" in reason for reason in gate(inverted))
    # A sliver: four points near a circle, long edges everywhere, almost no volume.
    sliver = np.array([[1, 0, 0.01], [0, 1, -0.01], [-1, 0, 0.01], [0, -1, -0.01]], float)
    reasons = gate(tet_quality(sliver, outward(sliver)))
    assert any("dihedral_min" in reason for reason in reasons)
    assert any("dihedral_max" in reason for reason in reasons)


def test_limits_are_what_decides():
    good = tet_quality(REGULAR, outward(REGULAR))
    assert gate(good, QualityLimits(dihedral_min=71.0)) == ["1 elements break dihedral_min = 71 (worst 70.5)"]
