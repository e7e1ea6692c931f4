# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline.material import density
from palpate.fem_offline.verification.convergence import slopes
from palpate.fem_offline.verification.manufactured import Manufactured, errors, manufactured_body
from palpate.fem_offline.verification.simplex_rule import simplex_rule

FINITE = Manufactured(0.48, 0.2, 0.5, True)
PLACES = np.random.default_rng(0).uniform(-0.01, 0.01, (5, 3))


@pytest.mark.parametrize(
    ("nu", "swelling", "linear", "theory"),
    [(0.25, 0.1, False, (3, 2)), (0.4999, 0.5, False, (2, 1)), (0.25, 0.1, True, (2, 1))],
    ids=["kappa whole", "kappa split", "linear tetrahedra"],
)
def test_errors_fall_at_the_order_of_theory(nu, swelling, linear, theory):
    assert slopes(Manufactured(nu, 0.1, swelling, False), (4, 6), linear) == pytest.approx(theory, abs=0.15)


def test_gradient_is_the_displacements_derivative():
    h = 1e-6
    for j in range(3):
        step = h * np.eye(3)[j]
        change = (FINITE.displacement(PLACES + step) - FINITE.displacement(PLACES - step)) / (2.0 * h)
        assert FINITE.gradient(PLACES)[..., j] == pytest.approx(change, abs=1e-8)


def test_body_force_is_minus_the_stress_divergence():
    h = 1e-6
    expected = np.zeros_like(PLACES)
    for j in range(3):
        step = h * np.eye(3)[j]
        expected -= (FINITE.stress(PLACES + step) - FINITE.stress(PLACES - step))[..., j] / (2.0 * h)
    assert FINITE.body_force(PLACES) == pytest.approx(expected, rel=1e-6)


def test_stress_is_the_materials():
    F = np.eye(3) + FINITE.gradient(PLACES)
    assert FINITE.stress(PLACES) == pytest.approx(density(FINITE.material, F)[1], rel=1e-10)


def test_the_interpolant_is_nearly_right():
    body = manufactured_body(FINITE, 3)
    error, slope = errors(body.space, body.given, FINITE)
    assert error < 0.02 and slope < 0.1


@pytest.mark.parametrize("dimension", [2, 3])
def test_rule_is_exact_to_its_degree(dimension):
    """int L_0^a L_1^b over a simplex of measure 1 is a! b! n! / (a + b + n)!."""
    from math import factorial as f

    points, weights = simplex_rule(dimension, 3)
    for a, b in ((0, 0), (1, 0), (2, 3), (5, 0), (0, 4)):
        exact = f(a) * f(b) * f(dimension) / f(a + b + dimension)
        assert weights @ (points[:, 0] ** a * points[:, 1] ** b) == pytest.approx(exact, rel=1e-13)
