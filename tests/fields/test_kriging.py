# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Gradient-enhanced kriging."""

import numpy as np
import pytest

from palpate.fields.covariance import KrigingSettings, Pairs, Sites, covariance, matern
from palpate.fields.kriging import fit_kriging
from palpate.fields.roughness import Roughness


def surface(count: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Points of a plane in 6 dimensions, two directions, two smooth columns and their gradients."""
    rng = np.random.default_rng(seed)
    z = np.zeros((count, 6))
    z[:, :2] = rng.uniform(-0.03, 0.03, (count, 2))
    z[:, 5] = 0.02
    x, y = z[:, 0] / 0.012, z[:, 1] / 0.015
    values = np.stack([np.sin(x) * np.cos(y), np.cos(x + y)], axis=1)
    along_x = np.stack([np.cos(x) * np.cos(y), -np.sin(x + y)], axis=1) / 0.012
    along_y = np.stack([-np.sin(x) * np.sin(y), -np.sin(x + y)], axis=1) / 0.015
    directions = np.zeros((count, 2, 6))
    directions[:, 0, 0] = directions[:, 1, 1] = 1.0
    return z, values, directions, np.stack([along_x, along_y], axis=1)


def test_covariances_are_derivatives_of_the_covariance():
    rng = np.random.default_rng(1)
    z, u = rng.normal(size=(2, 6)) * 0.02, rng.normal(size=(2, 2, 6))
    settings = KrigingSettings(0.03, 0.0, 0.0)
    sites = Sites(z, u)
    K = covariance(Pairs.of(sites, sites), settings).reshape(2, 3, 2, 3)
    h = 1e-5

    def k(a: np.ndarray, b: np.ndarray) -> float:
        return float(matern(np.linalg.norm(a - b)[None], 0.03)[0][0])

    for t in range(2):
        v = u[1, t]
        assert abs(K[0, 0, 1, 1 + t] - (k(z[0], z[1] + h * v) - k(z[0], z[1] - h * v)) / (2 * h)) < 1e-4
        w = u[0, t]
        assert abs(K[0, 1 + t, 1, 0] - (k(z[0] + h * w, z[1]) - k(z[0] - h * w, z[1])) / (2 * h)) < 1e-4
        for r in range(2):
            w = u[0, r]
            numeric = sum(a * b * k(z[0] + a * h * w, z[1] + b * h * v) for a in (-1, 1) for b in (-1, 1)) / (
                4 * h * h
            )
            assert abs(K[0, 1 + r, 1, 1 + t] - numeric) < 1e-3 * abs(K).max()
    np.testing.assert_allclose(K.reshape(6, 6), K.reshape(6, 6).T, atol=1e-9)
    assert np.linalg.eigvalsh(K.reshape(6, 6)).min() > 0


def test_a_rough_part_follows_the_product_rule():
    rng = np.random.default_rng(4)
    rough = Roughness(rng.normal(size=(5, 6)) * 0.02, np.full(5, 0.03), rng.uniform(0, 5e4, 5))
    settings = KrigingSettings(0.03, 0.0, 0.0, 0.008, 0.5)
    z, u, h = rng.normal(size=(2, 6)) * 0.01, rng.normal(size=(2, 1, 6)), 1e-6

    def cov(a, b):
        first, second = (rough.sites(x, u[:1]) for x in (a[None], b[None]))
        return covariance(Pairs.of(first, second), settings)

    K = covariance(Pairs.of(rough.sites(z, u), rough.sites(z, u)), settings).reshape(2, 2, 2, 2)
    along = (cov(z[0], z[1] + h * u[1, 0])[0, 0] - cov(z[0], z[1] - h * u[1, 0])[0, 0]) / (2 * h)
    assert abs(K[0, 0, 1, 1] - along) < 1e-5 * abs(along)
    assert np.linalg.eigvalsh(K.reshape(4, 4)).min() > 0


def test_without_noise_values_and_gradients_are_met():
    z, values, directions, gradients = surface(25)
    model = fit_kriging(z, values, directions, gradients, settings=KrigingSettings(0.03, 0.0, 0.0))
    np.testing.assert_allclose(model.predict(z), values, atol=1e-6)
    h = 1e-6
    slope = (model.predict(z + h * directions[:, 0]) - model.predict(z - h * directions[:, 0])) / (2 * h)
    np.testing.assert_allclose(slope, gradients[:, 0], atol=1e-3 * np.abs(gradients).max())


@pytest.mark.parametrize("with_gradients", [True, False])
def test_leaving_out_in_closed_form_is_leaving_out(with_gradients):
    z, values, directions, gradients = surface(14)
    data = (directions, gradients) if with_gradients else (None, None)
    settings = KrigingSettings(0.025, 1e-4, 1e-2)
    whole = fit_kriging(z, values, *data, settings=settings)
    for i in (0, 5, 13):
        keep = np.arange(14) != i
        rest = [None if a is None else a[keep] for a in data]
        left = fit_kriging(z[keep], values[keep], *rest, settings=settings)
        np.testing.assert_allclose(whole.left_out[i], values[i] - left.predict(z[i : i + 1])[0], atol=1e-7)


def test_gradients_are_worth_presses():
    z, values, directions, gradients = surface(30)
    fresh, truth, _, _ = surface(200, seed=7)
    inner = np.abs(fresh[:, :2]).max(axis=1) < 0.025
    with_them = np.abs(fit_kriging(z, values, directions, gradients).predict(fresh) - truth)[inner]
    without = np.abs(fit_kriging(z, values).predict(fresh) - truth)[inner]
    assert np.quantile(with_them, 0.95) < 0.4 * np.quantile(without, 0.95)


def test_noise_goes_to_the_nugget():
    z, values, _, _ = surface(120)
    noisy = values + 0.1 * np.random.default_rng(3).normal(size=values.shape)
    model = fit_kriging(z, noisy)
    assert 1e-3 < model.settings.value_noise < 0.2
    assert np.sqrt(np.mean((model.predict(z) - values) ** 2)) < 0.06


def test_trend_carries_constants_and_scaling():
    z, values, directions, gradients = surface(20)
    fresh = surface(50, seed=3)[0]
    settings = KrigingSettings(0.03, 1e-4, 1e-3)
    plain = fit_kriging(z, values, directions, gradients, settings=settings).predict(fresh)
    moved = fit_kriging(z, 5 * values + 7, directions, 5 * gradients, settings=settings).predict(fresh)
    np.testing.assert_allclose(moved, 5 * plain + 7, atol=1e-8)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_few_points_are_interpolated_without_a_search(count):
    z, values, directions, gradients = surface(count)
    model = fit_kriging(z, values, directions, gradients)
    np.testing.assert_allclose(model.predict(z), values, atol=0.2)
    assert np.isfinite(model.predict(surface(10, seed=5)[0])).all()


def test_bad_data_are_refused():
    z, values, _, _ = surface(5)
    with pytest.raises(ValueError, match="coincide"):
        fit_kriging(np.concatenate([z, z[:1]]), np.concatenate([values, values[:1]]))
    with pytest.raises(ValueError, match="finite"):
        fit_kriging(z, values * np.nan)


def test_more_points_than_can_be_held_are_refused_with_how_many_would_do():
    count = 100_000
    z = np.zeros((count, 6))
    with pytest.raises(ValueError, match=r"at most 5000 such points"):
        fit_kriging(z, np.zeros((count, 1)), np.zeros((count, 2, 6)), np.zeros((count, 2, 1)))
