# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Hayward's table 1: each limit by its formula, and what the chapter says of the PHANTOM and the Pantograph."""

from __future__ import annotations

import numpy as np
import pytest

from palpate.author.texture.rendered import DEVICES, device_named, fastest, finest, limits_of, rendered
from palpate.fields.texture import DeviceLimits, Texture, Waves

FULL = DeviceLimits(10.0, 5.0, 10.0, 30e-6, 1e-3, 500.0, 100.0)


def test_each_limit_is_its_formula() -> None:
    k, v, A, T = 1000.0, 0.05, 0.02, 1e-3
    rows = limits_of(FULL, T, k, v, A)
    assert rows["scanning_velocity"]["value"] == pytest.approx(10.0 * k * v * T)
    assert rows["low_speed_reconstruction"]["value"] == pytest.approx(5.0 * k * 30e-6)
    assert rows["high_speed_reconstruction"]["value"] == pytest.approx(10.0 * k * 30e-6)
    assert (rows["force_reconstruction"]["value"], rows["force_reconstruction"]["bound"]) == (0.01, A)
    assert (rows["gain"]["value"], rows["gain"]["bound"]) == (pytest.approx(20.0), 500.0)
    assert (rows["structure"]["value"], rows["structure"]["bound"]) == (pytest.approx(50.0), 100.0)
    assert [row["met"] for row in rows.values()] == [True] * 6


@pytest.mark.parametrize(
    ("change", "broken"),
    [
        ({"v": 0.1}, ["scanning_velocity", "structure"]),
        ({"k": 4000.0}, ["scanning_velocity", "high_speed_reconstruction", "structure"]),
        ({"k": 7000.0}, [
            "scanning_velocity", "low_speed_reconstruction", "high_speed_reconstruction", "structure",
        ]),
        ({"A": 0.01}, ["force_reconstruction"]),
        ({"A": 0.5}, ["gain"]),
    ],
)  # fmt: skip
def test_what_exceeds_a_limit_is_named(change: dict[str, float], broken: list[str]) -> None:
    given = {"k": 1000.0, "v": 0.05, "A": 0.02} | change
    rows = limits_of(FULL, 1.001e-3, given["k"], given["v"], given["A"])
    assert [name for name, row in rows.items() if row["met"] is False] == broken


def test_what_nobody_knows_is_no_limit() -> None:
    rows = limits_of(DeviceLimits(), 1e-3, 1e5, 10.0)
    assert all(row["met"] is None for row in rows.values())
    assert finest(DeviceLimits(), 1e-3, 0.1) == (0.0, "") and fastest(DeviceLimits(), 1e-3, 1e3) == (None, "")


def test_the_phantom_resolves_a_millimetre_and_its_structure_spoils_ten() -> None:
    """ "in principle, has enough resolution in time and space ... up to 1 mm": alpha = beta = 10; yet a first
    anti-resonance of 30 Hz is met by a 10 mm grating at 0.3 m/s, and by one of 1 mm at 0.03 m/s already."""
    device = device_named("phantom")
    assert device is not None
    period, limits = 1.0 / device.rate, device.limits()
    slow = limits_of(limits, period, 1000.0, 0.05)
    assert all(
        slow[n]["met"] for n in ("scanning_velocity", "low_speed_reconstruction", "high_speed_reconstruction")
    )
    assert slow["structure"]["met"] is False
    coarse = limits_of(limits, period, 100.0, 0.35)
    assert [name for name, row in coarse.items() if row["met"] is False] == ["structure"]
    assert fastest(limits, period, 100.0) == (pytest.approx(0.3), "structure")


def test_the_pantographs_structure_bears_all_reasonable_speeds() -> None:
    """400 Hz: a 1 mm grating up to 0.4 m/s, a 10 mm grating up to 4 m/s; thirteen times a PHANTOM's."""
    phantom, pantograph = DEVICES
    period = 1.0 / pantograph.rate
    assert all(
        row["met"] is not False for row in limits_of(pantograph.limits(), period, 1000.0, 0.35).values()
    )
    assert fastest(pantograph.limits(), period, 1000.0) == (pytest.approx(0.4), "structure")
    assert pantograph.structural_frequency / phantom.structural_frequency == pytest.approx(400 / 30)


def test_each_wave_of_a_texture_is_judged() -> None:
    waves = Waves(np.array([[500.0, 0, 0], [0, 4000.0, 0]]), np.zeros(2), np.array([20e-6, 1e-6]))
    told = rendered(FULL, 1000.0, Texture((waves,), 1e-3, 1000.0))
    first, second = told["waves"]
    assert first["met"] and first["force"] == pytest.approx(0.02) and first["speed_max"] == pytest.approx(0.2)
    assert not second["met"] and not told["met"]
    assert second["limits"]["high_speed_reconstruction"]["met"] is False
    assert second["limits"]["force_reconstruction"]["met"] is False
    at_tenth = next(row for row in told["finest"] if row["speed"] == 0.1)
    assert (at_tenth["wavelength"], at_tenth["limit"]) == (pytest.approx(1e-3), "scanning_velocity")
