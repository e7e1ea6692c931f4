# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Scene data -> USD -> .rfield -> runtime, and back: energies are recomputed from the USD, not by the runtime."""

import numpy as np
import pytest
from known_organ import KnownOrgan, field_of

from palpate.fields.as_cooked import as_cooked
from palpate.fields.cook import cook
from palpate.fields.interpolation import evaluate
from palpate.fields.organ_geometry import OrganGeometry, Support
from palpate.fields.usd_read import read_field
from palpate.fields.usd_write import write_asset
from palpate.runtime import Config, Field, Session

TICKS = 60


@pytest.fixture(scope="module")
def from_usd(tmp_path_factory):
    """A field that went through a USD asset, and the runtime's field cooked from what was read."""
    points = 0.02 * np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], np.int32)
    organ = OrganGeometry(
        "ellipsoid", points, faces, points, np.array([[0, 1, 2, 3]], np.int32),
        (Support("bottom", np.array([0, 1, 2], np.int32)),), ("tissue",), np.zeros(1, np.int32),
        np.arange(4, dtype=np.int32), {"model": "neo_hookean", "youngs_modulus": 5400.0, "poissons_ratio": 0.48},
    )  # fmt: skip
    folder = tmp_path_factory.mktemp("asset")
    asset = write_asset(folder, organ, as_cooked(field_of(KnownOrgan(), 12)))
    field = read_field(asset, "ball")
    return field, Field.open(cook(field))


def test_what_usd_holds_is_what_the_runtime_reads(from_usd):
    field, runtime = from_usd
    rng = np.random.default_rng(0)
    c = KnownOrgan().cap_points(500, rng, 19e-3)
    q = c + (5e-3 - rng.uniform(0.0, 5e-3, (500, 1))) * KnownOrgan().normal(c)
    sample, twin = runtime.sample(q), evaluate(field, q)
    assert np.abs(sample["force"] - twin.force).max() < 1e-11 * np.abs(twin.force).max()
    assert np.abs(sample["stored_energy"] - twin.energy).max() < 1e-11 * twin.energy.max()


def random_walks(rng: np.random.Generator, count: int) -> np.ndarray:
    """(count, TICKS, 3): walks with inertia that start free above the cap; every second one returns the way it came."""
    organ = KnownOrgan()
    c = organ.cap_points(count, rng, 15e-3)
    start = c + 5.5e-3 * organ.normal(c)
    step = rng.normal(size=(count, TICKS - 1, 3)) * 1.5e-4
    for i in range(1, TICKS - 1):
        step[:, i] += 0.9 * step[:, i - 1]
    step[:, :6] -= 8e-4 * organ.normal(c)[:, None]  # into the tissue first
    walk = np.concatenate([start[:, None], start[:, None] + np.cumsum(step, axis=1)], axis=1)
    half = TICKS // 2
    walk[::2, half:] = walk[::2, half - 1 :: -1][:, : TICKS - half]
    return walk


@pytest.mark.parametrize("paths", [200, pytest.param(2_500, marks=pytest.mark.slow)])
@pytest.mark.parametrize("friction", [None, 0.0, 0.3, 1.0])
def test_random_and_closed_paths_create_no_energy_by_the_usd_data(from_usd, friction, paths):
    """10,000 paths in all when slow tests run; only paths that the runtime renders to their end are judged."""
    field, runtime = from_usd
    q = random_walks(np.random.default_rng(7), paths)
    config = Config(friction_coefficient=friction, speed_max=0.0)
    response = np.stack([Session(runtime, config).tick_batch(p) for p in q])
    rendered = (response["status"] & ~np.uint32(3)) == 0  # extrapolated and slipping are ordinary
    whole = rendered.all(axis=1)
    assert whole.mean() > 0.5
    moved = np.abs(np.sum(response["force"][whole][:, :-1] * np.diff(q[whole], axis=1), axis=2)).sum(axis=1)
    assert np.median(moved) > 1e-4  # J: the paths do press
    created, force_error = balance(field, q[whole], response[whole])
    assert force_error < 1e-10  # N
    assert created.max() < 1e-13  # J


def balance(field, q: np.ndarray, response: np.ndarray) -> tuple[np.ndarray, float]:
    """Energy from nowhere, (paths, ticks) J, and the largest |f + grad U + k s|, from the USD's field alone.

    created = E - E_0 - W - hold, with E = U + k |s|^2 / 2, W = -sum f . dq, and the zero-order hold's own terms
    U_i - U_(i-1) - grad U . dq + k |dq across|^2 / 2.
    """
    shape = q.shape[:2]
    e = evaluate(field, q.reshape(-1, 3))
    energy, k = e.energy.reshape(shape), e.friction_stiffness.reshape(shape)
    gradient, normal = e.gradient.reshape(q.shape), e.normal.reshape(q.shape)
    force, s, dq = response["force"], q - response["anchor"], np.diff(q, axis=1)
    across = dq - np.sum(dq * normal[:, :-1], axis=2, keepdims=True) * normal[:, :-1]
    stored = energy + 0.5 * k * np.sum(s * s, axis=2)
    hold = np.diff(energy, axis=1) - np.sum(gradient[:, :-1] * dq, axis=2)
    hold += 0.5 * k[:, :-1] * np.sum(across * across, axis=2)
    work = -np.sum(force[:, :-1] * dq, axis=2)
    created = np.diff(stored, axis=1) - work - hold
    return np.cumsum(created, axis=1), float(np.abs(force + gradient + k[..., None] * s).max())
