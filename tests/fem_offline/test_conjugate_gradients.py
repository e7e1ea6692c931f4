# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline.conjugate_gradients import NegativeCurvatureError, StaleError, conjugate_gradients


@pytest.fixture
def matrix():
    A = np.random.default_rng(0).standard_normal((40, 40))
    return A @ A.T + 2.0 * np.eye(40)


def test_exact_preconditioner_needs_one_step(matrix):
    b = np.ones(40)
    x = conjugate_gradients(lambda p: matrix @ p, lambda r: np.linalg.solve(matrix, r), b, 1e-10, 1)
    assert x == pytest.approx(np.linalg.solve(matrix, b), rel=1e-9)


def test_reaches_the_reduction_asked_for(matrix):
    b, M = np.random.default_rng(1).standard_normal(40), np.diag(np.diag(matrix))
    for tolerance in (1e-2, 1e-5, 1e-9):
        x = conjugate_gradients(lambda p: matrix @ p, lambda r: np.linalg.solve(M, r), b, tolerance, 200)
        r = b - matrix @ x
        assert np.sqrt((r @ np.linalg.solve(M, r)) / (b @ np.linalg.solve(M, b))) <= 1.01 * tolerance


def test_zero_load_gives_zero(matrix):
    assert not conjugate_gradients(lambda p: matrix @ p, lambda r: r, np.zeros(40), 1e-8, 5).any()


def test_negative_curvature_is_refused(matrix):
    shifted = matrix - np.linalg.eigvalsh(matrix)[20] * np.eye(40)
    with pytest.raises(NegativeCurvatureError):
        conjugate_gradients(lambda p: shifted @ p, lambda r: r, np.ones(40), 1e-12, 400)


def test_too_few_steps_are_told(matrix):
    with pytest.raises(StaleError):
        conjugate_gradients(lambda p: matrix @ p, lambda r: r, np.ones(40), 1e-12, 2)
