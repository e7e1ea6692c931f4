# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A tool on a path: equilibrium after equilibrium, each started from the ones before.

The path is a pose for every m of way.  Displacements and multipliers are extrapolated from the last two equilibria;
a step that fails is halved.  Without friction only the pose counts; with friction the way counts too, so steps are
smaller, each ends in equilibrium, and the contact remembers it.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass

import numpy as np

from palpate.fem_offline.contact import Unilateral
from palpate.fem_offline.coulomb import Coulomb, FrictionCheck
from palpate.fem_offline.equilibrium import Equilibrium, EquilibriumError, equilibrate
from palpate.fem_offline.site import Site
from palpate.fem_offline.sliding import equilibrate_sliding
from palpate.fem_offline.tool import Pose, Tool

__all__ = ["DEFAULT_SETTINGS", "Ladder", "PressSettings", "reaction_error"]

LOOSE = 1.0e-2
"""Residual at which multipliers are updated; a better one does not survive the update."""
PATH = 1.0e-5
"""Residual of steps on the way with friction; they are remembered."""
PENALTY_RANGE = (12.0, 120.0)
"""Of the penalty over E, times the contact's size: a contact of 40 um that has 8 per mm gave three quarters of its
force, and one of 0.2 m is over-constrained, as the stick radius of partial slip is from 25 on (off by 12 % instead of
3).  A ball of 5 mm, 1 to 5 mm deep, has 18 to 40."""


@dataclass(frozen=True)
class PressSettings:
    """How a press is solved; part of every record's hash.

    Attributes:
        penalty: contact penalty over E, 1/m (8 per mm; see contact.py); kept within PENALTY_RANGE of the contact.
        updates: multiplier updates at each recorded depth; multipliers are extrapolated in depth as well.
        tolerance: residual over force at recorded states.
        step: largest move of the tool between equilibria over the size of the contact at the deepest state.
        halvings: how often a failed step is halved before the press stops.
        sticking_penalty: multiple of `penalty` that holds sticking points.
        reaction_tolerance: action against reaction above which a state is refused.
        growth: with friction, largest step over the depth already reached; the first is an eighth of the first depth.
    """

    penalty: float = 8.0e3
    updates: int = 1
    tolerance: float = 1.0e-9
    step: float = 0.12
    halvings: int = 4
    sticking_penalty: float = 10.0
    reaction_tolerance: float = 1.0e-8
    growth: float = 0.25


DEFAULT_SETTINGS = PressSettings()


@dataclass
class Ladder:
    """The last equilibria on a path.

    Attributes:
        size: m; of the contact at the deepest state.
        path: pose of the tool, of the way from the start, m.
        way: m; of the last equilibria, as are u, (N, 3) m each, and pressure, (B, Q) Pa each.
        newton_steps: in all.
        dissipation: J on the way.  check: of the last step.  Both with friction only.
        growing: steps on the way grow with it, because contact grows from a point.
        warm: steps after which the last two equilibria may be extrapolated; the untouched one is no guide.
    """

    site: Site
    tool: Tool
    settings: PressSettings
    contact: Unilateral
    size: float
    path: Callable[[float], Pose]
    way: list[float]
    u: list[np.ndarray]
    pressure: list[np.ndarray]
    newton_steps: int = 0
    dissipation: float = 0.0
    check: FrictionCheck | None = None
    growing: bool = False
    warm: int = 2

    @classmethod
    def above(
        cls, site: Site, tool: Tool, settings: PressSettings, deepest: float, friction: float = 0.0
    ) -> Ladder:
        """At touch, on the way in along -normal, as far as `deepest` (m); the way is depth."""

        def path(depth: float) -> Pose:
            return site.pose(tool, depth)

        rest = np.zeros_like(site.body.nodes)
        size = site.contact_size(tool, deepest)
        penalty = _penalty(settings, size) * site.youngs_modulus
        if not friction:
            contact = Unilateral(site.surface, tool, penalty, path(0.0))
        elif 0.0 < friction < np.inf:
            contact = Coulomb(
                site.surface,
                tool,
                penalty,
                path(0.0),
                friction=friction,
                tangential_penalty=settings.sticking_penalty * penalty,
            )
            contact.start(rest)
        else:
            raise ValueError(f"friction is {friction}; it must be zero or a positive number")
        pressure = np.zeros(site.surface.point_shape)
        return cls(
            site, tool, settings, contact, size, path, [0.0], [rest], [pressure], growing=bool(friction)
        )

    def turn(self, path: Callable[[float], Pose]) -> Ladder:
        """From here on another path, whose way starts at 0; this ladder stays where it is."""
        other = copy(self)
        other.contact, other.path = copy(self.contact), path
        other.way, other.u, other.pressure = [0.0], self.u[-1:], self.pressure[-1:]
        other.newton_steps, other.dissipation, other.growing, other.warm = 0, 0.0, False, 1
        return other

    @property
    def force_floor(self) -> float:
        return 1e-4 * self.site.youngs_modulus * self.size**2

    def step_to(self, way: float, recorded: bool) -> Equilibrium:
        """One equilibrium at `way`, started by extrapolating the last two."""
        self.contact.pose = self.path(way)
        start = self.u[-1]
        self.contact.multiplier = self.pressure[-1]
        if len(self.way) > self.warm:
            ratio = (way - self.way[-1]) / (self.way[-1] - self.way[-2])
            start = self.site.body.follow(self.u[-1] + ratio * (self.u[-1] - self.u[-2]))
            rise = self.pressure[-1] - self.pressure[-2]
            self.contact.multiplier = np.maximum(0.0, self.pressure[-1] + ratio * rise)
            if not np.isfinite(self.site.body.state(start).energy):
                start = self.u[-1]
        found = self._solve(start, LOOSE if recorded or not isinstance(self.contact, Coulomb) else PATH)
        if recorded:
            for _ in range(self.settings.updates - 1):
                self.contact.update(found.u)
                found = self._solve(found.u, LOOSE)
            self.contact.update(found.u)
            found = self._solve(found.u, self.settings.tolerance)
        pressure = np.linalg.norm(found.contact.traction, axis=2)
        if isinstance(self.contact, Coulomb):
            pressure = self._remember(found)
        self.way.append(way)
        self.u.append(found.u)
        self.pressure.append(pressure)
        self.way, self.u, self.pressure = self.way[-3:], self.u[-3:], self.pressure[-3:]
        return found

    def _remember(self, found: Equilibrium) -> np.ndarray:
        """End a step with friction; returns the pressures, (B, Q) Pa."""
        self.check = self.contact.check(found.u, found.contact)
        if self.check.failure():
            raise EquilibriumError(self.check.failure())
        self.contact.commit(found.u)
        self.dissipation += self.check.dissipation
        return self.contact.limit / self.contact.friction

    def _largest(self, way: float) -> float:
        """m; longest step towards `way`."""
        largest = self.settings.step * self.size
        return min(largest, self.settings.growth * self.way[-1] or way / 8.0) if self.growing else largest

    def _solve(self, start: np.ndarray, tolerance: float) -> Equilibrium:
        solve = equilibrate_sliding if isinstance(self.contact, Coulomb) else equilibrate
        found = solve(self.site.body, self.contact, start, tolerance, self.force_floor)
        self.newton_steps += found.iterations
        return found

    def go_to(self, way: float) -> Equilibrium:
        """Equilibrium at `way` in steps of at most settings.step contact sizes, halved where they fail."""
        largest = np.inf
        halvings = 0
        while True:
            remaining = way - self.way[-1]
            count = int(np.ceil(remaining / min(largest, self._largest(way)) - 1e-9))
            target = self.way[-1] + remaining / max(count, 1)
            kept = (list(self.way), list(self.u), list(self.pressure))
            try:
                found = self.step_to(target, count <= 1)
            except EquilibriumError:
                self.way, self.u, self.pressure = kept
                halvings += 1
                if halvings > self.settings.halvings:
                    raise
                largest = 0.5 * min(largest, remaining / max(count, 1))
                continue
            if count <= 1:
                return found


def _penalty(settings: PressSettings, size: float) -> float:
    """1/m; settings.penalty, doubled or halved until it suits a contact of `size` (m).

    In steps of two, so that tools that press alike do so with the same.
    """
    least, most = np.log2(np.array(PENALTY_RANGE) / (settings.penalty * size))
    steps = max(0.0, np.ceil(least)) + min(0.0, np.floor(most))
    return settings.penalty * 2.0**steps


def reaction_error(site: Site, found: Equilibrium, pose: Pose) -> float:
    """Force and moment on the tool against the supports', as a share of the force (times the body's size)."""
    force, moment = found.contact.force, found.contact.moment
    support = site.body.support_reaction(found.u, found.elastic)
    scale = max(float(np.linalg.norm(force)), 1e-300)
    outline = np.concatenate([site.patch.points, site.surroundings.far_faces.reshape(-1, 3)])
    arm = float(np.linalg.norm(outline - site.contact_point, axis=1).max())
    turned = moment + np.cross(pose.position, force) - support[3:]
    return float(max(np.linalg.norm(force - support[:3]) / scale, np.linalg.norm(turned) / (scale * arm)))
