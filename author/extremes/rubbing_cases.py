# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Friction at its ends, by finite elements.

What sticks entirely is pressed by at most (1 - nu) ln(3 - 4 nu) / (1 - 2 nu) of the force of what slides freely (flat
punch, Mossakovskii 1963; a ball's is a little less, Spence 1968), and by no less than it.  As the coefficient goes to
nothing, so does what it changes; the solver with friction then has to find what the one without it finds.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

from palpate.author.extremes import block_press as b
from palpate.author.extremes.case import Case, Wrong, close_to, must_refuse, not_above
from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.tool import Sphere

__all__ = ["NEXT_TO_NOTHING", "rubbing_cases"]

NEXT_TO_NOTHING = 1e-6
"""A coefficient that takes the solver with friction, and changes no force that anybody can tell."""


def rubbing_cases() -> Iterator[Case]:
    for friction in (0.0, 1.0, 10.0):
        yield Case("friction", f"{friction:g}, by finite elements", lambda mu=friction: _friction(mu))
    for friction in (-0.1, np.nan, np.inf):
        value = f"{friction:g}, by finite elements"
        yield Case("friction", value, lambda mu=friction: must_refuse(lambda: _rubbed(mu, 0.3)), True)


@cache
def _rubbed(friction: float, nu: float) -> float:
    organ = b.block(NeoHookean(b.MODULUS, nu))
    depths = 0.5 * b.DEPTH * np.array([0.5, 1.0])
    return float(b.pressed(organ, Sphere(b.RADIUS), depths, friction=friction).force[-1])


def _friction(friction: float) -> str:
    nu = 0.3
    ratio = _rubbed(friction or NEXT_TO_NOTHING, nu) / _rubbed(0.0, nu)
    if not friction:
        return close_to(f"force at {NEXT_TO_NOTHING:g} against the press without any", ratio, 1.0, 2e-3)
    most = (1.0 - nu) * np.log(3.0 - 4.0 * nu) / (1.0 - 2.0 * nu)
    if ratio < 1.0 - 1e-3:
        raise Wrong(f"friction made the press softer, {ratio:.4f} times")
    return not_above("force over that without friction", ratio, most + 5e-3)
