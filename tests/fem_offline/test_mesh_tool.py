# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
import trimesh

from palpate.fem_offline.errors import ToolError
from palpate.fem_offline.spline_grid import spline_grid
from palpate.fem_offline.tool import FlatPunch, MeshTool, Pose, tilted

R = 5e-3
POSE = Pose(np.array([0.01, -0.02, 0.03]), tilted(np.array([0.36, -0.48, 0.8]), 0.4))


def as_tool(mesh, **options):
    return MeshTool(vertices=np.array(mesh.vertices), triangles=np.array(mesh.faces), **options)


@pytest.fixture(scope="module")
def ball():
    return as_tool(trimesh.creation.icosphere(subdivisions=4, radius=R), tip=(0.0, 0.0, 0.0))


@pytest.fixture(scope="module")
def rod():
    return as_tool(trimesh.creation.cylinder(radius=R, height=0.03, sections=64))


def around(tool, pose, inside=0.4e-3, outside=1.5e-3):
    points = pose.position + np.random.default_rng(0).uniform(-0.01, 0.01, (3000, 3))
    gap = tool.distance(points, pose).gap
    return points[(gap > -inside) & (gap < outside)]


@pytest.mark.parametrize("name", ["ball", "rod"])
def test_normal_and_curvature_are_exactly_the_derivatives_of_the_gap(name, request):
    """At corners and edges too: force and energy of a press agree because of this."""
    tool, h = request.getfixturevalue(name), 1e-7
    points = around(tool, POSE)
    found = tool.distance(points, POSE)
    assert len(points) > 50
    for k, e in enumerate(np.eye(3)):
        ahead, behind = (tool.distance(points + s * h * e, POSE) for s in (1, -1))
        assert np.abs((ahead.gap - behind.gap) / (2 * h) - found.normal[:, k]).max() < 1e-6
        slope = (ahead.normal - behind.normal) / (2 * h)
        assert np.abs(slope - found.curvature[:, :, k]).max() < 1e-3 * np.abs(found.curvature).max()


def test_a_fine_ball_is_a_sphere(ball):
    points = around(ball, POSE)
    length = np.linalg.norm(points - POSE.position, axis=1)
    found = ball.distance(points, POSE)
    sagged = R * (1 - np.cos(0.07 / np.sqrt(3)))  # middle of a facet; its corners are 0.07 R apart
    assert np.abs(found.gap - (length - R)).max() < 2 * sagged
    assert np.abs(found.normal - (points - POSE.position) / length[:, None]).max() < 0.03


def test_a_rod_touches_where_its_mesh_is(rod):
    assert rod.offset_along(np.array([0.0, 0.0, -1.0])) == pytest.approx(0.0, abs=1e-12)
    assert rod.offset_along(np.array([0.0, 0.0, 1.0])) == pytest.approx(0.03, abs=1e-9)
    assert rod.contact_size(0.5e-3) == pytest.approx(FlatPunch(R).contact_size(0.5e-3), rel=0.05)


def test_rounding_is_measured_and_falls_with_the_spacing():
    box = trimesh.creation.box((8e-3, 8e-3, 8e-3))
    mean = [as_tool(box, spacing=s).rounding[0] for s in (1e-3, 0.5e-3, 0.25e-3)]
    assert mean[0] < 60e-6 and mean[1] < 0.5 * mean[0] and mean[2] < 0.5 * mean[1]
    assert as_tool(box).rounding[0] <= 5e-6 or as_tool(box).solid.grid.spacing == 0.25e-3


def test_beyond_the_grid_the_distance_is_exact():
    rod = as_tool(trimesh.creation.cylinder(radius=1e-3, height=0.1, sections=16))
    found = rod.distance(np.array([[3e-3, 0.0, 0.08]]), Pose.upright(np.zeros(3)))
    assert found.gap[0] == pytest.approx(2e-3, rel=0.02) and found.normal[0] == pytest.approx(
        [1, 0, 0], abs=0.1
    )


def test_splines_follow_smooth_functions():
    axis = np.linspace(0.0, 1.0, 12)
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    grid = spline_grid(np.sin(x) * np.cos(2 * y) + x * z**2, np.zeros(3), axis[1])
    p = np.random.default_rng(0).uniform(0.35, 0.65, (20, 3))
    value, gradient, hessian = grid(p)
    assert value == pytest.approx(np.sin(p[:, 0]) * np.cos(2 * p[:, 1]) + p[:, 0] * p[:, 2] ** 2, abs=2e-4)
    assert gradient[:, 2] == pytest.approx(2 * p[:, 0] * p[:, 2], abs=2e-2)
    assert hessian[:, 0, 2] == pytest.approx(2 * p[:, 2], abs=0.2)


def test_hash_follows_mesh_tip_and_axis(ball):
    mesh = trimesh.creation.icosphere(subdivisions=4, radius=R)
    assert ball.hash() == as_tool(mesh, tip=(0.0, 0.0, 0.0)).hash()
    assert ball.hash() != as_tool(mesh, tip=(0.0, 0.0, 1e-6)).hash()
    assert ball.hash() != as_tool(mesh, tip=(0.0, 0.0, 0.0), axis=(0.0, 1.0, 0.0)).hash()


def test_a_mesh_that_is_no_solid_is_refused_with_what_where_and_what_would_be_right():
    box = trimesh.creation.box((8e-3, 8e-3, 8e-3))
    vertices, triangles = np.array(box.vertices), np.array(box.faces)
    with pytest.raises(ToolError, match=r"open at 3 edges.*mm.*expected one closed surface"):
        MeshTool(vertices=vertices, triangles=triangles[1:])
    with pytest.raises(ToolError, match="inside out"):
        MeshTool(vertices=vertices, triangles=triangles[:, ::-1])
    flipped = triangles.copy()
    flipped[0] = flipped[0, ::-1]
    with pytest.raises(ToolError, match="opposite ways at 3 edges"):
        MeshTool(vertices=vertices, triangles=flipped)
    with pytest.raises(ToolError, match="no triangles"):
        MeshTool(vertices=vertices, triangles=triangles[:0])
    with pytest.raises(ToolError, match="tip"):
        MeshTool(vertices=vertices, triangles=triangles, tip=(1.0, 0.0, 0.0)).contact_size(1e-3)


def test_triangles_with_corners_of_their_own_are_joined():
    box = trimesh.creation.box((8e-3, 8e-3, 8e-3))
    soup = np.array(box.vertices)[np.array(box.faces)].reshape(-1, 3)
    assert len(MeshTool(vertices=soup, triangles=np.arange(len(soup)).reshape(-1, 3)).vertices) == 8
