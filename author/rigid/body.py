# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A rigid body: its surface elements, which of them bound which, and the mass properties of a uniform solid."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

__all__ = ["Body", "Element", "combined", "frame_of"]

UP = np.array([0.0, 0.0, 1.0])


def frame_of(axis: np.ndarray) -> np.ndarray:
    """(3,) a unit vector across `axis` (3,), always the same one for the same axis."""
    axis = np.asarray(axis, dtype=float)
    least = np.eye(3)[int(np.argmin(np.abs(axis)))]
    across = least - axis * (axis @ least)
    return across / np.linalg.norm(across)


@dataclass(frozen=True)
class Element:
    """A surface element; what each number means is in runtime_cpp/src/layers/rigid_layout.h.

    Attributes:
        bounds: indices of the elements of the same body whose closure holds this one (itself left out).
        numbers: polygon (k, 4) m, boundary lines in (across, axis x across) from the centre; vertex (k, 3) m, to the
            other end of each edge.
        outward: polygon (k, 3): of each boundary line the unit normal out of the face, and how far, for each metre
            that a point is sunk into the face beyond a reflex edge, it lies past the line; 0 for a convex edge.
        ball: (3,) m and m; centre and radius of a ball that holds the element.
    """

    kind: str
    centre: np.ndarray
    axis: np.ndarray = field(default_factory=lambda: UP)
    across: np.ndarray | None = None
    side: int = 1
    radius: float = 0.0
    size: float = 0.0
    low: float = 0.0
    high: float = 0.0
    cosine: float = 0.0
    normal: np.ndarray = field(default_factory=lambda: np.tile(UP, (2, 1)))
    bounds: tuple[int, ...] = ()
    numbers: np.ndarray = field(default_factory=lambda: np.zeros((0, 1)))
    outward: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    ball: tuple[np.ndarray, float] = field(default_factory=lambda: (np.zeros(3), 0.0))

    def moved(self, rotation: np.ndarray, offset: np.ndarray) -> Element:
        across = frame_of(self.axis) if self.across is None else self.across
        numbers = self.numbers @ rotation.T if self.kind == "vertex" and self.numbers.size else self.numbers
        return replace(
            self,
            centre=rotation @ self.centre + offset,
            axis=rotation @ self.axis,
            across=rotation @ across,
            normal=self.normal @ rotation.T,
            numbers=numbers,
            ball=(rotation @ self.ball[0] + offset, self.ball[1]),
        )


@dataclass(frozen=True)
class Body:
    """Elements and mass properties.

    Attributes:
        elements: with `bounds` into this tuple.
        volume: m3; 0 for what has none (a plane, a bowl's surface).
        centre: (3,) m; centre of mass.
        second: (3, 3) m5; integral of (x - centre)(x - centre)^T over the volume.
        smallest: m; the smallest thickness, which deepest contact must stay below.
    """

    elements: tuple[Element, ...]
    volume: float
    centre: np.ndarray
    second: np.ndarray
    smallest: float

    def moved(self, rotation: np.ndarray, offset: np.ndarray) -> Body:
        """The body turned by `rotation` (3, 3), then moved by `offset` (3,), m."""
        return Body(
            tuple(e.moved(rotation, offset) for e in self.elements),
            self.volume,
            rotation @ self.centre + offset,
            rotation @ self.second @ rotation.T,
            self.smallest,
        )

    def inertia(self, mass: float) -> np.ndarray:
        """(3, 3) kg m2 about the centre of mass, of a uniform solid: I = rho (tr(S) 1 - S)."""
        return mass / self.volume * (np.trace(self.second) * np.eye(3) - self.second)


def combined(bodies: list[Body]) -> Body:
    """One body of several that do not overlap: elements renumbered, second moments carried to the common centre."""
    elements: list[Element] = []
    for body in bodies:
        first = len(elements)
        elements += [replace(e, bounds=tuple(b + first for b in e.bounds)) for e in body.elements]
    volume = sum(b.volume for b in bodies)
    if volume == 0.0:
        centre = np.mean([b.centre for b in bodies], axis=0)
        return Body(tuple(elements), 0.0, centre, np.zeros((3, 3)), min(b.smallest for b in bodies))
    centre = sum((b.volume * b.centre for b in bodies), np.zeros(3)) / volume
    second = np.zeros((3, 3))
    for b in bodies:
        d = b.centre - centre
        second += b.second + b.volume * np.outer(d, d)
    return Body(tuple(elements), volume, centre, second, min(b.smallest for b in bodies))
