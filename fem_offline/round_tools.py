# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Tools that are rounded solids of revolution: flat punch, cylinder, cone, capsule.

Their own axis is z, their touching end is low.  No edge is ever perfectly sharp: a rounding that is not given gets a
default that is stated here and enters the hash.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from palpate.fem_offline.placed_tool import PlacedTool
from palpate.fem_offline.revolved import Revolved

__all__ = ["Capsule", "Cone", "Cylinder", "FlatPunch"]

EDGE_SHARE = 0.1
"""Edge radius of a punch or cylinder over its radius, where none is given."""
SHAFT = 0.1
"""m; how far a punch or cone goes up, where nothing else is said: as long as the reach of a small organ."""
TIP_RADIUS = 0.5e-3
"""m; of a cone, where none is given."""


def _positive(**lengths: float) -> None:
    for name, value in lengths.items():
        if not (value > 0.0 and math.isfinite(value)):
            raise ValueError(f"{name} is {value} m; it must be positive")


def _edge(radius: float, edge_radius: float | None, length: float) -> float:
    if edge_radius is None:
        return min(EDGE_SHARE * radius, 0.25 * length)
    _positive(edge_radius=edge_radius)
    if edge_radius > radius or 2.0 * edge_radius > length:
        raise ValueError(
            f"edge_radius is {edge_radius} m; it must be at most the radius ({radius} m) "
            f"and half the length ({length} m)"
        )
    return edge_radius


def _rounded_cylinder(radius: float, length: float, r: float) -> Revolved:
    """Standing on z = 0."""
    s, low, high = radius - r, r, length - r
    corners = [(0.0, low), (s, low), (s, high), (0.0, high)]
    if s == 0.0:
        corners = [(0.0, low), (0.0, high)]
    if high == low:
        raise ValueError("an edge radius of half the length leaves no side; take a little less")
    return Revolved(tuple(corners), r)


class _RoundedRod(PlacedTool):
    """A standing cylinder with rounded edges."""

    radius: float
    edge_radius: float | None
    length: float

    def __post_init__(self) -> None:
        _positive(radius=self.radius, length=self.length)
        _ = self.solid

    @cached_property
    def solid(self) -> Revolved:
        r = _edge(self.radius, self.edge_radius, self.length)
        return _rounded_cylinder(self.radius, self.length, r)


@dataclass(frozen=True)
class FlatPunch(_RoundedRod):
    """A round, flat-ended punch with a rounded edge, on a shaft as wide as itself.

    Attributes:
        radius: m, the rounding included.
        edge_radius: m; None: EDGE_SHARE of the radius.
        length: m; of the shaft.
    """

    radius: float
    edge_radius: float | None = None
    length: float = SHAFT


@dataclass(frozen=True)
class Cylinder(_RoundedRod):
    """A cylinder with rounded edges: standing with the axis key along z, lying with it across.

    Attributes:
        radius: m.  length: m, both with the rounding included.
        edge_radius: m; None: EDGE_SHARE of the radius.
    """

    radius: float
    length: float
    edge_radius: float | None = None


@dataclass(frozen=True)
class Capsule(PlacedTool):
    """A rod with half balls for ends.

    Attributes:
        radius: m.
        length: m; of the straight part, from the centre of one half ball to the other's (as USD's Capsule has it).
    """

    radius: float
    length: float

    def __post_init__(self) -> None:
        _positive(radius=self.radius, length=self.length)

    @cached_property
    def solid(self) -> Revolved:
        return Revolved(((0.0, self.radius), (0.0, self.radius + self.length)), self.radius)


@dataclass(frozen=True)
class Cone(PlacedTool):
    """A cone or needle with a ball for a tip.

    Attributes:
        half_angle: rad, between axis and flank.
        tip_radius: m; the flank touches this ball.  The reference point is its lowest point, not the cone's apex,
            which is tip_radius (1 / sin half_angle - 1) below.
        shaft_radius: m; where the flank goes over into a shaft.  None: the flank goes all the way up.
        length: m; from tip to upper end.
    """

    half_angle: float
    tip_radius: float = TIP_RADIUS
    shaft_radius: float | None = None
    length: float = SHAFT

    def __post_init__(self) -> None:
        _positive(tip_radius=self.tip_radius, length=self.length)
        if not 0.0 < self.half_angle < 0.5 * math.pi:
            raise ValueError(f"half_angle is {self.half_angle} rad; it must lie between 0 and pi / 2")
        if 2.0 * self.tip_radius >= self.length:
            raise ValueError(f"tip_radius is {self.tip_radius} m; it must be less than half the length")
        if self.shaft_radius is not None and not self.shaft_radius > self.tip_radius:
            raise ValueError(
                f"shaft_radius is {self.shaft_radius} m; it must be larger than the tip's ({self.tip_radius} m)"
            )
        _ = self.solid

    @cached_property
    def solid(self) -> Revolved:
        r = self.tip_radius
        height, slope = self.length - 2.0 * r, math.tan(self.half_angle)
        wide = height * slope if self.shaft_radius is None else self.shaft_radius - r
        shoulder = wide / slope
        corners = [(0.0, r), (wide, r + shoulder)]
        if shoulder < height:
            corners.append((wide, r + height))
        elif shoulder > height * (1.0 + 1e-12):
            raise ValueError(
                f"a flank of {math.degrees(self.half_angle):.3g} deg does not reach shaft_radius {self.shaft_radius} m "
                f"within {self.length} m: a longer tool or a slimmer shaft"
            )
        return Revolved((*corners, (0.0, r + height)), r)
