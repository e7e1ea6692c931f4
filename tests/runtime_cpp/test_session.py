# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a session does at its edges: entry, lift-off, fast strokes, deep places, bad input."""

import numpy as np
import pytest

from palpate.runtime import Config, Region, RuntimeFailure, Session, Tick
from palpate.runtime.layout import STATE, Input

OUTSIDE, FREE, TOUCHING = (-4e-3, 0, 20e-3), (-4e-3, 0, 6e-3), (-4e-3, 0, 3e-3)
DEEP, DEEPEST = (-4e-3, 0, -1e-3), (-4e-3, 0, -12e-3)


def pressed(cooked, config=None, place=TOUCHING):
    """A session that went in from outside to `place` in 1,000 ticks, and its last response."""
    session = Session(cooked.field, config)
    above = (place[0], place[1], 8e-3)
    response = session.tick_batch(np.linspace(above, place, 1000))[-1]
    assert response["force"][2] > 0.05 and response["status"] & ~Tick.SLIPPING & ~Tick.EXTRAPOLATED == 0
    return session, response


def status(response):
    return Tick(int(response["status"]))


def silent(response):
    return not response["force"].any() and not response["torque"].any() and response["stored_energy"] == 0


def test_a_session_that_starts_inside_feels_nothing_until_it_has_been_outside(plane):
    session = Session(plane.field)
    for _ in range(3):
        r = session.tick(TOUCHING)
        assert silent(r) and status(r) == Tick.WAITING and r["region"] == Region.CONTACT
    assert status(session.tick(FREE)) == 0
    assert session.tick(TOUCHING)["force"][2] > 0.05


def test_first_contact_is_unstretched_and_lift_off_lets_go(plane):
    session = Session(plane.field)
    session.tick(FREE)
    r = session.tick((-4e-3, 0, 4.9e-3))
    assert np.array_equal(r["anchor"], r["reference_point"]) and r["spring_energy"] == 0
    session.tick_batch(np.linspace((-4e-3, 0, 4.9e-3), (-4e-3, 0, 3e-3), 200))
    assert session.tick((-3.99e-3, 0, 3e-3))["spring_energy"] > 0
    r = session.tick(FREE)
    assert silent(r) and status(r) == 0
    r = session.tick(TOUCHING)
    assert r["spring_energy"] == 0 and np.array_equal(r["anchor"], r["reference_point"])


def test_sticking_pulls_back_with_the_springs_stiffness(plane):
    session, before = pressed(plane)
    r = session.tick((TOUCHING[0] + 5e-6, 0, TOUCHING[2]))
    assert r["force"][0] - before["force"][0] == pytest.approx(-r["friction_stiffness"] * 5e-6, rel=1e-3)
    assert not status(r) & Tick.SLIPPING


def test_slipping_pulls_back_with_mu_times_the_normal_force(plane):
    session, _ = pressed(plane, Config(friction_coefficient=0.2))
    r = session.tick_batch(np.linspace(TOUCHING, (TOUCHING[0] + 2e-3, 0, TOUCHING[2]), 100))[-1]
    assert status(r) == Tick.SLIPPING
    friction = -r["friction_stiffness"] * (r["reference_point"] - r["anchor"])
    assert np.linalg.norm(friction) == pytest.approx(0.2 * r["normal_force"], rel=1e-9)
    assert friction[0] < 0


@pytest.mark.parametrize(
    ("change", "bit"),
    [
        ({"position": (np.nan, 0, 0)}, Tick.BAD_INPUT),
        ({"position": (0, np.inf, 0)}, Tick.BAD_INPUT),
        ({"position": (0, 0, 1e300)}, Tick.BAD_INPUT),
        ({"dt": 0.0}, Tick.BAD_INPUT),
        ({"dt": -1e-3}, Tick.BAD_INPUT),
        ({"dt": np.nan}, Tick.BAD_INPUT),
        ({"flags": 0, "orientation": (0, 0, 0, 0)}, Tick.BAD_INPUT),
        ({"flags": 0, "orientation": (0, np.nan, 0, 1)}, Tick.BAD_INPUT),
        ({"flags": 0, "orientation": (0, 0, 0, 2)}, Tick.BAD_INPUT),
        ({"dt": 0.5}, Tick.STALE),
        ({"position": (30e-3, 0, 3e-3)}, Tick.JUMP),
        ({"flags": Input.POSITION_ONLY | Input.RELEASE}, Tick.RELEASED),
        ({"position": DEEPEST, "dt": 0.09}, Tick.TOO_DEEP),
    ],
)
def test_what_cannot_be_rendered_releases_until_the_tool_was_outside(plane, change, bit):
    session, before = pressed(plane)
    state = np.zeros(1, dtype=STATE)
    state["position"], state["dt"], state["flags"] = TOUCHING, 1e-3, Input.POSITION_ONLY
    for name, value in change.items():
        state[name] = value
    r = session.tick_batch(state)[0]
    assert silent(r) and status(r) & bit
    r = session.tick(TOUCHING, dt=0.05)
    assert silent(r) and status(r) & (Tick.WAITING | Tick.PASSED_THROUGH)
    given = r["work_in"] + r["hold_leak"] - r["dissipated_friction"] - r["dissipated_rule"]
    assert given == pytest.approx(0, abs=1e-15)
    assert r["dissipated_rule"] >= 0 and before["stored_energy"] > 1e-5
    session.tick(FREE, dt=0.05)
    assert session.tick(TOUCHING)["force"][2] > 0.05


def test_deeper_than_the_presses_continues_and_says_so(plane):
    session, _ = pressed(plane)
    r = session.tick_batch(np.linspace(TOUCHING, DEEP, 1000))
    deep = r["depth"] > plane.field.info.depth_max
    assert deep.any() and np.array_equal((r["status"] & Tick.EXTRAPOLATED) != 0, deep)
    assert np.all(np.diff(r["normal_force"]) > 0)
    assert np.abs(np.diff(r["normal_force"], 2)).max() < 1e-5  # no kink where the curves end


def test_deeper_than_the_band_is_released(plane):
    session, _ = pressed(plane)
    r = session.tick_batch(np.linspace(TOUCHING, DEEPEST, 3000))
    assert silent(r[-1]) and status(r[-1]) == Tick.TOO_DEEP and r["region"][-1] == Region.DEEP
    assert silent(session.tick_batch(np.linspace(DEEPEST, TOUCHING, 3000))[-1])
    assert r["dissipated_rule"][-1] > 0


@pytest.mark.parametrize("speed", [1.0, 5.0, 9.0, 20.0, 80.0, 300.0])
def test_no_stroke_tunnels_through_a_slab(slab, speed):
    """6 mm of tissue and a 5 mm ball, started at 60 different places: felt, or known to have passed."""
    for offset in np.linspace(0, 1, 60, endpoint=False):
        session = Session(slab.field, Config(speed_max=0.0))
        z = np.arange(0.05 + offset * speed * 1e-3, -0.06 - speed * 1e-3, -speed * 1e-3)
        r = session.tick_batch(np.stack([0.3e-3 + 0 * z, 0 * z, z], axis=1))
        below = z < -1e-3
        assert not r["force"][below].any(), "force on the wrong side"
        stopped = Tick.PASSED_THROUGH | Tick.JUMP
        assert np.any(r["status"] & stopped), "passed without notice"


def test_a_stroke_that_grazes_past_stays_free(plane):
    session = Session(plane.field)
    r = session.tick_batch([(-12e-3, 0, 6e-3), (-5e-3, 0, 6e-3), (3e-3, 0, 5.5e-3)])
    assert not r["status"].any() and not r["force"].any()


def test_a_fast_stroke_that_ends_in_contact_is_felt(plane):
    session = Session(plane.field)
    session.tick((-4e-3, 0, 9e-3))
    r = session.tick((-4e-3, 0, 3.5e-3))  # 5.5 m/s
    assert status(r) == 0 and r["force"][2] > 0.01 and r["spring_energy"] == 0


def test_a_slow_push_through_a_thin_slab_is_released_in_its_middle(slab):
    session = Session(slab.field)
    z = np.linspace(9e-3, -9e-3, 6000)
    r = session.tick_batch(np.stack([0 * z, 0 * z, z], axis=1))
    assert r["force"][z > 0.1e-3][:, 2].max() > 0.1
    assert np.any(r["status"] & Tick.PASSED_THROUGH)
    assert not r["force"][(z < -0.1e-3)].any()
    assert r["dissipated_rule"][-1] > 0


def test_leaving_the_reach_in_contact_gives_no_energy_on_the_way_back(plane):
    """Out through the side of the stored box and back in: contact is refused until the tool was really free."""
    session = Session(plane.field)
    path = np.linspace((-10e-3, 0, 8e-3), (-10e-3, 0, 2e-3), 500)
    out = np.linspace((-10e-3, 0, 2e-3), (-22e-3, 0, 2e-3), 500)
    r = session.tick_batch(np.concatenate([path, out, out[::-1]]))
    assert r["region"][999] == Region.OUTSIDE and Region.UNREACHED in r["region"]
    assert r["force"][500, 2] > 0 and silent(r[-1])
    assert r["work_in"][-1] + r["hold_leak"][-1] >= 0
    fast = Session(plane.field)
    r = fast.tick_batch([(-22e-3, 0, 2e-3), (-12e-3, 0, 2e-3)])
    assert silent(r[-1])


def test_torque_is_arm_times_force_about_the_grip(plane):
    arm = (0.01, -0.02, -0.15)
    half = np.sqrt(0.5)
    turn = (half, 0, 0, half)  # 90 degrees about x: (x, y, z) -> (x, -z, y)
    arm_turned = np.array([0.01, 0.15, -0.02])
    session = Session(plane.field, Config(reference_point=arm))
    q = np.linspace((-4e-3, 0, 8e-3), TOUCHING, 500)
    r = session.tick_batch(q - arm_turned, orientations=np.tile(turn, (500, 1)))[-1]
    np.testing.assert_allclose(r["reference_point"], TOUCHING, atol=1e-15)
    np.testing.assert_allclose(r["torque"], np.cross(arm_turned, r["force"]), atol=1e-15)
    assert r["force"][2] > 0.05


def test_a_snapshot_goes_on_bit_for_bit(plane):
    session, _ = pressed(plane)
    copy = session.snapshot()
    path = np.array(TOUCHING) + np.cumsum(np.random.default_rng(3).normal(size=(500, 3)) * 1e-5, axis=0)
    assert session.tick_batch(path).tobytes() == copy.tick_batch(path).tobytes()


def test_reset_is_a_fresh_session(plane):
    session, _ = pressed(plane)
    session.reset()
    r = session.tick(TOUCHING)
    assert status(r) == Tick.WAITING and r["work_in"] == 0


def test_one_tick_is_a_batch_of_one(plane):
    path = np.linspace((-4e-3, 0, 8e-3), TOUCHING, 50)
    one, many = Session(plane.field), Session(plane.field)
    assert b"".join(one.tick(p).tobytes() for p in path) == many.tick_batch(path).tobytes()


@pytest.mark.parametrize("config", [Config(speed_max=-1), Config(dt_max=0), Config(reference_point=(np.nan, 0, 0)),
                                    Config(friction_coefficient=np.inf)])  # fmt: skip
def test_a_config_out_of_range_is_refused(plane, config):
    with pytest.raises(RuntimeFailure):
        Session(plane.field, config)


@pytest.mark.parametrize("name", ["friction_coefficient", "speed_max", "force_max"])
def test_a_config_that_is_no_number_is_refused_by_name(plane, name):
    with pytest.raises(RuntimeFailure, match=name):
        Session(plane.field, Config(**{name: float("nan")}))
