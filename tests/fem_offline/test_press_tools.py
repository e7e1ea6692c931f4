# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Presses with tools of every shape, on blocks so small that only identities are checked."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from palpate.fem_offline.clearance import why_stray
from palpate.fem_offline.contact import Unilateral, contact_surface
from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.press import press
from palpate.fem_offline.site import open_site, patch_size
from palpate.fem_offline.tool import Capsule, Cone, Cylinder, FlatPunch, MeshTool, Pose, Sphere, tilted
from palpate.fem_offline.verification.blocks import block_organ

R = 3e-3
PLACE = np.array([1e-3, 0.5e-3, 0.0])
DEPTHS = np.array([0.3e-3, 0.5e-3, 0.8e-3])
TILT = np.radians(20.0)
TOOLS = {
    "flat punch": (FlatPunch(R, 1e-3), 0.0),
    "tilted punch": (FlatPunch(R, 1e-3), TILT),
    "lying cylinder": (Cylinder(2e-3, 6e-3, 1e-3, axis=(1.0, 0.0, 0.0)), 0.0),
    "cone": (Cone(np.radians(60.0), 1e-3, length=0.02), 0.0),
    "tilted capsule": (Capsule(R, 0.02), 2 * TILT),
}


@pytest.fixture(scope="module")
def organ():
    return block_organ((0.04, 0.04, 0.02), (4, 4, 2), {0: NeoHookean(5400.0, 0.45)})


def coarse_site(organ, tool, tilt=0.0, depth=DEPTHS[-1]):
    size = patch_size(tool, depth, radius=0.008, refinement=0.6, tilt=tilt)
    return open_site(organ, PLACE, tool, size, tilt=tilt)


@pytest.fixture(scope="module")
def ball_site(organ):
    return coarse_site(organ, Sphere(R))


@pytest.mark.parametrize("name", TOOLS)
def test_force_is_the_energy_slope_and_the_supports_answer_force_and_moment(organ, name):
    tool, tilt = TOOLS[name]
    record = press(coarse_site(organ, tool, tilt), tool, DEPTHS)
    assert record.converged, record.reason
    assert record.reaction_error.max() < 1e-8
    assert record.work_mismatch < 0.02
    assert (np.diff(record.force) > 0.0).all()


def test_tilting_a_ball_changes_nothing(ball_site):
    tool = Sphere(R)
    upright = press(ball_site, tool, DEPTHS[:1])
    turned = press(replace(ball_site, rotation=tilted(ball_site.normal, 0.7)), tool, DEPTHS[:1])
    assert turned.force_vector[-1] == pytest.approx(upright.force_vector[-1], rel=1e-9, abs=1e-12)
    assert turned.energy[-1] == pytest.approx(upright.energy[-1], rel=1e-9)


def test_a_capsule_presses_like_its_ball(ball_site):
    ball, capsule = (press(ball_site, tool, DEPTHS[:1]) for tool in (Sphere(R), Capsule(R, 0.02)))
    assert capsule.force_vector[-1] == pytest.approx(ball.force_vector[-1], rel=1e-4, abs=1e-8)
    arm = np.array([0.0, 0.0, R])  # from the ball's centre to the capsule's tip, about which it has a moment
    moved = ball.moment[-1] + np.cross(arm, ball.force_vector[-1])
    assert capsule.moment[-1] == pytest.approx(moved, abs=1e-4 * R * ball.force[-1])


def test_a_ball_of_triangles_presses_like_a_ball(ball_site):
    """Less by what its facets sag (mean 1 um, 2.4 um at most): 1.5 sag / depth of the force."""
    mesh = trimesh.creation.icosphere(subdivisions=4, radius=R)
    triangles = MeshTool(vertices=mesh.vertices, triangles=mesh.faces, tip=(0.0, 0.0, 0.0))
    ball, meshed = (press(ball_site, tool, DEPTHS) for tool in (Sphere(R), triangles))
    assert (meshed.force[1:] < ball.force[1:]).all()
    assert meshed.force[1:] == pytest.approx(ball.force[1:], rel=1.5 * 2.4e-6 / DEPTHS[0])
    assert meshed.reaction_error.max() < 1e-8 and meshed.work_mismatch < 0.02


def test_a_scene_turned_as_a_whole_answers_turned(organ):
    """Energy, force and moment of a tilted punch on deformed faces that are turned and moved with it."""
    nodes = organ.space.nodes
    faces = organ.space.face_nodes(organ.faces[(organ.points[organ.faces][:, :, 2] > -1e-9).all(axis=1)])
    u = 1e-5 * np.random.default_rng(0).standard_normal(nodes.shape)
    tool, pose = FlatPunch(R), Pose(np.array([1e-3, 0.0, -0.2e-3]), tilted(np.array([0.0, 0.0, 1.0]), TILT))
    Q, t = tilted(np.array([0.36, -0.48, 0.8]), 0.4), np.array([0.1, -0.2, 0.05])
    here = Unilateral(contact_surface(nodes, faces), tool, 4e7, pose).state(u)
    turned = Pose(Q @ pose.position + t, Q @ pose.rotation)
    there = Unilateral(contact_surface(nodes @ Q.T + t, faces), tool, 4e7, turned).state(u @ Q.T)
    assert there.energy == pytest.approx(here.energy, rel=1e-9)
    assert there.force == pytest.approx(Q @ here.force, abs=1e-9 * np.linalg.norm(here.force))
    assert there.moment == pytest.approx(Q @ here.moment, abs=1e-8 * np.linalg.norm(here.moment))
    assert np.linalg.norm(here.moment) > 0.1 * R * np.linalg.norm(here.force)


def test_a_shaft_that_touches_is_refused_with_where_and_what_would_help(organ):
    """A rod laid on the block, on a site that was made for its round end."""
    rod = Capsule(2e-3, 0.03)
    site = open_site(organ, PLACE, rod, patch_size(rod, 0.5e-3, radius=0.008), tilt=np.radians(88.0))
    reason = why_stray(site, rod, 0.5e-3, np.zeros_like(site.body.nodes))
    assert (
        "touches the tissue" in reason and "mm from its reference point" in reason and "less tilt" in reason
    )
    assert why_stray(site, Sphere(2e-3), 0.5e-3, np.zeros_like(site.body.nodes)) == ""
    record = press(site, rod, np.array([0.5e-3]))
    assert not record.converged and "less tilt" in record.reason


def test_a_press_deeper_than_the_tissue_is_refused(ball_site):
    assert ball_site.thickness == pytest.approx(0.02, rel=1e-9)
    record = press(replace(ball_site, thickness=0.4e-3), Sphere(R), DEPTHS)
    assert not record.converged and len(record.depth) == 2
    assert "0.50 mm is deeper than the tissue, 0.40 mm thick here" in record.reason


def test_a_tool_that_is_in_the_tissue_before_the_press_is_refused(ball_site):
    low = replace(ball_site, contact_point=ball_site.contact_point - 0.5e-3 * ball_site.normal)
    record = press(low, Sphere(R), DEPTHS)
    assert not record.converged and len(record.depth) == 1
    assert "0.50 mm in the tissue before the press begins" in record.reason
