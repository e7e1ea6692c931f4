# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Exact curved shapes, as surface elements and uniform solids.  Their axis is z; the origin is said with each."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from palpate.author.rigid.body import Body, Element

__all__ = ["bowl", "capsule", "cone", "cylinder", "paraboloid", "pen", "plane", "sphere", "torus", "tube"]

Z = np.array([0.0, 0.0, 1.0])
O = np.zeros(3)
_GAUSS = np.polynomial.legendre.leggauss(12)


def _revolved(
    pieces: list[tuple[Callable[[np.ndarray], np.ndarray], float, float]],
) -> tuple[float, np.ndarray, np.ndarray]:
    """Volume, centre, second moments of the solid of revolution r(z) over pieces (r^2 of z, low, high)."""
    volume = first = zz = xx = 0.0
    for squared, low, high in pieces:
        z = 0.5 * (high - low) * _GAUSS[0] + 0.5 * (high + low)
        w = 0.5 * (high - low) * _GAUSS[1]
        r2 = squared(z)
        volume += np.pi * np.sum(w * r2)
        first += np.pi * np.sum(w * r2 * z)
        zz += np.pi * np.sum(w * r2 * z**2)
        xx += np.pi / 4 * np.sum(w * r2**2)
    centre = first / volume
    return float(volume), np.array([0, 0, centre]), np.diag([xx, xx, zz - volume * centre**2])


def _disc(z: float, radius: float, up: int, inner: float = 0.0) -> Element:
    centre = z * Z
    return Element("disc", centre, up * Z, radius=radius, size=inner, ball=(centre, radius))


def _rim(
    z: float,
    radius: float,
    up: int,
    bounds: tuple[int, ...],
    axial: float = 0.0,
    side: int = 1,
    first: float = 1.0,
) -> Element:
    """A circular edge between a surface with axial normal part `first` (along up z) and one with `axial`."""
    centre = z * Z
    return Element(
        "circle",
        centre,
        up * Z,
        side=side,
        radius=radius,
        size=axial,
        low=first,
        bounds=bounds,
        ball=(centre, radius),
    )


def sphere(radius: float) -> Body:
    """A ball about the origin."""
    volume, centre, second = _revolved([(lambda z: radius**2 - z**2, -radius, radius)])
    face = Element("sphere", O, radius=radius, low=-1.0, ball=(O, radius))
    return Body((face,), volume, centre, second, 2 * radius)


def cylinder(radius: float, length: float) -> Body:
    """A solid cylinder about the origin, along z."""
    h = length / 2
    volume, centre, second = _revolved([(lambda z: radius**2 + 0 * z, -h, h)])
    lateral = Element("cylinder", O, radius=radius, high=h, ball=(O, float(np.hypot(radius, h))))
    parts = (
        lateral,
        _disc(h, radius, 1),
        _disc(-h, radius, -1),
        _rim(h, radius, 1, (0, 1)),
        _rim(-h, radius, -1, (0, 2)),
    )
    return Body(parts, volume, centre, second, min(2 * radius, length))


def capsule(radius: float, length: float) -> Body:
    """A cylinder of `length` between its caps' centres, along z, with half balls at both ends."""
    h = length / 2
    pieces = [
        (lambda z: radius**2 - (z + h) ** 2, -h - radius, -h),
        (lambda z: radius**2 + 0 * z, -h, h),
        (lambda z: radius**2 - (z - h) ** 2, h, h + radius),
    ]
    volume, centre, second = _revolved(pieces)
    lateral = Element("cylinder", O, radius=radius, high=h, ball=(O, float(np.hypot(radius, h))))
    caps = tuple(
        Element("sphere", s * h * Z, s * Z, radius=radius, low=0.0, bounds=(0,), ball=(s * h * Z, radius))
        for s in (1, -1)
    )
    return Body((lateral, *caps), volume, centre, second, 2 * radius)


def cone(radius: float, height: float) -> Body:
    """A cone: apex at the origin, base at z = height."""
    t = radius / height
    volume, centre, second = _revolved([(lambda z: (t * z) ** 2, 0.0, height)])
    cosine = 1 / np.hypot(1, t)
    slant = float(np.hypot(radius, height))
    lateral = Element(
        "cone", O, Z, size=t, low=0.0, high=height, cosine=float(cosine), ball=(height / 2 * Z, slant)
    )
    along = np.array([[radius, 0, height], [-radius, 0, height], [0, radius, height], [0, -radius, height]])
    apex = Element("vertex", O, bounds=(0,), numbers=along)
    base = _disc(height, radius, 1)
    return Body(
        (lateral, apex, base, _rim(height, radius, 1, (0, 2), -t * cosine)),
        volume,
        centre,
        second,
        min(height, radius),
    )


def torus(radius: float, tube_radius: float) -> Body:
    """A torus about the origin: circle of `radius` in the xy plane, tube of `tube_radius`."""
    R, r = radius, tube_radius
    volume = 2 * np.pi**2 * R * r**2
    zz, xx = volume * r**2 / 4, volume * (R**2 / 2 + 3 * r**2 / 8)
    face = Element("torus", O, radius=R, size=r, ball=(O, R + r))
    return Body((face,), float(volume), O, np.diag([xx, xx, zz]), 2 * r)


def plane(width: float, depth: float) -> Body:
    """A flat face in z = 0, solid below, without edges: for floors wider than anything that touches them."""
    x, y = width / 2, depth / 2
    corners = np.array([[-x, -y], [x, -y], [x, y], [-x, y]])
    lines = np.concatenate([corners, np.roll(corners, -1, axis=0)], axis=1)
    face = Element("polygon", O, Z, np.array([1.0, 0, 0]), numbers=lines, ball=(O, float(np.hypot(x, y))))
    return Body((face,), 0.0, O, np.zeros((3, 3)), np.inf)


def paraboloid(curvature: float, height: float) -> Body:
    """A solid z >= c rho^2, z <= height, tip at the origin; `curvature` c in 1/m."""
    radius = float(np.sqrt(height / curvature))
    volume, centre, second = _revolved([(lambda z: z / curvature, 0.0, height)])
    face = Element(
        "paraboloid",
        O,
        Z,
        size=curvature,
        high=height,
        ball=(height / 2 * Z, float(np.hypot(radius, height))),
    )
    slope = 2 * curvature * radius
    axial = -1 / np.hypot(1, slope)
    return Body(
        (face, _disc(height, radius, 1), _rim(height, radius, 1, (0, 1), float(axial))),
        volume,
        centre,
        second,
        min(height, radius),
    )


def bowl(curvature: float, height: float, rim_width: float) -> Body:
    """The inside z = c rho^2 of a bowl and its flat rim at z = height, of `rim_width`; a fixed object without mass."""
    radius = float(np.sqrt(height / curvature))
    face = Element(
        "paraboloid",
        O,
        Z,
        side=-1,
        size=curvature,
        high=height,
        ball=(height / 2 * Z, float(np.hypot(radius, height))),
    )
    slope = 2 * curvature * radius
    flat = _disc(height, radius + rim_width, 1, radius)
    edge = _rim(height, radius, 1, (0, 1), float(1 / np.hypot(1, slope)), -1)
    return Body((face, flat, edge), 0.0, O, np.zeros((3, 3)), rim_width)


def tube(inner: float, outer: float, length: float) -> Body:
    """A pipe about the origin, along z: inside and outside, both flat ends, four rims."""
    h = length / 2
    v0, c, s0 = _revolved([(lambda z: outer**2 + 0 * z, -h, h)])
    v1, _, s1 = _revolved([(lambda z: inner**2 + 0 * z, -h, h)])
    ball = (O, float(np.hypot(outer, h)))
    outside = Element("cylinder", O, radius=outer, high=h, ball=ball)
    inside = Element("cylinder", O, side=-1, radius=inner, high=h, ball=ball)
    ends = [_disc(h, outer, 1, inner), _disc(-h, outer, -1, inner)]
    rims = [
        _rim(s * h, r, s, (wall, 2 + (s < 0)), side=1 if wall == 0 else -1)
        for s in (1, -1)
        for wall, r in ((0, outer), (1, inner))
    ]
    return Body((outside, inside, *ends, *rims), v0 - v1, c, s0 - s1, outer - inner)


def pen(radius: float, length: float, tip_radius: float, half_angle: float) -> Body:
    """A pen: a cylinder, a cone of `half_angle` (rad) tangent to a ball of `tip_radius`; tip at the origin, along z."""
    s, c, t = np.sin(half_angle), np.cos(half_angle), np.tan(half_angle)
    ball = tip_radius * Z  # centre of the tip
    apex = tip_radius - tip_radius / s  # of the cone that is tangent to it
    low, high = tip_radius * (1 - s), apex + radius / t  # where ball and cone, cone and cylinder meet
    top = length
    h = (top - high) / 2
    middle = (top + high) / 2 * Z
    volume, centre, second = _revolved(
        [
            (lambda z: tip_radius**2 - (z - tip_radius) ** 2, 0.0, low),
            (lambda z: (t * (z - apex)) ** 2, low, high),
            (lambda z: radius**2 + 0 * z, high, top),
        ]
    )
    shaft = Element("cylinder", middle, Z, radius=radius, high=h, ball=(middle, float(np.hypot(radius, h))))
    taper = Element(
        "cone", apex * Z, Z, size=float(t), low=low - apex, high=high - apex, cosine=float(c),
        ball=((low + high) / 2 * Z, float(np.hypot(radius, (high - low) / 2))),
    )  # fmt: skip
    end = _disc(top, radius, 1)
    tip = Element("sphere", ball, -Z, radius=tip_radius, low=float(s), bounds=(1,), ball=(ball, tip_radius))
    edge = _rim(top, radius, 1, (0, 2))
    shoulder = _rim(high, radius, 1, (0, 1), -s, first=0.0)
    return Body((shaft, taper, end, tip, edge, shoulder), volume, centre, second, 2 * tip_radius)
