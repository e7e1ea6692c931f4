# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline.corotation import cayley, corotation
from palpate.fem_offline.far_modes import rigid_motions

RNG = np.random.default_rng(3)
POINTS = RNG.normal(size=(20, 3)) * 0.01 + 0.05
TRACE = np.concatenate([rigid_motions(POINTS), RNG.normal(size=(60, 5))], axis=1)
TURNING = corotation(POINTS, TRACE)
Y = 0.1 * RNG.normal(size=11)


def test_cayley_turns():
    Q, _, _ = cayley(np.array([0.3, -0.5, 0.2]))
    assert pytest.approx(np.eye(3), abs=1e-15) == Q @ Q.T and np.linalg.det(Q) == pytest.approx(1.0)


def test_cayley_s_derivatives_are_differences():
    theta, h = np.array([0.3, -0.5, 0.2]), 1e-5
    _, first, second = cayley(theta)
    for k in range(3):
        step = h * np.eye(3)[k]
        (a, a_k, _), (b, b_k, _) = cayley(theta + step), cayley(theta - step)
        assert first[k] == pytest.approx((a - b) / (2 * h), abs=1e-9)
        assert second[k] == pytest.approx((a_k - b_k) / (2 * h), abs=1e-9)


def test_small_coordinates_move_the_interface_linearly():
    y = 1e-7 * Y
    assert TURNING.displacement(y).ravel() == pytest.approx(TRACE @ y, abs=1e-13)


def test_a_rigid_rotation_stays_rigid():
    """Its linear picture grows by the square of the angle; the interface keeps every distance."""
    y = np.zeros(11)
    y[3:6] = 0.01 * np.array([0.5, -0.3, 0.4])
    x = POINTS + TURNING.displacement(y)
    before = np.linalg.norm(POINTS[:, None] - POINTS[None], axis=2)
    assert np.linalg.norm(x[:, None] - x[None], axis=2) == pytest.approx(before, abs=1e-15)
    assert TURNING.angle(y) > 0.2


def test_slope_and_curvature_are_differences():
    h = 1e-6
    force = RNG.normal(size=(20, 3))
    J = TURNING.slope(Y)
    G = TURNING.curvature(Y, force)
    for k in range(11):
        step = h * np.eye(11)[k]
        slope = (TURNING.displacement(Y + step) - TURNING.displacement(Y - step)).ravel() / (2 * h)
        assert J[:, k] == pytest.approx(slope, abs=1e-8)
        bend = force.ravel() @ (TURNING.slope(Y + step) - TURNING.slope(Y - step)) / (2 * h)
        assert G[k] == pytest.approx(bend, rel=1e-6, abs=1e-6 * np.abs(G).max())


def test_without_turning_it_is_linear():
    straight = corotation(POINTS, TRACE, turning=False)
    assert straight.displacement(Y).ravel() == pytest.approx(TRACE @ Y, abs=1e-15)
    assert straight.slope(Y) == pytest.approx(TRACE, abs=1e-15) and straight.angle(Y) == 0.0


def test_nothing_behind_a_patch_turns_nothing():
    none = corotation(np.zeros((0, 3)), np.zeros((0, 0)))
    assert none.displacement(np.zeros(0)).shape == (0, 3) and none.slope(np.zeros(0)).shape == (0, 0)
    assert none.curvature(np.zeros(0), np.zeros((0, 3))).shape == (0, 0) and none.angle(np.zeros(0)) == 0.0
