# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
from importlib.util import find_spec

import numpy as np
import pytest
from scipy import sparse

from palpate.fem_offline import linear_solver
from palpate.fem_offline.linear_solver import (
    Factor,
    NotPositiveDefiniteError,
    pardiso_available,
    schur_complement,
)


@pytest.fixture(params=["pardiso", "scipy"])
def solver(request, monkeypatch):
    if request.param == "scipy":
        monkeypatch.setattr(linear_solver, "_pardiso", lambda: None)
    elif find_spec("pypardiso") is None:
        pytest.skip("Pardiso is not installed")
    else:
        assert pardiso_available(), "pypardiso is installed, but its library is not found"
    return request.param


def random_matrix(n=60, shift=0.0, seed=0):
    """Dense symmetric positive definite matrix with a sparse pattern, and its upper triangle."""
    random = np.random.default_rng(seed)
    A = sparse.random(n, n, 0.1, random_state=random).toarray()
    A = A @ A.T + (1.0 + shift) * np.eye(n)
    upper = sparse.triu(sparse.csr_matrix(A)).tocsr()
    upper.sort_indices()
    return A, upper


def test_solutions_are_those_of_dense_algebra(solver):
    A, upper = random_matrix()
    factor = Factor(upper.indptr, upper.indices)
    factor.factorise(upper.data)
    b = np.random.default_rng(1).standard_normal((60, 3))
    assert factor.solve(b) == pytest.approx(np.linalg.solve(A, b), rel=1e-10, abs=1e-12)
    assert factor.solve(b[:, 0]) == pytest.approx(np.linalg.solve(A, b[:, 0]), rel=1e-10, abs=1e-12)


def test_new_values_replace_old_ones(solver):
    A, upper = random_matrix()
    factor = Factor(upper.indptr, upper.indices)
    factor.factorise(upper.data)
    factor.factorise(3.0 * upper.data)
    b = np.ones(60)
    assert factor.solve(b) == pytest.approx(np.linalg.solve(3.0 * A, b), rel=1e-10)


def test_schur_complement_is_that_of_dense_algebra(solver):
    A, upper = random_matrix()
    kept = np.array([3, 4, 17, 30, 59])
    rest = np.setdiff1d(np.arange(60), kept)
    exact = A[np.ix_(kept, kept)] - A[np.ix_(kept, rest)] @ np.linalg.solve(
        A[np.ix_(rest, rest)], A[np.ix_(rest, kept)]
    )
    schur = schur_complement(upper, kept)
    assert schur == pytest.approx(exact, rel=1e-9, abs=1e-11)
    assert np.abs(schur - schur.T).max() == 0.0


def test_indefinite_matrices_are_refused(solver):
    A, upper = random_matrix()
    upper = (upper - 2.0 * sparse.diags(np.linalg.eigvalsh(A)[30] * np.ones(60))).tocsr()
    upper.sort_indices()
    factor = Factor(upper.indptr, upper.indices)
    with pytest.raises(NotPositiveDefiniteError):
        factor.factorise(upper.data)


def test_singular_matrices_are_refused(solver):
    upper = sparse.triu(sparse.csr_matrix(np.ones((3, 3)))).tocsr()
    factor = Factor(upper.indptr, upper.indices)
    with pytest.raises(NotPositiveDefiniteError):
        factor.factorise(upper.data)


def test_a_refused_factor_works_again_with_good_values(solver):
    A, upper = random_matrix()
    factor = Factor(upper.indptr, upper.indices)
    with pytest.raises(NotPositiveDefiniteError):
        factor.factorise(-upper.data)
    factor.factorise(upper.data)
    assert factor.solve(np.ones(60)) == pytest.approx(np.linalg.solve(A, np.ones(60)), rel=1e-10)
