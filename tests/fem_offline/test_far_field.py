# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline.far_field import condense
from palpate.fem_offline.patch import carve


@pytest.fixture(scope="module")
def condensed(supported_block):
    """The far field around a small patch, and the stiffness of what it stands for."""
    organ = supported_block
    carved = carve(organ, np.zeros(3), 0.008)
    inside = np.unique(organ.space.elements[carved])
    outside = np.unique(organ.space.elements[~carved])
    border = np.setdiff1d(np.intersect1d(inside, outside), organ.held_nodes)
    return (
        condense(organ, carved, border),
        organ.rest_stiffness(~carved) + organ.spring_stiffness(~carved),
        outside,
    )


def dofs(nodes):
    return (3 * np.asarray(nodes)[:, None] + np.arange(3)).ravel()


def test_condensed_stiffness_is_that_of_dense_algebra(supported_block, condensed):
    far, K, outside = condensed
    kept = dofs(far.organ_nodes)
    free = dofs(np.setdiff1d(outside, np.union1d(supported_block.held_nodes, far.organ_nodes)))
    coupling = K[free][:, kept].toarray()
    exact = K[kept][:, kept].toarray() - coupling.T @ np.linalg.solve(K[free][:, free].toarray(), coupling)
    assert far.stiffness == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())


def test_far_field_is_positive_definite(condensed):
    far, _, _ = condensed
    assert np.abs(far.stiffness - far.stiffness.T).max() == 0.0
    assert np.linalg.eigvalsh(far.stiffness)[0] > 0.0
