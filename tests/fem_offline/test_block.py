# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from scipy.spatial import cKDTree

from palpate.fem_offline.block import block, graded
from palpate.fem_offline.errors import MeshError
from palpate.fem_offline.mesh_quality import tet_quality
from palpate.fem_offline.surface_parts import is_closed


def test_tetrahedra_fill_the_box_once():
    mesh = block((0.08, 0.06, 0.03), (5, 4, 3), focus=(0.01, -0.02, 0.0), finest=0.004)
    volume = tet_quality(mesh.points, mesh.tets).volume
    assert (volume > 0.0).all()
    assert volume.sum() == pytest.approx(0.08 * 0.06 * 0.03, rel=1e-12)
    assert len(mesh.tets) == 5 * 5 * 4 * 3
    assert is_closed(mesh.boundary)
    assert len(mesh.boundary) == 2 * 2 * (5 * 4 + 4 * 3 + 3 * 5)
    assert mesh.points.max(axis=0) == pytest.approx([0.04, 0.03, 0.0], abs=1e-15)


def test_boundary_faces_point_outward():
    mesh = block((0.08, 0.06, 0.03), (4, 4, 2))
    a, b, c = np.moveaxis(mesh.points[mesh.boundary], 1, 0)
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0 == pytest.approx(0.08 * 0.06 * 0.03, rel=1e-12)


def test_even_block_is_its_own_mirror_image():
    mesh = block((0.08, 0.08, 0.04), (6, 6, 3), finest=0.005)
    middles = mesh.points[mesh.tets].mean(axis=1)
    tree = cKDTree(middles)
    for axis in (0, 1):
        mirrored = middles * np.where(np.arange(3) == axis, -1.0, 1.0)
        assert tree.query(mirrored)[0].max() < 1e-12


def test_cubes_give_regular_and_corner_tetrahedra():
    quality = tet_quality(*(lambda m: (m.points, m.tets))(block((1.0, 1.0, 1.0), (2, 2, 2))))
    assert quality.dihedral_max.max() == pytest.approx(90.0, abs=1e-9)
    assert quality.dihedral_min.min() == pytest.approx(np.degrees(np.arccos(1 / np.sqrt(3))), abs=1e-9)
    assert quality.radius_ratio.max() == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("focus", [0.0, 0.3, 0.5, 1.0])
def test_spacing_is_finest_at_the_focus_and_as_asked(focus):
    x = graded(1.0, 40, focus, 0.005)
    spacing = np.diff(x)
    assert x[0] == 0.0 and x[-1] == 1.0 and (spacing > 0.0).all()
    finest = int(np.argmin(spacing))
    assert abs(0.5 * (x[finest] + x[finest + 1]) - focus) < 0.006
    assert spacing[finest] == pytest.approx(0.005, rel=0.02)


def test_impossible_blocks_are_refused():
    with pytest.raises(MeshError, match="no block"):
        block((0.1, 0.1, 0.0), (2, 2, 2))
    with pytest.raises(MeshError, match="does not fit"):
        block((0.1, 0.1, 0.1), (2, 2, 2), finest=0.06)
    with pytest.raises(MeshError, match="does not fit"):
        block((0.1, 0.1, 0.1), (2, 2, 2), focus=(0.2, 0.0, 0.0), finest=0.01)
