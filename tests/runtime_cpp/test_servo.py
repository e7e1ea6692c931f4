# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The servo thread, led from Python: the runtime's own forces, steady ways, counts that add up."""

import time
from types import SimpleNamespace

import numpy as np
import pytest
import synthetic_field

from palpate.fields.cook import cook
from palpate.runtime import Field, Region, RuntimeFailure, Servo, Session, Tick

ABOVE, DEEP = (-4e-3, 0.0, 9e-3), (-4e-3, 0.0, 3e-3)


@pytest.fixture(scope="module")
def plane():
    return Field.open(cook(synthetic_field.FIELDS["plane"]()))


def wait(servo, reached, seconds=20.0):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        state = servo.state
        if reached(state):
            return state
        time.sleep(2e-3)
    raise AssertionError(f"not reached within {seconds} s: {state}")


def arrived(place):
    return lambda state: state["ticks"] > 0 and np.array_equal(state["position"], place)


def test_it_goes_to_its_target_and_feels_what_a_session_feels_there(plane):
    with Servo(plane, ABOVE) as servo:
        servo.move(DEEP, duration=0.1)
        state = wait(servo, arrived(DEEP))
        state = wait(servo, lambda s: s["ticks"] > state["ticks"])
    session = Session(plane)
    session.tick(ABOVE)
    alone = session.tick(DEEP)
    felt = state["response"]
    assert felt["region"] == Region.CONTACT and felt["normal_force"] > 0.05
    assert felt["force"] == pytest.approx(alone["force"], rel=1e-12)
    assert felt["stored_energy"] == pytest.approx(alone["stored_energy"], rel=1e-12)


def test_what_cannot_be_read_now_is_what_was_read_before(plane, monkeypatch):
    """As when the system stops the thread while it publishes."""
    with Servo(plane, ABOVE) as servo:
        state = wait(servo, lambda s: s["ticks"] > 3)
        with monkeypatch.context() as held_up:
            held_up.setattr(
                "palpate.runtime.servo._servo", lambda: SimpleNamespace(palpate_servo_read=lambda *_: 1)
            )
            assert servo.state is state
        assert wait(servo, lambda s: s["ticks"] > state["ticks"])


def test_on_its_way_it_is_on_the_line_and_never_ahead(plane):
    with Servo(plane, ABOVE) as servo:
        began = time.monotonic()
        servo.move((-4e-3, 3e-3, 9e-3), duration=0.5)
        seen = []
        while not seen or seen[-1][0] < 3e-3:
            y = servo.state["position"][1]
            seen.append((y, time.monotonic() - began))  # read before the clock: y is at most as late
            assert time.monotonic() - began < 20.0
    y, t = np.array(seen).T
    assert np.all(np.diff(y) >= 0) and np.any((y > 0) & (y < 3e-3))
    assert np.all(y <= 6e-3 * (t + 2e-3) + 1e-12)


def test_energy_of_a_led_press_balances_and_the_way_back_returns_it(plane):
    with Servo(plane, ABOVE) as servo:
        servo.move(DEEP, duration=0.1)
        pressed = wait(servo, arrived(DEEP))["response"]
        servo.move(ABOVE, duration=0.1)
        lifted = wait(servo, arrived(ABOVE))["response"]
    for felt in (pressed, lifted):
        kept = felt["stored_energy"] + felt["dissipated_friction"] + felt["dissipated_rule"]
        assert felt["work_in"] + felt["hold_leak"] == pytest.approx(kept, abs=1e-14)
    assert pressed["stored_energy"] > 1e-5 and lifted["stored_energy"] == 0


def test_dragging_slips_and_slips_are_counted(plane):
    with Servo(plane, ABOVE) as servo:
        servo.move(DEEP, duration=0.05)
        assert wait(servo, arrived(DEEP))["slip_ticks"] == 0
        aside = (6e-3, 0.0, 3e-3)
        servo.move(aside, duration=0.2)
        state = wait(servo, arrived(aside))
    assert 0 < state["slip_ticks"] <= state["contact_ticks"] <= state["ticks"]
    assert state["response"]["dissipated_friction"] > 0


def test_letting_go_takes_the_force_away_until_the_tool_comes_from_outside(plane):
    with Servo(plane, ABOVE) as servo:
        servo.move(DEEP, duration=0.05)
        wait(servo, arrived(DEEP))
        servo.move(DEEP, release=True)
        state = wait(servo, lambda s: s["response"]["status"] & Tick.RELEASED)
        assert np.all(state["response"]["force"] == 0)
        servo.move(DEEP)
        state = wait(servo, lambda s: s["response"]["status"] & Tick.WAITING)
        assert np.all(state["response"]["force"] == 0)


def test_another_field_is_felt_from_the_next_tick_on(plane):
    stiffer = Field.open(
        cook(synthetic_field.synthetic_field(amplitude=lambda q: 2.0 * synthetic_field.step(q)))
    )
    with Servo(plane, ABOVE) as servo:
        servo.set_field(stiffer)
        servo.move(DEEP, duration=0.05)
        felt = wait(servo, arrived(DEEP))["response"]
        servo.reset()
        wait(servo, lambda s: s["response"]["work_in"] == 0)
    assert felt["normal_force"] == pytest.approx(stiffer.sample(DEEP)[0]["normal_force"], rel=1e-9)


def test_ticks_and_missed_ticks_add_up_to_the_time(plane):
    with Servo(plane, ABOVE, rate=1000.0) as servo:
        first = wait(servo, lambda s: s["ticks"] > 5)
        began = time.monotonic()
        time.sleep(0.3)
        last, took = servo.state, time.monotonic() - began
    periods = int(last["ticks"] + last["missed"]) - int(first["ticks"] + first["missed"])
    assert periods == pytest.approx(1000 * took, abs=max(5, 1.5e3 * float(last["longest"])))
    assert last["longest"] >= 1e-3 * 0.5


@pytest.mark.parametrize(
    "arguments",
    [{"position": (0, 0, np.nan)}, {"orientation": (0, 0, 0, 2)}, {"rate": 0.0}, {"rate": np.nan}],
)
def test_what_cannot_be_used_is_refused(plane, arguments):
    with pytest.raises(RuntimeFailure):
        Servo(plane, **({"position": ABOVE} | arguments))


def test_a_closed_servo_says_so(plane):
    servo = Servo(plane, ABOVE)
    servo.close()
    with pytest.raises(RuntimeFailure):
        servo.move(DEEP)
    with pytest.raises(RuntimeFailure, match="closed"):
        _ = servo.state
