# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Quadratic B-spline lattices: what they reproduce, and their derivatives."""

import numpy as np

from palpate.fields.lattice import Lattice
from palpate.fields.lattice_fit import LatticeFit, blocks_of, lattice_from_values
from palpate.fields.lattice_stencil import sample_lattice, stencil

ORIGIN, SPACING = np.array([0.01, -0.02, 0.03]), 2e-3


def full_lattice(blocks: int = 3, channels: int = 2, seed: int = 0) -> Lattice:
    dense = np.random.default_rng(seed).normal(size=(4 * blocks,) * 3 + (channels,))
    present = np.ones((blocks,) * 3, dtype=bool)
    return lattice_from_values(ORIGIN, SPACING, dense, present, np.full(present.shape, -1))


def interior(count: int, blocks: int = 3, seed: int = 1) -> np.ndarray:
    u = np.random.default_rng(seed).uniform(0, 4 * blocks - 2, (count, 3))
    return ORIGIN + SPACING * u


def test_weights_sum_to_one_and_their_derivatives_to_zero():
    s = stencil(interior(50), ORIGIN, SPACING, hessian=True)
    np.testing.assert_allclose(s.value.sum(axis=1), 1.0, atol=1e-14)
    np.testing.assert_allclose(s.gradient.sum(axis=1), 0.0, atol=1e-9)
    np.testing.assert_allclose(s.hessian.sum(axis=1), 0.0, atol=1e-6)


def test_sum_is_the_formula_of_the_format():
    lattice, q = full_lattice(channels=1), interior(1)[0]
    u = (q - ORIGIN) / SPACING
    i = np.floor(u).astype(int)
    t = u - i
    w = np.array([(1 - t) ** 2 / 2, 0.5 + t * (1 - t), t**2 / 2])
    total = 0.0
    for a, b, c in np.ndindex(3, 3, 3):
        j = i + np.array([a, b, c])
        row = lattice.block_index[tuple(j // 4)]
        total += w[a, 0] * w[b, 1] * w[c, 2] * lattice.coefficients[(row, *(j % 4), 0)]
    assert abs(sample_lattice(lattice, q[None]).value[0, 0] - total) < 1e-14


def test_gradient_and_hessian_are_finite_differences():
    lattice, q = full_lattice(), interior(200)
    s, h = sample_lattice(lattice, q, hessian=True), 1e-8
    for axis, e in enumerate(np.eye(3)):
        ahead, behind = sample_lattice(lattice, q + h * e), sample_lattice(lattice, q - h * e)
        np.testing.assert_allclose(s.gradient[:, :, axis], (ahead.value - behind.value) / (2 * h), atol=1e-4)
        numeric = (ahead.gradient - behind.gradient) / (2 * h)
        np.testing.assert_allclose(s.hessian[..., axis], numeric, rtol=1e-4, atol=1.0)


def test_value_and_gradient_are_continuous_across_cells_and_blocks():
    lattice, q = full_lattice(), interior(200)
    q[:, 0] = ORIGIN[0] + SPACING * np.round((q[:, 0] - ORIGIN[0]) / SPACING)
    left = sample_lattice(lattice, q - np.array([1e-12, 0, 0]))
    right = sample_lattice(lattice, q + np.array([1e-12, 0, 0]))
    np.testing.assert_allclose(left.value, right.value, atol=1e-8)
    np.testing.assert_allclose(left.gradient, right.gradient, atol=1e-5)


def test_absent_blocks_count_as_zero_and_are_told():
    lattice = full_lattice()
    index = lattice.block_index.copy()
    index[2, 1, 1] = -3
    holed = Lattice(lattice.origin, lattice.spacing, index, lattice.coefficients)
    inside = ORIGIN + SPACING * np.array([[8.5, 4.5, 4.5]])
    away = ORIGIN + SPACING * np.array([[1.5, 1.5, 1.5]])
    assert sample_lattice(holed, inside).present.tolist() == [False]
    assert sample_lattice(holed, away).present.tolist() == [True]
    assert not sample_lattice(holed, np.array([[np.nan, 0, 0], [1e6, 0, 0]])).present.any()


def test_fit_reproduces_quadratics_exactly():
    wanted = np.ones((8, 8, 8), dtype=bool)
    fit = LatticeFit(ORIGIN, SPACING, wanted)
    q = interior(3000, blocks=2)

    def quadratic(p: np.ndarray) -> np.ndarray:
        x, y, z = ((p - ORIGIN) / SPACING).T
        return np.stack([1 + x - 2 * y + x * y + z * z, 3 * x * x - y * z], axis=1)

    values = fit.solve(q, quadratic(q), np.ones(len(q)), smoothing=1e-12, hold=1e-14, tolerance=1e-13)
    dense = np.zeros((8, 8, 8, 2))
    dense[tuple(fit.index.T)] = values
    lattice = lattice_from_values(ORIGIN, SPACING, dense, blocks_of(wanted), np.full((2, 2, 2), -1))
    p = interior(300, blocks=2, seed=9)
    np.testing.assert_allclose(sample_lattice(lattice, p).value, quadratic(p), atol=1e-6)
