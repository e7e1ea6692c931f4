# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import json

import numpy as np
import pytest
import trimesh

from palpate.assets import PHANTOM_FOLDER
from palpate.assets.palpation_block import NODULE_RADII, block, nodule
from palpate.assets.phantom import PHANTOMS, generate, surface


@pytest.fixture(scope="module")
def regenerated(tmp_path_factory):
    folder = tmp_path_factory.mktemp("phantoms")
    generate(folder)
    return folder


def load(path) -> trimesh.Trimesh:
    return trimesh.load(path, process=False)


@pytest.mark.parametrize("name", [phantom.name for phantom in PHANTOMS])
def test_shipped_files_are_what_the_generator_makes(regenerated, name):
    shipped, new = load(PHANTOM_FOLDER / f"{name}.ply"), load(regenerated / f"{name}.ply")
    assert np.array_equal(shipped.faces, new.faces)
    # Not bit by bit: exp and float32 rounding differ in the last place between processors.
    assert np.abs(shipped.vertices - new.vertices).max() < 1e-6
    facts = [json.loads((folder / f"{name}.json").read_text()) for folder in (PHANTOM_FOLDER, regenerated)]
    for key in ("volume", "area"):
        assert facts[0].pop(key) == pytest.approx(facts[1].pop(key), rel=1e-4)
    assert facts[0] == facts[1]


@pytest.mark.parametrize("phantom", PHANTOMS, ids=lambda phantom: phantom.name)
def test_surfaces_are_closed_even_solids_on_their_formula(phantom):
    vertices, triangles = surface(phantom)
    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    assert mesh.is_watertight and mesh.is_winding_consistent and mesh.volume > 0.0
    assert mesh.body_count == 1 and mesh.euler_number == 2
    assert np.abs(phantom.shape(vertices)).max() < 1e-6
    assert mesh.edges_unique_length.max() < 2.0 * phantom.spacing
    height = 2.0 * mesh.area_faces / mesh.edges_unique_length[mesh.faces_unique_edges].max(axis=1) ** 2
    assert np.percentile(height, 1) > 0.3  # 0.87 in an equilateral triangle


def test_liver_has_the_size_of_a_liver():
    facts = json.loads((PHANTOM_FOLDER / "liver_phantom.json").read_text())
    assert 1.4e-3 < facts["volume"] < 1.6e-3
    assert 0.19 < max(facts["extent"]) < 0.22
    assert (PHANTOM_FOLDER / "liver_phantom.ply").stat().st_size < 1.5e6


def test_liver_has_a_thin_left_edge_and_a_gallbladder_bed():
    mesh = load(PHANTOM_FOLDER / "liver_phantom.ply")
    x, z = mesh.vertices[:, 0], mesh.vertices[:, 2]
    assert np.ptp(z[x > 0.10]) < 0.025 < 0.12 < np.ptp(z[np.abs(x + 0.03) < 0.005])
    # The bed: seen from below, its middle lies deeper than the line between its two sides.
    shape = next(p for p in PHANTOMS if p.name == "liver_phantom").shape
    heights = np.linspace(-0.1, 0.0, 2001)
    lowest = [
        heights[np.argmax(shape(np.stack([np.full(2001, x), np.full(2001, -0.012), heights], axis=1)) < 0.0)]
        for x in (-0.036, -0.016, 0.0)
    ]
    assert lowest[1] > 0.5 * (lowest[0] + lowest[2]) + 0.006


def test_nodule_lies_inside_the_block_at_its_stated_depth():
    vertices, triangles = surface(next(p for p in PHANTOMS if p.name == "nodule"))
    assert (block(vertices) < -0.006).all()
    assert 0.030 - vertices[:, 2].max() == pytest.approx(0.0065, abs=1e-4)
    volume = trimesh.Trimesh(vertices, triangles, process=False).volume
    assert volume == pytest.approx(4.0 / 3.0 * np.pi * np.prod(NODULE_RADII), rel=0.03)
    assert nodule(np.array([[0.014, 0.004, 0.0175]]))[0] < 0.0
