# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Device limits, adhesion and changed fields through the Python view, energies recomputed from positions and forces."""

import numpy as np
import pytest
import synthetic_field

from palpate.fields.cook import cook
from palpate.runtime import Adhesion, Config, Field, RuntimeFailure, Session, Tick

ROUNDING = 1e-13  # J


def cycle(ticks=1000):
    """(4 ticks, 3) m: down at x = -2 mm, across the 6:1 step, up at 7 mm, back in the air."""
    down = np.linspace((-2e-3, 0, 5.2e-3), (-2e-3, 0, 1e-3), ticks)
    across = np.linspace((-2e-3, 0, 1e-3), (7e-3, 0, 1e-3), 2 * ticks)
    return np.concatenate([down, across, np.linspace((7e-3, 0, 1e-3), (7e-3, 0, 5.2e-3), ticks)])


def hands_work(q, r):
    return -np.sum(r["force"][:-1] * np.diff(q, axis=0))


@pytest.mark.parametrize("adhesion", list(Adhesion))
@pytest.mark.parametrize("force_max", [0.0, 0.08])
def test_closed_paths_give_nothing_whatever_the_adhesion_and_the_limit(plane, adhesion, force_max):
    session = Session(
        plane.field, Config(friction_coefficient=0.3, speed_max=0.0, adhesion=adhesion, force_max=force_max)
    )
    q = cycle()
    r = session.tick_batch(q)
    last = r[-1]
    assert last["stored_energy"] == 0
    work = hands_work(q, r)
    assert work == pytest.approx(last["work_in"], abs=ROUNDING)
    moved = np.sum(np.diff(q, axis=0) ** 2)
    assert work >= -0.5 * plane.field.info.stiffness_max * moved
    assert work + last["hold_leak"] >= -ROUNDING
    if force_max:
        assert np.linalg.norm(r["force"], axis=1).max() <= force_max
        assert np.any(r["status"] & Tick.FORCE_LIMITED)


def test_at_the_limit_the_stored_energy_is_the_fields_at_the_yielded_depth(plane):
    """Recomputed from the field alone: a plane's energy at depth d - o is that of the point o further out."""
    session = Session(plane.field, Config(friction_coefficient=0.0, speed_max=0.0, force_max=0.08))
    r = session.tick_batch(np.linspace((-5e-3, 0, 6e-3), (-5e-3, 0, 1e-3), 2000))[-1]
    assert r["surface_offset"] > 1e-3
    out = r["reference_point"] + r["surface_offset"] * r["normal"]
    there = plane.field.sample(out)[0]
    assert there["stored_energy"] == pytest.approx(r["stored_energy"], rel=1e-3)
    assert np.linalg.norm(r["force"]) == pytest.approx(0.08, rel=2e-6)


def test_without_a_limit_nothing_yields(plane):
    r = Session(plane.field, Config(speed_max=0.0)).tick_batch(cycle())
    assert not r["surface_offset"].any()


def test_a_field_changed_in_contact_never_raises_stored_energy(plane, sphere):
    session = Session(plane.field, Config(speed_max=0.0))
    before = session.tick_batch(np.linspace((0, 0, 6e-3), (0, 0, 2e-3), 500))[-1]
    other = Field.open(cook(synthetic_field.FIELDS["plane"]()))
    session.set_field(other)
    after = session.tick((0, 0, 2e-3))
    assert after["stored_energy"] <= before["stored_energy"] * (1 + 1e-12)
    np.testing.assert_allclose(after["force"], before["force"], rtol=1e-9, atol=1e-12)  # the same field again
    session.set_field(sphere.field)  # deep inside that organ
    gone = session.tick((0, 0, 2e-3))
    assert not gone["force"].any() and gone["stored_energy"] == 0


@pytest.mark.parametrize("config", [Config(adhesion=0), Config(adhesion=5), Config(adhesion_start=1.0),
                                    Config(force_max=-1), Config(force_max=np.nan)])  # fmt: skip
def test_limits_out_of_range_are_refused(plane, config):
    with pytest.raises(RuntimeFailure):
        Session(plane.field, config)
