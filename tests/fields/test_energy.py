# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Sticking and slipping, and whether energy is created."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from known_organ import FLAT, KnownOrgan, field_of

from palpate.fields.energy import energy_audit
from palpate.fields.friction import follow
from palpate.fields.interpolation import evaluate

ORGAN = KnownOrgan(FLAT)
ROUNDING = 1e-14
"""J; sums of ten thousand terms of the order of a millijoule."""


def place(x: float, y: float, s: float) -> np.ndarray:
    """Tool reference (3,) m above the cap at x, y, at distance s from the surface."""
    a, b, h = FLAT
    c = np.array([[x, y, h * np.sqrt(1 - (x / a) ** 2 - (y / b) ** 2)]])
    return (c + s * ORGAN.normal(c))[0]


def line(*corners: np.ndarray, ticks: int = 2000) -> np.ndarray:
    parts = [a + np.linspace(0, 1, ticks)[:, None] * (b - a) for a, b in pairwise(corners)]
    return np.concatenate(parts)


def test_sticking_pulls_back_like_a_spring_and_slipping_like_coulomb():
    field = field_of(ORGAN, 25)
    down, side = place(0, 0, 2e-3), place(0, 0, 2e-3) + np.array([3e-3, 0, 0])
    path = line(place(0, 0, 6e-3), down, side)
    told = follow(field, path)
    tangential = told.stiffness[:, None] * told.stretch
    at = evaluate(field, path)
    pull = np.linalg.norm(tangential, axis=1)
    limit = at.friction_coefficient * at.normal_force
    assert np.all(pull <= limit * (1 + 1e-12) + 1e-15)
    assert told.slipping[-1] and pull[-1] == pytest.approx(limit[-1])
    early = 2000 + 20
    moved = path[early] - path[2000]
    expected = told.stiffness[early] * moved
    assert not told.slipping[early]
    np.testing.assert_allclose(tangential[early], expected, rtol=0.03, atol=1e-5)
    assert told.force[-1, 0] < at.force[-1, 0]  # friction opposes the move


def test_deeper_contact_carries_no_shear_yet_and_lift_off_forgets():
    field = field_of(ORGAN, 25)
    path = line(
        place(0, 0, 6e-3), place(0, 0, 3e-3), place(2e-4, 0, 3e-3), place(2e-4, 0, 1e-3), place(2e-4, 0, 6e-3)
    )
    told = follow(field, path)
    pull = told.stiffness[:, None] * told.stretch
    deepening = slice(4000, 5999)
    steps = np.abs(np.diff(pull[deepening, 0]))
    assert steps.max() < 0.01 * np.abs(pull[3999]).max()
    assert np.abs(pull[5999, 0]) == pytest.approx(np.abs(pull[3999, 0]), rel=0.1)
    assert not told.stretch[-1].any() and told.stored[-1] == 0.0


@pytest.mark.parametrize("friction", [0.0, 0.1, 0.3])
def test_closed_cycle_from_soft_to_stiff_returns_no_energy(friction):
    """Press where it is soft, drag to where it is stiff, lift, return: the published per-point schemes gain here."""
    organ = KnownOrgan(FLAT, friction=friction, stiffness_ratio=0.7 if friction else 0.0)
    field = field_of(organ, 25)
    x = np.linspace(-15e-3, 15e-3, 61)
    stiff = [float(evaluate(field, place(v, 0, 1.5e-3)[None]).normal_force[0]) for v in x]
    soft_x, stiff_x = x[int(np.argmin(stiff))], x[int(np.argmax(stiff))]
    assert max(stiff) > 2 * min(stiff)
    drag = np.array([place(v, 0, 1.5e-3) for v in np.linspace(soft_x, stiff_x, 2000)])
    path = np.concatenate(
        [
            line(place(soft_x, 0, 6e-3), drag[0], ticks=1000),
            drag,
            line(drag[-1], place(stiff_x, 0, 6e-3), place(soft_x, 0, 6e-3), ticks=1000),
        ]
    )
    told = follow(field, path)
    audit = energy_audit(field, path, told.force, told.stretch)
    assert audit.leak <= ROUNDING
    scale = audit.stored.max()
    if friction == 0.0:
        assert abs(audit.work[-1]) < 2e-3 * scale
    else:
        assert audit.work[-1] > 0.01 * scale


@given(st.integers(0, 10_000), st.sampled_from([0.05, 0.3, 1.0]), st.booleans())
@settings(max_examples=10, deadline=None)
def test_random_paths_never_gain_energy(seed, speed, closed):
    """Random walks in and out of contact, in reach and margin, some of them closed."""
    field = field_of(ORGAN, 25)
    rng = np.random.default_rng(seed)
    start = place(*rng.uniform(-14e-3, 14e-3, 2), 5.5e-3)
    walk = np.cumsum(rng.normal(size=(1000, 3)) * speed * 1e-4, axis=0)
    walk -= np.linspace(0, 1, 1000)[:, None] * np.array([0, 0, rng.uniform(0, 4e-3)])
    path = start + walk
    if closed:
        path = np.concatenate([path, path[::-1], path])
    valid = evaluate(field, path).valid
    path = path[: int(np.argmin(valid)) if not valid.all() else len(path)]
    if len(path) < 2:
        return
    told = follow(field, path)
    audit = energy_audit(field, path, told.force, told.stretch)
    np.testing.assert_allclose(audit.stored, told.stored, atol=1e-15)
    assert audit.leak <= ROUNDING
    step_hold, step_bound = np.diff(audit.hold), np.diff(audit.hold_bound)
    assert np.all(step_hold <= step_bound * 1.3 + 1e-12)


def test_the_audit_finds_energy_that_is_created():
    """Local springs along the normal, with stiffness that varies along the surface, push without a lateral force."""
    field = field_of(KnownOrgan(FLAT, friction=0.0), 25)
    x = np.linspace(-12e-3, 12e-3, 800)
    deep = np.array([place(v, 0, 1e-3) for v in x])
    path = np.concatenate(
        [
            line(place(-12e-3, 0, 6e-3), deep[0], ticks=500),
            deep,
            line(deep[-1], place(12e-3, 0, 6e-3), ticks=500),
        ]
    )
    at = evaluate(field, path)
    spring_only = at.normal_force[:, None] * at.normal
    nothing = np.zeros_like(path)
    gained = [
        energy_audit(field, p, f, nothing).leak
        for p, f in ((path, spring_only), (path[::-1], spring_only[::-1]))
    ]
    assert max(gained) > 0.05 * at.energy.max()


def test_the_audit_refuses_what_it_cannot_judge():
    field, p = field_of(ORGAN, 25), np.zeros((4, 3))
    with pytest.raises(ValueError, match="shapes"):
        energy_audit(field, p, p[:3], p)
    with pytest.raises(ValueError, match="finite"):
        energy_audit(field, p, p * np.nan, p)
