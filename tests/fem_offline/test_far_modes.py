# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline.far_field import condense
from palpate.fem_offline.far_modes import far_modes
from palpate.fem_offline.green import blocks_around, green_block, loaded_nodes
from palpate.fem_offline.patch import carve

CENTRE = np.array([4e-3, 1e-3, 0.0])
RADIUS = 0.012
RIGID = 6


def unkept(cell, seen, make):
    return make()


@pytest.fixture(scope="module", params=["beside the supports", "with a support in it"])
def carved(request, supported_block):
    """Tetrahedra of a patch; border nodes."""
    organ = supported_block
    chosen = carve(organ, CENTRE, RADIUS if request.param == "beside the supports" else 0.024)
    inside = np.unique(organ.space.elements[chosen])
    if request.param == "with a support in it" and not (
        np.isin(inside, organ.held_nodes).any() or organ.elastic is not None
    ):
        raise AssertionError("the patch must reach a support")
    outside = np.unique(organ.space.elements[~chosen])
    return chosen, np.setdiff1d(np.intersect1d(inside, outside), organ.held_nodes)


@pytest.fixture(scope="module")
def modes(supported_block, carved):
    return far_modes(supported_block, *carved, CENTRE, RADIUS, unkept)


@pytest.fixture(scope="module")
def exact(supported_block, carved):
    return condense(supported_block, *carved).stiffness


def test_stiffness_of_the_modes_is_the_condensed_far_field_s(modes, exact):
    there = modes.trace.T @ exact @ modes.trace
    wrong = np.abs(there - modes.stiffness)
    wrong[-RIGID:, -RIGID:] = 0.0  # bounded only
    assert wrong.max() < 1e-10 * np.abs(there).max()


def test_rigid_motions_are_never_too_soft(modes, exact):
    rigid = modes.trace[:, -RIGID:]
    excess = modes.stiffness[-RIGID:, -RIGID:] - rigid.T @ exact @ rigid
    assert np.linalg.eigvalsh(excess)[0] > 0.0
    assert np.linalg.eigvalsh(modes.stiffness)[0] > 0.0


def test_support_reaction_balances_the_forces_on_the_border(modes, exact):
    """Two ways to it: the forces that made the modes, and the exact far field's own forces."""
    elastic = modes.trace[:, :-RIGID]
    on_border = (exact @ elastic).reshape(-1, 3, elastic.shape[1]).sum(axis=0)
    assert modes.reaction[:, :-RIGID] == pytest.approx(-on_border, abs=1e-9 * np.abs(on_border).max())


def test_a_push_near_the_contact_is_made_of_the_modes(supported_block, carved, modes, exact):
    """The border's displacement under forces at the contact, in the energy of the far field.  A hard case: the patch
    is hardly larger than the tetrahedra (on the liver, four times as large, forces are right to 0.1 %)."""
    organ = supported_block
    inside = np.setdiff1d(np.unique(organ.space.elements[carved[0]]), organ.held_nodes)
    near = inside[np.argsort(np.linalg.norm(organ.space.nodes[inside] - CENTRE, axis=1))[:4]]
    block = green_block(organ, near, 1.0)
    at_border = block.displacement[np.searchsorted(block.node, carved[1])].reshape(-1, len(near), 3)
    push = at_border[:, :, 2].sum(axis=1)
    S = modes.trace.T @ exact @ modes.trace
    part = modes.trace.T @ exact @ push
    assert part @ np.linalg.solve(S, part) == pytest.approx(push @ exact @ push, rel=3e-2)


def test_green_s_functions_solve_the_whole_organ(supported_block):
    organ = supported_block
    everything = np.ones(len(organ.tets), bool)
    K = organ.rest_stiffness(everything) + organ.spring_stiffness(everything)
    block = next(blocks_around(organ, CENTRE, RADIUS, unkept))
    assert len(block.node) == organ.space.node_count  # a small organ is seen as a whole
    force = (K @ block.displacement.reshape(-1, block.displacement.shape[2])).reshape(
        block.displacement.shape
    )
    force[organ.held_nodes] = 0.0
    wanted = np.zeros_like(force)
    for k, node in enumerate(block.loaded):
        wanted[node, [0, 1, 2], 3 * k + np.arange(3)] = 1.0
    assert force == pytest.approx(wanted, abs=1e-9)


def test_forces_stand_apart_and_on_free_nodes(supported_block):
    loaded = loaded_nodes(supported_block)
    assert len(np.unique(loaded)) == len(loaded) and not np.isin(loaded, supported_block.held_nodes).any()
    assert len(loaded) < 0.8 * supported_block.space.node_count


def test_functions_that_do_not_see_the_whole_patch_are_not_used(supported_block, carved, exact, monkeypatch):
    """Long tetrahedra can reach beyond what is kept; the patch then has functions of its own."""
    monkeypatch.setattr("palpate.fem_offline.green.sight", lambda organ, radius: 0.011)
    modes = far_modes(supported_block, *carved, CENTRE, RADIUS, unkept)
    elastic = modes.trace[:, :-RIGID]
    there = elastic.T @ exact @ elastic
    assert np.abs(there - modes.stiffness[:-RIGID, :-RIGID]).max() < 1e-10 * np.abs(there).max()
