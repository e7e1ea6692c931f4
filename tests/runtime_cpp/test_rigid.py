# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rigid contact against closed forms of rigid-body mechanics."""

import zlib
from dataclasses import replace

import numpy as np
import pytest

from palpate.author.rigid.cook import cooked_rigid
from palpate.author.rigid.free_body import let_go, turned
from palpate.author.rigid.law import LUO_XIAO
from palpate.author.rigid.polyhedron import box
from palpate.author.rigid.shapes import capsule, cylinder, plane, sphere
from palpate.runtime.library import RuntimeFailure
from palpate.runtime.rigid import (
    Case,
    Motion,
    Region,
    Rigid,
    RigidConfig,
    RigidSession,
    Status,
    add_wrenches,
    tick_text,
)

MASS, G = 0.5, 9.8
UPRIGHT = np.array([0, 0, 0, 1.0])
LYING = np.array([np.sqrt(0.5), 0, 0, np.sqrt(0.5)])
FLOOR = plane(2.0, 2.0)
EPS, K, MU, MU_D, KP = 1e-3, 2300.0, 0.7, 0.08, 1600.0
DEEP = 0.5e-3
"""m; how far the tests press below eps."""


def held(body, law=LUO_XIAO, fixed=FLOOR, **config):
    return RigidSession(Rigid(cooked_rigid(body, fixed, MASS, law)), RigidConfig(**config))


def pressed(session, height, orientation=UPRIGHT, deep=DEEP, ticks=60):
    """Comes down from free space, slowly, until the gap is eps - deep; returns where it is."""
    p = np.array([0, 0, height + 1.5e-3])
    path = p[None] - np.linspace(0, 0.5e-3 + deep, ticks)[:, None] * [0, 0, 1]
    session.tick_batch(path, orientation)
    for _ in range(5):
        session.tick(path[-1], orientation)
    return path[-1]


def turn_about(axis, angle):
    return turned(UPRIGHT, np.asarray(axis, dtype=float) * angle)


def test_normal_force_is_stiffness_times_depth_below_the_threshold():
    s = held(sphere(0.02))
    out = s.tick(pressed(s, 0.02))
    assert out["contact_force"] == pytest.approx([0, 0, K * DEEP], abs=1e-9)
    assert out["force"] == pytest.approx([0, 0, K * DEEP - MASS * G], abs=1e-9)
    assert out["contact"][0]["normal"] == pytest.approx([0, 0, 1])


def test_damping_pushes_back_while_coming_down_and_never_pulls():
    s = held(sphere(0.02))
    p = pressed(s, 0.02)
    down = s.tick(p - np.array([0, 0, 1e-5]))
    assert down["contact_force"][2] == pytest.approx(K * (DEEP + 1e-5) + 5.0 * 1e-2, rel=1e-6)
    up = s.tick(p + np.array([0, 0, 0.45e-3]))
    assert up["contact_force"][2] == 0.0


def test_friction_stays_in_the_static_cone_and_is_kinetic_beyond_it():
    s = held(sphere(0.02))
    p = pressed(s, 0.02)
    normal = K * DEEP
    slow = [s.tick(p + np.array([x, 0, 0])) for x in np.arange(0, 0.9e-3, 0.9e-6)]  # below speed_static
    side = np.array([-o["contact_force"][0] for o in slow])
    assert side.max() == pytest.approx(MU * normal, rel=1e-9)
    assert side[100] == pytest.approx(KP * 100 * 0.9e-6, rel=1e-6)  # equation 3
    assert side[-1] == pytest.approx(MU * normal)  # equation 4: it creeps
    fast = [s.tick(p + np.array([0.9e-3 + x, 0, 0])) for x in np.arange(1e-5, 1e-3, 1e-5)]
    assert fast[-1]["contact_force"][0] == pytest.approx(-MU_D * normal, rel=1e-9)  # equation 5 with mu_D
    assert fast[-1]["motion_case"] == Case.SLIDING and fast[-1]["motion"] == Motion.KEPT


def test_dissipation_of_a_drag_is_kinetic_friction_times_distance():
    s = held(sphere(0.02))
    p = pressed(s, 0.02)
    out = s.tick_batch(p + np.arange(1, 2000)[:, None] * [1e-5, 0, 0], UPRIGHT)
    spent = out["dissipated_friction"][-1] - out["dissipated_friction"][999]
    assert spent == pytest.approx(MU_D * K * DEEP * 999e-5, rel=1e-3)
    assert abs(out["unaccounted"][-1] - out["unaccounted"][999]) < 1e-3 * spent


def test_a_let_go_box_stands_where_its_weight_is_carried():
    body = box((0.04, 0.06, 0.02))
    rigid = Rigid(cooked_rigid(body, FLOOR, MASS))
    tilt = turn_about([1, 0.5, 0], 0.003)
    session = RigidSession(rigid, RigidConfig(inertia=False))
    start = pressed(session, 0.01, tilt, deep=MASS * G / K)
    places, _, out = let_go(rigid, body, MASS, start, 1.5, orientation=tilt, session=session)
    last = out[-400:]
    assert last["contact_force"].mean(axis=0) == pytest.approx(
        [0, 0, MASS * G], rel=0.02, abs=0.02 * MASS * G
    )
    assert np.abs(places[-400:, 3:5]).max() < 2e-3  # it rocks: the law damps no turning
    assert places[-1, 2] - 0.01 == pytest.approx(EPS - MASS * G / K, rel=0.02)
    assert out["contact"]["region"][-1, 0] == Region.PLANE


@pytest.mark.parametrize("degrees", [5.0, 15.0, 30.0])
def test_a_ball_rolls_without_slip_down_an_incline(degrees):
    a = np.radians(degrees)
    law = replace(LUO_XIAO, gravity=(G * np.sin(a), 0.0, -G * np.cos(a)))
    body = sphere(0.02)
    rigid = Rigid(cooked_rigid(body, FLOOR, MASS, law))
    session = RigidSession(rigid, RigidConfig(inertia=False))
    start = pressed(session, 0.02, deep=MASS * G * np.cos(a) / K)
    places, velocities, out = let_go(rigid, body, MASS, start, 0.45, dt=5e-4, session=session)
    period = 2 * np.pi / np.sqrt(KP * (1 + 5 / 2) / MASS)  # of the friction spring: whole ones are averaged
    half = len(places) - round(6 * period / 5e-4)
    time = (np.arange(len(places)) * 5e-4)[half:]
    acceleration = np.polyfit(time, velocities[half:, 0], 1)[0]
    assert acceleration == pytest.approx(5 / 7 * G * np.sin(a), rel=0.02)
    assert np.mean(out["contact_force"][half:, 0]) == pytest.approx(-2 / 7 * MASS * G * np.sin(a), rel=0.02)
    assert np.mean(out["motion_case"][half:] == Case.ROLLING) > 0.95


def test_a_spinning_disc_feels_two_thirds_of_mu_n_r():
    radius = 0.02
    s = held(cylinder(radius, 0.08))
    p = pressed(s, 0.04)
    out = [s.tick(p, turn_about([0, 0, 1], 1e-3 * i)) for i in range(600)]
    normal = K * DEEP
    torque = np.array([o["contact_torque"][2] for o in out[400:]])
    assert torque == pytest.approx(-2 / 3 * MU_D * normal * radius, rel=0.02)
    assert out[0]["contact"][0]["region"] == Region.PLANE


def test_a_spinning_line_feels_a_quarter_of_mu_n_l():
    s = held(cylinder(0.02, 0.08))
    p = pressed(s, 0.02, LYING)
    out = [s.tick(p, turned(LYING, np.array([0, 0, 1e-3 * i]))) for i in range(600)]
    assert out[-1]["contact"][0]["region"] == Region.LINE
    assert out[-1]["contact_torque"][2] == pytest.approx(-MU_D * K * DEEP * 0.08 / 4, rel=0.02)


def test_a_disc_that_turns_about_a_point_beside_its_centre_feels_what_the_integral_says():
    radius, off = 0.02, 0.008
    s = held(cylinder(radius, 0.08))
    p = pressed(s, 0.04)
    rng = np.random.default_rng(1)
    disc = rng.uniform(-radius, radius, (400_000, 2))
    disc = disc[(disc**2).sum(axis=1) < radius**2]
    out = None
    for i in range(500):
        angle = 1e-3 * i
        centre = p + np.array([off * (1 - np.cos(angle)), -off * np.sin(angle), 0])
        out = s.tick(centre, turn_about([0, 0, 1], angle))
    c, sn = np.cos(angle), np.sin(angle)
    axis = np.array([off * c, off * sn])
    v = np.stack([-(disc[:, 1] - axis[1]), disc[:, 0] - axis[0]], axis=1)
    u = v / np.linalg.norm(v, axis=1)[:, None]
    force = -MU_D * K * DEEP * u.mean(axis=0)
    torque = -MU_D * K * DEEP * (disc[:, 0] * u[:, 1] - disc[:, 1] * u[:, 0]).mean()
    assert out["contact_torque"][2] == pytest.approx(
        torque, rel=0.06
    )  # sixteen sectors of a pressure that l^2 spreads
    assert out["contact_force"][:2] == pytest.approx(force, abs=0.06 * np.linalg.norm(force))


def test_free_motion_is_felt_as_inertia_and_weight():
    body = box((0.04, 0.06, 0.02))
    s = held(body, filter_time=0.0)
    t = np.arange(0, 0.2, 1e-3)
    a = np.array([2.0, -1.0, 0.5])
    path = np.array([0, 0, 0.5]) + 0.5 * a * t[:, None] ** 2
    turns = [turned(UPRIGHT, np.array([0, 0, 0.5 * 6.0 * x**2])) for x in t]
    out = s.tick_batch(path, np.array(turns))[-1]
    assert out["force"] == pytest.approx([0, 0, -MASS * G] - MASS * a, rel=1e-6)
    assert out["torque"] == pytest.approx([0, 0, -body.inertia(MASS)[2, 2] * 6.0], rel=1e-3, abs=1e-9)


def guarded_hit(push):
    """A cylinder comes down at 20 degrees from the normal; `push` m/s2 along the surface."""
    s = held(cylinder(0.02, 0.08), filter_time=2e-3)
    t = np.arange(0, 0.12, 5e-4)
    speed, angle = 0.03, np.radians(20.0)
    x = speed * np.sin(angle) * t + 0.5 * push * t**2
    z = 0.02 + 3.0e-3 - speed * np.cos(angle) * t
    path = np.stack([x, 0 * t, z], axis=1)
    out = s.tick_batch(path, LYING, 5e-4)
    return out[out["motion"] == Motion.GUARDED][0]


def test_a_guarded_hit_sticks_without_acceleration_and_slides_with():
    stuck, slid = guarded_hit(0.0), guarded_hit(2.0)
    friction = np.linalg.norm(stuck["contact"][0]["friction"])
    assert stuck["contact"][0]["sliding"] == 0
    assert friction == pytest.approx(
        np.tan(np.radians(20.0)) * stuck["contact"][0]["normal_force"], rel=1e-3
    )  # equation 2
    assert slid["contact"][0]["sliding"] == 1
    assert np.linalg.norm(slid["contact"][0]["friction"]) == pytest.approx(
        MU_D * slid["contact"][0]["normal_force"]
    )


def test_pressing_and_lifting_without_sliding_gives_and_takes_no_energy():
    s = held(sphere(0.02), replace(LUO_XIAO, damping=0.0))
    path = np.concatenate([np.linspace(1.5e-3, 0, 500), np.linspace(0, 1.5e-3, 500)])
    out = s.tick_batch(np.stack([0 * path, 0 * path, 0.02 + path], axis=1), UPRIGHT)
    assert out["stored_energy"].max() == pytest.approx(0.5 * K * EPS**2, rel=1e-6)
    assert abs(out["unaccounted"][-1]) < 0.01 * out["stored_energy"].max()


@pytest.mark.parametrize(
    ("change", "status"),
    [
        ({"position": (np.nan, 0, 0)}, Status.BAD_INPUT),
        ({"orientation": (0, 0, 0, 0)}, Status.BAD_INPUT),
        ({"dt": 0.0}, Status.BAD_INPUT),
        ({"dt": 0.5}, Status.STALE),
        ({"flags": 2}, Status.RELEASED),
        ({"position": (0.1, 0, 0.0205)}, Status.JUMP),
    ],
)
def test_bad_input_gives_no_wrench_a_status_and_contact_only_from_free_space(change, status):
    s = held(sphere(0.02))
    p = pressed(s, 0.02)
    out = s.tick(**({"position": p} | change))
    assert out["status"] & status and np.all(out["force"] == 0) and np.all(out["torque"] == 0)
    assert s.tick(p)["contact_count"] == 0 and s.tick(p)["status"] & Status.WAITING
    for z in np.linspace(p[2], 0.0215, 50):
        s.tick((0, 0, z))
    assert s.tick((0, 0, 0.0209))["contact_count"] == 1
    assert tick_text(int(status)) and "\n" not in tick_text(int(status))


def test_what_presses_deeper_than_contact_is_followed_is_released():
    s = held(sphere(0.02))
    p = pressed(s, 0.02)
    out = [s.tick((0, 0, z)) for z in np.linspace(p[2], 0.0175, 10)]
    assert out[-1]["status"] & (Status.TOO_DEEP | Status.WAITING) and any(
        o["status"] & Status.TOO_DEEP for o in out
    )
    assert np.all(out[-1]["force"] == 0)
    assert max(np.linalg.norm(o["contact_force"]) for o in out) <= K * 3e-3 + 5.0 * 0.4


def test_an_object_that_starts_inside_another_is_not_thrown_out():
    for z in (0.0195, 0.015, 0.0):
        s = held(sphere(0.02))
        for height in np.linspace(z, 0.0208, 800):
            assert np.all(s.tick((0, 0, height))["contact_force"] == 0)


def test_force_and_torque_stay_within_the_device():
    s = held(box((0.04, 0.06, 0.02)), force_max=1.0, torque_max=0.01, grip=(0.03, 0, 0.05))
    rng = np.random.default_rng(3)
    position, q = np.array([0.03, 0, 0.0625]), UPRIGHT
    limited = 0
    for _ in range(2000):
        position = position + rng.normal(size=3) * [2e-4, 2e-4, 1e-4] + [0, 0, 0.05 * (0.0608 - position[2])]
        q = turned(q, rng.normal(size=3) * 2e-3)
        out = s.tick(position, q)
        assert np.linalg.norm(out["force"]) <= 1.0 + 1e-9 and np.linalg.norm(out["torque"]) <= 0.01 + 1e-9
        limited += bool(out["status"] & Status.FORCE_LIMITED)
    assert limited > 0


def test_a_stroke_through_a_thin_plate_is_noticed():
    plate = box((0.2, 0.2, 0.006)).moved(np.eye(3), np.array([0, 0, -0.003]))
    s = held(sphere(0.003), replace(LUO_XIAO, depth_max=1.2e-3), plate, speed_max=50.0)
    s.tick((0, 0, 0.01))
    out = s.tick((0, 0, -0.012), dt=1e-3)
    assert out["status"] & Status.JUMP and np.all(out["force"] == 0)


def test_two_worlds_are_one_wrench_within_the_device():
    force, torque, limited = add_wrenches(([1, 0, 0], [0, 0.1, 0]), ([0, 2, 0], [0, 0, 0.2]))
    assert force == pytest.approx([1, 2, 0]) and torque == pytest.approx([0, 0.1, 0.2]) and not limited
    force, torque, limited = add_wrenches(([1, 0, 0], [0, 0.1, 0]), ([0, 2, 0], [0, 0, 0.2]), force_max=1.0)
    assert np.linalg.norm(force) == pytest.approx(1.0) and limited
    assert np.cross(force, [1, 2, 0]) == pytest.approx([0, 0, 0], abs=1e-12)


def test_a_shaft_slides_on_bone_while_its_tip_presses_tissue(plane):
    """One grip, one wrench: the rigid shaft's and the tissue's, each as it would be alone."""
    from palpate.runtime import Config, Session

    grip = np.array([0.0, 0.0, 0.1])  # in the shaft's frame, whose lower end carries the tip
    shaft, tip = capsule(0.005, 0.15), (0.0, 0.0, -0.18)
    bone = box((0.05, 0.2, 0.05)).moved(np.eye(3), np.array([-0.03, 0, 0.08]))
    rigid, tissue = (
        held(shaft, fixed=bone, grip=tuple(grip)),
        Session(plane.field, Config(reference_point=tip)),
    )
    both = 0
    for k in range(400):
        at = np.array(
            [0.0005 + max(0.0, 1e-3 - 1e-5 * k), 0.0, 0.187 - 1e-5 * k]
        )  # tissue fills z < 0, the tip is a 5 mm ball
        hard, soft = rigid.tick(at), tissue.tick(at, orientation=UPRIGHT)
        force, torque, _ = add_wrenches(
            (hard["force"], hard["torque"]), (soft["force"], soft["torque"]), force_max=10.0
        )
        assert np.linalg.norm(force) <= 10.0 + 1e-12
        if (
            hard["contact_count"]
            and soft["depth"] > 0
            and np.linalg.norm(hard["force"] + soft["force"]) < 10.0
        ):
            both += 1
            assert force == pytest.approx(hard["force"] + soft["force"])
            assert torque == pytest.approx(hard["torque"] + soft["torque"])
            assert hard["contact_force"][0] > 0 and soft["normal_force"] > 0
    assert both > 20


def test_damaged_bytes_are_refused_in_one_sentence():
    data = cooked_rigid(capsule(0.01, 0.04), FLOOR, MASS)
    rng = np.random.default_rng(2)
    for cut in rng.integers(0, len(data), 200):
        with pytest.raises(RuntimeFailure):
            Rigid(data[:cut])
    for at in rng.integers(0, len(data), 300):
        changed = bytearray(data)
        changed[at] ^= 1 << int(rng.integers(8))
        with pytest.raises(RuntimeFailure):
            Rigid(bytes(changed))


def test_hostile_bytes_with_a_right_checksum_are_refused_or_rendered_finite():
    data = cooked_rigid(box((0.04, 0.06, 0.02)), cylinder(0.02, 0.2), MASS, formations=((0, 1),))
    rng = np.random.default_rng(4)
    opened = 0
    for _ in range(400):
        changed = bytearray(data)
        for at in rng.integers(24, len(data), rng.integers(1, 4)):
            changed[at] = int(rng.integers(256))
        changed[16:20] = bytes(4)
        changed[16:20] = zlib.crc32(bytes(changed)).to_bytes(4, "little")
        try:
            rigid = Rigid(bytes(changed))
        except RuntimeFailure:
            continue
        opened += 1
        s = RigidSession(rigid)
        path = np.array([0, 0, 0.14]) - np.linspace(0, 0.06, 40)[:, None] * np.array([0.2, 0.1, 1])
        out = s.tick_batch(path, np.array([turn_about([1, 1, 0], 0.02 * i) for i in range(40)]))
        assert np.all(np.isfinite(out["force"])) and np.all(np.isfinite(out["torque"]))
    assert opened > 20
