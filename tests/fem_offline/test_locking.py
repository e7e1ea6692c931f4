# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline.verification.cook import cook_rows, membrane
from palpate.fem_offline.verification.linear_tetrahedra import linear_in_quadratic
from palpate.fem_offline.verification.loaded_body import finite_strain, small_strain
from palpate.fem_offline.verification.locking import beam, locking_rows
from palpate.fem_offline.verification.mixed_block import STORED as BLOCKS
from palpate.fem_offline.verification.mixed_block import beam_work
from palpate.fem_offline.verification.mixed_membrane import STORED, solve_membrane


def test_split_kappa_bends_as_a_mixed_method_does():
    for row in locking_rows(confined=False):
        assert row.met, f"{row.name}: {row.value:.3f}"


def test_linear_tetrahedra_lock_in_bending():
    body = beam(0.49, 2)
    assert body.work(small_strain(body, linear=True)) < 0.7 * BLOCKS["beam", 0.49]


def test_cooks_membrane_is_met_by_quadratic_and_failed_by_linear_tetrahedra():
    pytest.importorskip("skfem")
    rows = list(cook_rows((0.3, 0.4999), finite=False))
    assert len(rows) == 3 and all(row.met for row in rows), rows


def test_stored_numbers_are_what_the_other_code_gives():
    pytest.importorskip("skfem")
    for nu in (0.3, 0.4999):
        found, stored = solve_membrane(nu, False, 16), STORED[nu, False]
        assert found.tip == pytest.approx(stored.tip, rel=7e-3)
        assert found.work == pytest.approx(stored.work, rel=2e-3)
    found, stored = solve_membrane(0.49, True, 8), STORED[0.49, True]
    assert (found.tip, found.work) == pytest.approx((stored.tip, stored.work), rel=7e-3)
    assert beam_work(0.49, 2) == pytest.approx(BLOCKS["beam", 0.49], rel=6e-3)


def test_small_loads_at_finite_strain_are_small_strains():
    body = membrane(0.49, 2)
    body.load[:] *= 1e-3
    linear = small_strain(body)
    assert finite_strain(body) == pytest.approx(linear, abs=1e-3 * np.abs(linear).max())


def test_linear_displacements_are_among_the_quadratic_ones():
    space = membrane(0.3, 2).space
    corners = space.node_count - len(space.edge_nodes)
    random = np.random.default_rng(0)
    nodal = random.standard_normal((corners, 3))
    u = (linear_in_quadratic(space) @ nodal.ravel()).reshape(-1, 3)
    a, b, mid = space.edge_nodes.T
    assert np.array_equal(u[:corners], nodal)
    assert u[mid] == pytest.approx(0.5 * (nodal[a] + nodal[b]), abs=1e-15)
