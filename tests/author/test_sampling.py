# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Places on a block of 80 x 60 x 30 mm, held at its bottom."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from scipy.spatial.distance import cdist, pdist

from palpate.assets import scene_path
from palpate.author.errors import InputError
from palpate.author.organ_stage import OrganMesh
from palpate.author.sampling import farthest_points, held_out_points, reach_samples
from palpate.author.scene import load_scene
from palpate.author.scene_tables import Reach
from palpate.author.seeds import places_of
from palpate.author.tool_stage import ToolShape, contact_extent
from palpate.author.tool_work import ToolWork
from palpate.fem_offline.surface import load_surface, repair_surface

BALL = ToolShape("sphere", (("radius", 5e-3),))


@pytest.fixture(scope="module")
def scene():
    return load_scene(scene_path("palpation_block"))


@pytest.fixture(scope="module")
def mesh(scene) -> OrganMesh:
    surface = repair_surface(load_surface(scene.organ.surface, "m"))
    none = np.zeros((0, 3))
    return OrganMesh(
        surface.vertices,
        surface.triangles,
        none,
        none,
        "block",
        scene.organ.material,
        scene.organ.support,
        (),
        {},
        "h",
    )


@pytest.fixture(scope="module")
def samples(scene, mesh):
    return reach_samples(mesh, scene.reach, BALL, 4e-3)


def test_samples_lie_on_the_surface_inside_the_reach_and_off_the_supports(scene, mesh, samples):
    assert np.abs(mesh.distance(samples.points)).max() < 1e-9
    assert scene.reach.contains(samples.points).all()
    assert not mesh.held(samples.points).any()
    assert np.allclose(np.linalg.norm(samples.normals, axis=1), 1.0)


def test_samples_leave_no_hole(scene, mesh, samples):
    centres = mesh.vertices[mesh.triangles].mean(axis=1)
    inside = np.linalg.norm(centres - np.array([0.014, 0.004, 0.03]), axis=1) < 14e-3
    beyond = samples.beyond(mesh)(centres[inside])
    assert beyond.max() < samples.spacing


def test_farthest_points_are_spread_better_than_random_ones(samples):
    nodes = samples.points[farthest_points(samples, 16)]
    drawn = np.random.default_rng(0).choice(len(samples.points), (50, 16))
    assert pdist(nodes).min() > 2.0 * np.median([pdist(samples.points[d]).min() for d in drawn])
    again = samples.points[farthest_points(samples, 10)]
    assert np.array_equal(again, nodes[:10])


def test_held_out_points_follow_their_seed_and_never_coincide(samples):
    first, second = held_out_points(samples, 8, 1), held_out_points(samples, 8, 1)
    assert np.array_equal(first, second)
    assert not np.array_equal(first, held_out_points(samples, 8, 2))
    assert len(set(first)) == 8
    assert pdist(samples.points[first]).min() > 2e-3


def test_tissue_too_thin_for_the_depth_is_left_out_and_counted(scene, mesh):
    deep = reach_samples(mesh, scene.reach, BALL, 13e-3)  # 30 mm thick: at most 12 mm
    assert not deep.allowed.any()
    assert any("thinner" in reason for reason in deep.left_out)


def test_a_ridge_that_turns_over_within_the_contact_is_left_out_and_counted_and_flat_beside_it_is_not(mesh):
    box = boxed(mesh, 60e-3, 50e-3, 40e-3)
    around, contact = reach_samples(box, Reach(), BALL, 2e-3), contact_extent(BALL, 2e-3)
    top = around.points[:, 2] > 20e-3 - 1e-6
    inset = (np.array([30e-3, 25e-3]) - np.abs(around.points[:, :2])).min(axis=1)
    sharp, flat = top & (inset < 0.5 * contact), top & (inset > contact + 4e-3)
    assert sharp.sum() > 50 and not around.allowed[sharp].any()
    assert flat.sum() > 50 and around.allowed[flat].all()
    (count,) = [count for reason, count in around.left_out.items() if "ridge" in reason]
    assert count >= sharp.sum()


def boxed(mesh: OrganMesh, *extents: float) -> OrganMesh:
    box = trimesh.creation.box(extents).subdivide_to_size(2e-3)
    return replace(mesh, vertices=np.array(box.vertices), triangles=np.array(box.faces), supports=())


def test_a_ridge_just_beyond_the_reach_is_seen(mesh):
    top = Reach(half_space={"point": [0, 0, 19.9e-3], "normal": [0, 0, -1]})
    around = reach_samples(boxed(mesh, 60e-3, 50e-3, 40e-3), top, BALL, 2e-3)
    inset = (np.array([30e-3, 25e-3]) - np.abs(around.points[:, :2])).min(axis=1)
    rim = inset < 1e-3
    assert rim.sum() > 100 and not around.allowed[rim].any()


def test_the_far_face_of_a_plate_is_no_ridge(mesh):
    plate, punch = boxed(mesh, 60e-3, 50e-3, 4e-3), ToolShape("sphere", (("radius", 20e-3),))
    around = reach_samples(plate, Reach(), punch, 1e-3)
    assert contact_extent(punch, 1e-3) > 4e-3
    inset = (np.array([30e-3, 25e-3]) - np.abs(around.points[:, :2])).min(axis=1)
    middle = inset > contact_extent(punch, 1e-3) + 4e-3
    assert middle.sum() > 100 and around.allowed[middle].all()


def test_a_contact_that_would_reach_a_support_is_left_out_and_counted(mesh):
    everywhere = reach_samples(mesh, Reach(), BALL, 4e-3)
    assert any("of a support" in reason for reason in everywhere.left_out)
    side = everywhere.allowed & (
        np.abs(everywhere.normals[:, 0]) > 0.99
    )  # the flanks, which stand on the held bottom
    top_of_support = mesh.vertices[mesh.supported(mesh.vertices)][:, 2].max()
    height = everywhere.points[:, 2] - top_of_support
    assert height[side].min() > 3e-3 and height.min() < 2e-3


def test_held_out_points_never_become_nodes_even_where_nothing_else_is_left(scene, mesh, samples):
    held = held_out_points(samples, 4, 1)
    places = places_of(samples, held)
    assert cdist(places.position, samples.points[held]).min() > 0.0
    greedy = scene.accuracy.model_copy(update={"held_out": 100_000})
    with pytest.raises(InputError, match=r"held_out.*no place for a node.*fewer, or a larger reach"):
        ToolWork(scene.model_copy(update={"accuracy": greedy}), mesh, scene.tool[0])
