# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A slender bar bends at the frequencies of beam theory, held and free; mass is what the organ weighs."""

from __future__ import annotations

import numpy as np
import pytest

from palpate.fem_offline.block import block
from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.organ import Organ
from palpate.fem_offline.quadratic_space import quadratic_space
from palpate.fem_offline.vibration import consistent_mass, vibration_modes

LENGTH, WIDTH, HEIGHT = 0.20, 0.02, 0.01
E, NU, DENSITY = 1e9, 0.3, 1000.0
BENDING = 0.5 / np.pi * np.sqrt(E * HEIGHT**2 / (12.0 * DENSITY)) / LENGTH**2
"""Hz; times (beta L)^2 the frequency of an Euler-Bernoulli beam that bends across its height."""


@pytest.fixture(scope="module")
def bar() -> Organ:
    mesh = block((LENGTH, WIDTH, HEIGHT), (20, 2, 2))
    return Organ(
        mesh.points, mesh.tets, {0: NeoHookean(E, NU)}, np.zeros(len(mesh.tets), int),
        lambda x: x[:, 0] < -0.5 * LENGTH + 1e-9, lambda p: (p, p), "bar",
    )  # fmt: skip


def test_the_mass_is_density_times_volume_and_turns_like_a_solid() -> None:
    mesh = block((LENGTH, WIDTH, HEIGHT), (4, 2, 2))
    space = quadratic_space(mesh.points, mesh.tets)
    mass = consistent_mass(space, DENSITY)
    assert mass.sum() == pytest.approx(DENSITY * LENGTH * WIDTH * HEIGHT, rel=1e-12)
    x = space.nodes[:, 0]
    assert x @ (mass @ x) == pytest.approx(DENSITY * WIDTH * HEIGHT * LENGTH**3 / 12.0, rel=1e-12)


@pytest.mark.parametrize(("free", "roots"), [(False, (1.8751, 4.6941)), (True, (4.7300, 7.8532))])
def test_a_slender_bar_bends_at_the_frequencies_of_a_beam(
    bar: Organ, free: bool, roots: tuple[float, ...]
) -> None:
    modes = vibration_modes(bar, DENSITY, 6, free)
    middle = (abs(bar.space.nodes[:, 1]) < 1e-9) & (abs(bar.space.nodes[:, 2] + 0.5 * HEIGHT) < 1e-9)
    size = np.linalg.norm(modes.shape[:, middle], axis=1)
    bends = modes.frequency[np.argmax(size, axis=1) == 2]  # across the height, not the width, and no twist
    for found, root, within in zip(bends, roots, (0.01, 0.03), strict=False):
        assert found == pytest.approx(BENDING * root**2, rel=within)
    if free:  # shear and rotary inertia slow a beam down; a clamp that lets nothing contract stiffens it
        assert np.all(bends[:2] < BENDING * np.square(roots))


def test_modes_are_orthogonal_with_unit_modal_mass_and_free_ones_carry_no_momentum(bar: Organ) -> None:
    mass = consistent_mass(bar.space, DENSITY)
    modes = vibration_modes(bar, DENSITY, 4, free=True)
    assert len(modes.frequency) == 4 and np.all(np.diff(modes.frequency) > 0)
    product = np.einsum("inx,jnx->ij", modes.shape, np.stack([mass @ one for one in modes.shape]))
    assert product == pytest.approx(np.eye(4), abs=1e-8)
    momentum = np.stack([(mass @ one).sum(axis=0) for one in modes.shape])
    assert abs(momentum).max() < 1e-6 * np.sqrt(mass.sum())


def test_what_makes_no_modes_is_refused(bar: Organ) -> None:
    with pytest.raises(ValueError, match="above 0"):
        vibration_modes(bar, 0.0, 3)
    with pytest.raises(ValueError, match="degrees of freedom"):
        vibration_modes(bar, DENSITY, 10**6)
