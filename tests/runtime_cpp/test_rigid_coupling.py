# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A virtual coupling against closed forms, and its energy over any path."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from palpate.author.rigid.cook import cooked_rigid
from palpate.author.rigid.free_body import turned
from palpate.author.rigid.law import LUO_XIAO
from palpate.author.rigid.polyhedron import box
from palpate.author.rigid.shapes import capsule, plane, sphere
from palpate.runtime.library import RuntimeFailure
from palpate.runtime.rigid import Rigid, RigidConfig, RigidSession, Status

MASS, G, EPS, K_CONTACT, MU, MU_D = 0.5, 9.8, 1e-3, 2300.0, 0.7, 0.08
UPRIGHT = np.array([0, 0, 0, 1.0])
FLOOR = plane(2.0, 2.0)
K, B, KAPPA, BETA = 1000.0, 20.0, 0.5, 0.004
COUPLED = RigidConfig(
    coupling_stiffness=K,
    coupling_damping=B,
    coupling_torsional_stiffness=KAPPA,
    coupling_torsional_damping=BETA,
)
NO_WEIGHT = replace(LUO_XIAO, gravity=(0.0, 0.0, 0.0))


def held(body, law=LUO_XIAO, fixed=FLOOR, config=COUPLED, mass=MASS):
    return RigidSession(Rigid(cooked_rigid(body, fixed, mass, law)), config)


def resting(session, place, orientation=UPRIGHT, ticks=3000):
    """The response and the object's place after `ticks` ticks with the device at rest."""
    out = session.tick_batch(np.tile(place, (ticks, 1)), orientation)[-1]
    return out, *session.place()


def radius_of(body):
    return max(float(np.linalg.norm(e.ball[0] - body.centre)) + e.ball[1] for e in body.elements)


def hardest(position, orientation, dt, radius):
    """m/s2; the largest acceleration of a path, of any point within `radius`."""
    turns = Rotation.from_quat(orientation)
    spin = (turns[1:] * turns[:-1].inv()).as_rotvec()
    straight = np.linalg.norm(np.diff(position, 2, axis=0), axis=1)
    return float((straight + radius * np.linalg.norm(np.diff(spin, axis=0), axis=1)).max() / dt**2)


def reserve(body, config, dt):
    radius = radius_of(body)
    k = max(config.coupling_stiffness, config.coupling_torsional_stiffness / radius**2)
    b = max(config.coupling_damping, config.coupling_torsional_damping / radius**2)
    a = config.acceleration_max * dt**2 / 0.9
    return 1.01 * a * (k * a / 2 + 0.3 * b) + 1e-12


def test_without_a_coupling_the_object_is_where_the_device_is():
    s = held(sphere(0.02), config=RigidConfig(grip=(0.0, 0.0, 0.01)))
    with pytest.raises(RuntimeFailure):
        s.place()
    s.tick((0.1, 0.2, 0.3))
    assert s.place()[0] == pytest.approx([0.1, 0.2, 0.29], abs=1e-15)


def test_a_hanging_object_sags_by_its_weight_over_the_stiffness():
    out, position, _ = resting(held(sphere(0.02)), (0, 0, 0.5))
    assert 0.5 - position[2] == pytest.approx(MASS * G / K, rel=1e-9)
    assert out["force"] == pytest.approx([0, 0, -MASS * G], rel=1e-9, abs=1e-9)
    assert out["status"] == 0


def test_an_object_held_beside_its_centre_turns_by_its_moment_over_the_torsional_stiffness():
    arm = 0.01
    out, position, q = resting(
        held(box((0.04, 0.06, 0.02)), config=replace(COUPLED, grip=(arm, 0.0, 0.0))), (0, 0, 0.5)
    )
    angle = 2 * np.arctan2(q[1], q[3])  # about y
    assert KAPPA * angle == pytest.approx(-MASS * G * arm * np.cos(angle), rel=1e-4)
    assert out["torque"][1] == pytest.approx(-MASS * G * arm * np.cos(angle), rel=1e-6)
    assert position[2] - np.sin(angle) * arm == pytest.approx(0.5 - MASS * G / K, rel=1e-6)


def test_pressed_on_a_floor_coupling_and_contact_are_springs_in_series():
    s = held(sphere(0.02))
    down = np.concatenate([np.linspace(0.03, 0.0185, 800), np.full(3000, 0.0185)])
    out = s.tick_batch(np.stack([0 * down, 0 * down, down], axis=1), UPRIGHT)[-1]
    z = (K * 0.0185 - MASS * G + K_CONTACT * (0.02 + EPS)) / (K + K_CONTACT)
    assert s.place()[0][2] == pytest.approx(z, abs=1e-9)
    assert out["contact_force"][2] == pytest.approx(K_CONTACT * (0.02 + EPS - z), rel=1e-6)
    assert out["force"][2] == pytest.approx(K * (z - 0.0185), rel=1e-6)


def test_the_device_may_go_deep_where_the_object_stays_outside():
    """A direct object is released 2 mm deep; a coupled one stays on the surface and pushes back with k e."""
    s = held(sphere(0.02), config=replace(COUPLED, coupling_stiffness=200.0), mass=0.1)
    down = np.concatenate([np.linspace(0.03, 0.01, 1500), np.full(2000, 0.01)])
    out = s.tick_batch(np.stack([0 * down, 0 * down, down], axis=1), UPRIGHT)
    assert not np.any(out["status"])
    assert out["force"][-1, 2] == pytest.approx(200.0 * (s.place()[0][2] - 0.01), rel=1e-6)
    assert out["contact"]["gap"][-1, 0] > -2e-3


def test_a_plucked_object_swings_at_the_root_of_stiffness_over_mass():
    config = replace(COUPLED, coupling_damping=0.0, coupling_torsional_damping=0.0)
    s, dt = held(sphere(0.02), law=NO_WEIGHT, config=config), 2e-5
    start = np.tile([0, 0, 0.5], (200, 1))
    start[100:, 0] = np.linspace(0, 2e-3, 100)
    out = s.tick_batch(np.concatenate([start, np.tile(start[-1], (40_000, 1))]), UPRIGHT, dt)["force"][
        200:, 0
    ]
    rises = np.nonzero((out[:-1] < 0) & (out[1:] >= 0))[0]
    period = np.diff(rises).mean() * dt
    assert period == pytest.approx(2 * np.pi * np.sqrt(MASS / K), rel=2e-3)


def test_a_pulled_object_drags_with_kinetic_friction():
    s = held(
        sphere(0.02),
        config=replace(COUPLED, coupling_torsional_stiffness=5.0, coupling_torsional_damping=0.05),
    )
    down = np.concatenate([np.linspace(0.03, 0.02, 800), np.full(500, 0.02)])
    s.tick_batch(np.stack([0 * down, 0 * down, down], axis=1), UPRIGHT)
    x = 5e-5 * np.arange(3000)
    out = s.tick_batch(np.stack([x, 0 * x, 0 * x + 0.02], axis=1), UPRIGHT)
    normal = out["contact"]["normal_force"][2000:, 0]
    assert np.mean(-out["force"][2000:, 0]) == pytest.approx(MU_D * normal.mean(), rel=0.02)
    assert np.all(out["contact"]["sliding"][2000:, 0] == 1)


def walked(rng, count, jitter, dt):
    """A hand's path over and into the floor: smooth wandering and jitter of each tick (m)."""
    t = np.arange(count) * dt
    wander = np.zeros((count, 3))
    for _ in range(6):
        f, phase = rng.uniform(0.3, 12, 3), rng.uniform(0, 2 * np.pi, 3)
        wander += rng.uniform(1e-3, 6e-3) * np.sin(2 * np.pi * f * t[:, None] + phase)
    position = np.array([0, 0, 0.03]) + wander - wander[0] + rng.normal(size=(count, 3)) * jitter
    q, orientation = UPRIGHT, np.zeros((count, 4))
    spin = rng.normal(size=3) * 2.0
    for i in range(count):
        orientation[i] = q
        q = turned(q, dt * spin + rng.normal(size=3) * jitter * 5)
        if i % 400 == 0:
            spin = rng.normal(size=3) * 2.0
    return position, orientation


@pytest.mark.parametrize("jitter", [0.0, 2e-4, 8e-4])
@pytest.mark.parametrize("damping", [0.0, 1.0])
@pytest.mark.parametrize("dt", [1e-3, 2.5e-4])
def test_no_path_takes_out_more_energy_than_the_hand_put_in(jitter, damping, dt):
    config = replace(
        COUPLED, coupling_damping=damping * B, coupling_torsional_damping=damping * BETA, speed_max=50.0
    )
    rng = np.random.default_rng(7)
    touched = 0
    for body, law in ((box((0.04, 0.06, 0.02)), LUO_XIAO), (capsule(0.01, 0.04), NO_WEIGHT)):
        path = walked(rng, 4000, jitter * dt / 1e-3, dt)
        config = replace(config, acceleration_max=1.01 * hardest(*path, dt, radius_of(body)))
        out = held(body, law, config=config).tick_batch(*path, dt)
        touched += np.count_nonzero(out["contact_count"])
        assert np.all(out["unaccounted"] >= -reserve(body, config, dt))
        books = (
            out["work_in"] - out["stored_energy"] - out["dissipated_friction"] - out["dissipated_damping"]
            - out["gravity_work"] - out["unaccounted"]
        )  # fmt: skip
        assert np.abs(books).max() < 1e-9 and np.all(out["stored_energy"] >= 0)
        assert np.all(np.diff(out["dissipated_friction"]) >= 0) and np.all(
            np.diff(out["dissipated_damping"]) >= 0
        )
    assert touched > 50


def test_an_ordinary_hand_is_never_kept_back():
    s = held(box((0.04, 0.06, 0.02)))
    t = np.arange(8000) * 1e-3
    position = np.stack(
        [0.02 * np.sin(5 * t), 0.03 * np.sin(3 * t), 0.016 + 0.005 * np.cos(4 * t)], axis=1
    )  # at most 0.14 m/s
    orientation = np.array([turned(UPRIGHT, np.array([0, 0.02, 0.4]) * np.sin(2 * x)) for x in t])
    out = s.tick_batch(position, orientation)
    assert np.count_nonzero(out["contact_count"]) > 2000
    assert not np.any(out["status"])


def test_a_shake_at_every_other_tick_gets_no_more_than_the_reserve():
    """Held wrenches of an undamped spring feed such a shake: each tick gives k dx^2 that nobody put in."""
    config = replace(COUPLED, coupling_damping=0.0, coupling_torsional_damping=0.0, acceleration_max=2000.0)
    body = sphere(0.02)
    s = held(body, NO_WEIGHT, config=config)
    x = 4e-4 * np.where(np.arange(20_000) // 2 % 2 == 0, 1, -1)
    x[:10] = 0
    x[10:] = np.cumsum(np.clip(np.diff(x[9:]), -9e-4, 9e-4))
    path = np.stack([x, 0 * x, 0 * x + 0.5], axis=1)
    out = s.tick_batch(path, UPRIGHT)
    assert not np.any(out["status"] & Status.JUMP)
    assert out["unaccounted"].min() >= -reserve(body, config, 1e-3)
    assert -out["work_in"].min() <= reserve(body, config, 1e-3)


def test_light_objects_in_stiff_couplings_stay_at_rest_at_slow_ticks():
    config = replace(COUPLED, coupling_stiffness=20_000.0, coupling_torsional_stiffness=20.0)
    s = held(sphere(0.005), mass=1e-3, config=config)
    down = np.concatenate([np.linspace(0.01, 0.0045, 600), np.full(1500, 0.0045)])
    out = s.tick_batch(np.stack([0 * down, 0 * down, down], axis=1), UPRIGHT, 2e-3)
    assert np.ptp(out["force"][-300:, 2]) < 1e-6 and out["force"][-1, 2] > 1.0


def test_the_coupling_keeps_within_the_device():
    s = held(box((0.04, 0.06, 0.02)), config=replace(COUPLED, force_max=2.0, torque_max=0.02))
    out = s.tick_batch(*walked(np.random.default_rng(2), 6000, 1e-4, 1e-3))
    assert np.linalg.norm(out["force"], axis=1).max() <= 2.0 * (1 + 1e-12)
    assert np.linalg.norm(out["torque"], axis=1).max() <= 0.02 * (1 + 1e-12)
    assert np.any(out["status"] & Status.FORCE_LIMITED)


@pytest.mark.parametrize("bad", [(np.nan, 0, 0), (0.3, 0, 0.05)])
def test_bad_input_lets_go_until_free_space(bad):
    s = held(sphere(0.02))
    s.tick_batch(np.tile([0, 0, 0.05], (50, 1)), UPRIGHT)
    out = s.tick(bad)
    assert out["status"] & (Status.BAD_INPUT | Status.JUMP) and np.all(out["force"] == 0)
    out = s.tick_batch(np.tile([0, 0, 0.019], (50, 1)), UPRIGHT)  # inside the floor
    assert np.all(out["force"] == 0) and np.all(out["status"][1:] == Status.WAITING)
    out = s.tick_batch(np.linspace([0, 0, 0.019], [0, 0, 0.05], 200), UPRIGHT)
    assert out["status"][-1] == 0 and out["force"][-1, 2] < 0


@pytest.mark.parametrize(
    "change",
    [
        {"coupling_torsional_stiffness": 0.0},
        {"coupling_stiffness": 0.0},
        {"coupling_damping": -1.0},
        {"coupling_stiffness": float("nan")},
        {"acceleration_max": 0.0},
    ],
)
def test_half_a_coupling_is_refused(change):
    with pytest.raises(RuntimeFailure):
        held(sphere(0.02), config=replace(COUPLED, **change))
