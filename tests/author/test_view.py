# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What the live view does without a browser: finds places, leads the tool, reads the servo, answers."""

import json
import re
import shutil
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from viewed_organ import ORGAN, STIFFER, TOOLS, write_two_tools

from palpate.author.command_line import main
from palpate.author.errors import InputError
from palpate.author.view.curve import curve_at
from palpate.author.view.dimple import Dimple
from palpate.author.view.place import Place, Surface, held, on_field
from palpate.author.view.probe import CLEARANCE, Probe
from palpate.author.view.readings import Readings, missed_share, table
from palpate.author.view.viewed import HELD_OUT_ERROR, MAPS, viewed
from palpate.runtime import Servo, Tick

FRAME = 1 / 60


@pytest.fixture(scope="module")
def asset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_two_tools(tmp_path_factory.mktemp("view") / "ellipsoid")


@pytest.fixture(scope="module")
def organ(asset):
    return viewed(asset)


@pytest.fixture(scope="module")
def ball(organ):
    return organ.tools[TOOLS[0]]


def place_at(x: float, y: float) -> Place:
    a, b, h = ORGAN.semi_axes
    point = np.array([x, y, h * np.sqrt(1 - (x / a) ** 2 - (y / b) ** 2)])
    return Place(point, ORGAN.normal(point[None])[0])


def led(probe, servo, reached, seconds=20.0):
    """Frames until `reached(state)`; every state on the way."""
    states, end = [], time.monotonic() + seconds
    while time.monotonic() < end:
        states.append(servo.state)
        if states[-1]["ticks"] and reached(states[-1]):
            return states
        probe.step(servo, states[-1], FRAME)
        time.sleep(FRAME)
    raise AssertionError(f"not reached within {seconds} s: {states[-1]}")


def at(depth):
    return lambda state: abs(state["response"]["depth"] - depth) < 2e-6


def test_an_asset_is_its_tools_with_their_cooked_fields(organ):
    assert tuple(organ.tools) == TOOLS
    soft, stiff = (
        tool.runtime.sample(place_at(0, 0).point + np.array([0, 0, 2e-3]))[0] for tool in organ.tools.values()
    )
    assert stiff["normal_force"] == pytest.approx(STIFFER * soft["normal_force"], rel=1e-3)


def test_a_tool_that_was_not_cooked_or_is_another_one_is_named_with_the_command(asset, tmp_path):
    copy = shutil.copytree(asset, tmp_path / "copy")
    (copy / "stiffer.rfield").unlink()
    with pytest.raises(InputError, match=r"stiffer\.rfield does not exist.*palpate cook"):
        viewed(copy)
    shutil.copy(copy / "ball.rfield", copy / "stiffer.rfield")
    with pytest.raises(InputError, match=r"another tool.*palpate cook"):
        viewed(copy)
    with pytest.raises(InputError, match="does not exist"):
        viewed(tmp_path / "nowhere")


def test_maps_are_those_of_the_field(ball):
    assert set(MAPS) == {*ball.reach.values, "friction", HELD_OUT_ERROR}
    inside = np.linalg.norm(ball.reach.vertices[:, :2], axis=1) < 15e-3
    assert ball.map_values("friction", 4)[inside] == pytest.approx(ORGAN.friction, rel=0.02)
    q = ball.reach.feet + (ball.offset() - ball.reach.depths[4]) * ball.reach.normals
    rendered = ball.runtime.sample(q)["normal_force"]
    assert ball.map_values("normal_force", 4) == pytest.approx(rendered, rel=1e-3, abs=1e-4)


def test_the_map_of_errors_is_that_of_the_nearest_held_out_press(ball):
    assert not ball.map_values(HELD_OUT_ERROR, 0).any()
    rows = [
        {"contact_point": [x, 0.0, ORGAN.semi_axes[2]], "force_error_max": error}
        for x, error in ((-9e-3, 0.01), (9e-3, 0.03), (0.0, None))
    ]
    shown = replace(ball, held_out=rows).map_values(HELD_OUT_ERROR, 4)
    assert shown == pytest.approx(np.where(ball.reach.feet[:, 0] < 0.0, 1.0, 3.0))


def test_a_ray_meets_the_surface_that_faces_it_and_the_field_corrects_the_facet(ball):
    surface = Surface(ball.reach.vertices, ball.reach.triangles)
    eye = np.array([0.01, -0.2, 0.3])
    aim = place_at(6e-3, -4e-3).point
    hit = surface.hit(eye, aim - eye)
    assert hit is not None and np.linalg.norm(hit.point - aim) < 1e-3
    place = on_field(ball, hit)
    assert abs(ORGAN.signed_distance(place.point)[0]) < 5e-5
    assert place.normal @ ORGAN.normal(place.point[None])[0] > 1 - 1e-4
    assert surface.hit(eye, eye - aim) is None and surface.hit(-eye, aim + eye) is None  # away; from inside


def test_the_tool_is_held_along_the_normal_or_leans_by_its_tilt(ball):
    from scipy.spatial.transform import Rotation

    n = place_at(9e-3, 7e-3).normal
    for tilt in (0.0, 0.3):
        axis = Rotation.from_quat(held(ball.field.tool, n, tilt)).as_matrix()[:, 2]
        assert axis @ n == pytest.approx(np.cos(tilt))


def test_a_led_press_is_as_deep_as_asked_and_feels_what_the_field_says(ball):
    probe = Probe(ball, place_at(3e-3, 2e-3))
    with Servo(ball.runtime, probe.position, probe.orientation) as servo:
        probe.press(2e-3)
        felt = led(probe, servo, at(2e-3))[-1]["response"]
    depth, force = curve_at(ball, probe.place.point, probe.place.normal)
    assert felt["normal_force"] == pytest.approx(np.interp(2e-3, depth, force), rel=5e-3)
    assert felt["normal_force"] == pytest.approx(
        ORGAN.force(felt["reference_point"][None])[0] @ felt["normal"], rel=0.05
    )


def test_a_near_place_is_slid_to_and_a_far_one_reached_through_the_air(ball):
    probe = Probe(ball, place_at(-8e-3, 0))
    with Servo(ball.runtime, probe.position, probe.orientation) as servo:
        probe.press(2e-3)
        led(probe, servo, at(2e-3))
        near = on_field(ball, place_at(-2e-3, 0))
        probe.lead_to(near)
        slid = led(
            probe,
            servo,
            lambda s: np.linalg.norm(s["position"] - probe.position) < 1e-7 and probe.place is probe.wanted,
        )
        assert min(s["response"]["depth"] for s in slid) > 1.5e-3 and slid[-1]["slip_ticks"] > 0
        probe.lead_to(place_at(14e-3, 0))
        hop = led(probe, servo, lambda s: s["position"][0] > 13e-3 and at(2e-3)(s))
        assert min(s["response"]["depth"] for s in hop) < 0
    lost = Tick.PASSED_THROUGH | Tick.WAITING | Tick.JUMP
    assert not any(int(s["response"]["status"]) & lost for s in slid + hop)


def test_a_contact_that_was_lost_is_lifted_and_entered_anew(ball):
    probe = Probe(ball, place_at(0, 0))
    with Servo(ball.runtime, probe.position, probe.orientation) as servo:
        probe.press(2e-3)
        led(probe, servo, at(2e-3))
        servo.move(probe.position, probe.orientation, release=True)
        end = time.monotonic() + 20
        while not int(servo.state["response"]["status"]) & Tick.RELEASED and time.monotonic() < end:
            time.sleep(1e-3)
        assert not servo.state["response"]["force"].any()
        servo.move(probe.position, probe.orientation)
        again = led(probe, servo, lambda s: s["response"]["normal_force"] > 0 and at(2e-3)(s))
    assert min(s["response"]["depth"] for s in again) < 0


def test_the_drawn_surface_gives_way_to_the_ball_and_comes_back(ball):
    dimple = Dimple(ball)
    probe = Probe(ball, on_field(ball, place_at(4e-3, 2e-3)))
    probe.press(3e-3)
    with Servo(ball.runtime, probe.position, probe.orientation, 1000.0) as servo:
        states = led(probe, servo, lambda s: s["response"]["depth"] > 2.9e-3)
    assert dimple.there and not dimple.moved(states[0]["response"], False).any()
    response = states[-1]["response"]
    moved = dimple.to_draw(response, True)
    assert dimple.to_draw(response, True) is None  # drawn already
    dimple.at_rest()  # another map was chosen, and the surface drawn without its dimple
    assert np.array_equal(dimple.to_draw(response, True), moved)
    vertices, radius = ball.reach.vertices, ball.offset()
    away = np.linalg.norm(vertices - response["reference_point"], axis=1)
    inside = away < radius
    assert inside.sum() > 3  # of the surface at rest
    now = np.linalg.norm(vertices + moved - response["reference_point"], axis=1)
    assert now.min() > radius - 0.1e-3
    inwards = -np.einsum("vi,i->v", moved, response["normal"])
    assert inwards[inside].min() > 0.0 and inwards.max() < 1.6 * response["depth"]
    assert dimple.to_draw(response, False) is not None  # back at rest


def test_a_field_that_does_not_say_how_its_surface_moves_is_drawn_at_rest_and_says_so(organ):
    dimple = Dimple(organ.tools[TOOLS[1]])
    assert not dimple.there and "deformation" in dimple.words and "at rest" in dimple.words


def test_the_gizmo_leads_the_tool_itself_and_a_place_takes_it_back(ball):
    probe = Probe(ball, place_at(0, 0))
    with Servo(ball.runtime, probe.position, probe.orientation) as servo:
        probe.free = place_at(2e-3, 0).point + (ball.offset() - 1e-3) * place_at(2e-3, 0).normal
        led(probe, servo, lambda s: np.array_equal(s["position"], probe.free))
        assert probe.depth == pytest.approx(1e-3, abs=5e-5)
        probe.lead_to(place_at(4e-3, 0))
        assert probe.free is None
        led(
            probe,
            servo,
            lambda s: abs(s["position"][0] - probe.position[0]) < 1e-9 and probe.place is probe.wanted,
        )


def test_another_tool_comes_from_outside(organ):
    first, second = organ.tools.values()
    probe = Probe(first, place_at(0, 0))
    with Servo(first.runtime, probe.position, probe.orientation) as servo:
        probe.press(2e-3)
        led(probe, servo, at(2e-3))
        probe.change(second)
        servo.set_field(second.runtime)
        led(probe, servo, at(-CLEARANCE))
        probe.press(2e-3)
        felt = led(probe, servo, at(2e-3))[-1]["response"]
    said = second.runtime.sample(felt["reference_point"])[0]
    assert felt["normal_force"] == pytest.approx(said["normal_force"], rel=1e-9)


def test_the_readings_are_the_servos_and_its_accounts_balance(ball):
    probe = Probe(ball, place_at(0, 0))
    with Servo(ball.runtime, probe.position, probe.orientation) as servo:
        probe.press(2e-3)
        state = led(probe, servo, at(2e-3))[-1]
    now = Readings(state, False, "")
    assert abs(now.imbalance) < 1e-12 and now.contact and state["response"]["work_in"] > 1e-6
    html = table('a "b"', now, 7)
    data = dict(re.findall(r'data-(\w+)="([^"]*)"', html))
    assert float(data["force"]) == pytest.approx(now.force, abs=1e-6) and data["contact"] == "1"
    assert data["tool"] == "a &quot;b&quot;" and data["moves"] == "7" and int(data["ticks"]) > 0
    assert "sticking" in html and "slipping" in table("b", Readings(state, True, ""), 0)


def test_missed_ticks_are_a_share_of_those_that_were_due():
    state = np.zeros(1, dtype=[("ticks", "<u8"), ("missed", "<u8")])[0]
    assert missed_share(state) == 0.0
    state["ticks"], state["missed"] = 990, 10
    assert missed_share(state) == pytest.approx(0.01)


def test_the_command_ends_by_itself_and_counts_its_ticks(asset, capfd):
    code = main(
        ["view", str(asset), "--port", "0", "--no-browser", "--seconds", "1", "--tool", "stiffer", "--json"]
    )
    captured = capfd.readouterr()
    answer = json.loads(captured.out)
    assert answer["tool"] == "stiffer" and answer["tools"] == list(TOOLS)
    assert f"palpate: {answer['url']}" in captured.err
    due = answer["ticks"] + answer["missed"]
    assert due == pytest.approx(1e3 * answer["seconds"], abs=1e3 * max(0.15, answer["longest_tick"]))
    assert answer["missed_share"] == pytest.approx(answer["missed"] / due)
    assert answer["met"] == (answer["missed_share"] < 0.01) and code == (0 if answer["met"] else 1)


def test_an_unknown_tool_is_refused_with_a_guess(asset, capsys):
    assert main(["view", str(asset), "--no-browser", "--tool", "stifer"]) == 2
    assert "stiffer" in capsys.readouterr().err


def test_an_address_of_another_machine_is_refused(asset, capsys):
    """192.0.2.1 is nobody's (RFC 5737)."""
    assert main(["view", str(asset), "--no-browser", "--seconds", "0", "--host", "192.0.2.1"]) == 2
    assert '--host = "192.0.2.1" is no address of this machine' in capsys.readouterr().err


def test_without_viser_one_sentence_says_what_to_install(asset, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "viser", None)
    assert main(["view", str(asset), "--no-browser"]) == 2
    assert 'pip install "palpate[view]"' in capsys.readouterr().err
