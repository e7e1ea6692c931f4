# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline.revolved import Revolved
from palpate.fem_offline.tool import Capsule, Cone, Cylinder, FlatPunch, Pose, Sphere

R = 5e-3
HOME = Pose.upright(np.zeros(3))


def gap(tool, *points):
    return tool.distance(np.array(points, float), HOME).gap


def test_a_point_profile_is_a_ball():
    points = np.random.default_rng(0).uniform(-0.01, 0.01, (50, 3))
    ball, sphere = Revolved(((0.0, 0.0),), R).distance(points), Sphere(R).distance(points, HOME)
    assert ball.gap == pytest.approx(sphere.gap, abs=1e-16)
    assert ball.normal == pytest.approx(sphere.normal, abs=1e-13)
    assert ball.curvature == pytest.approx(sphere.curvature, rel=1e-12, abs=1e-12 / R)


def test_on_the_axis_derivatives_are_the_limits_from_beside_it():
    """Under a ball both curvatures are 1/r, under a flat face both are 0."""
    for tool, bend in (
        (Capsule(R, 0.02), 1.0 / (R + 1e-3)),
        (FlatPunch(R), 0.0),
        (Cone(0.5, 1e-3), 1.0 / 2e-3),
    ):
        on, beside = (tool.distance(np.array([[x, 0.0, -1e-3]]), HOME) for x in (0.0, 1e-9))
        assert on.normal[0] == pytest.approx([0.0, 0.0, -1.0], abs=1e-12)
        assert on.curvature[0] == pytest.approx(bend * np.diag([1.0, 1.0, 0.0]), abs=1e-9 / R)
        assert on.curvature[0] == pytest.approx(beside.curvature[0], abs=1e-3 / R)


def test_punch_by_hand():
    punch, r = FlatPunch(R, 1e-3), 1e-3
    assert gap(punch, [0, 0, -2e-3], [3e-3, 0, -2e-3]) == pytest.approx(2e-3)
    assert gap(punch, [0, R + 2e-3, 0.02]) == pytest.approx(2e-3)
    assert gap(punch, [R, 0, 0]) == pytest.approx(r * (np.sqrt(2) - 1))


def test_cone_flank_and_tip_by_hand():
    """The flank is a straight line at the half angle whose apex lies r / sin(a) below the ball's centre."""
    a, r = np.radians(30), 1e-3
    cone = Cone(a, r, length=0.04)
    apex = r - r / np.sin(a)
    for s in (3e-3, 8e-3):
        assert gap(cone, [s, 0, apex + s / np.tan(a)]) == pytest.approx(0.0, abs=1e-16)
    assert gap(cone, [0, 0, 0]) == pytest.approx(0.0, abs=1e-16)


def test_needle_goes_over_into_its_shaft():
    needle = Cone(np.radians(15), 0.3e-3, 1.5e-3, 0.04)
    assert gap(needle, [1.5e-3, 0, 0.03], [0, 1.5e-3 + 1e-3, 0.03]) == pytest.approx([0.0, 1e-3], abs=1e-15)


def test_a_cylinder_without_a_flat_end_is_a_capsule():
    points = np.random.default_rng(0).uniform(-0.02, 0.02, (50, 3))
    round_ended, capsule = Cylinder(R, 0.03, R), Capsule(R, 0.02)
    assert round_ended.distance(points, HOME).gap == pytest.approx(
        capsule.distance(points, HOME).gap, abs=1e-16
    )


def test_a_stated_default_rounds_edges_and_tips():
    assert FlatPunch(R).hash() != FlatPunch(R, 0.2 * R).hash()
    assert FlatPunch(R).solid == FlatPunch(R, 0.1 * R).solid
    assert Cone(0.5).tip_radius == 0.5e-3


@pytest.mark.parametrize(
    ("make", "what"),
    [
        (lambda: FlatPunch(-R), "radius"),
        (lambda: FlatPunch(R, 2 * R), "edge_radius"),
        (lambda: Cylinder(R, 0.0), "length"),
        (lambda: Capsule(R, np.inf), "length"),
        (lambda: Cone(np.pi / 2), "half_angle"),
        (lambda: Cone(0.5, 1e-3, 0.5e-3), "shaft_radius"),
        (lambda: Cone(0.1, 1e-3, 50e-3), "does not reach"),
        (lambda: Revolved(((0.0, 0.0), (R, R), (0.5 * R, R), (0.0, 3 * R)), 1e-3), "convex"),
        (lambda: Revolved(((0.0, 0.0), (R, R)), 1e-3), "axis"),
        (lambda: Capsule(R, 0.02, axis=(0.0, 0.0, 0.0)).hash(), "direction"),
    ],
)
def test_impossible_shapes_are_refused(make, what):
    with pytest.raises(ValueError, match=what):
        make()
