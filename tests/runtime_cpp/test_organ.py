# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A moving organ: only the tool's place in the organ counts, and the organ's own power has an account of its own."""

import numpy as np
import pytest
from energy_books import books
from scipy.spatial.transform import Rotation

from palpate.runtime import Config, Organ, RuntimeFailure, Session, Tick
from palpate.runtime.layout import STATE, Input

ROUNDING = 1e-13  # J
CONFIG = Config(friction_coefficient=0.3, speed_max=0.0)


def press_and_drag(ticks=600):
    """(3 ticks, 3) m in organ axes: down, across the 6:1 step, up."""
    down = np.linspace((-2e-3, 0, 5.4e-3), (-2e-3, 0, 1.5e-3), ticks)
    across = np.linspace((-2e-3, 0, 1.5e-3), (6e-3, 1e-3, 1.5e-3), ticks)
    return np.concatenate([down, across, np.linspace((6e-3, 1e-3, 1.5e-3), (6e-3, 1e-3, 5.4e-3), ticks)])


def smooth_motion(rng, ticks, reach=20e-3, turn=0.4):
    """Poses (ticks, 3) m and rotations of an organ that sways and turns, from a random place."""
    t = np.linspace(0, 1, ticks)[:, None]
    wave = sum(rng.normal(size=3) * np.sin(2 * np.pi * (k * t + rng.uniform(0, 1, 3))) / k for k in (1, 2, 3))
    spin = sum(rng.normal(size=3) * np.sin(2 * np.pi * (k * t + rng.uniform(0, 1, 3))) / k for k in (1, 2))
    return rng.normal(size=3) + reach * wave, Rotation.from_rotvec(turn * spin) * Rotation.random(rng=rng)


def in_world(x, position, rotation):
    return rotation.apply(x) + position


def test_an_organ_that_lies_elsewhere_feels_the_same(plane):
    x = press_and_drag()
    still = Session(plane.field, CONFIG).tick_batch(x)
    rotation, position = Rotation.from_rotvec([0.3, -1.2, 0.5]), np.array([0.4, -0.1, 0.2])
    moved = Session(plane.field, CONFIG).tick_batch(
        in_world(x, position, rotation), organ_positions=position, organ_orientations=rotation.as_quat()
    )
    np.testing.assert_allclose(moved["force"], rotation.apply(still["force"]), atol=1e-11)
    np.testing.assert_allclose(moved["anchor"], in_world(still["anchor"], position, rotation), atol=1e-14)
    np.testing.assert_allclose(moved["normal"], rotation.apply(still["normal"]), atol=1e-12)
    assert np.abs(moved["organ_work"]).max() < ROUNDING
    assert abs(moved["work_in"][-1] - still["work_in"][-1]) < ROUNDING


@pytest.mark.parametrize("seed", range(4))
def test_hand_and_organ_together_put_in_what_is_stored_and_dissipated(plane, seed):
    """Works recomputed from forces and poses, energies by NumPy in the organ's axes."""
    x = press_and_drag()
    position, rotation = smooth_motion(np.random.default_rng(seed), len(x))
    p = in_world(x, position, rotation)
    r = Session(plane.field, CONFIG).tick_batch(
        p, organ_positions=position, organ_orientations=rotation.as_quat()
    )
    hand = -np.sum(r["force"][:-1] * np.diff(p, axis=0))
    seen = r.copy()  # the same answers in the organ's axes
    seen["force"], seen["anchor"] = (
        rotation.inv().apply(r["force"]),
        rotation.inv().apply(r["anchor"] - position),
    )
    b = books(plane.truth, x[None], seen[None], plane.field.info.stiffness_max, 0.3)
    assert b.created.max() <= ROUNDING and b.force_error < 1e-10
    last = r[-1]
    assert last["work_in"] == pytest.approx(hand, abs=ROUNDING)
    assert last["organ_work"] == pytest.approx(b.net_work[0] - hand, abs=ROUNDING)
    assert abs(last["organ_work"]) > 1e-5  # the organ does work
    spent = last["dissipated_friction"] + last["dissipated_rule"] + last["stored_energy"]
    assert last["work_in"] + last["organ_work"] + last["hold_leak"] == pytest.approx(spent, abs=ROUNDING)


def test_the_organs_power_is_force_times_the_velocity_of_its_matter_at_the_tool(plane):
    """In the limit of short ticks: the error falls with the tick."""
    errors = []
    for ticks in (400, 1600):
        x = press_and_drag(ticks)
        position, rotation = smooth_motion(np.random.default_rng(3), len(x))
        p = in_world(x, position, rotation)
        r = Session(plane.field, CONFIG).tick_batch(
            p, organ_positions=position, organ_orientations=rotation.as_quat()
        )
        carried = (
            in_world(x[:-1], position[1:], rotation[1:]) - p[:-1]
        )  # matter at the tool, to the next tick
        power = np.sum(r["force"][:-1] * carried)
        errors.append(abs(r["organ_work"][-1] - power))
    assert errors[1] < errors[0] / 3


def test_a_breathing_organ_under_a_held_tool_takes_back_what_it_gave(plane):
    """The hand does nothing; over a breath the organ pays for friction and the hold, no more."""
    for friction in (0.0, 0.3):
        ticks = 4000
        breath = np.zeros((ticks, 3))
        breath[:, 2] = 4e-3 * np.sin(np.linspace(0, 2 * np.pi, ticks)) ** 2
        breath[:, 0] = 2e-3 * np.sin(np.linspace(0, 2 * np.pi, ticks))
        tool = np.tile((2e-3, 0, 5.2e-3), (ticks, 1))
        session = Session(plane.field, Config(friction_coefficient=friction, speed_max=0.0))
        r = session.tick_batch(tool, organ_positions=breath)
        last = r[-1]
        assert np.all(r["work_in"] == 0) and last["stored_energy"] == 0
        assert r["force"][:, 2].max() > 0.3
        paid = last["organ_work"] + last["hold_leak"]
        assert paid == pytest.approx(last["dissipated_friction"], abs=ROUNDING)
        assert (paid > 1e-5) == (friction > 0)


def sixty_hertz(field, duration):
    """Forces at 6 kHz on a held tool while a scene publishes its organ's pose 60 times a second."""
    session, organ = Session(field, Config(friction_coefficient=0.2)), Organ()
    session.set_organ(organ)
    forces = []
    for frame in range(40):
        organ.move((1e-3 * np.sin(0.2 * frame), 0, -1e-3 + 2.5e-3 * np.sin(0.15 * frame)), duration=duration)
        forces.append(session.tick_batch(np.tile((0, 0, 5e-3), (100, 1)), dt=1 / 6000)["force"])
    return np.concatenate(forces)


def test_a_pose_sixty_times_a_second_is_felt_without_steps(plane):
    stairs, smooth = sixty_hertz(plane.field, 0.0), sixty_hertz(plane.field, 1 / 60)
    assert np.abs(smooth).max() > 0.03
    largest = [np.linalg.norm(np.diff(f, axis=0), axis=1).max() for f in (stairs, smooth)]
    assert largest[1] < largest[0] / 40  # 100 ticks a frame


def test_half_way_between_two_poses_is_half_the_turn(plane):
    session, organ = Session(plane.field, Config(speed_max=0.0)), Organ()
    session.set_organ(organ)
    half = np.sin(0.25), np.cos(0.25)  # 0.5 rad about z
    organ.move((0, 0, 0))
    session.tick((0, 0, 8e-3), dt=0.01)
    organ.move((2e-3, 0, 0), (0, 0, half[0], half[1]), duration=0.1)
    session.tick((0, 0, 8e-3), dt=0.05)
    arrived = session.snapshot()
    r = session.tick_batch(np.linspace((1e-3, 0, 8e-3), (1e-3, 0, 4e-3), 2), dt=1e-9)[-1]
    turn = Rotation.from_rotvec([0, 0, 0.25]).inv()
    q = turn.apply(np.array([1e-3, 0, 4e-3]) - np.array([1e-3, 0, 0]))
    expected = turn.inv().apply(plane.field.sample(q[None])[0]["force"])
    np.testing.assert_allclose(r["force"], expected, rtol=1e-6)
    arrived.tick((0, 0, 8e-3), dt=0.06)
    r = arrived.tick((2e-3, 0, 4e-3))
    turn = Rotation.from_rotvec([0, 0, 0.5])
    np.testing.assert_allclose(
        r["force"], turn.apply(plane.field.sample([[0, 0, 4e-3]])[0]["force"]), rtol=1e-9
    )


def test_two_hands_on_one_organ_feel_what_each_would_alone(plane):
    rng = np.random.default_rng(1)
    position, rotation = smooth_motion(rng, 900, reach=3e-3, turn=0.05)
    places = [
        in_world(press_and_drag(300) + offset, position, rotation) for offset in ((0, 0, 0), (-4e-3, 3e-3, 0))
    ]
    organ = Organ()
    together = [Session(plane.field, CONFIG) for _ in places]
    for session in together:
        session.set_organ(organ)
    answers = [[], []]
    for i in range(900):
        organ.move(position[i], rotation[i].as_quat(), 1e-3)
        for session, place, answer in zip(together, places, answers, strict=True):
            answer.append(session.tick(place[i]))
    for place, answer in zip(places, answers, strict=True):
        alone = Session(plane.field, CONFIG).tick_batch(
            place, organ_positions=position, organ_orientations=rotation.as_quat()
        )
        assert np.linalg.norm(alone["force"], axis=1).max() > 0.1
        np.testing.assert_allclose(np.array(answer)["force"], alone["force"], atol=1e-12)


@pytest.mark.parametrize(
    ("name", "value"),
    [("organ_position", np.nan), ("organ_position", 1e300), ("organ_orientation", 0.0), ("organ_orientation", np.inf)],
)  # fmt: skip
def test_a_pose_that_is_not_one_releases_until_the_tool_was_outside(plane, name, value):
    session = Session(plane.field)
    session.tick_batch(np.linspace((-4e-3, 0, 8e-3), (-4e-3, 0, 3e-3), 500))
    state = np.zeros(1, dtype=STATE)
    state["position"], state["dt"], state["organ_orientation"] = (-4e-3, 0, 3e-3), 1e-3, (0, 0, 0, 1)
    state["flags"] = Input.POSITION_ONLY | Input.ORGAN_POSE
    state[name][0, 0] = value
    if name == "organ_orientation" and value == 0.0:
        state[name] = 0.0
    r = session.tick_batch(state)[0]
    assert r["status"] == Tick.BAD_INPUT and not r["force"].any() and r["stored_energy"] == 0
    assert session.tick((-4e-3, 0, 3e-3))["status"] == Tick.WAITING


def test_a_tool_further_from_its_organ_than_any_can_be_releases_and_no_work_is_booked(plane):
    """Both places are usable by themselves; where the hand went is not known to the session."""
    session = Session(plane.field, CONFIG)
    before = session.tick_batch(
        np.linspace((-4e-3, 0, 8e-3), (-4e-3, 0, 3e-3), 500), organ_positions=np.zeros(3)
    )[-1]
    r = session.tick_batch(np.array([[900.0, 0, 3e-3]]), organ_positions=(-900.0, 0, 0))[0]
    assert r["status"] == Tick.BAD_INPUT and not r["force"].any() and r["stored_energy"] == 0
    assert r["work_in"] == before["work_in"] and r["organ_work"] == before["organ_work"]
    given = r["work_in"] + r["organ_work"] + r["hold_leak"]
    assert given == pytest.approx(r["dissipated_friction"] + r["dissipated_rule"], abs=ROUNDING)
    back = session.tick_batch(np.array([[-4e-3, 0, 3e-3]]), organ_positions=np.zeros(3))[0]
    assert back["status"] == Tick.WAITING and back["work_in"] == r["work_in"]


def test_an_organ_that_begins_to_move_under_a_pressed_tool_has_its_work_counted(plane):
    session = Session(plane.field, CONFIG)
    x = press_and_drag()
    before = session.tick_batch(x[:900])  # no pose so far
    rise = np.zeros((300, 3))
    rise[:, 2] = np.linspace(1e-5, 5e-4, 300)
    r = session.tick_batch(np.tile(x[900], (300, 1)), organ_positions=rise)
    assert r["organ_work"][-1] > 1e-5
    first = -before["force"][-1] @ (x[900] - x[899])
    assert r["work_in"][-1] == pytest.approx(before["work_in"][-1] + first, abs=ROUNDING)


def test_an_organ_that_jumps_away_is_let_go(plane):
    session = Session(plane.field)
    tool = np.linspace((-4e-3, 0, 8e-3), (-4e-3, 0, 3e-3), 500)
    session.tick_batch(tool, organ_positions=np.zeros(3))
    r = session.tick(tool[-1])
    assert r["force"][2] > 0.05  # stays where it was
    state = session.tick_batch(tool[-1:], organ_positions=(0, 0, 0.05))[0]
    assert state["status"] & Tick.JUMP and not state["force"].any()


@pytest.mark.parametrize("move", [{"position": (np.nan, 0, 0)}, {"position": (0, 0, 0), "orientation": (0, 0, 0, 2)},
                                  {"position": (0, 0, 0), "duration": -1.0}, {"position": (0, 0, 1e9)}])  # fmt: skip
def test_a_pose_out_of_range_is_refused_where_it_is_published(move):
    with pytest.raises(RuntimeFailure):
        Organ().move(**move)
