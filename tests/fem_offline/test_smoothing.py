# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
import trimesh

from palpate.fem_offline.smoothing import dihedral_angles, faired, solid_volume


@pytest.fixture(scope="module")
def rough_ball() -> tuple[np.ndarray, np.ndarray]:
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.03)
    noise = np.random.default_rng(1).normal(scale=1e-4, size=len(ball.vertices))
    return ball.vertices * (1.0 + noise / 0.03)[:, None], np.array(ball.faces)


def test_smoothing_takes_roughness_off_and_keeps_volume_and_limit(rough_ball):
    vertices, triangles = rough_ball
    smooth, passes = faired(vertices, triangles, limit=3e-4, target=5.5)
    before, after = dihedral_angles(vertices, triangles), dihedral_angles(smooth, triangles)
    assert passes > 0
    assert np.percentile(after, 95) < 0.6 * np.percentile(before, 95)
    assert np.linalg.norm(smooth - vertices, axis=1).max() <= 3e-4 * (1 + 1e-12)
    assert solid_volume(smooth, triangles) == pytest.approx(solid_volume(vertices, triangles), rel=1e-4)


def test_smooth_surface_is_left_alone():
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.03)
    smooth, passes = faired(ball.vertices, ball.faces, limit=1e-3, target=8.0)
    assert passes == 0 and np.array_equal(smooth, ball.vertices)


def test_dihedral_angles_of_a_cube_are_flat_or_right():
    box = trimesh.creation.box()
    angles = np.sort(dihedral_angles(box.vertices, box.faces))
    assert np.allclose(angles, [0.0] * 6 + [90.0] * 12, atol=1e-5)
