# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What the runtime evaluates is what the ResponseField says, and its force is minus the gradient of its energy."""

import numpy as np
import pytest
from rfield_evaluation import evaluate

from palpate.runtime import Region

LOW, HIGH = (-10e-3, -10e-3, 0.2e-3), (16e-3, 10e-3, 7e-3)


@pytest.fixture(params=["plane", "sphere"])
def case(request):
    cooked = request.getfixturevalue(request.param)
    rng = np.random.default_rng(5)
    q = rng.uniform(LOW, HIGH, (3000, 3))
    if request.param == "sphere":
        q = rng.normal(size=(3000, 3))
        q *= rng.uniform(30.2e-3, 37e-3, (3000, 1)) / np.linalg.norm(q, axis=1, keepdims=True)
    return cooked, q


def test_samples_are_the_response_fields_own_values(case):
    cooked, q = case
    sample, truth = cooked.field.sample(q), evaluate(cooked.truth, q)
    contact = truth.depth > 0
    assert 0.3 < contact.mean() < 0.9
    assert np.array_equal(sample["region"] == Region.CONTACT, contact)
    np.testing.assert_allclose(sample["depth"], truth.depth, atol=1e-15)
    np.testing.assert_allclose(sample["normal"], truth.normal, atol=1e-12)
    for name, values in (
        ("stored_energy", truth.energy),
        ("friction_stiffness", truth.friction_stiffness),
        ("friction_coefficient", truth.friction_coefficient),
    ):
        np.testing.assert_allclose(sample[name][contact], values[contact], rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(sample["force"][contact], -truth.gradient[contact], rtol=1e-9, atol=1e-12)
    assert not sample["force"][~contact].any() and not sample["stored_energy"][~contact].any()


def test_force_is_minus_the_central_difference_of_the_energy(case):
    """1e-6 of the force; cells where the second derivative jumps inside the difference are left out by the median."""
    cooked, q = case
    sample = cooked.field.sample(q)
    q, sample = q[sample["depth"] > 0.1e-3], sample[sample["depth"] > 0.1e-3]
    h = 2e-7
    difference = np.stack(
        [
            (
                cooked.field.sample(q + h * e)["stored_energy"]
                - cooked.field.sample(q - h * e)["stored_energy"]
            )
            / (2 * h)
            for e in np.eye(3)
        ],
        axis=1,
    )
    error = np.linalg.norm(sample["force"] + difference, axis=1) / np.linalg.norm(sample["force"], axis=1)
    assert np.quantile(error, 0.95) < 1e-6
    assert error.max() < 2e-5  # h / spacing, where a cell border lies between


def test_stiffness_is_the_slope_of_the_normal_force_on_a_plane(plane):
    q = np.random.default_rng(6).uniform((-9e-3, -9e-3, 0.5e-3), (-3e-3, 9e-3, 4.5e-3), (500, 3))
    h = 1e-7
    up, down = (plane.field.sample(q + s * np.array([0, 0, h]))["normal_force"] for s in (1, -1))
    np.testing.assert_allclose(plane.field.sample(q)["stiffness"], (down - up) / (2 * h), rtol=1e-3)


def test_energy_is_continuous_where_amplitude_blocks_end(plane):
    """A line along the surface through the border of the stored amplitudes."""
    x = np.linspace(-14.9e-3, -8e-3, 20001)
    q = np.stack([x, 0 * x, np.full_like(x, 2e-3)], axis=1)
    s = plane.field.sample(q)
    touching = s["region"] == Region.CONTACT
    steps = np.linalg.norm(np.diff(s["force"][touching], axis=0), axis=1)
    assert steps.max() < 5e-3


def test_regions(plane, slab):
    q = np.array(
        [[0, 0, 0.5], [0, 0, 9e-3], [0, 0, 3e-3], [0, 0, -12e-3], [-14.9e-3, 0, 2e-3], [np.nan, 0, 0]]
    )
    assert list(plane.field.sample(q)["region"]) == [
        Region.OUTSIDE, Region.FREE, Region.CONTACT, Region.DEEP, Region.CONTACT, Region.UNKNOWN]  # fmt: skip
    beyond = plane.field.sample([[-15.1e-3, 0, 2e-3], [-30e-3, 0, 2e-3]])["region"]
    assert list(beyond) == [Region.UNREACHED, Region.OUTSIDE]
    assert slab.field.sample([[0, 0, 0]])["region"][0] == Region.CONTACT
