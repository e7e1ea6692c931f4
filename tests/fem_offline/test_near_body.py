# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline.linear_body import LinearBody
from palpate.fem_offline.near_body import NearBody
from palpate.fem_offline.site import open_site, patch_size
from palpate.fem_offline.tool import Sphere

TOOL = Sphere(5e-3)
STEP = 1e-7  # m


@pytest.fixture(scope="module", params=["near_field", "linear"])
def body(request, supported_block):
    size = patch_size(TOOL, 2e-3, radius=0.012)
    return open_site(supported_block, np.array([4e-3, 1e-3, 0.0]), TOOL, size, request.param).body


@pytest.fixture(scope="module")
def moved(body):
    """A displacement that strains the patch and turns the interface."""
    rng = np.random.default_rng(5)
    u = body.moved(np.zeros_like(body.nodes), np.zeros(body.equation_count))
    u[: len(body.tissue.nodes)] = 2e-4 * np.sin(60.0 * body.tissue.nodes[:, [1, 2, 0]])
    u[body.held] = 0.0
    step = np.zeros(body.equation_count)
    step[-body.far.count :] = 3e-4 * rng.standard_normal(body.far.count)
    return body.moved(u, step)


def directions(body, count=4):
    rng = np.random.default_rng(7)
    for _ in range(count):
        d = rng.standard_normal(body.equation_count)
        yield d / np.abs(d).max()


def test_force_is_the_slope_of_the_energy(body, moved):
    gradient = body.state(moved).force.ravel()[body.equation >= 0]
    for d in directions(body):
        up, down = (body.state(body.moved(moved, s * STEP * d)).energy for s in (1, -1))
        assert np.isfinite(up + down)
        assert gradient @ d == pytest.approx((up - down) / (2 * STEP), rel=1e-5)


def test_hessian_is_the_slope_of_the_force(body, moved):
    upper = body.pattern.matrix(body.hessian(moved))
    for d in directions(body):
        up, down = (
            body.state(body.moved(moved, s * STEP * d)).force.ravel()[body.equation >= 0] for s in (1, -1)
        )
        product = upper @ d + upper.T @ d - upper.diagonal() * d
        assert product == pytest.approx((up - down) / (2 * STEP), abs=1e-6 * np.abs(product).max())


def test_only_the_near_field_turns(body, moved):
    assert (body.angle(moved) > 1e-3) == (not isinstance(body, LinearBody))


def test_the_estimate_grows_with_the_angle(body, moved):
    small, large = (body.far_field_error(s * moved, body.state(body.follow(s * moved))) for s in (0.1, 1.0))
    if isinstance(body, LinearBody):
        assert np.isnan(small) and np.isnan(large)
    else:
        assert 0.0 < small < 0.3 * large


def test_a_linear_body_s_forces_are_proportional(supported_block, body, moved):
    if type(body) is NearBody:
        half, whole = (body.state(body.follow(s * moved)).force for s in (0.5, 1.0))
        assert np.abs(2.0 * half - whole).max() > 1e-3 * np.abs(whole).max()
    else:
        half, whole = (body.state(body.follow(s * moved)).force for s in (0.5, 1.0))
        assert 2.0 * half == pytest.approx(whole, abs=1e-12 * np.abs(whole).max())
