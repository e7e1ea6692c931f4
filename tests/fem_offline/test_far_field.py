# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest

from palpate.fem_offline.far_field import condense
from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.membrane import Capsule
from palpate.fem_offline.patch import carve
from palpate.fem_offline.verification.blocks import block_organ


@pytest.fixture(scope="module", params=["bonded", "covered, on springs", "covered, on both"])
def organ(request):
    """Bonded below; or covered, on springs that vary over the right half's surface; or both, bonded on the left."""
    block = block_organ((0.05, 0.05, 0.03), (5, 5, 3), {0: NeoHookean(5400.0, 0.48)})
    if request.param == "bonded":
        return block
    block = replace(
        block,
        capsule=Capsule(1e-4, NeoHookean(5.4e5, 0.4)),
        elastic=lambda x: np.where(x[:, 0] > 4e-3, 2e5 * (1.0 + x[:, 1] / 0.1), 0.0),
    )
    if request.param == "covered, on springs":
        return replace(block, held=lambda x: np.zeros(len(x), bool))
    bonded = block.held
    return replace(block, held=lambda x: bonded(x) & (x[:, 0] < -3e-3))


@pytest.fixture(scope="module")
def condensed(organ):
    """Carved tetrahedra, the far field on their border, and the stiffness of the rest, dense."""
    carved = carve(organ, np.zeros(3), 0.008)
    inside = np.unique(organ.space.elements[carved])
    outside = np.unique(organ.space.elements[~carved])
    far = condense(organ, carved, np.intersect1d(inside, outside))
    return far, organ.rest_stiffness(~carved) + organ.spring_stiffness(~carved), outside


def dofs(nodes):
    return (3 * np.asarray(nodes)[:, None] + np.arange(3)).ravel()


def test_condensed_stiffness_is_that_of_dense_algebra(organ, condensed):
    far, K, outside = condensed
    kept = dofs(far.organ_nodes)
    free = dofs(np.setdiff1d(outside, np.union1d(organ.held_nodes, far.organ_nodes)))
    coupling = K[free][:, kept].toarray()
    exact = K[kept][:, kept].toarray() - coupling.T @ np.linalg.solve(K[free][:, free].toarray(), coupling)
    assert far.stiffness == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())


def test_support_reaction_is_that_of_the_held_nodes_and_of_the_springs(organ, condensed):
    """Solve for the far field's interior by hand and sum forces and moments of held nodes and springs."""
    far, K, outside = condensed
    held = np.intersect1d(organ.held_nodes, outside)
    kept = dofs(far.organ_nodes)
    free = dofs(np.setdiff1d(outside, np.union1d(held, far.organ_nodes)))
    moved = np.random.default_rng(0).standard_normal(len(kept))
    u = np.zeros(K.shape[0])
    u[kept] = moved
    u[free] = -np.linalg.solve(K[free][:, free].toarray(), K[free][:, kept] @ moved)
    springs = organ.spring_stiffness(~carve(organ, np.zeros(3), 0.008)) @ u
    forces = -springs.reshape(-1, 3)
    forces[held] += (K @ u).reshape(-1, 3)[held]
    moment = np.cross(organ.space.nodes, forces).sum(axis=0)
    reaction = far.reaction @ moved
    assert reaction[:3] == pytest.approx(forces.sum(axis=0), abs=1e-8 * np.abs(forces).sum())
    assert reaction[3:] == pytest.approx(moment, abs=1e-8 * np.abs(forces).sum() * 0.03)


def test_interface_and_supports_balance(condensed):
    """Sum of the interface's forces + supports' reaction = 0 for any displacement."""
    far, _, _ = condensed
    moved = np.random.default_rng(1).standard_normal(far.stiffness.shape[0])
    force = (far.stiffness @ moved).reshape(-1, 3)
    assert force.sum(axis=0) + far.reaction[:3] @ moved == pytest.approx(
        np.zeros(3), abs=1e-10 * np.abs(force).sum()
    )


def test_far_field_is_positive_definite(condensed):
    far, _, _ = condensed
    assert np.abs(far.stiffness - far.stiffness.T).max() == 0.0
    assert np.linalg.eigvalsh(far.stiffness)[0] > 0.0
