# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A scale of stiffness by place multiplies energies, whatever material is there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.organ import Organ
from palpate.fem_offline.press import press
from palpate.fem_offline.site import open_site, patch_size
from palpate.fem_offline.tool import Sphere
from palpate.fem_offline.verification.blocks import block_organ


@pytest.fixture(scope="module")
def organ() -> Organ:
    """A small block, stiff where x > 4 mm, which is no face of its mesh."""
    made = block_organ(
        (0.05, 0.05, 0.03), (4, 4, 2), {0: NeoHookean(5400.0, 0.48), 1: NeoHookean(27e3, 0.45)}
    )
    return replace(made, label_at=lambda x: (x[:, 0] > 4e-3).astype(int))


def test_an_even_scale_multiplies_the_stiffness_of_every_material(organ):
    everything = np.ones(len(organ.tets), bool)
    plain = organ.rest_stiffness(everything)
    scaled = replace(organ, scale=lambda x: np.full(len(x), 3.0)).rest_stiffness(everything)
    assert abs(scaled - 3.0 * plain).max() < 1e-12 * abs(scaled).max()


def test_a_scale_of_one_changes_nothing(organ):
    one = replace(organ, scale=lambda x: np.ones(len(x)))
    np.testing.assert_allclose(one.fractions, organ.fractions, rtol=1e-14)
    uniform = replace(organ, label_at=None)
    np.testing.assert_allclose(
        replace(uniform, scale=lambda x: np.ones(len(x))).fractions, uniform.fractions, rtol=1e-14
    )


def test_a_tetrahedron_has_the_mean_scale_of_its_inside_and_the_border_stays_where_it_is(organ):
    sloped = replace(organ, scale=lambda x: 2.0 + 10.0 * x[:, 0])  # linear: its mean is its middle's
    middle = organ.points[organ.tets].mean(axis=1)
    np.testing.assert_allclose(sloped.fractions.sum(axis=1), 2.0 + 10.0 * middle[:, 0], rtol=1e-12)
    whole = (organ.fractions == 1.0).any(axis=1)
    share = sloped.fractions[whole] / sloped.fractions[whole].sum(axis=1, keepdims=True)
    np.testing.assert_allclose(share, organ.fractions[whole], atol=1e-14)


def test_a_press_into_tissue_of_any_scale_is_that_many_times_as_hard():
    """Contact too: its penalty follows the tissue at the contact."""
    ball, depth = Sphere(5e-3), np.array([1e-3])
    plain = block_organ((0.05, 0.05, 0.03), (5, 5, 3), {0: NeoHookean(5400.0, 0.48)})
    force = {}
    for scale in (0.01, 1.0, 100.0):
        organ = replace(plain, scale=lambda x, scale=scale: np.full(len(x), scale))
        site = open_site(organ, np.zeros(3), ball, patch_size(ball, 1e-3, radius=0.01), "full")
        force[scale] = press(site, ball, depth).force[-1]
    assert force[0.01] == pytest.approx(0.01 * force[1.0], rel=1e-5)
    assert force[100.0] == pytest.approx(100.0 * force[1.0], rel=1e-5)


def test_an_organ_of_a_millimetre_and_one_of_ten_metres_are_pressed_as_one_of_a_hand():
    """Dimensional analysis: lengths times s, force times s^2; whatever has a length of its own would show."""
    force = {}
    for s in (1 / 60, 1.0, 1000 / 6):
        organ = block_organ((0.06 * s, 0.06 * s, 0.04 * s), (4, 4, 3), {0: NeoHookean(5400.0, 0.48)})
        ball, depth = Sphere(5e-3 * s), np.array([1e-3 * s])
        size = patch_size(ball, depth[0], radius=0.01 * s, refinement=0.6)
        site = open_site(organ, s * np.array([1.3e-3, 0.7e-3, 0.0]), ball, size)
        force[s] = press(site, ball, depth).force[-1] / s**2
    assert force[1 / 60] == pytest.approx(force[1.0], rel=5e-3)
    assert force[1000 / 6] == pytest.approx(
        force[1.0], rel=0.02
    )  # its patch is finer away from the tool: 1.1 %
