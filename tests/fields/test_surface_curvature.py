# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Curvature from the contact geometry, and the step from gradients at the tool to gradients on the surface."""

import numpy as np
from known_organ import BALL, CURVED, FLAT, KnownOrgan, geometry_of

from palpate.fields.surface_curvature import foot_points, normal_derivative, shape_operator, tangent_frame

SPHERE = KnownOrgan(BALL)
ORGAN = KnownOrgan(FLAT)


def test_sphere_has_one_over_radius():
    c = SPHERE.cap_points(20, np.random.default_rng(0))
    n = SPHERE.normal(c)
    P = np.eye(3) - n[:, :, None] * n[:, None]
    for s in (0.0, 2e-3, 5e-3):
        q = c + s * n
        np.testing.assert_allclose(normal_derivative(geometry_of(SPHERE), q), P / (BALL[0] + s), atol=0.02)
        np.testing.assert_allclose(shape_operator(geometry_of(SPHERE), q), P / BALL[0], atol=0.02)


def test_ellipsoid_pole_has_its_two_principal_curvatures():
    """Curvature at the pole of semi-axis c along x: c / a^2."""
    a, b, c = FLAT
    W = shape_operator(geometry_of(ORGAN), np.array([[0.0, 0.0, c + 3e-3]]))[0]
    np.testing.assert_allclose(W, np.diag([c / a**2, c / b**2, 0.0]), atol=0.05)


def test_foot_points_are_the_nearest_points():
    c = ORGAN.cap_points(40, np.random.default_rng(1))
    found, normal = foot_points(geometry_of(ORGAN), c + 4e-3 * ORGAN.normal(c))
    np.testing.assert_allclose(found, c, atol=10e-6)
    np.testing.assert_allclose(normal, ORGAN.normal(c), atol=2e-3)


def test_tangent_frames_are_orthonormal():
    n = np.random.default_rng(2).normal(size=(50, 3))
    n = np.concatenate([n / np.linalg.norm(n, axis=1, keepdims=True), np.eye(3), -np.eye(3)])
    frame = np.concatenate([tangent_frame(n), n[:, None]], axis=1)
    np.testing.assert_allclose(
        frame @ frame.swapaxes(1, 2), np.broadcast_to(np.eye(3), frame.shape), atol=1e-12
    )


def test_surface_gradient_is_one_plus_s_W_times_the_gradient_at_the_tool():
    """Against differences of log U between presses at neighbouring surface points; without s W it is wrong."""
    organ = KnownOrgan(CURVED)
    position = organ.cap_points(25, np.random.default_rng(2))
    normal = organ.normal(position)
    frame, h = tangent_frame(normal), 1e-5
    W = shape_operator(geometry_of(organ), position + 2.5e-3 * normal)
    for s in (3.5e-3, 2e-3, 0.0):
        q = position + s * normal

        def log_energy(c: np.ndarray, s: float = s) -> np.ndarray:
            c = organ.foot(c)
            return np.log(organ.energy(c + s * organ.normal(c)))

        truth = np.stack(
            [
                (log_energy(position + h * frame[:, t]) - log_energy(position - h * frame[:, t])) / (2 * h)
                for t in range(2)
            ],
            axis=1,
        )
        steps = [(q + h * e, q - h * e) for e in np.eye(3)]
        b = np.stack([np.log(organ.energy(a) / organ.energy(c)) / (2 * h) for a, c in steps], axis=-1)
        plain = np.einsum("nti,ni->nt", frame, b)
        right = plain + s * np.einsum("nti,nij,nj->nt", frame, W, b)
        size = np.abs(truth).mean()
        assert np.abs(right - truth).mean() < 0.003 * size
        assert np.abs(plain - truth).mean() > 10 * s * size  # 1/m: what leaving out s W costs
