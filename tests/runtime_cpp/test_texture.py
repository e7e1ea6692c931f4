# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A texture is a part of the potential: line at k v, no work around closed paths, still while the tool is."""

import dataclasses

import numpy as np
import pytest
import synthetic_field

from palpate.fields.cook import cook
from palpate.fields.field_error import FieldError
from palpate.fields.interpolation import evaluate
from palpate.fields.rfield_read import read_rfield
from palpate.fields.texture import DeviceLimits, Texture, grating, joined, noise
from palpate.fields.texture_layout import HEADER_DTYPE, read_texture, texture_bytes
from palpate.runtime import Config, Field, RuntimeFailure, Session, TextureLimits, texture_info
from palpate.runtime.layout import Tick

PLANE = synthetic_field.small_plane()
K = 800.0  # 1/m
ABOVE = np.array([0.0, 0.0, 1e-3])  # m; from a place in contact to free space
GRATING = Texture((grating(20e-6, K, (1, 0, 0)),), 0.2e-3, 300.0)
MIXED = Texture(
    joined([noise(6e-6, (300.0, 2500.0), 3, 8), grating(15e-6, 500.0, (0.6, 0.8, 0.0))]), 0.4e-3, 300.0
)
PATCHY = dataclasses.replace(synthetic_field.patchy_texture(), limits=DeviceLimits())


def textured(texture: Texture):
    return dataclasses.replace(PLANE, layers={"texture": texture_bytes(texture)})


def opened(texture: Texture | None) -> Field:
    return Field.open(cook(PLANE if texture is None else textured(texture)))


def above(field: Field) -> np.ndarray:
    """A reference point where depth is 0, above the middle of the field's box."""
    low, high = np.array(field.info.box_min), np.array(field.info.box_max)
    middle = 0.5 * (low + high)
    z = np.linspace(high[2], low[2], 2001)
    points = np.column_stack([np.full_like(z, middle[0]), np.full_like(z, middle[1]), z])
    found = field.sample(points)
    i = int(np.flatnonzero(found["region"] == 2)[0])
    return points[i] + [0.0, 0.0, found["depth"][i]]


def inside(field: Field, count: int, seed: int = 1) -> np.ndarray:
    """Points in contact, up to depth_max."""
    at = above(field)
    random = np.random.default_rng(seed)
    q = at + np.column_stack([*random.uniform(-3e-3, 9e-3, (2, count)), np.zeros(count)])
    return q - random.uniform(0.02, 1.0, count)[:, None] * [0.0, 0.0, field.info.depth_max]


@pytest.mark.parametrize("texture", [GRATING, MIXED, PATCHY])
def test_force_is_minus_the_gradient_of_the_energy(texture):
    field = opened(texture)
    q = inside(field, 300)
    step = 1e-7
    ends = np.stack([q + s * step * axis for axis in np.eye(3) for s in (-1.0, 1.0)])
    energy = field.sample(ends.reshape(-1, 3))["stored_energy"].reshape(3, 2, -1)
    slope = (energy[:, 1] - energy[:, 0]).T / (2.0 * step)
    found = field.sample(q)
    assert found["force"] == pytest.approx(-slope, abs=2e-6 * abs(found["force"]).max())
    assert abs(found["force"] - opened(None).sample(q)["force"]).max() > 0.01


@pytest.mark.parametrize("texture", [MIXED, PATCHY])
def test_the_numpy_twin_says_the_same(texture):
    field = opened(texture)
    q = inside(field, 200)
    found, twin = field.sample(q), evaluate(read_rfield(cook(textured(texture))), q)
    assert found["stored_energy"] == pytest.approx(twin.energy, rel=1e-9, abs=1e-15)
    assert found["force"] == pytest.approx(twin.force, abs=1e-9)


def test_a_session_that_keeps_masks_feels_what_a_sample_does():
    field = opened(PATCHY)
    ahead = 3e-6 * np.arange(-2000, 2000)[:, None] * [1.0, 0.0, 0.0]
    path = above(field) - [0.0, 0.0, 0.5e-3] + ahead * 1.2  # through several cells of the masks, and back
    path = np.concatenate([path, path[::-1]])
    session = Session(field, Config(friction_coefficient=0.0))
    session.tick_batch(np.linspace(path[0] + ABOVE, path[0], 500), dt=1e-4)
    out = session.tick_batch(path, dt=1e-4)
    assert out["force"] == pytest.approx(field.sample(path)["force"], abs=1e-12)
    assert out["force"] == pytest.approx(evaluate(read_rfield(cook(textured(PATCHY))), path).force, abs=1e-9)


@pytest.mark.parametrize(("speed", "spatial_frequency"), [(0.02, 800.0), (0.1, 800.0), (0.05, 1600.0)])
def test_a_drag_has_its_line_at_k_v(speed, spatial_frequency):
    texture = Texture((grating(10e-6, spatial_frequency, (1, 0, 0)),), 0.2e-3)
    field, dt = opened(texture), 1e-4
    at = above(field) - [2e-3, 0.0, 0.4e-3]
    ticks = int(4e-3 / speed / dt)
    path = at + speed * dt * np.arange(ticks)[:, None] * [1.0, 0.0, 0.0]
    session = Session(field, Config(friction_coefficient=0.0))
    session.tick_batch(np.linspace(at + ABOVE, at, 200), dt=dt)
    out = session.tick_batch(path, dt=dt)["force"]
    plain = Session(opened(None), Config(friction_coefficient=0.0))
    plain.tick_batch(np.linspace(at + ABOVE, at, 200), dt=dt)
    f = (out - plain.tick_batch(path, dt=dt)["force"])[:, 0]
    padded = np.fft.rfft(f * np.hanning(ticks), 64 * ticks)
    line = np.fft.rfftfreq(64 * ticks, dt)[np.argmax(abs(padded))]
    assert line == pytest.approx(spatial_frequency * speed, rel=0.01)


def loop(field: Field, ticks: int = 40_000) -> np.ndarray:
    """(ticks + 1, 3); a closed path in contact, slowly."""
    s = 2.0 * np.pi * np.arange(ticks + 1) / ticks
    around = np.column_stack([1.5e-3 * np.sin(s), 1e-3 * np.sin(2 * s), -0.3e-3 * (1.0 - np.cos(s))])
    return above(field) - [0.0, 0.0, 0.5e-3] + around


def worked(field: Field, mu: float) -> tuple[float, np.void, np.void]:
    session = Session(field, Config(friction_coefficient=mu))
    path = loop(field)
    session.tick_batch(np.linspace(path[0] + [0, 0, 1e-3], path[0], 2000), dt=1e-4)
    out = session.tick_batch(path, dt=1e-4)
    f = 0.5 * (out["force"][1:] + out["force"][:-1])  # the trapezoid: no hold's share to first order
    return float(-np.sum(f * np.diff(path, axis=0))), out[0], out[-1]


def booked(first: np.void, last: np.void) -> float:
    """J; work and leak that went neither into stored energy nor into a dissipation."""
    names = {
        "work_in": 1,
        "hold_leak": 1,
        "stored_energy": -1,
        "dissipated_friction": -1,
        "dissipated_rule": -1,
    }
    return sum(sign * (last[name] - first[name]) for name, sign in names.items())


def test_a_closed_path_does_no_work_and_sliding_dissipates():
    field = opened(MIXED)
    work, first, last = worked(field, 0.0)
    assert last["stored_energy"] == pytest.approx(first["stored_energy"], rel=1e-9)
    exchanged = first["stored_energy"]
    assert abs(work) < 1e-6 * exchanged  # of the trapezoid; the accounts below are exact
    assert booked(first, last) == pytest.approx(0.0, abs=1e-15)
    slid, first, last = worked(field, 0.3)
    assert slid > 1e-3 * exchanged
    assert last["dissipated_friction"] > first["dissipated_friction"]


def test_a_stuck_tool_comes_back_without_work():
    field = opened(GRATING)
    session = Session(field, Config(friction_coefficient=2.0))
    at = above(field) - [0, 0, 0.5e-3]
    session.tick_batch(np.linspace(at + ABOVE, at, 500), dt=1e-4)
    there = np.linspace(at, at + np.array([20e-6, 10e-6, 0.0]), 500)
    out = session.tick_batch(np.concatenate([there, there[::-1]]), dt=1e-4)
    assert not np.any(out["status"] & Tick.SLIPPING)
    assert booked(out[0], out[-1]) == pytest.approx(0.0, abs=1e-17)
    spring = out["spring_energy"].max()
    assert out["spring_energy"][-1] < 1e-4 * spring
    # what is missing is the friction spring's, whose stiffness follows the felt depth
    assert out["dissipated_friction"][-1] - out["dissipated_friction"][0] < 0.02 * spring


def test_it_is_still_while_the_tool_is():
    session = Session(opened(MIXED), Config(friction_coefficient=0.0))
    session.set_texture_limits(TextureLimits(time_factor=30.0))
    at = above(session.field) - [0, 0, 0.5e-3]
    session.tick_batch(np.linspace(at + ABOVE, at, 200), dt=1e-4)
    fast = at + 0.5 * 1e-4 * np.arange(30)[:, None] * [1.0, 0.0, 0.0]
    moved = session.tick_batch(fast, dt=1e-4)
    assert np.any(moved["status"] & Tick.TEXTURE_LIMITED)
    held = session.tick_batch(np.repeat(fast[-1:], 50, axis=0), dt=1e-4)["force"]
    assert np.array_equal(held, np.repeat(held[:1], 50, axis=0))


def test_contact_begins_where_it_did_and_force_is_continuous():
    field, plain = opened(GRATING), opened(None)
    at = above(field)
    z = np.linspace(1e-6, -3e-6, 401)
    q = at + z[:, None] * [0.0, 0.0, 1.0]
    touched = field.sample(q)
    assert np.array_equal(touched["region"], plain.sample(q)["region"])
    just = (touched["depth"] > 0) & (touched["depth"] < 0.5e-6)  # w h is below 0.1 % of d there
    assert touched["force"][just] == pytest.approx(plain.sample(q)["force"][just], rel=3e-3, abs=1e-9)
    steps = np.linalg.norm(np.diff(touched["force"], axis=0), axis=1)
    assert steps.max() <= field.info.stiffness_max * 1e-8 * 1.01


def test_without_it_bytes_and_ticks_are_the_same():
    layer = textured(GRATING)
    assert cook(dataclasses.replace(layer, layers={})) == cook(PLANE)
    field, plain = opened(GRATING), opened(None)
    free = above(field) + 0.1 * ABOVE + np.zeros((5, 3))
    assert np.array_equal(Session(field).tick_batch(free)["force"], Session(plain).tick_batch(free)["force"])


@pytest.mark.parametrize(
    ("texture", "least"), [(MIXED, 0.25), (PATCHY, 0.1)]
)  # of masks the bound knows the worst alone
def test_its_stiffness_counts_in_the_certificate(texture, least):
    field, plain = opened(texture), opened(None)
    sigma = field.info.stiffness_max
    assert sigma > plain.info.stiffness_max
    q = inside(field, 4000)
    q = q[field.sample(q)["depth"] <= field.info.depth_max]
    step = 1e-7
    worst = 0.0
    for axis in np.random.default_rng(2).normal(size=(6, 3)):
        axis /= np.linalg.norm(axis)
        change = field.sample(q + step * axis)["force"] - field.sample(q - step * axis)["force"]
        worst = max(worst, float(np.linalg.norm(change, axis=1).max()) / (2.0 * step))
    assert least * sigma < worst <= sigma


def test_what_is_too_fast_is_faded_without_making_energy_and_comes_back():
    field = opened(GRATING)
    session = Session(field, Config(friction_coefficient=0.0))
    session.set_texture_limits(TextureLimits(time_factor=10.0))
    at, dt = above(field) - [1e-3, 0, 0.5e-3], 1e-3
    session.tick_batch(np.linspace(at + ABOVE, at, 200), dt=dt)
    assert session.texture_gain()[0] == 1.0
    slow, fast = 0.05, 0.3  # m/s; alpha k v T is 0.4 and 2.4
    there = at + np.cumsum(np.r_[[fast * dt] * 12])[:, None] * [1.0, 0.0, 0.0] % 2e-3
    out = session.tick_batch(there, dt=dt)
    assert session.texture_gain()[0] < 1e-12
    assert np.all(out["status"][2:] & Tick.TEXTURE_LIMITED)
    assert np.all(np.diff(out["dissipated_rule"]) >= 0.0) and out["dissipated_rule"][-1] > 0.0
    back = there[-1] + slow * dt * np.arange(1, 100)[:, None] * [-1.0, 0.0, 0.0]
    out = session.tick_batch(back, dt=dt)
    assert session.texture_gain()[0] == 1.0 and not out["status"][-1] & Tick.TEXTURE_LIMITED
    balance = out["work_in"] + out["hold_leak"] - out["stored_energy"] - out["dissipated_friction"]
    assert balance - out["dissipated_rule"] == pytest.approx(0.0, abs=1e-14)


def with_gains(texture: Texture, gain: np.ndarray) -> Texture:
    """Amplitudes times a session's gains (16,), which count groups of four waves of one mask."""
    scaled, first = [], 0
    for waves in texture.waves:
        count = len(waves.phase)
        scaled.append(
            dataclasses.replace(waves, amplitude=waves.amplitude * gain[first : first + count] + 1e-30)
        )
        first += 4 * -(-count // 4)
    return dataclasses.replace(texture, waves=tuple(scaled))


MASKED = dataclasses.replace(PATCHY, waves=tuple(dataclasses.replace(w, mask=0) for w in PATCHY.waves))


@pytest.mark.parametrize("texture", [MIXED, PATCHY, MASKED])
def test_gains_that_go_and_come_are_accounted_tick_by_tick(texture):
    field = opened(texture)
    session = Session(field, Config(friction_coefficient=0.0))
    session.set_texture_limits(TextureLimits(structural_frequency=12.0))
    dt, ticks = 1e-4, 600
    speed = np.where(np.arange(ticks) // 100 % 2, 4e-3, 60e-3)  # m/s; k v from 1 to 90 Hz
    at = above(field) - [0.0, 0.0, 0.5e-3]
    path = at + np.cumsum(speed * dt)[:, None] * [0.7, -0.6, 0.0]
    session.tick_batch(np.linspace(at + ABOVE, at, 2000), dt=dt)
    twin = read_rfield(cook(textured(texture)))

    def judged(point: np.ndarray, gain: np.ndarray):
        layer = texture_bytes(with_gains(texture, gain))
        return evaluate(dataclasses.replace(twin, layers={"texture": layer}), point[None])

    gain, moved = session.texture_gain().copy(), 0
    last = session.tick_batch(at[None], dt=dt)[0]
    for q in path:
        out = session.tick_batch(q[None], dt=dt)[0]
        now = session.texture_gain().copy()
        fell = out["dissipated_rule"] - last["dissipated_rule"]
        assert fell >= 0.0 and booked(last, out) == pytest.approx(0.0, abs=1e-17)
        assert bool(out["status"] & Tick.TEXTURE_LIMITED) == bool(np.any(now < 1.0))
        if np.any(now != gain):
            moved += 1
            if moved % 10 == 1:
                felt = judged(q, now)
                assert out["force"] == pytest.approx(felt.force[0], abs=1e-9)
                assert out["stored_energy"] == pytest.approx(felt.energy[0], rel=1e-9)
                assert fell == pytest.approx(judged(q, gain).energy[0] - felt.energy[0], abs=1e-15)
        gain, last = now, out
    assert moved > 100 and last["dissipated_rule"] > 0.0


def test_limits_that_come_while_touching_fade_it_wherever_the_tool_is():
    field = opened(GRATING)
    for cycles in (0.0, 0.25, 0.5, 0.75):  # on the crest, beside it, in the trough
        session = Session(field, Config(friction_coefficient=0.0))
        at = above(field) - [0, 0, 0.5e-3]
        at[0] = (np.round(at[0] * K) + cycles) / K
        session.tick_batch(np.linspace(at + ABOVE, at, 300), dt=1e-4)
        session.set_texture_limits(TextureLimits(force_factor=1.0, force_resolution=1.0))
        slow = at + 1e-6 * np.arange(3750)[:, None] * [1.0, 0.0, 0.0]  # three wavelengths
        out = session.tick_batch(slow, dt=1e-4)
        assert session.texture_gain()[0] == 0.0
        assert out["force"][-1] == pytest.approx(opened(None).sample(slow[-1:])["force"][0], abs=1e-12)


@pytest.mark.parametrize(
    ("limits", "gain"),
    [
        (TextureLimits(space_factor=10.0, resolution=1e-4), 1.0),  # beta k delta = 0.8
        (TextureLimits(space_factor=10.0, resolution=1.3e-4), 0.0),
        (TextureLimits(time_factor=10.0, resolution=1.3e-4), 0.0),
        (TextureLimits(force_factor=10.0, force_resolution=0.5e-3), 1.0),  # A = 300 N/m 20 um = 6 mN
        (TextureLimits(force_factor=10.0, force_resolution=0.7e-3), 0.0),
        (TextureLimits(stiffness_max=2.4), 0.5),  # A k = 4.8 N/m
        # under 1 N, 2 pi k 1 N = 5,027 N/m: A = 0.1005 N
        (TextureLimits(force_factor=10.0, force_resolution=10.0e-3), (1.0, 1.0)),
        (TextureLimits(force_factor=10.0, force_resolution=10.1e-3), (0.0, 1.0)),
        (TextureLimits(stiffness_max=0.5 * 20e-6 * 2.0 * np.pi * K**2), (0.5, 1.0)),
        (TextureLimits(force_factor=10.0, force_resolution=0.5e-3), (1.0, 0.05)),  # 300 N/m is more than 251
    ],
)
def test_what_a_device_can_never_render_is_limited_and_said(limits, gain):
    gain, force = gain if isinstance(gain, tuple) else (gain, 0.0)
    grating_ = dataclasses.replace(GRATING, normal_force=force)
    field = opened(grating_)
    session = Session(field, Config(friction_coefficient=0.0))
    session.set_texture_limits(limits)
    assert session.texture_gain()[0] == pytest.approx(gain)
    at = above(field) - [0, 0, 0.5e-3]
    out = session.tick_batch(np.linspace(at + ABOVE, at, 300), dt=1e-4)
    assert bool(out["status"][-1] & Tick.TEXTURE_LIMITED) == (gain < 1.0)
    stored = opened(dataclasses.replace(grating_, limits=DeviceLimits(**dataclasses.asdict(limits))))
    out_of_file = Session(stored, Config(friction_coefficient=0.0)).tick_batch(
        np.linspace(at + ABOVE, at, 300), dt=1e-4
    )
    assert np.array_equal(out_of_file["force"], out["force"])
    assert stored.sample(at)["force"][0] == pytest.approx(out["force"][-1], abs=1e-15)


def test_a_slow_structure_limits_it_too():
    session = Session(opened(GRATING), Config(friction_coefficient=0.0))
    session.set_texture_limits(TextureLimits(structural_frequency=30.0))
    at, dt = above(session.field) - [1e-3, 0, 0.5e-3], 1e-3
    session.tick_batch(np.linspace(at + ABOVE, at, 200), dt=dt)
    for speed, gain in ((0.03, 1.0), (0.05, 0.0)):  # v k is 24 and 40 Hz
        session.tick_batch(at + (speed * dt * np.arange(60)[:, None] % 2e-3) * [1.0, 0.0, 0.0], dt=dt)
        assert session.texture_gain()[0] == pytest.approx(gain)


def test_the_layer_is_read_back_as_it_was_written():
    for texture in (PATCHY, MIXED, dataclasses.replace(MIXED, normal_force=1.5)):
        layer = texture_bytes(texture)
        assert read_rfield(cook(textured(texture))).layers["texture"] == layer
        assert texture_bytes(read_texture(layer)) == layer
    info = texture_info(opened(texture))
    assert (info.wave_count, info.bytes) == (9, len(layer))
    assert info.height_max == pytest.approx(MIXED.height_max)
    assert info.normal_force == 1.5
    with pytest.raises(RuntimeFailure):
        texture_info(opened(None))


def of_version_1(layer: bytes) -> bytes:
    """The layer as version 1 had it: a shorter header, and the masks where they then begin."""
    header = np.frombuffer(layer[: HEADER_DTYPE.itemsize], HEADER_DTYPE)[0].copy()
    header["version"] = 1
    head = HEADER_DTYPE.itemsize + 160 * int(header["group_count"])
    old = header.tobytes()[:152] + layer[HEADER_DTYPE.itemsize : head]
    return old + (bytes(-len(old) % 64) + layer[head + -head % 64 :] if header["mask_stored"] else b"")


@pytest.mark.parametrize("texture", [GRATING, MIXED, PATCHY])
def test_a_layer_of_version_1_still_loads(texture):
    known = dataclasses.replace(texture, normal_force=2.0)
    old = of_version_1(texture_bytes(known))
    assert texture_bytes(read_texture(old)) == texture_bytes(texture)
    field = Field.open(cook(dataclasses.replace(PLANE, layers={"texture": old})))
    assert texture_info(field).normal_force == 0.0
    q = inside(field, 100)
    assert np.array_equal(field.sample(q)["force"], opened(texture).sample(q)["force"])
    for wrong in (old[:-8], old[:151], texture_bytes(known)[:152]):
        with pytest.raises(FieldError, match="texture"):
            read_texture(wrong)


@pytest.mark.parametrize(
    ("key", "value"),
    [("magic", 1), ("version", 0), ("version", 3), ("group_count", 0), ("group_count", 5), ("group_count", 2**31),
     ("mask_stored", 1), ("mask_stored", 2**32 - 1), ("mask_channel", 0), ("fade_depth", 0.0), ("fade_depth", np.nan),
     ("fade_depth", 1e-5), ("stiffness", -1.0), ("stiffness", np.inf), ("normal_force", -1.0), ("normal_force", np.inf),
     ("time_factor", -1.0), ("resolution", np.nan)],
)  # fmt: skip
def test_a_header_that_is_wrong_is_refused(key, value):
    layer = texture_bytes(GRATING)
    header = np.frombuffer(layer[: HEADER_DTYPE.itemsize], HEADER_DTYPE)[0].copy()
    header[key] = value
    data = cook(textured(GRATING)).replace(layer, header.tobytes() + layer[HEADER_DTYPE.itemsize :])
    with pytest.raises(RuntimeFailure, match="effect texture"):
        Field.open(fitted(data))


def test_a_body_that_is_wrong_is_refused():
    layer, whole = texture_bytes(GRATING), cook(textured(GRATING))
    for at in range(HEADER_DTYPE.itemsize, len(layer), 8):
        for wrong in (np.nan, 1e9, -np.inf):
            broken = layer[:at] + np.float64(wrong).tobytes() + layer[at + 8 :]
            with pytest.raises(RuntimeFailure, match="effect texture"):
                Field.open(fitted(whole.replace(layer, broken)))


def fitted(data: bytes) -> bytes:
    """The checksum made to fit."""
    import zlib

    from palpate.fields.rfield_layout import HEADER_DTYPE as WHOLE

    start = WHOLE.fields["checksum"][1]
    data = bytearray(data)
    data[start : start + 4] = bytes(4)
    data[start : start + 4] = zlib.crc32(data).to_bytes(4, "little")
    return bytes(data)


def test_what_makes_no_layer_is_refused_in_words():
    with pytest.raises(FieldError, match="at least 8e-05 m is right"):
        Texture((grating(20e-6, K, (1, 0, 0)),), 0.05e-3)
    with pytest.raises(FieldError, match="1 to 16 waves"):
        Texture((noise(1e-6, (100.0, 900.0), 1, 17),), 1e-3)
    with pytest.raises(FieldError, match="no direction"):
        grating(1e-6, K, (0, 0, 0))
