# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Counts of knots and of nodes at their ends, on a field that is known everywhere (known_field.py).

Verified: the runtime's normal force at fresh places and depths, against the law that the nodes were drawn from.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from palpate.author.extremes.case import Case, must_refuse, not_above
from palpate.author.extremes.known_field import DEPTH, HALF, RADIUS, KnownField, geometry_of, made
from palpate.fields.cook import cook
from palpate.fields.depth_curve import fit_depth_curve
from palpate.fields.node_fit import uniform_knots
from palpate.fields.site_curves import SiteCurves
from palpate.runtime import Field

__all__ = ["field_cases"]

KNOTS = (2, 4, 13, 64, 1000)
NODES = (3, 4, 5, 10, 30, 100)
TOO_MANY = (10_000, 100_000)
FEWEST = 30
"""Nodes below which the law is the same everywhere: so few cannot know more."""
BAR = 0.035
"""Of force, at the 95th percentile: the default tolerance of a scene."""


def field_cases() -> Iterator[Case]:
    for count in (0, 1, -3):
        yield Case("knots", f"{count}", lambda n=count: must_refuse(lambda: uniform_knots(DEPTH, n)), True)
    for count in KNOTS:
        yield Case("knots", f"{count}", lambda n=count: _error(20, n), count in (2, 64))
    for count in (0, 1, 2):
        yield Case("nodes", f"{count}", lambda n=count: _few(n), count == 0)
    for count in NODES:
        yield Case("nodes", f"{count}", lambda n=count: _error(n, 13), count == 3)
    for count in TOO_MANY:
        yield Case("nodes", f"{count}", lambda n=count: must_refuse(lambda: _many(n)), True)
    yield Case("nodes", "two at one place", _twice, True)
    yield Case("depth ladder", "forces that are not finite", lambda: must_refuse(_not_finite), True)


def _error(nodes: int, knots: int) -> str:
    known = KnownField(wave=0.3 if nodes >= FEWEST else 0.0)
    field = Field.open(cook(made(known, nodes, knots)))
    rng = np.random.default_rng(11)
    c = np.column_stack([rng.uniform(-HALF, HALF, (400, 2)), np.zeros(400)])
    depth = DEPTH * rng.uniform(0.15, 1.0, 400)
    said = field.sample(c + np.outer(RADIUS - depth, [0.0, 0.0, 1.0]))
    truth = np.array([known.law(p[None], np.array([d]))[1][0, 0] for p, d in zip(c, depth, strict=True)])
    error = np.abs(said["normal_force"] / truth - 1.0)
    return not_above(
        "force against the law at 400 fresh places, 95th percentile off by",
        float(np.quantile(error, 0.95)),
        BAR,
    )


def _few(nodes: int) -> str:
    """One node says nothing of elsewhere; where one is enough, it has to be right."""
    return _error(nodes, 13) if nodes else must_refuse(_none)


def _none() -> None:
    from palpate.fields.node_fit import fit_nodes

    fit_nodes([], uniform_knots(DEPTH), RADIUS)


def _many(count: int) -> None:
    """Nodes as a caller may hand them over; only what they need at first is made of them."""
    from palpate.fields.kriging import fit_kriging

    side = int(np.ceil(np.sqrt(count)))
    grid = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2)[:count] * 1e-4
    z = np.column_stack([grid, np.zeros((count, 4))])
    directions = np.tile(np.eye(6)[:2], (count, 1, 1))
    fit_kriging(z, np.zeros((count, 1)), directions, np.zeros((count, 2, 1)))


def _twice() -> str:
    known = KnownField(wave=0.0)
    places = known.places(6, 3)
    places[3] = places[0]
    from palpate.fields.node_fit import fit_nodes

    nodes = fit_nodes([known.press(c) for c in places], uniform_knots(DEPTH), RADIUS)
    return must_refuse(lambda: SiteCurves.from_nodes(nodes, geometry_of(known), RADIUS, 20e-3))


def _not_finite() -> None:
    depth = np.linspace(0.0, DEPTH, 5)
    force = depth * np.array([1.0, 1.0, np.nan, 1.0, 1.0])
    fit_depth_curve(depth, force, 0.5 * depth**2)
