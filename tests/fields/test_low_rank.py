# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Shared piecewise cubic curves."""

import numpy as np

from palpate.fields.low_rank import low_rank_energy, second_derivatives
from palpate.fields.shared_curves import curves_from_second_derivative, curves_from_values, evaluate_curves

D = 5e-3


def test_curves_start_at_rest_are_c2_and_have_the_given_second_derivative():
    second = np.abs(np.random.default_rng(0).normal(size=(2, 9)))
    curves = curves_from_second_derivative(D, second)
    h = D / 8
    edges = np.arange(9) * h
    for side in (-1e-12, 1e-12):
        value, slope, bend = evaluate_curves(curves, edges[1:-1] + side)
        np.testing.assert_allclose(bend, second.T[1:-1], atol=1e-7)
        reference = evaluate_curves(curves, edges[1:-1])
        np.testing.assert_allclose(value, reference[0], atol=1e-12)
        np.testing.assert_allclose(slope, reference[1], atol=1e-9)
    value, slope, _ = evaluate_curves(curves, np.array([1e-15]))
    assert abs(value).max() < 1e-20 and abs(slope).max() < 1e-12


def test_curves_are_integrals_of_each_other_and_end_as_quadratics():
    curves = curves_from_second_derivative(D, np.abs(np.random.default_rng(1).normal(size=(3, 33))))
    d, h = np.linspace(1e-5, 1.5 * D, 400), 1e-8
    _, slope, bend = evaluate_curves(curves, d)
    ahead, behind = evaluate_curves(curves, d + h), evaluate_curves(curves, d - h)
    np.testing.assert_allclose((ahead[0] - behind[0]) / (2 * h), slope, rtol=1e-5, atol=1e-12)
    np.testing.assert_allclose((ahead[1] - behind[1]) / (2 * h), bend, rtol=1e-4, atol=1e-6)
    beyond = evaluate_curves(curves, np.array([D, 1.2 * D, 2 * D]))[2]
    np.testing.assert_allclose(beyond, beyond[:1].repeat(3, axis=0))
    assert all(np.all(part == 0) for part in evaluate_curves(curves, np.array([0.0, -1e-3])))


def test_values_are_interpolated():
    values = np.random.default_rng(2).uniform(1, 2, (2, 17))
    at = evaluate_curves(curves_from_values(D, values), np.arange(1, 17) * D / 16)[0]
    np.testing.assert_allclose(at, values.T[1:], rtol=1e-12)


def hertz_family(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    depth = D * (np.arange(64) + 1) / 64
    scale, beta, power = (
        rng.uniform(100, 600, (count, 1)),
        rng.uniform(0, 1, (count, 1)),
        rng.uniform(2.4, 2.7, (count, 1)),
    )
    x = depth / D
    energy = scale * x**power * (1 + beta * x)
    force = scale / D * x ** (power - 1) * (power + beta * (power + 1) * x)
    return depth, energy, force


def test_three_curves_stand_for_a_family_of_presses():
    depth, energy, force = hertz_family(300)
    second = second_derivatives(depth, energy, force, D, 32, convex=True)
    assert second.min() >= -1e-9
    result = low_rank_energy(second, D, 3)
    assert result.error_p95 < 3e-3
    value, slope, bend = evaluate_curves(result.curves, depth)
    felt = force > 0.05 * force[:, -1:]
    assert np.quantile(np.abs((result.amplitudes @ slope.T) / force - 1)[felt], 0.95) < 5e-3
    assert np.quantile(np.abs((result.amplitudes @ value.T) / energy - 1)[felt], 0.95) < 5e-3
    assert (result.amplitudes @ bend.T).min() > 0  # still convex
    assert 0.1 < np.abs(result.amplitudes[:, 0]).mean() < 10


def test_convexity_is_held_where_asked():
    depth, energy, force = hertz_family(5)
    force = force * (1 - 0.4 * np.exp(-(((depth / D - 0.7) / 0.05) ** 2)))
    assert second_derivatives(depth, energy, force, D, 32, convex=False).min() < 0
    assert second_derivatives(depth, energy, force, D, 32, convex=True).min() >= 0
