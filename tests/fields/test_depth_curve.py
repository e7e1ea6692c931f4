# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""One press as a curve."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palpate.fields.depth_curve import fit_depth_curve

D = 5e-3


def hertz(d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return 200 * d**2.5, 500 * d**1.5


def stiffening(d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return 200 * d**2.5 * (1 + 0.5 * d / D), 200 * (2.5 * d**1.5 + 0.5 * 3.5 * d**2.5 / D)


def punch(d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return 50 * d**2, 100 * d


@pytest.mark.parametrize(("law", "bar"), [(hertz, 1e-6), (stiffening, 5e-4), (punch, 1e-3)])
def test_exact_ladders_are_followed_between_their_depths(law, bar):
    depth = np.linspace(0, D, 11)
    energy, force = law(depth)
    curve = fit_depth_curve(depth, force, energy)
    d = np.linspace(0.1 * D, D, 97)
    true_energy, true_force = law(d)
    e, f, second = curve(d)
    np.testing.assert_allclose(f, true_force, rtol=bar)
    np.testing.assert_allclose(e, true_energy, rtol=bar)
    assert second.min() >= 0
    assert curve.convex and curve.force_residual < bar


def test_noise_is_averaged_not_followed():
    """Half a percent of noise in ten forces and energies leaves about half a percent in the curve."""
    rng = np.random.default_rng(0)
    depth = np.linspace(0, D, 11)
    worst = []
    for _ in range(30):
        energy, force = stiffening(depth)
        noisy = force * (1 + 0.005 * rng.normal(size=11)), energy * (1 + 0.005 * rng.normal(size=11))
        _, f, _ = fit_depth_curve(depth, *noisy)(np.linspace(0.15 * D, D, 50))
        worst.append(np.abs(f / stiffening(np.linspace(0.15 * D, D, 50))[1] - 1).max())
    assert np.mean(worst) < 0.008
    assert max(worst) < 0.02


@given(st.integers(0, 10_000), st.floats(0.0, 0.02))
@settings(max_examples=30, deadline=None)
def test_starts_at_rest_and_energy_force_stiffness_are_derivatives(seed, noise):
    rng = np.random.default_rng(seed)
    depth = np.sort(rng.uniform(0.1, 1, 8)) * D + np.arange(8) * 1e-5
    energy, force = stiffening(depth)
    curve = fit_depth_curve(depth, force * (1 + noise * rng.normal(size=8)), energy)
    for part in curve(np.array([0.0, -1e-3])):
        assert np.all(part[1:] == 0)
    assert curve(np.zeros(1))[0][0] == 0 and curve(np.zeros(1))[1][0] == 0
    d, h = np.linspace(0.05 * D, 1.3 * D, 40), 1e-7
    (e0, f0, _), (e1, f1, _), (_, f, s) = curve(d - h), curve(d + h), curve(d)
    np.testing.assert_allclose((e1 - e0) / (2 * h), f, rtol=1e-5, atol=1e-9)
    np.testing.assert_allclose((f1 - f0) / (2 * h), s, rtol=1e-3, atol=1e-3)
    if curve.convex:
        assert curve(np.linspace(0, D, 300))[2].min() >= -1e-12


def test_convexity_yields_to_data_that_soften():
    """A force that falls by a third is no noise."""
    depth = np.linspace(0, D, 16)
    fine = np.linspace(0, D, 4001)

    def law(d):
        return np.sin(np.pi * np.clip(d / D, 0, 1) * 0.75) ** 1.5

    energy = np.interp(
        depth, fine, np.concatenate([[0], np.cumsum(0.5 * np.diff(fine) * (law(fine)[1:] + law(fine)[:-1]))])
    )
    curve = fit_depth_curve(depth, law(depth), energy)
    assert not curve.convex
    assert curve.force_residual < 0.03


def test_ripples_do_not_break_convexity():
    depth = np.linspace(0, D, 11)
    energy, force = hertz(depth)
    force = force * (1 + 0.006 * np.sin(40 * np.arange(11)))
    curve = fit_depth_curve(depth, force, energy)
    assert curve.convex and curve(np.linspace(0, D, 200))[2].min() >= -1e-12


def test_bad_ladders_are_refused_in_words():
    d = np.linspace(0, D, 6)
    with pytest.raises(ValueError, match="at least 3"):
        fit_depth_curve(d[:3], d[:3], d[:3])
    with pytest.raises(ValueError, match="finite"):
        fit_depth_curve(d, d * np.nan, d)
    with pytest.raises(ValueError, match="must be > 0"):
        fit_depth_curve(d, -d, d**2)
