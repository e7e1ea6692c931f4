# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline import tetwild
from palpate.fem_offline.errors import MeshError
from palpate.fem_offline.mesh_quality import QualityLimits, gate, tet_quality
from palpate.fem_offline.signed_distance import SignedDistance
from palpate.fem_offline.surface import repair_surface
from palpate.fem_offline.surface_parts import is_closed
from palpate.fem_offline.tetrahedra import boundary_triangles, tetrahedralise


@pytest.fixture(scope="module")
def surface(ball):
    return repair_surface([ball], edge=4e-3)


@pytest.fixture(scope="module")
def mesh(surface):
    return tetrahedralise(surface, 8e-3)


def test_tetrahedra_are_positive_and_pass_the_gate(mesh):
    quality = tet_quality(mesh.points, mesh.tets)
    assert (quality.volume > 0.0).all()
    assert gate(quality) == []
    assert mesh.report.quality["dihedral_min"] == pytest.approx(quality.dihedral_min.min())


def test_boundary_is_closed_outward_and_as_near_as_reported(mesh, surface):
    assert is_closed(mesh.boundary)
    a, b, c = np.moveaxis(mesh.points[mesh.boundary], 1, 0)
    enclosed = np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0
    assert enclosed == pytest.approx(tet_quality(mesh.points, mesh.tets).volume.sum(), rel=1e-10)
    assert enclosed == pytest.approx((1.0 + mesh.report.volume_error) * surface.report.volume, rel=1e-10)
    phi = SignedDistance(surface.vertices, surface.triangles)(mesh.points[np.unique(mesh.boundary)])
    assert np.abs(phi).max() <= mesh.report.distance_to_surface < 1.5e-3
    assert abs(mesh.report.volume_error) < 0.05


def test_every_point_is_used_and_no_boundary_face_twice(mesh):
    assert np.array_equal(np.unique(mesh.tets), np.arange(len(mesh.points)))
    assert len(np.unique(np.sort(boundary_triangles(mesh.tets), axis=1), axis=0)) == len(mesh.boundary)


def test_quality_that_is_not_met_is_refused_with_its_reason(surface):
    with pytest.raises(MeshError, match="break dihedral_min = 60"):
        tetrahedralise(surface, 10e-3, limits=QualityLimits(dihedral_min=60.0))
    with pytest.raises(MeshError, match="mm from the surface"):
        tetrahedralise(surface, 10e-3, distance_limit=1e-7)


@pytest.mark.parametrize("mesh_size", [0.0, -1e-3, 0.02])
def test_mesh_size_that_does_not_fit_the_organ_is_refused(surface, mesh_size):
    with pytest.raises(MeshError, match="no mesh size for an organ of 60 mm"):
        tetrahedralise(surface, mesh_size)


def test_meshing_that_takes_too_long_is_stopped(surface):
    with pytest.raises(MeshError, match="needs more than"):
        tetwild.fill(surface.vertices, surface.triangles, 1e-3, 1e-4, time_limit=0.2)


def test_nothing_is_left_in_the_working_folder(surface, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    tetrahedralise(surface, 12e-3)
    assert list(tmp_path.iterdir()) == []
