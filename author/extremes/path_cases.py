# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Paths that live where a field is at its worst: creases, cusps, thin lobes, and the ends of what is known.

Each path presses and shakes around one such place, 4000 ticks with steps from a nanometre to 0.1 mm.  Verified: the
energy books (books.py), and that force is continuous there, its steps falling with the path's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np

from palpate.author.extremes.books import books, judged
from palpate.author.extremes.case import Case, Wrong
from palpate.author.extremes.known_field import DEPTH, HALF, RADIUS, KnownField, made, surface_field
from palpate.fields.cook import cook
from palpate.fields.response_field import ResponseField
from palpate.runtime import Config, Field, Session, Tick

__all__ = ["path_cases"]

TICKS = 4000
Start = Callable[[ResponseField], np.ndarray]


@dataclass(frozen=True)
class Place:
    """Where a path lives.

    Attributes:
        surface: a name of `known_field.SURFACES`.
        at: (3,) m of a field, where the reference point shakes.
        above: (3,) m added to it where the path comes in from.
    """

    surface: str
    at: Start
    above: tuple[float, float, float] = (0.0, 0.0, 8e-3)


def _lattice_corner(field: ResponseField) -> np.ndarray:
    """A corner of the amplitudes' cells, in contact."""
    lattice = field.amplitudes
    near = np.array([2e-3, 3e-3, RADIUS - 2e-3])
    return lattice.origin + np.round((near - lattice.origin) / lattice.spacing) * lattice.spacing


PLACES: dict[str, Place] = {
    "in a crease": Place("crease", lambda f: np.array([0.0, 3e-3, RADIUS / np.cos(np.radians(20.0)) - 2e-3])),
    "on an edge of 90 degrees": Place("ridge", lambda f: np.array([0.0, 3e-3, RADIUS - 2e-3])),
    "on a cusp": Place("cusp", lambda f: np.array([0.0, 0.0, RADIUS - 2e-3])),
    "in a lobe of 3 mm": Place("thin lobe", lambda f: np.array([1e-3, 2e-3, RADIUS - 2e-3])),
    "through a lobe of 3 mm": Place("thin lobe", lambda f: np.array([1e-3, 2e-3, -1e-3])),
    "at first contact": Place("plane", lambda f: np.array([1e-3, 2e-3, RADIUS])),
    "at depth_max": Place("plane", lambda f: np.array([1e-3, 2e-3, RADIUS - DEPTH])),
    "at the band's deep edge": Place("plane", lambda f: np.array([1e-3, 2e-3, float(f.own_band[0])])),
    "below the band": Place("plane", lambda f: np.array([1e-3, 2e-3, float(f.own_band[0]) - 4e-3])),
    "at the reach's edge": Place("plane", lambda f: np.array([HALF, 2e-3, RADIUS - 2e-3])),
    "where the field ends": Place("plane", lambda f: np.array([HALF + 15e-3, 2e-3, RADIUS - 2e-3])),
    "at a corner of cells": Place("plane", _lattice_corner),
}


def path_cases() -> Iterator[Case]:
    for name in PLACES:
        for friction in (0.0, 0.5):
            value, quick = f"{name}, friction {friction:g}", PLACES[name].surface == "plane"
            yield Case("path", value, lambda n=name, mu=friction: _shaken(n, mu), quick)
    for name in ("in a crease", "on an edge of 90 degrees", "on a cusp", "at the reach's edge"):
        yield Case("continuity", name, lambda n=name: _continuous(n), PLACES[name].surface == "plane")


@cache
def _field(surface: str) -> tuple[ResponseField, Field]:
    truth = made(KnownField()) if surface == "plane" else surface_field(surface)
    return truth, Field.open(cook(truth))


def _shaken(name: str, friction: float) -> str:
    place = PLACES[name]
    truth, field = _field(place.surface)
    at = place.at(truth)
    rng = np.random.default_rng(7)
    come = np.linspace(at + np.array(place.above), at, 200)
    step = 10.0 ** rng.uniform(-9.0, -4.0, TICKS // 8).repeat(8)[:, None]
    shake = rng.normal(size=(len(step), 3)) * step
    shake = np.cumsum(shake, axis=0)
    shake -= np.linspace(0.0, 1.0, len(shake))[:, None] * shake[-1]  # comes back to where it is worst
    q = np.concatenate([come, at + shake, come[::-1]])
    r = Session(field, Config(friction_coefficient=friction)).tick_batch(q, dt=1e-3)
    return judged(books(truth, q, r, field.info.stiffness_max, friction), len(q))


def _continuous(name: str) -> str:
    """Across the place, 2 mm deep, in steps of 40 um and of 10 um; no friction, whose slips are steps by right."""
    place = PLACES[name]
    truth, field = _field(place.surface)
    at = place.at(truth)
    largest = []
    for step in (4e-5, 1e-5):
        x = np.arange(-4e-3, 4e-3, step)
        q = at + x[:, None] * np.array([1.0, 0.0, 0.0])
        come = np.linspace(q[0] + np.array(place.above), q[0], 400)
        r = Session(field, Config(friction_coefficient=0.0)).tick_batch(np.concatenate([come, q]), dt=1e-3)[
            len(come) :
        ]
        if np.any(r["status"] & ~np.uint32(Tick.FELT)):
            raise Wrong("contact is lost on a path along the surface")
        largest.append(float(np.linalg.norm(np.diff(r["force"], axis=0), axis=1).max()))
    ratio = largest[1] / largest[0]
    said = f"largest step of force falls to {ratio:.2f} with a quarter of the step"
    if not ratio <= 0.35:
        raise Wrong(f"{said} (bar 0.35; {largest[0]:.2g} N, then {largest[1]:.2g} N)")
    return said
