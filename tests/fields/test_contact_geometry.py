# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The signed distance as a lattice, against closed forms."""

import numpy as np
import pytest
from known_organ import BALL, KnownOrgan, geometry_of

from palpate.fields.contact_geometry import contact_geometry, known_cells
from palpate.fields.lattice import ABSENT_INSIDE, ABSENT_OUTSIDE, ABSENT_UNREACHED
from palpate.fields.lattice_stencil import sample_lattice

ORGAN = KnownOrgan()


def band_points(count: int, low: float, high: float, extent: float) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    c = ORGAN.cap_points(count, rng, extent)
    s = rng.uniform(low, high, count)
    return c + s[:, None] * ORGAN.normal(c), s


def test_distance_and_slope_are_right_in_the_whole_band_and_margin():
    geometry = geometry_of(ORGAN)
    q, s = band_points(200, -0.5e-3, 6e-3, 33e-3)
    sample = sample_lattice(geometry.signed_distance, q)
    assert sample.present.all()
    np.testing.assert_allclose(sample.value[:, 0], s, atol=2e-6)
    np.testing.assert_allclose(np.linalg.norm(sample.gradient[:, 0], axis=1), 1.0, atol=2e-3)
    assert geometry.error_p99 < 2e-6
    assert geometry.flagged_share == 0.0


def test_no_stored_coefficient_is_left_to_chance():
    """Every cell whose coefficients are all stored gives the distance, also beyond band and reach."""
    ball = KnownOrgan(BALL)
    lattice = geometry_of(ball).signed_distance
    q = lattice.origin + (known_cells(lattice) + 0.5) * lattice.spacing
    truth = np.linalg.norm(q, axis=1) - BALL[0]
    assert truth.min() < -3e-3 and truth.max() > 9e-3  # there are such cells
    np.testing.assert_allclose(sample_lattice(lattice, q).value[:, 0], truth, atol=1e-6)


def test_reported_error_covers_fresh_points_of_a_faceted_distance():
    """A distance with creases is fitted less well, and the report says how well."""

    def facets(q: np.ndarray) -> np.ndarray:
        return np.maximum(q[:, 2] + 0.15 * q[:, 0], q[:, 2] - 0.15 * q[:, 0]) / np.hypot(1, 0.15)

    def everywhere(q: np.ndarray) -> np.ndarray:
        return np.full(len(q), -1.0)

    bounds = np.array([[-0.02, -0.02, -0.02], [0.02, 0.02, 0.02]])
    geometry = contact_geometry(facets, everywhere, bounds, (0.0, 5e-3), spacing=2e-3, seed=1)
    rng = np.random.default_rng(7)
    q = rng.uniform([-0.02, -0.02, -4e-3], [0.02, 0.02, 8e-3], (20000, 3))
    truth = facets(q)
    q, truth = q[(truth > 0) & (truth < 5e-3)], truth[(truth > 0) & (truth < 5e-3)]
    error = np.quantile(np.abs(sample_lattice(geometry.signed_distance, q).value[:, 0] - truth), 0.99)
    assert 10e-6 < error < 100e-6
    assert abs(geometry.error_p99 - error) < 0.3 * error


def test_absent_blocks_say_why():
    lattice = geometry_of(ORGAN).signed_distance
    edge = 4 * lattice.spacing

    def label(q: np.ndarray) -> int:
        return int(lattice.block_index[tuple(np.floor((q - lattice.origin) / edge).astype(int))])

    assert label(np.array([0.043, 0.043, 0.044])) == ABSENT_OUTSIDE
    assert label(np.array([0.0, 0.0, 0.006])) == ABSENT_INSIDE
    c = ORGAN.foot(np.array([[0.043, 0.0, 0.021]]))[0]
    assert label(c + 2e-3 * ORGAN.normal(c[None])[0]) == ABSENT_UNREACHED


def test_same_input_gives_the_same_bits():
    first = geometry_of(ORGAN)
    geometry_of.cache_clear()
    assert np.array_equal(first.signed_distance.coefficients, geometry_of(ORGAN).signed_distance.coefficients)


def test_nothing_in_reach_is_refused():
    bounds = np.array([[0.2, 0.2, 0.2], [0.22, 0.22, 0.22]])
    with pytest.raises(ValueError, match="no cell of the band"):
        contact_geometry(ORGAN.signed_distance, ORGAN.reach, bounds, (0.0, 5e-3))
