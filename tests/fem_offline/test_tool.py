# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What holds for every rigid tool."""

import numpy as np
import pytest

from palpate.fem_offline.tool import Capsule, Cone, Cylinder, FlatPunch, Pose, Sphere, tangents, tilted

R = 5e-3
TOOLS = {
    "sphere": Sphere(R),
    "punch": FlatPunch(R),
    "punch with a tip of its own": FlatPunch(R, 1e-3, tip=(1e-3, 0.0, 2e-3)),
    "standing cylinder": Cylinder(R, 0.02),
    "lying cylinder": Cylinder(R, 0.02, axis=(1.0, 0.0, 0.0)),
    "slanted cylinder": Cylinder(R, 0.02, axis=(1.0, 2.0, -0.5)),
    "cone": Cone(np.radians(60), 1e-3, length=0.02),
    "needle": Cone(np.radians(15), 0.3e-3, 1.5e-3, 0.04),
    "capsule": Capsule(R, 0.03),
    "upside down capsule": Capsule(R, 0.03, axis=(0.0, 0.0, -1.0)),
}


@pytest.fixture(params=TOOLS.values(), ids=TOOLS.keys())
def tool(request):
    return request.param


@pytest.fixture
def pose():
    return Pose(np.array([0.01, -0.02, 0.03]), tilted(np.array([0.36, -0.48, 0.8]), 0.4))


def around(tool, pose, seed=0):
    """Points from 0.4 mm inside to 3 mm outside, where the gap has two derivatives."""
    random = np.random.default_rng(seed)
    points = pose.position + random.uniform(-0.03, 0.03, (4000, 3))
    gap = tool.distance(points, pose).gap
    return points[(gap > -0.4e-3) & (gap < 3e-3)]


def test_normal_is_the_slope_of_the_gap_and_of_unit_length(tool, pose):
    points, h = around(tool, pose), 1e-7
    found = tool.distance(points, pose)
    assert len(points) > 20
    assert np.linalg.norm(found.normal, axis=1) == pytest.approx(1.0, abs=1e-12)
    for k, e in enumerate(np.eye(3)):
        ahead, behind = (tool.distance(points + s * h * e, pose).gap for s in (1, -1))
        assert np.abs((ahead - behind) / (2 * h) - found.normal[:, k]).max() < 2e-4 * 1e-3 / 0.3e-3
        assert np.median(np.abs((ahead - behind) / (2 * h) - found.normal[:, k])) < 1e-8


def test_curvature_is_the_slope_of_the_normal(tool, pose):
    """Where no border between features (where it jumps) lies within the step: nearly everywhere."""
    points, h = around(tool, pose), 1e-8
    found = tool.distance(points, pose)
    slope = np.empty_like(found.curvature)
    for k, e in enumerate(np.eye(3)):
        ahead, behind = (tool.distance(points + s * h * e, pose).normal for s in (1, -1))
        slope[:, :, k] = (ahead - behind) / (2 * h)
    off = np.abs(slope - found.curvature).max(axis=(1, 2))
    assert np.mean(off < 1e-4 / R) > 0.99
    assert found.curvature == pytest.approx(np.swapaxes(found.curvature, 1, 2), abs=1e-9)


def test_gap_is_the_way_to_the_surface(tool, pose):
    """Going the gap against the normal ends on the surface."""
    points = around(tool, pose)
    found = tool.distance(points, pose)
    foot = points - found.gap[:, None] * found.normal
    assert np.abs(tool.distance(foot, pose).gap).max() < 1e-12


def test_a_tool_turned_with_the_points_sees_the_same(tool, pose):
    points = around(tool, pose)
    found, at_home = tool.distance(points, pose), Pose.upright(np.zeros(3))
    home = tool.distance(pose.into_tool(points), at_home)
    assert home.gap == pytest.approx(found.gap, abs=1e-15)
    assert home.normal @ pose.rotation.T == pytest.approx(found.normal, abs=1e-12)


def test_offset_is_the_distance_to_the_touched_plane(tool):
    """No point of a plane that far away is inside, some point of a plane a little nearer is."""
    random = np.random.default_rng(1)
    for n in random.standard_normal((4, 3)):
        n /= np.linalg.norm(n)
        touched = _gap_over_plane(tool, n, tool.offset_along(-n))
        assert touched == pytest.approx(0.0, abs=2e-6)


def _gap_over_plane(tool, n, offset):
    """Smallest gap of a plane with normal n, `offset` below the reference point, by zooming grids."""
    frame, middle, half = tangents(n), -offset * n, 0.11
    for _ in range(14):
        a = np.linspace(-half, half, 31)
        points = middle + (a[:, None, None] * frame[0] + a[None, :, None] * frame[1]).reshape(-1, 3)
        gap = tool.distance(points, Pose.upright(np.zeros(3))).gap
        middle, half = points[np.argmin(gap)], 0.35 * half
    return gap.min()


@pytest.mark.parametrize("name", [n for n, t in TOOLS.items() if not isinstance(t, Sphere) and t.tip is None])
def test_upright_tools_touch_at_their_tip(name):
    tool = TOOLS[name]
    assert tool.offset_along(np.array([0.0, 0.0, -1.0])) == pytest.approx(0.0, abs=1e-15)
    if tool is TOOLS["slanted cylinder"]:
        return  # it touches with an edge, its tip is beside it on the touching plane
    tip = tool.distance(np.zeros((1, 3)), Pose.upright(np.zeros(3)))
    assert tip.gap[0] == pytest.approx(0.0, abs=1e-15) and tip.normal[0] == pytest.approx([0.0, 0.0, -1.0])


def test_hash_follows_geometry_axis_and_tip_and_nothing_else(tool):
    hashes = {t.hash() for t in TOOLS.values()}
    assert len(hashes) == len(TOOLS)
    assert FlatPunch(R).hash() == FlatPunch(R, axis=(0.0, 0.0, 2.0), tip=(0.0, 0.0, 0.0)).hash()
    assert Sphere(R).hash() != Sphere(R + 1e-9).hash()


def test_contact_grows_with_depth_and_lies_within_its_extent(tool):
    sizes = [tool.contact_size(d) for d in (0.5e-3, 1e-3, 2e-3)]
    assert (np.diff(sizes) >= -1e-12).all() and sizes[0] > 0.0
    assert tool.contact_extent(2e-3) >= sizes[-1]


def test_contact_of_a_capsule_is_hertz():
    """Until it is deep: the section of a ball is a little smaller than Hertz' paraboloid has it."""
    for depth, off in ((0.1 * R, 0.04), (R, 0.16), (2.0 * R, 0.03)):
        assert Capsule(R, 0.03).contact_size(depth) == pytest.approx(Sphere(R).contact_size(depth), rel=off)


def test_contact_of_a_lying_cylinder_is_long():
    lying = Cylinder(R, 0.02, axis=(1.0, 0.0, 0.0))
    assert lying.contact_size(1e-3) == pytest.approx(np.sqrt(R * 1e-3), rel=0.05)
    assert 0.0095 < lying.contact_extent(1e-3) < 0.0108


@pytest.mark.parametrize("normal", [[0.0, 0.0, 1.0], [0.6, 0.0, -0.8], [1.0, 0.0, 0.0]])
def test_a_tilted_axis_leans_from_the_normal_towards_the_first_tangent(normal):
    n, b = np.array(normal), 0.3
    Q, (first, _) = tilted(n, b), tangents(n)
    assert Q.T @ Q == pytest.approx(np.eye(3), abs=1e-14) and np.linalg.det(Q) == pytest.approx(1.0)
    assert Q[:, 2] @ n == pytest.approx(np.cos(b)) and Q[:, 2] @ first == pytest.approx(np.sin(b))


@pytest.mark.parametrize("radius", [0.0, -1.0, np.nan])
def test_impossible_spheres_are_refused(radius):
    with pytest.raises(ValueError, match="positive"):
        Sphere(radius)
