# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""How long the runtime takes: the published examples, pairs of curved surfaces, and the virtual coupling."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from palpate.author.rigid import shapes
from palpate.author.rigid.body import Body
from palpate.author.rigid.cook import cooked_rigid
from palpate.author.rigid.examples import EPS, EXAMPLES, MASS
from palpate.author.rigid.known_configurations import ALONG_X
from palpate.runtime.rigid import Rigid, RigidConfig, bench_rigid

__all__ = [
    "COUPLING",
    "CURVED_PAIRS",
    "NAMING_BAR",
    "WRENCH_BAR",
    "Timing",
    "coupled_timings",
    "curved_timings",
    "example_timings",
    "press_and_roll",
]

COUPLING = RigidConfig(
    coupling_stiffness=2000.0,
    coupling_damping=20.0,
    coupling_torsional_stiffness=2.0,
    coupling_torsional_damping=0.02,
)

NAMING_BAR, WRENCH_BAR = 20_000.0, 1_500.0
"""ns, of the median tick; Luo and Xiao (2004) report 12 to 16 us for the wrench."""

UPSIDE_DOWN = np.diag([1.0, -1.0, -1.0])
RING, CONE, TIP = shapes.torus(0.02, 0.005), shapes.cone(0.02, 0.05), shapes.paraboloid(20.0, 0.03)
BAR = shapes.cylinder(0.02, 0.2).moved(ALONG_X, np.zeros(3))
SPIKE, HILL = (body.moved(UPSIDE_DOWN, np.zeros(3)) for body in (CONE, TIP))  # their bases below

CURVED_PAIRS: dict[str, tuple[Body, Body]] = {
    "torus on cylinder": (RING, BAR),
    "torus on torus": (RING, RING),
    "torus on cone": (RING, SPIKE),
    "torus in bowl": (RING, shapes.bowl(10.0, 0.05, 0.02)),
    "cone on cylinder": (CONE, BAR),
    "cone on paraboloid": (CONE, HILL),
    "paraboloid on paraboloid": (TIP, HILL),
    "paraboloid on torus": (TIP, RING),
    "capsule on cylinder": (shapes.capsule(0.01, 0.06), BAR),
}


@dataclass(frozen=True)
class Timing:
    """ns of the ticks in contact: naming the formation, all the rest of the tick, and both."""

    name: str
    identify: np.ndarray
    wrench: np.ndarray
    tick: np.ndarray

    @property
    def missed(self) -> list[str]:
        """Bars that the median tick does not meet."""
        bars = (("naming", self.identify, NAMING_BAR), ("wrench", self.wrench, WRENCH_BAR))
        return [f"{what} above {bar:.0f} ns" for what, ns, bar in bars if np.median(ns) > bar]


def example_timings() -> list[Timing]:
    rows = []
    for name, make in EXAMPLES.items():
        e = make()
        rows.append(_timed(name, Rigid(cooked_rigid(e.held, e.fixed, MASS)), e.path, e.dt))
    return rows


def curved_timings() -> list[Timing]:
    rows = []
    for name, (held, fixed) in CURVED_PAIRS.items():
        rigid = Rigid(cooked_rigid(held, fixed, MASS))
        rows.append(_timed(name, rigid, press_and_roll(rigid, held, fixed), 1e-3))
    return rows


def coupled_timings() -> list[Timing]:
    """The examples again, each held by `COUPLING`."""
    rows = []
    for name, make in EXAMPLES.items():
        e = make()
        rows.append(_timed(name, Rigid(cooked_rigid(e.held, e.fixed, MASS)), e.path, e.dt, COUPLING))
    return rows


def press_and_roll(rigid: Rigid, held: Body, fixed: Body, ticks: int = 1000) -> tuple[np.ndarray, np.ndarray]:
    """Leaning by half a radian, down from free space half of eps deep, then turning as far about the vertical.

    Returns:
        positions (n, 3) m of the centre of mass, orientations (n, 4).
    """
    lean = Rotation.from_euler("xy", [0.5, 0.3])
    middle = fixed.centre + np.array([0.004, 0.003, 0])  # beside the axes of symmetry
    reach = sum(
        max(float(np.linalg.norm(e.ball[0] - b.centre)) + e.ball[1] for e in b.elements)
        for b in (held, fixed)
    )

    def touching(angle: float) -> float:
        """Height where contact begins, m."""
        z = np.arange(reach, -reach, -0.1 * EPS)
        q = (Rotation.from_rotvec([0, 0, angle]) * lean).as_quat()
        found = rigid.identify(z[:, None] * [0, 0, 1] + middle, np.tile(q, (len(z), 1)))
        return float(z[np.argmax(found["contact_count"] > 0)])

    knots, angle = np.linspace(0, 0.5, 11), np.linspace(0, 0.5, ticks)
    high = np.interp(angle, knots, [touching(float(k)) for k in knots]) - 0.5 * EPS
    press = high[0] + np.arange(2 * EPS, 0, -0.1 * EPS)
    turns = np.concatenate([np.zeros(len(press)), angle])[:, None] * [0, 0, 1]
    position = middle + np.concatenate([press, high])[:, None] * [0, 0, 1]
    return position, (Rotation.from_rotvec(turns) * lean).as_quat()


def _timed(name, rigid: Rigid, path, dt: float, config: RigidConfig | None = None) -> Timing:
    found = rigid.identify(*path)["contact_count"] > 0
    ns = bench_rigid(rigid, *path, dt, config)
    identify, tick = ns["identify"][found], ns["tick"][found]
    return Timing(name, identify, tick - identify, tick)
