# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
import trimesh

from palpate.assets import SCENE_FOLDER, scene_path
from palpate.author.capabilities import CAPABILITIES, require_capabilities
from palpate.author.errors import InputError
from palpate.author.scene import load_scene

NAMES = sorted(path.stem for path in SCENE_FOLDER.glob("*.toml"))


def test_there_are_these_scenes():
    assert NAMES == ["encapsulated_block", "liver_phantom", "palpation_block", "palpation_block_nodule"]
    with pytest.raises(FileNotFoundError, match="liver_phantom"):
        scene_path("spleen")


@pytest.mark.parametrize("name", NAMES)
def test_scene_reaches_surface_that_no_support_holds(name):
    scene = load_scene(scene_path(name))
    mesh = trimesh.load(scene.organ.surface, process=False)
    places = mesh.triangles_center
    reached = scene.reach.contains(places)
    held = np.any([support.contains(places) for support in scene.organ.support], axis=0)
    assert 5e-4 < mesh.area_faces[reached].sum() < 20e-4  # m^2
    assert 0.05 < mesh.area_faces[held].sum() / mesh.area < 0.5
    gap = np.linalg.norm(places[reached][:, None] - places[held][None, ::7], axis=2).min()
    assert gap > 0.015  # m: three radii of the ball


@pytest.mark.parametrize("name", ["encapsulated_block", "liver_phantom", "palpation_block"])
def test_scene_asks_only_for_what_this_version_does(name):
    require_capabilities(load_scene(scene_path(name)))


def test_scene_with_a_nodule_is_refused_by_name_until_regions_come():
    scene = load_scene(scene_path("palpation_block_nodule"))
    if CAPABILITIES["regions"]:
        require_capabilities(scene)
    else:
        with pytest.raises(InputError, match="regions"):
            require_capabilities(scene)
