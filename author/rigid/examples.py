# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Luo and Xiao's three examples and three tests as scenes: a motion and what has to come out of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from scipy.optimize import fsolve
from scipy.spatial.transform import Rotation

from palpate.author.rigid.body import Body, combined
from palpate.author.rigid.cook import cooked_rigid
from palpate.author.rigid.formations import formation_table
from palpate.author.rigid.known_configurations import ALONG_X, CROSS, PEG, PLATE
from palpate.author.rigid.law import LUO_XIAO
from palpate.author.rigid.shapes import bowl, cylinder, pen, plane, sphere
from palpate.runtime.rigid import Case, Motion, Region, Rigid, RigidConfig, RigidSession, Status

__all__ = ["EXAMPLES", "Example", "Run", "example_named", "run_example"]

MASS = 0.5
EPS, K = LUO_XIAO.threshold, LUO_XIAO.stiffness
MU, MU_D = LUO_XIAO.static_friction, LUO_XIAO.kinetic_friction
BAD = Status.JUMP | Status.STALE | Status.BAD_INPUT | Status.TOO_DEEP | Status.WAITING | Status.OVERFLOW


@dataclass(frozen=True)
class Example:
    """Attributes:
    story: what moves, in a few words.
    path: positions (n, 3) m of the centre of mass, orientations (n, 4), one for each tick of `dt` s.
    checks: from responses to (what has to come out, whether it did).
    variants: further paths of the same scene, by name.
    """

    name: str
    story: str
    held: Body
    fixed: Body
    path: tuple[np.ndarray, np.ndarray]
    checks: Callable[[dict[str, np.ndarray]], list[tuple[str, bool]]]
    dt: float = 1e-3
    filter_time: float = 5e-3
    variants: dict[str, tuple[np.ndarray, np.ndarray]] = field(default_factory=dict)


@dataclass(frozen=True)
class Run:
    example: Example
    responses: dict[str, np.ndarray]
    outcomes: list[tuple[str, bool]]


def run_example(example: Example, samples: int = 0) -> Run:
    """Ticks the example's paths; with `samples`, against a table of formations searched with that many poses."""
    table = formation_table(example.held, example.fixed, samples=samples).formations if samples else ()
    rigid = Rigid(cooked_rigid(example.held, example.fixed, MASS, formations=table))
    responses = {}
    for name, (position, orientation) in {"": example.path, **example.variants}.items():
        session = RigidSession(rigid, RigidConfig(filter_time=example.filter_time))
        responses[name] = session.tick_batch(position, orientation, example.dt)
    outcomes = example.checks(responses)
    for name, out in responses.items():
        quiet = not np.any(out["status"] & int(BAD))
        outcomes.append(("no tick is refused" + (f" ({name})" if name else ""), quiet))
    return Run(example, responses, outcomes)


def example_named(name: str) -> Example:
    """Raises KeyError when there is none."""
    return EXAMPLES[name]()


def _along(*stops: tuple[float, float, float], ticks: int = 400) -> np.ndarray:
    """Straight lines from stop to stop, (n, 3) m, smooth at both ends."""
    s = 0.5 - 0.5 * np.cos(np.linspace(0, np.pi, ticks))
    legs = [np.array(a) + s[:, None] * (np.array(b) - a) for a, b in pairwise(stops)]
    return np.concatenate(legs)


def _still(positions: np.ndarray, rotation: Rotation | None = None) -> tuple[np.ndarray, np.ndarray]:
    q = (rotation or Rotation.identity()).as_quat()
    return positions, np.tile(q, (len(positions), 1))


def _counts(out: np.ndarray, *regions: int) -> np.ndarray:
    """Which ticks have exactly principal contacts of these regions."""
    wanted = sorted(regions)
    return np.array(
        [sorted(r["contact"]["region"][: r["contact_count"]].tolist()) == wanted for r in out], dtype=bool
    )


def peg_and_hole() -> Example:
    x, y = 0.02, 0.02  # from the middle of the hole to where face meets wall
    deep = 0.4e-3
    path = _along(
        (0, 0, 0.06),
        (0, 0, 0),
        (x - EPS + deep, 0, 0),
        (x - EPS + deep, y - EPS + deep, 0),
        (x - EPS + deep, y - EPS + deep, 0.012),
    )

    def checks(responses):
        out = responses[""]
        wall, corner = _counts(out, Region.PLANE), _counts(out, Region.PLANE, Region.PLANE)
        last = out[-100]
        return [
            (
                "a face meets a wall, then two faces two walls",
                wall.any() and corner.any() and wall.argmax() < corner.argmax(),
            ),
            (
                "each wall pushes with K (eps - d)",
                np.allclose(last["contact_force"][:2], -K * deep, rtol=1e-6),
            ),
            (
                "pulled up, two walls hold back with mu_D N each",
                np.isclose(last["contact_force"][2], -2 * MU_D * K * deep, rtol=1e-3),
            ),
            ("the new wall is a motion that gains a contact", Motion.GAINED in out["motion"]),
        ]

    return Example(
        "peg and hole",
        "a box goes down a hole, to one wall, along it to the next, then up",
        PEG,
        PLATE,
        _still(path),
        checks,
    )


def pen_and_bowl() -> Example:
    c, height, tip, shaft, deep = 10.0, 0.05, 0.003, 0.005, 0.5 * EPS
    body, dish = pen(shaft, 0.14, tip, 0.3), bowl(10.0, height, 0.02)
    rim = np.array([np.sqrt(height / c), height])

    def pose(foot: float, guess: float) -> tuple[np.ndarray, float]:
        slope = 2 * c * foot
        n = np.array([-slope, 1]) / np.hypot(1, slope)
        centre = np.array([foot, c * foot**2]) + n * (tip + EPS - deep)

        def away(angle):
            d = np.array([np.sin(angle[0]), np.cos(angle[0])])
            v = rim - centre
            return [v[0] * d[1] - v[1] * d[0] - (shaft + EPS - deep)]

        angle = float(fsolve(away, [guess])[0])
        d = np.array([np.sin(angle), np.cos(angle)])
        return centre + d * (body.centre[2] - tip), angle

    feet, places, angles = np.linspace(-0.01, 0.015, 800), [], []
    guess = 0.9
    for foot in feet:
        place, guess = pose(foot, guess)
        places.append([place[0], 0, place[1]])
        angles.append(guess)
    ways, turns = np.array(places), np.array(angles)
    lift = np.array([-0.004, 0, 0.004]) * np.linspace(1, 0, 200)[:, None]
    position = np.concatenate([ways[0] + lift, ways])
    orientation = Rotation.from_rotvec(
        np.concatenate([np.full(200, turns[0]), turns])[:, None] * [0, 1, 0]
    ).as_quat()

    def checks(responses):
        out = responses[""]
        both = out[300:]
        kinds = {
            tuple(
                sorted(zip(r["contact"]["held_element"][:2], r["contact"]["fixed_element"][:2], strict=True))
            )
            for r in both
        }
        first = len(body.elements)
        return [
            ("tip in the bowl and shaft on its rim, all the way", kinds == {((0, first + 2), (3, first))}),
            ("two point contacts", bool(_counts(both, Region.POINT, Region.POINT).all())),
            (
                "each pushes with K (eps - d)",
                np.allclose(both["contact"]["normal_force"][:, :2], K * deep, rtol=0.05),
            ),
            ("the tip slides with mu_D", both["contact"]["sliding"][-1, :2].any()),
        ]

    return Example(
        "pen and bowl",
        "a pen slides with its tip in a bowl and its shaft on the rim",
        body,
        dish,
        (position, orientation),
        checks,
    )


def cylinder_and_pipe() -> Example:
    deep = 0.4e-3
    bar = cylinder(0.02, 0.3)
    post = bar.moved(np.eye(3), np.array([0, 0, 0.15]))
    pipe = combined([bar.moved(ALONG_X, np.array([0.15, 0, 0])), post])
    body = cylinder(0.01, 0.06)
    lying = Rotation.from_matrix(ALONG_X)
    z, x = 0.03 + EPS - deep, 0.05 + EPS - deep
    path = _along((0.1, 0, 0.05), (0.1, 0, z), (x, 0, z), (x + 0.01, 0, z))

    def checks(responses):
        out = responses[""]
        line, two = _counts(out, Region.LINE), _counts(out, Region.LINE, Region.LINE)
        drag = out[600]
        return [
            (
                "lies along one pipe in a line, then meets the other in a second line",
                line.any() and two.any(),
            ),
            (
                "dragged, the line holds back with mu_D N",
                np.isclose(drag["contact_force"][0], MU_D * K * deep, rtol=1e-3),
            ),
            (
                "the second line pushes along the first pipe",
                out["contact_force"][two, 0].max() > 0.9 * K * deep,
            ),
            ("leaving it is a motion that breaks a contact", Motion.CHANGED in out["motion"]),
        ]

    return Example(
        "cylinder and pipe",
        "a rod lies down along a bar, is dragged to a post, and back",
        body,
        pipe,
        _still(path, lying),
        checks,
    )


def ball_on_two_cylinders() -> Example:
    away, deep = 0.04 + 0.5 * EPS, 0.5 * EPS
    z = np.linspace(-0.025, 0.025, 1500)
    xy = np.sqrt(away**2 - z**2)
    on = np.stack([xy, xy, z], axis=1)
    out_of = np.array([0.004, 0.004, 0]) * np.linspace(1, 0, 200)[:, None]
    path = np.concatenate([on[0] + out_of, on])

    def checks(responses):
        out = responses[""][300:]
        f = out["contact_force"]
        side = np.linalg.norm(f[:, :2], axis=1)
        top = int(side.argmax())
        n = np.array([0, 1, 0]) * on[-1] / away + np.array([0, 0, 1]) * on[-1] / away
        normal = K * deep * (n + n[[1, 0, 2]])
        return [
            ("both cylinders are kept", bool(_counts(out, Region.POINT, Region.POINT).all())),
            ("F_z goes from negative to positive", f[0, 2] < 0 < f[-1, 2]),
            (
                "F_x and F_y first grow, then fall",
                100 < top < len(out) - 100 and side[top] > 1.05 * max(side[0], side[-1]),
            ),
            (
                "all along it slides, within mu_D N of the normal forces' sum",
                np.linalg.norm(f[-1] - normal) < 2.05 * MU_D * K * deep,
            ),
        ]

    return Example(
        "ball on two cylinders",
        "a ball slides upward in the corner of two crossing bars",
        sphere(0.02),
        CROSS,
        _still(path),
        checks,
    )


def rotation_about_a_point() -> Example:
    deep, arm = 0.5 * EPS, 0.025
    rod = cylinder(0.02, 0.08)
    bar = cylinder(0.02, 0.2).moved(ALONG_X, np.zeros(3))
    angle = np.concatenate(
        [np.zeros(200), np.radians(40) * (0.5 - 0.5 * np.cos(np.linspace(0, np.pi, 1200)))]
    )
    turn = Rotation.from_rotvec(angle[:, None] * [0, 0, 1])
    lying = turn * Rotation.from_euler("x", 90, degrees=True)  # its axis across the bar
    height = np.concatenate([np.linspace(3e-3, 0, 200), np.zeros(1200)])
    point = np.array([0, 0, 0.02])
    centre = point + turn.apply([0, arm, 0.02 + EPS - deep]) + height[:, None] * [0, 0, 1]

    def checks(responses):
        out = responses[""][250:]
        f, m = out["contact_force"], out["contact_torque"]
        across = np.linalg.norm(f[:, :2], axis=1)
        turning = out["motion_case"][50:-50]
        return [
            ("the normal force is constant", np.allclose(f[:, 2], K * deep, rtol=1e-3)),
            ("the object turns about a contact point that rests", np.mean(turning == Case.TURNING) > 0.95),
            (
                "friction is static, within its cone",
                not out["contact"]["sliding"][:, 0].any() and across.max() <= MU * K * deep,
            ),
            (
                "the lever's torque turns with the object",
                m[-1, 1] * m[300, 1] > 0 and abs(m[-1, 1]) > 3 * abs(m[300, 1]),
            ),
        ]

    return Example(
        "rotation about a point",
        "a rod on a bar turns by 40 degrees about where it touches",
        rod,
        bar,
        (centre, lying.as_quat()),
        checks,
    )


def guarded_hit() -> Example:
    speed, angle, dt = 0.03, np.radians(20), 5e-4
    t = np.arange(0, 0.12, dt)
    lying = Rotation.from_euler("x", 90, degrees=True)

    def path(push: float) -> tuple[np.ndarray, np.ndarray]:
        x = speed * np.sin(angle) * t + 0.5 * push * t**2
        z = np.maximum(0.023 - speed * np.cos(angle) * t, 0.0201)
        return _still(np.stack([x, 0 * t, z], axis=1), lying)

    def checks(responses):
        hits = {
            name: out[out["motion"] == Motion.GUARDED][0]["contact"][0] for name, out in responses.items()
        }
        stuck, slid = hits[""], hits["with acceleration"]
        return [
            ("without acceleration it sticks", stuck["sliding"] == 0),
            ("its friction is the impulse's share along the surface", np.isclose(
                np.linalg.norm(stuck["friction"]), np.tan(angle) * stuck["normal_force"], rtol=1e-3)),
            ("with 2 m/s2 along the surface it slides", slid["sliding"] == 1),
            ("with kinetic friction", np.isclose(np.linalg.norm(slid["friction"]), MU_D * slid["normal_force"])),
        ]  # fmt: skip

    return Example(
        "guarded hit",
        "a rod hits a floor 20 degrees off the normal, at constant speed, and with 2 m/s2 along it",
        cylinder(0.02, 0.08),
        plane(1, 1),
        path(0.0),
        checks,
        dt,
        2e-3,
        {"with acceleration": path(2.0)},
    )


EXAMPLES: dict[str, Callable[[], Example]] = {
    "peg_and_hole": peg_and_hole,
    "pen_and_bowl": pen_and_bowl,
    "cylinder_and_pipe": cylinder_and_pipe,
    "ball_on_two_cylinders": ball_on_two_cylinders,
    "rotation_about_a_point": rotation_about_a_point,
    "guarded_hit": guarded_hit,
}
