# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rendered inertia gives the hand no energy that the hand has not put in through it."""

import numpy as np
import pytest

from palpate.author.rigid.cook import cooked_rigid
from palpate.author.rigid.free_body import turned
from palpate.author.rigid.polyhedron import box
from palpate.author.rigid.shapes import capsule
from palpate.runtime.rigid import Rigid, RigidConfig, RigidSession, Status

MASS, G, GRIP = 0.5, 9.8, np.array([0, 0, 0.1])
UPRIGHT = np.array([0, 0, 0, 1.0])
SHAFT = capsule(0.005, 0.15)
BONE = box((0.05, 0.4, 0.05)).moved(np.eye(3), np.array([-0.03, 0, 0.08]))
TOUCHING, FREE = 0.5e-3, 3e-3
"""m; x of the shaft's axis: half an eps deep in the bone, and away from it."""


@pytest.fixture(scope="module")
def rigid():
    return Rigid(cooked_rigid(SHAFT, BONE, MASS))


def reserve(dt):
    """J; m a dt^2 10 m/s2 / share, as rigid_inertia.h has it."""
    return MASS * 300.0 * dt**2 * 10.0 / 0.9


def smooth(u):
    return u * u * (3 - 2 * u)


def touch_and_slow(speed, dt):
    """Rests, touches, speeds up along the bone, lifts, slows down free, and comes back slowly: (n, 3) m."""

    def seconds(t):
        return np.linspace(0, 1, round(t / dt) + 1)[1:]

    down, ramp, up, slow = seconds(0.2), seconds(0.4), seconds(0.05), seconds(0.4)
    y = [0 * down, 0.5 * speed * 0.4 * ramp**2]
    y.append(y[-1][-1] + speed * 0.05 * up)
    y.append(y[-1][-1] + speed * 0.4 * (slow - 0.5 * slow**2))
    x = [FREE + (TOUCHING - FREE) * smooth(down), TOUCHING + 0 * ramp,
         TOUCHING + (FREE - TOUCHING) * smooth(up), FREE + 0 * slow]  # fmt: skip
    back = smooth(seconds(40.0 * y[-1][-1]))
    y.append(y[-1][-1] * (1 - back))
    x.append(FREE + 0 * back)
    y, x = np.concatenate(y) - 0.05, np.concatenate(x)
    return np.stack([x, y, 0.187 + 0 * x], axis=1)


@pytest.mark.parametrize("dt", [1e-3, 2.5e-4])
@pytest.mark.parametrize("filter_time", [0.0, 5e-3])
@pytest.mark.parametrize("speed", [0.1, 0.2])
def test_what_speeds_up_on_bone_gives_nothing_as_it_slows_down_free(rigid, speed, filter_time, dt):
    path = touch_and_slow(speed, dt)
    s = RigidSession(rigid, RigidConfig(grip=tuple(GRIP), filter_time=filter_time))
    out = s.tick_batch(path, UPRIGHT, dt)
    assert not np.any(out["status"]) and np.any(out["contact_count"] > 0)
    contact = out["dissipated_friction"][-1] + out["dissipated_damping"][-1]
    assert out["work_in"][-1] > 0 and contact > 0
    assert out["inertial"].min() > -2e-6


def test_free_motion_is_felt_whole_and_given_back_but_for_the_filters_loss(rigid):
    """An ordinary hand is not kept back: minus the mass by the filtered acceleration, whichever way it goes."""
    t = np.arange(0, 2.0, 1e-3)
    wave = np.sin(np.pi * t / 2) ** 2
    path = np.stack([0.2 + 0.05 * wave * np.sin(9 * t), 0.05 * wave * np.cos(14 * t), 0.3 + 0 * t], axis=1)
    turns = np.array([turned(UPRIGHT, np.array([0.3, 0.2, 0.5]) * a) for a in wave * np.sin(6 * t)])
    out = RigidSession(rigid, RigidConfig()).tick_batch(path, turns)
    felt = -MASS * out["acceleration"] - [0, 0, MASS * G]
    assert np.abs(out["force"] - felt).max() < 1e-9
    late = 2 * 5e-3 + 1.5e-3  # s; two filters, two differences and the hold: felt late, m a costs m late a^2
    loss = MASS * late * 1e-3 * np.sum(out["acceleration"] ** 2)
    assert out["inertial"][-1] == pytest.approx(loss, rel=0.02)
    assert np.diff(out["inertial"]).min() < -1e-4  # it gives as well as it takes


@pytest.mark.parametrize("filter_time", [0.0, 5e-3])
@pytest.mark.parametrize("dt", [1e-3, 2.5e-4])
@pytest.mark.parametrize("seed", range(4))
def test_no_hand_takes_more_than_the_reserve_out_of_inertia(rigid, seed, dt, filter_time):
    """Shaken at random and at every other tick, in and out of contact, by up to 300 m/s2."""
    rng, n = np.random.default_rng(seed), 4000
    a = 250.0 * rng.uniform(-1, 1, (n, 3))
    every_other = np.repeat(rng.random(n // 200) < 0.5, 200)
    a[every_other] = np.where(np.arange(n)[every_other] % 2, 200.0, -200.0)[:, None] * [0.2, 1.0, 0.0]
    position, step, path = np.array([FREE, 0, 0.187]), np.zeros(3), []
    for push in a:  # a spring to the middle keeps it near the bone
        pull = push - 900.0 * (position - [1.5e-3, 0, 0.187]) - 10.0 * step / dt
        step = step + np.clip(pull, -170.0, 170.0) * dt**2
        position = position + step
        path.append(position)
    s = RigidSession(rigid, RigidConfig(grip=tuple(GRIP), filter_time=filter_time))
    out = s.tick_batch(np.array(path), UPRIGHT, dt)
    assert np.all(np.isfinite(out["force"]))
    assert out["inertial"].min() >= -reserve(dt) * (1 + 1e-9 * n)


def test_what_is_let_go_loses_its_motion(rigid):
    """Sped up free to 0.2 m/s, let go for a tick, slowed down: nothing comes back."""
    t = np.arange(0, 0.2, 1e-3)
    faster = np.array([0.2, 0, 0.3]) + 0.5 * t[:, None] ** 2 * [0, 1.0, 0]
    slower = faster[-1] + (0.2 * t - 0.5 * t**2)[:, None] * [0, 1.0, 0]
    s = RigidSession(rigid, RigidConfig())
    before = s.tick_batch(faster, UPRIGHT)[-1]["inertial"]
    assert s.tick(faster[-1], flags=2)["status"] & Status.RELEASED
    after = s.tick_batch(slower[1:], UPRIGHT)["inertial"]
    assert before > 5e-3 and after.min() > 0.99 * before
