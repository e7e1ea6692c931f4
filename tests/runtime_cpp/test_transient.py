# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Transients play where the surface is crossed, add to the response alone, end, and are limited as promised."""

import dataclasses

import numpy as np
import pytest
import synthetic_field

from palpate.fields.cook import cook
from palpate.fields.rfield_read import read_rfield
from palpate.fields.transient_layout import HEADER_DTYPE, TransientLayerError, transient_layer
from palpate.runtime import Config, Field, RuntimeFailure, Session
from palpate.runtime.layout import Tick

RATE, DT = 10_000.0, 1e-4
TIME = np.arange(201) / RATE
VELOCITY = np.array([0.05, 0.10, 0.20])
FORCE = np.array([np.sin(2 * np.pi * 100.0 * TIME) * np.hanning(201) * 10.0 * v**1.2 for v in VELOCITY])
FORCE[:, [0, -1]] = 0.0


def library(**given) -> bytes:
    given = {"attenuation": 1.0, "force_short": 100.0, "force_steady": 100.0, "energy_max": 1.0} | given
    return transient_layer(RATE, VELOCITY, FORCE, **given)


PLANE = synthetic_field.small_plane()


def opened(layer: bytes | None) -> Field:
    return Field.open(cook(dataclasses.replace(PLANE, layers={"transient": layer} if layer else {})))


@pytest.fixture(scope="module")
def plain() -> Field:
    return opened(None)


def touch_height(field: Field) -> np.ndarray:
    """A reference point where depth is 0, above the middle of the field's box."""
    low, high = np.array(field.info.box_min), np.array(field.info.box_max)
    z = np.linspace(low[2], high[2], 2001)
    middle = 0.5 * (low + high)
    points = np.column_stack([np.full_like(z, middle[0]), np.full_like(z, middle[1]), z])
    depth = field.sample(points)
    inside = np.flatnonzero((depth["region"] == 2) & (depth["depth"] > 0))
    i = inside[-1]
    return points[i] + [0.0, 0.0, depth["depth"][i]]


def tap(field: Field, velocity: float, start: float = 0.8e-3, ticks: int = 700) -> tuple[np.ndarray, Session]:
    """Straight down from `start` above the surface, resting 0.5 mm deep."""
    at = touch_height(field)
    height = np.maximum(start - velocity * DT * np.arange(ticks), -0.5e-3)
    session = Session(field)
    return session.tick_batch(at + height[:, None] * [0.0, 0.0, 1.0], dt=DT), session


def played(field: Field, plain: Field, velocity: float) -> np.ndarray:
    """(ticks,) N out of the surface, from the event's first tick on."""
    with_it, session = tap(field, velocity)
    without, _ = tap(plain, velocity)
    assert session.transient_account()[2] == 1
    first = int(np.argmax((with_it["status"] & Tick.TRANSIENT) != 0))
    return (with_it["force"] - without["force"])[first:, 2]


@pytest.mark.parametrize("velocity", [0.05, 0.08, 0.1, 0.15, 0.2])
def test_a_tap_plays_the_combination_of_the_two_nearest(plain, velocity):
    found = played(opened(library()), plain, velocity)
    i = int(np.clip(np.searchsorted(VELOCITY, velocity) - 1, 0, 1))
    w = (velocity - VELOCITY[i]) / (VELOCITY[i + 1] - VELOCITY[i])
    expected = (1 - w) * FORCE[i] + w * FORCE[i + 1]
    assert found[:201] == pytest.approx(expected, abs=1e-4 * FORCE.max())
    assert found[201:] == pytest.approx(0.0, abs=1e-12)


def test_slower_than_the_library_scales_down_and_faster_is_limited_and_says_so(plain):
    field = opened(library())
    assert played(field, plain, 0.025)[:201] == pytest.approx(0.5 * FORCE[0], abs=1e-3 * FORCE.max())
    fast, _ = tap(field, 0.4)
    assert np.any(fast["status"] & Tick.TRANSIENT_LIMITED)
    assert played(field, plain, 0.4)[:201] == pytest.approx(FORCE[2], abs=1e-6)
    _, slow = tap(opened(library(velocity_min=0.06)), 0.05)
    assert slow.transient_account()[2] == 0


def test_attenuation_scales_what_is_played(plain):
    found = played(opened(library(attenuation=0.8)), plain, 0.1)
    assert found[:201] == pytest.approx(0.8 * FORCE[1], abs=1e-4 * FORCE.max())


def test_the_responses_accounts_do_not_know_it_and_its_own_adds_up(plain):
    field = opened(library())
    with_it, session = tap(field, 0.1)
    without, _ = tap(plain, 0.1)
    for name in ("work_in", "stored_energy", "hold_leak", "dissipated_rule", "injected", "depth"):
        assert np.array_equal(with_it[name], without[name])
    f = with_it["force"] - without["force"]
    work = np.einsum("ij,ij->i", f[:-1], np.diff(with_it["reference_point"], axis=0))
    given, taken, _ = session.transient_account()
    assert given == pytest.approx(work[work > 0].sum(), abs=1e-12)
    assert taken == pytest.approx(-work[work < 0].sum(), abs=1e-12)
    assert taken > 0


def test_a_hand_that_goes_along_gets_no_more_than_the_allowance():
    bound = 2e-6
    layer = transient_layer(
        RATE, VELOCITY, abs(FORCE), attenuation=1.0, force_short=100.0, force_steady=100.0, energy_max=bound
    )
    field = opened(layer)
    at = touch_height(field)
    down = 0.8e-3 - 0.1 * DT * np.arange(85)
    up = down[-1] + 0.05 * DT * np.arange(1, 300)
    session = Session(field)
    out = session.tick_batch(at + np.r_[down, up][:, None] * [0.0, 0.0, 1.0], dt=DT)
    given, _, events = session.transient_account()
    assert events == 1 and bound < given <= bound + np.linalg.norm(out["force"], axis=1).max() * 0.05 * DT
    assert np.any(out["status"] & Tick.TRANSIENT_LIMITED)


def test_force_stays_within_what_the_device_bears_for_a_moment(plain):
    response = np.linalg.norm(tap(plain, 0.2)[0]["force"], axis=1).max()
    limit = response + 0.2
    out, _ = tap(opened(library(force_short=limit)), 0.2)
    assert np.linalg.norm(out["force"], axis=1).max() <= limit * (1 + 1e-12)
    assert np.any(out["status"] & Tick.TRANSIENT_LIMITED)


def test_the_steady_limit_fades_it(plain):
    out, _ = tap(opened(library(force_steady=0.01, steady_time=0.005)), 0.2)
    free, _ = tap(plain, 0.2)
    late = abs(out["force"] - free["force"])[150:240]
    assert late.shape == (90, 3)
    assert np.any(out["status"] & Tick.TRANSIENT_LIMITED)
    assert late.max() < 1e-9


def test_chatter_begins_no_second_event_and_a_real_second_tap_does():
    field = opened(library())
    at = touch_height(field)

    def events(height: np.ndarray) -> int:
        session = Session(field)
        session.tick_batch(at + height[:, None] * [0.0, 0.0, 1.0], dt=DT)
        return session.transient_account()[2]

    down = 0.8e-3 - 0.1 * DT * np.arange(100)
    chatter = down[-1] + 0.25e-3 - 0.25e-3 * np.cos(2 * np.pi * 200.0 * DT * np.arange(400))
    assert events(np.r_[down, chatter]) == 1
    again = np.r_[down, down[::-1], down]
    assert events(again) == 2


def test_events_overlap_up_to_four_and_a_fifth_is_left_out_and_said(plain):
    time = np.arange(4001) / RATE
    force = 0.5 * np.sin(2 * np.pi * 40.0 * time) * np.hanning(4001)
    force[[0, -1]] = 0.0
    layer = transient_layer(
        RATE, [0.2], force[None], attenuation=1.0, force_short=100.0, force_steady=100.0, energy_max=1.0
    )
    at = touch_height(plain)
    down = 4e-3 - 0.2 * DT * np.arange(1, 206)
    height = np.concatenate([np.full(20, 4e-3), *([down, down[::-1]] * 5), np.full(4200, 4e-3)])
    way = at + height[:, None] * [0.0, 0.0, 1.0]
    session, still = Session(opened(layer)), Session(plain)
    out = session.tick_batch(way, dt=DT)
    found = (out["force"] - still.tick_batch(way, dt=DT)["force"])[:, 2]
    begun = np.flatnonzero((height[1:] < 0) & (height[:-1] >= 0)) + 1
    expected = np.zeros(len(height))
    for k in begun[:4]:
        expected[k : k + 4001] += force[: len(height) - k]
    assert len(begun) == 5 and session.transient_account()[2] == 4
    assert found == pytest.approx(expected, abs=0.01)  # of 1 N: the turn 20 ms before still counts for 1 %
    limited = (out["status"] & Tick.TRANSIENT_LIMITED) != 0
    assert np.flatnonzero(limited).tolist() == [begun[4]]


def test_the_torque_is_the_force_at_the_reference_point(plain):
    field, at = opened(library()), touch_height(plain)
    arm = np.array([0.02, -0.01, 0.05])
    height = np.maximum(0.8e-3 - 0.1 * DT * np.arange(300), -0.5e-3)
    grip = at + height[:, None] * [0.0, 0.0, 1.0] - arm
    config = Config(reference_point=tuple(arm))
    with_it, without = (Session(f, config).tick_batch(grip, dt=DT) for f in (field, plain))
    force, torque = (with_it[name] - without[name] for name in ("force", "torque"))
    assert abs(force).max() > 0.1
    assert torque == pytest.approx(np.cross(arm, force), abs=1e-12)


def test_a_session_that_starts_inside_plays_nothing():
    field = opened(library())
    session = Session(field)
    session.tick_batch(np.repeat([touch_height(field) - [0, 0, 3e-4]], 50, axis=0), dt=DT)
    assert session.transient_account() == (0.0, 0.0, 0)


def test_the_layer_is_read_back_as_it_was_written():
    layer = library()
    data = cook(dataclasses.replace(PLANE, layers={"transient": layer}))
    assert read_rfield(data).layers["transient"] == layer


@pytest.mark.parametrize(
    ("key", "value"),
    [("magic", 1), ("version", 2), ("velocity_count", 0), ("velocity_count", 2), ("sample_count", 1),
     ("sample_count", 2**31),
     ("rate", np.nan), ("attenuation", 2.0), ("energy_max", -1.0), ("steady_time", 0.0), ("force_short", np.inf)],
)  # fmt: skip
def test_a_header_that_is_wrong_is_refused(key, value):
    layer = library()
    header = np.frombuffer(layer[: HEADER_DTYPE.itemsize], HEADER_DTYPE)[0].copy()
    header[key] = value
    with pytest.raises(RuntimeFailure, match="effect transient"):
        opened(header.tobytes() + layer[HEADER_DTYPE.itemsize :])


def test_a_body_that_is_wrong_is_refused():
    layer = library()
    start = HEADER_DTYPE.itemsize
    for cut in (layer[:64], layer[:-4], layer + bytes(4)):
        with pytest.raises(RuntimeFailure, match="effect transient"):
            opened(cut)
    for at, what in ((start, "<f8"), (start + 24, "<f4"), (start + 24 + 40, "<f4"), (len(layer) - 4, "<f4")):
        broken = bytearray(layer)
        broken[at : at + np.dtype(what).itemsize] = np.array([5e6], what).tobytes()
        with pytest.raises(RuntimeFailure, match="effect transient"):
            opened(bytes(broken))


def test_what_makes_no_layer_is_refused_in_words():
    for arguments, match in (
        ((RATE, VELOCITY[::-1], FORCE), "rise"),
        ((RATE, VELOCITY, FORCE + 1.0), "zero at both ends"),
        ((RATE, VELOCITY[:2], FORCE), r"\(k, n\)"),
        ((1.0, VELOCITY, FORCE), "rate = 1"),
    ):
        with pytest.raises(TransientLayerError, match=match):
            transient_layer(*arguments)
