# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline.body import patch_space
from palpate.fem_offline.far_field import interface_nodes
from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.organ import boundary_faces
from palpate.fem_offline.patch import PatchError, PatchSize, carve, refine
from palpate.fem_offline.verification.blocks import block_organ

CENTRE = np.array([2e-3, 1e-3, 0.0])
SIZE = PatchSize(radius=0.012, finest=1.2e-3, core=3e-3, growth=0.5, coarsest=8e-3)


@pytest.fixture(scope="module")
def organ():
    soft, stiff = NeoHookean(5400.0, 0.48), NeoHookean(20000.0, 0.48)

    def right(middles):
        return (middles[:, 0] > 0.01).astype(int)

    return block_organ((0.06, 0.06, 0.03), (6, 6, 3), {0: soft, 1: stiff}, right)


@pytest.fixture(scope="module")
def patch(organ):
    return refine(organ, carve(organ, CENTRE, SIZE.radius), CENTRE, SIZE)


def volumes(points, tets):
    x = points[tets]
    return np.linalg.det(x[:, 1:] - x[:, :1]) / 6.0


def test_patch_fills_the_place_of_what_was_carved(organ, patch):
    for label in (0, 1):
        old = volumes(organ.points, organ.tets[patch.carved & (organ.label == label)]).sum()
        new = volumes(patch.points, patch.tets[patch.label == label])
        assert new.min() > 0.0
        assert new.sum() == pytest.approx(old, rel=0.02 if label else 0.01)
    total = volumes(organ.points, organ.tets[patch.carved]).sum()
    assert volumes(patch.points, patch.tets).sum() == pytest.approx(total, rel=1e-9)


def test_boundary_is_outer_faces_and_interface(organ, patch):
    whole = {tuple(sorted(face)) for face in boundary_faces(patch.tets)}
    parts = [tuple(sorted(face)) for face in (*patch.outer_faces, *patch.interface_faces)]
    assert len(parts) == len(set(parts)) and set(parts) == whole
    assert np.abs(patch.points[patch.outer_faces][..., 2]).max() == 0.0


def test_interface_nodes_are_shared_to_the_last_bit(organ, patch):
    space, _ = patch_space(organ, patch)
    own, theirs = interface_nodes(organ, patch, space)
    assert len(own) > 20 and len(np.unique(own)) == len(np.unique(theirs)) == len(own)
    assert np.array_equal(space.nodes[own], organ.space.nodes[theirs])


def test_interface_is_all_that_patch_and_rest_have_in_common(organ, patch):
    space, _ = patch_space(organ, patch)
    _, theirs = interface_nodes(organ, patch, space)
    inside = np.unique(organ.space.elements[patch.carved])
    common = np.intersect1d(inside, np.unique(organ.space.elements[~patch.carved]))
    assert np.array_equal(np.sort(theirs), common)


def test_edges_near_the_contact_have_the_size_asked_for(patch):
    x = patch.points
    pairs = np.unique(np.sort(patch.outer_faces[:, [[0, 1], [1, 2], [0, 2]]].reshape(-1, 2), axis=1), axis=0)
    length = np.linalg.norm(x[pairs[:, 0]] - x[pairs[:, 1]], axis=1)
    near = np.linalg.norm(x[pairs].mean(axis=1) - CENTRE, axis=1) < SIZE.core
    assert length[near].mean() == pytest.approx(SIZE.finest, rel=0.3)


def test_carving_keeps_one_connected_piece(organ):
    carved = carve(organ, CENTRE, SIZE.radius)
    distance = np.linalg.norm(organ.points[organ.tets] - CENTRE, axis=2).min(axis=1)
    assert np.array_equal(carved, distance <= SIZE.radius)
    with pytest.raises(PatchError, match="no tetrahedron"):
        carve(organ, np.array([0.0, 0.0, 0.2]), 0.01)
