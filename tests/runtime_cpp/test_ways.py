# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Ways of touching: one field for several tilts of a tool; tilting while pressed creates no energy."""

from importlib.resources import files

import numpy as np
import pytest
import synthetic_field
from rfield_evaluation import curves_at, lattice_at
from scipy.spatial.transform import Rotation

from palpate.fields.cook import CookError, cook
from palpate.fields.rfield_layout import OLDER_VERSIONS
from palpate.fields.rfield_read import read_header, read_rfield
from palpate.runtime import Config, Field, Session, Tick

COSINES = (1.0, 0.8, 0.5)
ROUNDING = 1e-13  # J


@pytest.fixture(scope="module")
def tilted():
    """The plane in three ways: upright, softer and shorter at 37 degrees, stiffer at 60; and NumPy's view."""
    data = synthetic_field.three_ways()
    return data, Field.open(data), [read_rfield(data, way) for way in range(3)]


def evaluate(ways, q, cosine, offset):
    """U (n,) J, grad U (n, 3) N, k (n,) N/m at fixed way and yielded surface, from the file's numbers alone."""
    c = np.clip(cosine, COSINES[-1], COSINES[0])
    share = np.stack([np.interp(c, COSINES[::-1], row[::-1]) for row in np.eye(3)], axis=1)  # (n, ways)
    phi, grad_phi = lattice_at(ways[0].geometry.signed_distance, q)
    depth = share @ [w.tool.offset for w in ways] - phi[:, 0] - offset
    a, da = 0.0, 0.0
    for i, w in enumerate(ways):
        value, gradient = lattice_at(w.amplitudes, q)
        a, da = a + share[:, i : i + 1] * value, da + share[:, i, None, None] * gradient
    value, slope = curves_at(ways[0].energy_curves, np.maximum(depth, 0))
    stiffness, _ = curves_at(ways[0].stiffness_curves, np.maximum(depth, 0))
    r = value.shape[1]
    gradient = (
        np.einsum("nr,nir->ni", value, da[..., :r])
        - np.einsum("nr,nr->n", slope, a[:, :r])[:, None] * grad_phi[..., 0]
    )
    k = np.einsum("nr,nr->n", stiffness, a[:, r : r + stiffness.shape[1]])
    touching = depth > 0
    energy = np.einsum("nr,nr->n", value, a[:, :r])
    return np.where(touching, energy, 0), gradient * touching[:, None], np.maximum(k, 0) * touching


def tilts(angles):
    """Quaternions (n, 4) that tilt the tool's axis from +z by `angles` (n,) rad about y."""
    return Rotation.from_rotvec(np.outer(angles, [0, 1, 0])).as_quat()


def created(ways, q, r):
    """(ticks - 1,) J from nowhere: stored - work - hold, each tick's hold at the way and offset before it."""
    c, o, s = r["way_cosine"], r["surface_offset"], q - r["anchor"]
    energy, gradient, k = evaluate(ways, q, c, o)
    stored = energy + 0.5 * k * np.sum(s * s, axis=1)
    n = np.array([0.0, 0.0, 1.0])  # the plane's, flat
    dq = np.diff(q, axis=0)
    across = dq - np.outer(dq @ n, n)
    moved, _, _ = evaluate(ways, q[1:], c[:-1], np.minimum(o[:-1], np.maximum(r["depth"][1:], 0) + 1.0))
    hold = moved - energy[:-1] - np.sum(gradient[:-1] * dq, axis=1) + 0.5 * k[:-1] * np.sum(across**2, axis=1)
    work = -np.sum(r["force"][:-1] * dq, axis=1)
    error = np.abs(r["force"] + gradient + k[:, None] * s).max()
    return np.diff(stored) - work - hold, error


def test_samples_between_ways_are_their_blend(tilted):
    _, field, ways = tilted
    q = np.random.default_rng(0).uniform((-6e-3, -6e-3, 0.5e-3), (10e-3, 6e-3, 4e-3), (300, 3))
    for cosine in (1.0, 0.93, 0.8, 0.71, 0.5, 0.1):
        energy, gradient, k = evaluate(ways, q, np.full(300, cosine), 0.0)
        sample = field.sample(q, cosine)
        np.testing.assert_allclose(sample["stored_energy"], energy, atol=1e-15 + 1e-12 * energy.max())
        np.testing.assert_allclose(sample["force"], -gradient, atol=1e-12 * np.abs(gradient).max())
        np.testing.assert_allclose(sample["friction_stiffness"], k, atol=1e-12 * k.max())


def test_an_upright_tool_feels_the_first_way(tilted, plane):
    q = np.linspace((-3e-3, 0, 6e-3), (4e-3, 1e-3, 1e-3), 800)
    config = Config(friction_coefficient=0.3, speed_max=0.0)
    several, one = Session(tilted[1], config).tick_batch(q), Session(plane.field, config).tick_batch(q)
    for name in ("force", "depth", "stored_energy", "anchor", "dissipated_friction"):
        np.testing.assert_allclose(several[name], one[name], atol=1e-14)


def test_a_tilted_press_feels_its_own_way(tilted):
    _, field, _ = tilted
    z = np.linspace(6e-3, 2e-3, 500)
    for angle in (0.3, 0.8, 1.0):
        q = np.stack([0 * z - 4e-3, 0 * z, z], axis=1)
        r = Session(field, Config(friction_coefficient=0.0)).tick_batch(
            q, orientations=tilts(np.full(500, angle))
        )[-1]
        assert r["way_cosine"] == pytest.approx(
            np.cos(angle), abs=1e-9
        )  # the plane's lattice is flat to rounding
        np.testing.assert_allclose(r["force"], field.sample(q[-1:], np.cos(angle))[0]["force"], atol=1e-9)


def test_tilting_to_a_stiffer_way_yields_and_to_a_softer_one_loses_once(tilted):
    """Held still while it rocks: energy falls to the softest way's and stays there, force does not fade away."""
    session = Session(tilted[1], Config(friction_coefficient=0.0))
    down = np.linspace((-4e-3, 0, 6e-3), (-4e-3, 0, 2e-3), 500)
    pressed = session.tick_batch(down, orientations=tilts(np.zeros(500)))[-1]
    rock = np.arccos(
        0.75 + 0.25 * np.cos(np.linspace(0, 40 * np.pi, 8000))
    )  # cosines 1 to 0.5 and back, 20 times
    r = session.tick_batch(np.tile(down[-1], (8000, 1)), orientations=tilts(rock))
    stored = np.concatenate([[pressed["stored_energy"]], r["stored_energy"]])
    assert np.all(np.diff(stored) <= 1e-12 * stored[0])
    assert np.any(r["status"] & Tick.RULE_YIELDED)
    softest = tilted[1].sample(down[-1:], 0.8)[0]["stored_energy"]
    assert stored[-1] > (1 - 1e-9) * softest > 0.1 * stored[0]
    steps = np.linalg.norm(np.diff(r["force"], axis=0), axis=1)
    assert steps.max() < 0.02 * np.linalg.norm(pressed["force"])
    lifted = session.tick_batch(down[::-1], orientations=tilts(np.zeros(500)))[-1]
    assert lifted["stored_energy"] == 0 and lifted["surface_offset"] == 0


def test_turning_a_tool_into_the_tissue_stores_nothing(tilted):
    """The short, tilted tool is free where the upright one touches."""
    session = Session(tilted[1])
    place = np.tile((-4e-3, 0, 4.7e-3), (50, 1))
    r = session.tick_batch(place, orientations=tilts(np.linspace(1.0, 0.0, 50)))
    assert r["depth"][0] < 0 < r["depth"][-1]
    assert not r["stored_energy"].any() and not r["force"].any() and r["hold_leak"][-1] == 0


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_random_walks_with_random_tilts_create_nothing(tilted, friction):
    _, field, ways = tilted
    rng = np.random.default_rng(5)
    judged = 0
    for _ in range(60):
        ticks = 400
        v = np.zeros((ticks, 3))
        for i in range(1, ticks):
            v[i] = 0.9 * v[i - 1] + rng.normal(size=3) * 4e-5
        q = np.array([rng.uniform(-4e-3, 6e-3), 0, 5.3e-3]) + np.cumsum(v, axis=0)
        fold = (q[:, 2] - 0.6e-3) % 12e-3  # between 0.6 and 6.6 mm
        q[:, 2] = 0.6e-3 + np.minimum(fold, 12e-3 - fold)
        angle = np.cumsum(rng.normal(size=ticks) * rng.choice([0.01, 0.1]))
        r = Session(field, Config(friction_coefficient=friction, speed_max=0.0)).tick_batch(
            q, orientations=tilts(angle)
        )
        if np.any(r["status"] & ~np.uint32(Tick.FELT)):
            continue  # left the reach
        judged += 1
        made, error = created(ways, q, r)
        assert made.max() < ROUNDING and error < 1e-11
        last = r[-1]
        kept = last["stored_energy"] + last["dissipated_friction"] + last["dissipated_rule"]
        assert last["work_in"] + last["hold_leak"] == pytest.approx(kept, abs=ROUNDING)
    assert judged > 30


def test_a_tool_is_swapped_for_another_and_back_without_a_gain(tilted, plane):
    """From the plane's ball to the tilting tool while pressed, and back."""
    q = (-1e-3, 0, 2e-3)
    session = Session(plane.field, Config(friction_coefficient=0.2))
    stored = [session.tick_batch(np.linspace((-1e-3, 0, 6e-3), q, 500))[-1]["stored_energy"]]
    for _ in range(10):
        for field in (tilted[1], plane.field):
            session.set_field(field)
            r = session.tick(q, orientation=tilts([0.9])[0])
            stored.append(r["stored_energy"])
            assert r["force"][2] > 0.02
    assert np.all(np.diff(stored) <= 1e-12 * stored[0])


def test_files_of_version_1_still_open():
    data = (files("palpate.assets") / "fields" / "palpation_block.rfield").read_bytes()
    header = read_header(data)
    assert header["version"] == 1, "the shipped field was cooked again: keep the older file, it is the proof"
    assert (header["layout_hash"], header["header_size"]) == OLDER_VERSIONS[1]
    info = Field.open(data).info
    assert info.way_count == 1 and info.way_offset[0] == info.tool_offset == header["tool_offset"]
    truth = read_rfield(data)
    q = np.random.default_rng(2).uniform(info.box_min, info.box_max, (20000, 3))
    sample = Field.open(data).sample(q)
    q, sample = q[sample["region"] == 2], sample[sample["region"] == 2]
    a, _ = lattice_at(truth.amplitudes, q)
    value, _ = curves_at(truth.energy_curves, sample["depth"])
    energy = np.einsum("nr,nr->n", value, a[:, : value.shape[1]])
    assert len(q) > 100
    np.testing.assert_allclose(sample["stored_energy"], energy, atol=1e-12 * np.abs(energy).max())


@pytest.mark.parametrize("cosines", [(1.0,), (0.5, 0.8), (-0.1,), (0.9, 0.8, 0.7, 0.6)])
def test_ways_that_do_not_fall_or_are_too_many_are_refused(cosines):
    first = synthetic_field.FIELDS["plane"]()
    with pytest.raises(CookError, match="tilted"):
        cook(first, [(c, first) for c in cosines])
