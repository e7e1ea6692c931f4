# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from scipy import sparse

from palpate.fem_offline.assembly import ElementSystem
from palpate.fem_offline.hessian_pattern import hessian_pattern
from palpate.fem_offline.material import Linear, MooneyRivlin, NeoHookean
from palpate.fem_offline.verification.elements import element_rows, irregular_mesh, stiffness_of, system_of

ROWS = list(element_rows())


@pytest.mark.parametrize("row", ROWS, ids=[row.name for row in ROWS])
def test_verification_row(row):
    assert row.met, f"error {row.error:.1e}, bar {row.bar:.0e}"


@pytest.fixture(scope="module")
def system():
    return system_of(irregular_mesh())


@pytest.fixture(scope="module")
def u(system):
    return 4e-4 * np.random.default_rng(5).standard_normal(system.space.nodes.shape)


def test_hessian_is_symmetric_and_whole(system, u):
    """Every column of the Hessian against differences of the force, not only a random direction."""
    K = stiffness_of(system, u).toarray()
    assert np.abs(K - K.T).max() == 0.0
    h = 1e-7
    for dof in np.random.default_rng(6).integers(0, u.size, 12):
        v = np.zeros(u.size)
        v[dof] = h
        v = v.reshape(u.shape)
        difference = (system.state(u + v).force - system.state(u - v).force).ravel() / (2 * h)
        assert difference == pytest.approx(K[:, dof], abs=1e-6 * np.abs(K[:, dof]).max())


def test_rest_stiffness_has_six_rigid_motions_and_no_other(system):
    K = stiffness_of(system, np.zeros_like(system.space.nodes)).toarray()
    eigenvalues = np.linalg.eigvalsh(K)
    assert np.abs(eigenvalues[:6]).max() < 1e-9 * eigenvalues[-1]
    assert eigenvalues[6] > 1e-5 * eigenvalues[-1]


def test_one_element_alone_has_no_soft_mode():
    """The centre rule for kappa alone would leave three of the 24 deforming modes to psi_iso's four points."""
    from palpate.fem_offline.quadratic_space import quadratic_space

    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    K = stiffness_of(
        system_of(quadratic_space(points, np.array([[0, 1, 2, 3]]))), np.zeros((10, 3))
    ).toarray()
    eigenvalues = np.linalg.eigvalsh(K)
    assert np.count_nonzero(eigenvalues < 1e-6 * eigenvalues[-1]) == 6


def test_forces_and_moments_of_the_whole_body_vanish(system, u):
    force = system.state(u).force
    x = system.space.nodes + u
    scale = np.abs(force).sum()
    assert np.abs(force.sum(axis=0)).max() < 1e-13 * scale
    assert np.abs(np.cross(x, force).sum(axis=0)).max() < 1e-13 * scale * 0.03


def test_inverted_elements_have_infinite_energy(system):
    u = np.zeros_like(system.space.nodes)
    u[:, 0] = -2.0 * system.space.nodes[:, 0]
    state = system.state(u)
    assert np.isinf(state.energy) and state.smallest_jacobian < 0.0


def test_a_cut_tetrahedron_mixes_energies(system, u):
    """Energy, force and Hessian are linear in the fractions, whatever the models."""
    materials = (NeoHookean(5400.0, 0.48), MooneyRivlin(600.0, 200.0, 0.4), Linear(9000.0, 0.3))
    fraction = np.random.default_rng(8).dirichlet([1.0, 1.0, 1.0], len(system.space.elements))
    fraction[::3] = np.eye(3)[np.random.default_rng(9).integers(0, 3, len(fraction[::3]))]
    mixed = ElementSystem(system.space, materials, fraction)
    apart = [ElementSystem(system.space, [m], fraction[:, [i]]) for i, m in enumerate(materials)]
    states = [part.state(u) for part in apart]
    force = sum(state.force for state in states)
    assert mixed.state(u).energy == pytest.approx(sum(state.energy for state in states), rel=1e-13)
    assert mixed.state(u).force == pytest.approx(force, abs=1e-13 * np.abs(force).max())
    K = sum(stiffness_of(part, u) for part in apart)
    assert np.abs((stiffness_of(mixed, u) - K).data).max() < 1e-13 * np.abs(K.data).max()


def test_fractions_of_another_mesh_are_refused(system):
    with pytest.raises(ValueError, match="1 materials"):
        ElementSystem(system.space, [NeoHookean(5400.0, 0.48)], np.ones((3, 1)))


def test_held_components_leave_the_rest_of_the_matrix_alone(system, u):
    space = system.space
    fixed = np.random.default_rng(7).random(3 * space.node_count) < 0.3
    pattern = hessian_pattern(space.elements, fixed, [np.array([0, 10, 200])])
    upper = pattern.matrix(system.hessian(u, pattern))
    part = (upper + sparse.triu(upper, 1).T).toarray()
    whole = stiffness_of(system, u).toarray()[np.ix_(~fixed, ~fixed)]
    assert part == pytest.approx(whole, abs=1e-12 * np.abs(whole).max())
    with pytest.raises(KeyError):
        pattern.places(np.array([0]), np.array([pattern.equation_count - 1]))
