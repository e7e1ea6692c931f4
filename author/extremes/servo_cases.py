# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The servo loop at its ends: rates, speeds, quantised and rounded positions, friction, and input that is none.

The path is a hand's that taps and rubs: depth and place are sines whose fastest speed is the one asked for.  What is
verified is said in books.py; a rounded position changes the force by no more than the field's largest stiffness allows.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

from palpate.author.extremes.books import books, judged
from palpate.author.extremes.case import Case, Refused, Wrong, must_refuse, not_above
from palpate.author.extremes.known_field import RADIUS, KnownField, geometry_of, made
from palpate.fields.build_field import build_field
from palpate.fields.cook import cook
from palpate.fields.interpolation import evaluate
from palpate.fields.node_fit import fit_nodes, uniform_knots
from palpate.fields.response_field import ResponseField, ToolReference
from palpate.runtime import Config, Field, Session, Tick

__all__ = ["servo_cases"]

RATES = (10.0, 100.0, 1e3, 1e4, 1e5)
SPEEDS = (1e-3, 0.1, 1.0, 3.0, 10.0)
"""m/s."""
TOO_FAST = (20.0, 1e3)
QUANTA = (1e-6, 1e-5, 1e-4, 1e-3)
"""m."""
FRICTIONS = (0.0, 0.1, 1.0, 10.0, 1e6)
TICKS = 4000
TAP, RUB = 3.2e-3, 12e-3
"""m; amplitudes of depth and place."""
BEFORE = 2e-4
"""m above the surface, where the path begins."""
BOTH = 1.2
"""Speed of the two sines together over that of one."""
EULER = (np.sqrt(5.0) - 1.0) / 2.0
"""An irrational ratio of the two sines, so that no tick meets the same place twice."""


@cache
def _field() -> tuple[ResponseField, Field]:
    known = made(KnownField())
    return known, Field.open(cook(known))


def servo_cases() -> Iterator[Case]:
    for rate in RATES:
        yield Case("servo_rate", f"{rate:g} Hz", lambda r=rate: _trace(r, 0.1), True)
        yield Case("servo_rate", f"{rate:g} Hz, 10 m/s", lambda r=rate: _trace(r, 10.0), True)
    yield Case("servo_rate", "1 Hz", lambda: _told(dt=1.0), True)
    for speed in SPEEDS:
        yield Case("speed", f"{speed:g} m/s", lambda v=speed: _trace(1e3, v), True)
    for speed in TOO_FAST:
        yield Case("speed", f"{speed:g} m/s", lambda v=speed: _stroke(v), True)
    for quantum in QUANTA:
        yield Case("quantisation", f"{1e3 * quantum:g} mm", lambda d=quantum: _quantised(d), True)
    yield Case("float_width", "positions as float32", lambda: _rounded(np.float32), True)
    yield Case("float_width", "positions as float16", lambda: _rounded(np.float16), True)
    yield Case("float_width", "amplitudes as float32 against float64", _amplitudes)
    yield Case("float_width", "organ 900 m from the origin", lambda: _far(900.0), True)
    for friction in FRICTIONS:
        value = f"{friction:g}, in the servo loop"
        yield Case("friction", value, lambda mu=friction: _trace(1e3, 0.1, friction=mu), True)
    for friction in (np.nan, np.inf):
        value = f"{friction:g}, in the servo loop"
        yield Case("friction", value, lambda mu=friction: must_refuse(lambda: _session(mu)), True)
    for dt in (0.0, -1e-3, np.nan):
        yield Case("input", f"dt {dt:g} s", lambda t=dt: _told(dt=t), True)
    for place in (np.nan, np.inf, 1e300, 2e3):
        yield Case("input", f"position {place:g} m", lambda x=place: _told(place=x), True)
    yield Case("input", "orientation of length 0", lambda: _told(orientation=np.zeros(4)), True)


def _path(rate: float, speed: float, ticks: int = TICKS) -> np.ndarray:
    """(ticks, 3) m; begins outside."""
    t = np.arange(ticks) / rate / BOTH
    depth = -BEFORE + TAP * (1.0 - np.cos(speed / TAP * t))
    place = RUB * np.sin(EULER * speed / RUB * t)
    return np.column_stack([place, 0.6 * RUB * np.sin(EULER**2 * speed / RUB * t), RADIUS - depth])


def _session(friction: float | None = None, **config) -> Session:
    return Session(_field()[1], Config(friction_coefficient=friction, **config))


def _trace(rate: float, speed: float, friction: float | None = None) -> str:
    truth, field = _field()
    q = _path(rate, speed)
    r = _session(friction).tick_batch(q, dt=1.0 / rate)
    return judged(books(truth, q, r, field.info.stiffness_max, friction), len(q))


def _stroke(speed: float) -> str:
    """From outside into the tissue in one tick: to be refused as faster than any device."""
    q = np.array([[0.0, 0.0, RADIUS + 1e-3], [0.0, 0.0, RADIUS + 1e-3 - 1e-3 * speed]])
    r = _session().tick_batch(q, dt=1e-3)[-1]
    if np.any(r["force"]):
        raise Wrong(f"a stroke of {speed:g} m/s gave a force of {np.linalg.norm(r['force']):.3g} N")
    return _refusal(int(r["status"]), Tick.JUMP | Tick.TOO_DEEP | Tick.PASSED_THROUGH)


def _refusal(status: int, allowed: int) -> str:
    from palpate.runtime.library import library

    if not status & allowed:
        raise Wrong(f"no status says why (status {status})")
    text = library().palpate_tick_text(status)
    raise Refused(text.decode() if isinstance(text, bytes) else str(text))


def _told(dt: float = 1e-3, place: float = 0.0, orientation: np.ndarray | None = None) -> str:
    """One tick of bad input in contact: zero force, a status, and no way back but from outside."""
    session = _session()
    start = np.array([[0.0, 0.0, RADIUS + 1e-3], [0.0, 0.0, RADIUS - 2e-3]])
    held = session.tick_batch(start, dt=1e-3)[-1]
    if not held["force"][2] > 0.0:
        raise Wrong("no contact to begin with")
    bad = session.tick([place, 0.0, RADIUS - 2e-3], dt=dt, orientation=orientation)
    after = session.tick(start[-1], dt=1e-3)
    if np.any(bad["force"]) or np.any(after["force"]) or not np.isfinite(bad["force"]).all():
        raise Wrong(f"bad input gave a force of {bad['force']} N, then {after['force']} N")
    return _refusal(int(bad["status"]), Tick.BAD_INPUT | Tick.STALE | Tick.JUMP)


def _quantised(quantum: float) -> str:
    """Books at the measured places; and the hand's true work may differ by what the steps of force are worth."""
    truth, field = _field()
    q = _path(1e3, 0.1)
    measured = np.round(q / quantum) * quantum
    r = _session().tick_batch(measured, dt=1e-3)
    found = books(truth, measured, r, field.info.stiffness_max)
    said = judged(found, len(q))
    f = r["force"]
    true_work = -np.sum(f[:-1] * np.diff(q, axis=0))
    seen_work = -np.sum(f[:-1] * np.diff(measured, axis=0))
    most = (
        0.5
        * np.sqrt(3.0)
        * quantum
        * (np.linalg.norm(np.diff(f, axis=0), axis=1).sum() + 2.0 * found.force_max)
    )
    return f"{said}; " + not_above(
        "the hand's true work differs by, of its bound,", abs(true_work - seen_work) / most, 1.0
    )


def _rounded(kind: type) -> str:
    truth, field = _field()
    q = _path(1e3, 0.1)
    other = q.astype(kind).astype(np.float64)
    config = {"friction": 0.0}
    a = _session(**config).tick_batch(q, dt=1e-3)
    b = _session(**config).tick_batch(other, dt=1e-3)
    said = judged(books(truth, other, b, field.info.stiffness_max, 0.0), len(q))
    shallow = a["depth"] < 0.98 * truth.depth_max
    change = np.linalg.norm(a["force"] - b["force"], axis=1)[shallow]
    allowed = 1.05 * field.info.stiffness_max * np.linalg.norm(q - other, axis=1)[shallow] + 1e-12
    worst = not_above("force changed by, of sigma |dq|,", float((change / allowed).max()), 1.0)
    return f"{said}; {worst}"


def _amplitudes() -> str:
    """The runtime on what was cooked, against the field before anything was rounded."""
    known = KnownField()
    nodes = fit_nodes([known.press(c) for c in known.places(40, 3)], uniform_knots(known.depth), RADIUS)
    tool = ToolReference("ball_5mm", "sphere", RADIUS, {"radius": RADIUS}, "0" * 64)
    exact = build_field(nodes, geometry_of(known), tool, known.reach)
    _, field = _field()
    q = _path(1e3, 0.1)
    truth, said = evaluate(exact, q), field.sample(q)
    touching = truth.depth > 0.2 * known.depth
    off = np.linalg.norm(said["force"] - truth.force, axis=1)[touching]
    deepest = float(np.linalg.norm(truth.force, axis=1).max())
    return not_above("force off, of the largest,", float(off.max()) / deepest, 1e-3)


def _far(away: float) -> str:
    """The organ's pose and the tool `away` (m) from the origin: forces as at home."""
    q = _path(1e3, 0.1, 1000)
    home = _session().tick_batch(q, dt=1e-3)
    shift = np.array([away, 0.0, 0.0])
    there = _session(speed_max=0.0).tick_batch(
        q + shift, dt=1e-3, organ_positions=np.tile(shift, (len(q), 1))
    )
    work = float(np.abs(there["force"] - home["force"]).max() / np.abs(home["force"]).max())
    if not np.any(there["force"]):
        raise Wrong("nothing is felt there")
    return not_above("force off what it is at home, of the largest,", work, 1e-6)
