# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The force amplitude that Hayward's table 1 is asked about is what a simulated drag measures."""

import dataclasses

import numpy as np
import pytest
from synthetic_field import small_plane, synthetic_field

from palpate.author.texture.drag import drag
from palpate.author.texture.rendered import rendered
from palpate.fields.cook import cook
from palpate.fields.response_field import ResponseField
from palpate.fields.texture import DeviceLimits, Texture, Waves, grating
from palpate.fields.texture_layout import texture_bytes
from palpate.runtime import Config, Field, Session, TextureLimits

FLAT = synthetic_field(amplitude=lambda q: np.ones(q.shape[:-1]), amplitude_spacing=3e-3)
HEIGHT, FADE = 20e-6, 0.2e-3  # m


def opened(texture: Texture | None, organ: ResponseField = FLAT) -> Field:
    layers = {} if texture is None else {"texture": texture_bytes(texture)}
    return Field.open(cook(dataclasses.replace(organ, layers=layers)))


def pressed(field: Field, x: np.ndarray, depth: float) -> np.ndarray:
    """(n, 3) N at places x (n,) m at this depth, one a tick."""
    top = field.sample(np.zeros((1, 3)))["depth"][0]
    path = np.column_stack([x, 0.0 * x, np.full_like(x, top - depth)])
    session = Session(field, Config(friction_coefficient=0.0))
    session.tick_batch(np.linspace(path[0] + [0.0, 0.0, depth + 1e-3], path[0], 500), dt=1e-3)
    return session.tick_batch(path, dt=1e-3)["force"]


@pytest.mark.parametrize(
    ("wavelength", "depth", "across"),
    [(0.8e-3, 3e-3, True), (1.25e-3, 2.5e-3, True), (1.25e-3, 0.6e-3, True), (16e-3, 0.6e-3, False)],
)
def test_a_drag_measures_it(wavelength: float, depth: float, across: bool) -> None:
    speed, count = 20e-3, max(1, round(8e-3 / wavelength))  # m/s, whole wavelengths
    x = -8e-3 + speed * 1e-3 * np.arange(round(count * wavelength / speed / 1e-3))
    texture = Texture((grating(HEIGHT, 1.0 / wavelength, (1, 0, 0)),), FADE)
    plain = pressed(opened(None), x, depth)
    added = pressed(opened(texture), x, depth) - plain
    line = 2.0 / len(x) * abs(np.exp(-2j * np.pi * x / wavelength) @ added)  # (3,) N at k v
    step = 1e-5
    softer, stiffer = (pressed(opened(None), x[:1], depth + s)[0, 2] for s in (-step, step))
    judged = dataclasses.replace(
        texture, stiffness=(stiffer - softer) / (2.0 * step), normal_force=float(plain[:, 2].mean())
    ).force_amplitude(texture.waves[0])
    assert (line[0] > line[2]) == across
    assert max(line[0], line[2]) == pytest.approx(judged[0], rel=0.03)


def test_the_drag_of_certify_measures_it_too() -> None:
    texture = Texture((grating(HEIGHT, 800.0, (1, 0, 0)),), FADE, 60.0)
    dragged = drag(cook(dataclasses.replace(FLAT, layers={"texture": texture_bytes(texture)})))
    assert dragged is not None
    assert dragged.judged == pytest.approx(HEIGHT * 2.0 * np.pi * 800.0 * dragged.normal_force)
    assert dragged.spectrum.max() == pytest.approx(dragged.judged, rel=0.03)
    assert dragged.judged > 7.0 * HEIGHT * texture.stiffness


def test_certify_and_the_runtime_judge_alike() -> None:
    random, organ = np.random.default_rng(5), small_plane()
    seen = set()
    for _ in range(60):
        k, a = 10.0 ** random.uniform(1.5, 3.7), 10.0 ** random.uniform(-6.5, -4.5)
        force, stiffness = 10.0 ** random.uniform(-1.5, 1.0), 10.0 ** random.uniform(1.5, 3.5)
        limits = DeviceLimits(
            2.0, 4.0, 10.0, 10.0 ** random.uniform(-5, -3.5), 10.0 ** random.uniform(-4, -2), 30.0, 0.0
        )
        texture = Texture((Waves(np.array([[k, 0.0, 0.0]]), np.zeros(1), np.array([a])),), 5.0 * a, stiffness,
                          normal_force=force)  # fmt: skip
        (row,) = rendered(limits, 1000.0, texture)["waves"]
        session = Session(opened(texture, organ))
        session.set_texture_limits(TextureLimits(**dataclasses.asdict(limits)))
        broken = frozenset(name for name, one in row["limits"].items() if one["met"] is False)
        gain = limits.stiffness_max / (row["force"] * k) if broken == {"gain"} else float(not broken)
        assert session.texture_gain()[0] == pytest.approx(gain)
        seen |= broken | {len(broken)}
    assert {0, "gain", "force_reconstruction", "low_speed_reconstruction"} <= seen
