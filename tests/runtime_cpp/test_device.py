# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A simulated device on the runtime: quiet where the bound holds, a limit cycle where it is broken."""

import numpy as np
import pytest

from palpate.runtime import Config, Session
from palpate.runtime.device import Device, Hand, simulate

PUSH = Hand(push=(0.0, 0.0, -0.1))  # N; sinks the ball some millimetres into the soft side
START = (-4e-3, 0, 5.2e-3)
RATE = 250.0  # Hz; slow, so that the leak is large


def restlessness(field, device, ticks=1750):
    """RMS speed along the push (m/s) in the second and in the last seventh of the time, and the motion.

    Aside it may slide to softer tissue.
    """
    motion = simulate(
        Session(field, Config(friction_coefficient=0.0, speed_max=0.0)), device, PUSH, START, ticks
    )
    part = ticks // 7
    early, late = (np.sqrt(np.mean(motion.velocity[i : i + part, 2] ** 2)) for i in (part, ticks - part))
    return float(early), float(late), motion


@pytest.fixture(scope="module")
def stiffness(plane):
    """N/m; where the push comes to rest."""
    *_, motion = restlessness(plane.field, Device(damping=5.0, rate=RATE))
    assert motion.responses["force"][-1, 2] == pytest.approx(0.1, rel=1e-3)
    return float(motion.responses["stiffness"][-1])


@pytest.mark.parametrize("delay", [0.0, 2e-3])
def test_with_the_damping_that_the_bound_asks_for_the_device_comes_to_rest(plane, stiffness, delay):
    bound = stiffness * (0.5 / RATE + delay)
    early, late, _ = restlessness(plane.field, Device(damping=1.3 * bound, rate=RATE, delay=delay))
    assert late < 0.2 * early
    _, late, _ = restlessness(plane.field, Device(damping=2.0 * bound, rate=RATE, delay=delay))
    assert late < 1e-4


@pytest.mark.parametrize("delay", [0.0, 2e-3])
def test_with_less_the_device_never_rests(plane, stiffness, delay):
    bound = stiffness * (0.5 / RATE + delay)
    early, late, motion = restlessness(plane.field, Device(damping=0.8 * bound, rate=RATE, delay=delay))
    assert late > early > 1e-2
    assert motion.responses["hold_leak"][-1] > 1e-4  # what feeds it


def test_a_faster_loop_is_a_cure(plane, stiffness):
    damping = 0.8 * stiffness * 0.5 / RATE
    early, late, _ = restlessness(plane.field, Device(damping=damping, rate=RATE))
    assert late > early
    early, late, _ = restlessness(plane.field, Device(damping=damping, rate=4 * RATE), 7000)
    assert late < 0.1 * early


def test_with_the_leaks_cover_a_device_beyond_the_bound_never_takes_more_than_it_gave(plane, stiffness):
    """It may sink, as the surface yields; without the cover the hold feeds it."""
    device = Device(damping=0.5 * stiffness * 0.5 / RATE, rate=RATE)
    taken = {}
    for cover in (False, True):
        config = Config(friction_coefficient=0.0, speed_max=0.0, passivity_control=cover)
        r = simulate(Session(plane.field, config), device, PUSH, START, 600).responses
        taken[cover] = float(np.max(r["stored_energy"] - r["work_in"]))
    assert taken[False] > 5e-4  # J
    assert taken[True] < 0.05 * taken[False]


def test_a_coarse_position_hums_without_dry_friction_and_rests_with_it(plane, stiffness):
    quantum = 0.2e-3
    device = Device(damping=0.75 * stiffness / RATE, rate=RATE, quantum=quantum)
    _, humming, _ = restlessness(plane.field, device)
    needed = 0.5 * stiffness * quantum
    quiet = Device(damping=device.damping, rate=RATE, quantum=quantum, dry_friction=1.5 * needed)
    assert restlessness(plane.field, quiet)[1] < 0.02 * humming


def test_a_hand_that_means_to_drag_drags(plane):
    ticks = 1000
    line = np.linspace((-4e-3, 0, 2e-3), (-1e-3, 0, 2e-3), ticks)
    hand = Hand(stiffness=400.0, damping=4.0, intention=line)
    motion = simulate(
        Session(plane.field, Config(friction_coefficient=0.2)), Device(damping=1.0), hand, START, ticks
    )
    last = motion.responses[-1]
    assert last["depth"] > 1e-3 and last["dissipated_friction"] > 0
    assert motion.position[-1, 0] > -1.5e-3 and last["force"][0] < 0


@pytest.mark.parametrize("device", [Device(mass=0), Device(rate=0), Device(delay=1.0), Device(damping=-1)])
def test_a_device_that_cannot_be_is_refused(plane, device):
    with pytest.raises(ValueError):
        simulate(Session(plane.field), device, PUSH, START, 1)
