# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline.tool import Pose, Sphere


def test_distance_normal_and_curvature_of_a_sphere():
    sphere, centre = Sphere(0.005), np.array([0.01, -0.02, 0.03])
    points = centre + np.random.default_rng(0).uniform(-0.01, 0.01, (20, 3))
    found = sphere.distance(points, Pose.upright(centre))
    assert found.gap == pytest.approx(np.linalg.norm(points - centre, axis=1) - 0.005)
    h = 1e-6
    for k, e in enumerate(np.eye(3)):
        ahead, behind = (sphere.distance(points + s * h * e, Pose.upright(centre)) for s in (1, -1))
        assert (ahead.gap - behind.gap) / (2 * h) == pytest.approx(found.normal[:, k], abs=1e-7)
        slope = (ahead.normal - behind.normal) / (2 * h)
        assert slope == pytest.approx(found.curvature[:, :, k], abs=1e-6 * np.abs(found.curvature).max())


def test_hash_follows_shape_and_nothing_else():
    assert Sphere(0.005).hash() == Sphere(0.005).hash() != Sphere(0.0050001).hash()


@pytest.mark.parametrize("radius", [0.0, -1.0, np.nan])
def test_impossible_spheres_are_refused(radius):
    with pytest.raises(ValueError, match="positive"):
        Sphere(radius)
