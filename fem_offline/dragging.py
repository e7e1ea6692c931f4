# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The friction that a hand feels, found as one would find it: press, drag one way, come back, drag the other way.

At each depth of a ladder with Coulomb friction the tool moves along a tangent s and, from the same pressed state,
along -s, at constant height, until the force is steady.  With f_t = -f . s and f_n = f . n, f the force on the tool,

    mu_eff = (f_t(+s) - f_t(-s)) / (f_n(+s) + f_n(-s))

An inhomogeneous or curved body pushes the tool sideways without friction too.  That part is the same both ways and
cancels in the difference; a drag one way would take it for friction.

How far is far enough?  A Hertz contact under load P slides as a whole when the tool has moved (Mindlin 1949)

    give = 3 mu P / (2 k_t),      k_t the sticking stiffness along s

and its force changes little from there on; steps are counted in this give, then in contact radii.

Amontons' law says that mu_eff does not depend on depth; the record says whether it holds and how far it is off.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from palpate.fem_offline.clearance import why_not_placed, why_stray
from palpate.fem_offline.equilibrium import Equilibrium, EquilibriumError
from palpate.fem_offline.ladder import DEFAULT_SETTINGS, Ladder, PressSettings, reaction_error
from palpate.fem_offline.press import sticking, sticking_stiffness
from palpate.fem_offline.site import Site
from palpate.fem_offline.tool import Pose, Tool, tangents

__all__ = ["DragPath", "DragRecord", "DragSettings", "drag"]


@dataclass(frozen=True)
class DragSettings:
    """How far and how finely a tool is dragged.

    Attributes:
        give: ways at which equilibria are found before the contact slides as a whole, in units of give.
        step: of the steps after that, in contact radii.
        steady: change of the force along the drag per tenth of a contact radius, over the friction that can be
            reached, below which the force is steady.
        farthest: way after which a force that is not steady yet is refused, contact radii.
        amontons: spread of mu_eff over depth up to which Amontons' law is said to hold.
    """

    give: tuple[float, ...] = (0.25, 0.5, 0.75, 1.0, 1.25)
    step: float = 0.1
    steady: float = 5.0e-3
    farthest: float = 1.5
    amontons: float = 0.02


DEFAULT_DRAGGING = DragSettings()


@dataclass(frozen=True)
class DragPath:
    """One drag; S states, the pressed one first.

    Attributes:
        depth: m.  direction: (3,) unit, where the tool went.
        way: (S,) m.  force_vector: (S, 3) N on the tool.
        energy: (S,) J in the tissue.  dissipation: (S,) J since the pressed state.
        sliding: (S,) share of the pressed area that slid in the last step.
        residual: largest |r| / |f|.  reaction_error: largest, fraction of |f|.
        energy_error: |work of the hand - change of energy - dissipation| over the work, at the end.
        steady: the force had become steady.
    """

    depth: float
    direction: np.ndarray
    way: np.ndarray
    force_vector: np.ndarray
    energy: np.ndarray
    dissipation: np.ndarray
    sliding: np.ndarray
    residual: float
    reaction_error: float
    energy_error: float
    steady: bool

    @property
    def resistance(self) -> np.ndarray:
        """(S,) N; against the motion."""
        return -self.force_vector @ self.direction


@dataclass(frozen=True)
class DragRecord:
    """What dragging found, at K depths along M tangents.

    Attributes:
        contact_point, normal: (3,) m, (3,).
        friction: Coulomb's coefficient at every point of the contact.
        depth: (K,) m.  directions: (M, 3) unit tangents.
        effective: (K, M); mu_eff, NaN where a drag did not end steadily.
        one_way: (K, M, 2); f_t / f_n along +s and along -s, resistance positive.
        paths: of the drags, depth by depth, direction by direction, +s before -s.
        amontons: mu_eff is constant over depth within `DragSettings.amontons`.
        spread: (largest - smallest) / mean of mu_eff over depth, of the worst direction.
        converged: every drag ended steadily.  reason: why not, else "".
        newton_steps: in all.  seconds: wall time.
    """

    contact_point: np.ndarray
    normal: np.ndarray
    friction: float
    depth: np.ndarray
    directions: np.ndarray
    effective: np.ndarray
    one_way: np.ndarray
    paths: tuple[DragPath, ...]
    amontons: bool
    spread: float
    converged: bool
    reason: str
    newton_steps: int
    seconds: float


def drag(
    site: Site,
    tool: Tool,
    depths: Sequence[float],
    friction: float,
    directions: np.ndarray | None = None,
    distance: float | None = None,
    settings: PressSettings = DEFAULT_SETTINGS,
    dragging: DragSettings = DEFAULT_DRAGGING,
    progress: Callable[[float], None] = lambda depth: None,
) -> DragRecord:
    """Drag `tool` both ways at each of `depths`.

    Args:
        depths: (K,) m, rising, positive.
        friction: Coulomb's coefficient, positive.
        directions: (M, 3) tangents, normalised here; None: the first tangent of the site's normal.
        distance: m; way of every drag.  None: until the force is steady.
        progress: called with each depth done.

    Returns:
        The record; NaN in `effective` from where something failed, `reason` says what.

    Raises:
        ValueError: friction is not positive, a direction is along the normal, or depths do not rise.
    """
    begun = time.perf_counter()
    depths = np.asarray(depths, float)
    if not friction > 0.0:
        raise ValueError(f"friction is {friction}; a drag needs it positive")
    if not (len(depths) and depths[0] > 0.0 and np.all(np.diff(depths) > 0.0)):
        raise ValueError(f"depths are {depths} m; they must be positive and rise")
    s = _directions(site.normal, directions)
    ladder = Ladder.above(site, tool, settings, float(depths[-1]), friction)
    one_way = np.full((len(depths), len(s), 2), np.nan)
    effective = np.full((len(depths), len(s)), np.nan)
    paths: list[DragPath] = []
    reason, steps = why_not_placed(site, tool, float(depths[-1])), 0
    for k, depth in enumerate(depths if not reason else []):
        where = f"pressing to {depth * 1e3:.2f} mm"
        try:
            pressed = ladder.go_to(float(depth))
            _refuse(why_stray(site, tool, float(depth), pressed.u))
            stiffness = sticking_stiffness(site, pressed, sticking(site, pressed, ladder.contact, settings))
            for m in range(len(s)):
                ends = []
                for sign in (1.0, -1.0):
                    where = f"dragging along {np.round(sign * s[m], 2)} at {depth * 1e3:.2f} mm"
                    along = _Drag(site, ladder, pressed, float(depth), sign * s[m], stiffness, dragging)
                    try:
                        path = along.path(distance)
                    finally:
                        steps += along.ladder.newton_steps
                    paths.append(path)
                    ends.append((path.resistance[-1], path.force_vector[-1] @ site.normal, path.steady))
                    if not path.steady and not reason:
                        reason = f"{where}: the force was not steady after {path.way[-1] * 1e3:.2f} mm"
                (t_plus, n_plus, steady_plus), (t_minus, n_minus, steady_minus) = ends
                one_way[k, m] = t_plus / n_plus, t_minus / n_minus
                if steady_plus and steady_minus:
                    effective[k, m] = (t_plus + t_minus) / (n_plus + n_minus)
        except (EquilibriumError, ArithmeticError) as error:
            reason = reason or f"{where}: {error}"
            break
        progress(float(depth))
    found = effective[np.isfinite(effective).all(axis=1)]
    spread = float(np.max(np.ptp(found, axis=0) / np.mean(found, axis=0))) if len(found) else np.nan
    return DragRecord(
        site.contact_point,
        site.normal,
        friction,
        depths,
        s,
        effective,
        one_way,
        tuple(paths),
        bool(reason == "" and spread <= dragging.amontons),
        spread,
        reason == "",
        reason,
        steps + ladder.newton_steps,
        time.perf_counter() - begun,
    )


def _refuse(reason: str) -> None:
    if reason:
        raise EquilibriumError(reason)


def _directions(normal: np.ndarray, directions: np.ndarray | None) -> np.ndarray:
    if directions is None:
        return tangents(normal)[:1]
    s = np.atleast_2d(np.asarray(directions, float))
    s = s - (s @ normal)[:, None] * normal
    length = np.linalg.norm(s, axis=1)
    if np.any(length < 1e-6):
        raise ValueError("a drag along the normal is a press")
    return s / length[:, None]


class _Drag:
    """One drag from a pressed state."""

    def __init__(
        self,
        site: Site,
        pressed: Ladder,
        found: Equilibrium,
        depth: float,
        direction: np.ndarray,
        stiffness: np.ndarray,
        settings: DragSettings,
    ) -> None:
        home = pressed.contact.pose

        def path(way: float) -> Pose:
            return home.at(home.position + way * direction)

        self.site, self.depth, self.direction, self.settings = site, depth, direction, settings
        self.ladder = pressed.turn(path)
        self.radius = np.sqrt(found.contact.area / np.pi)
        self.friction = self.ladder.contact.friction
        load = float(found.contact.force @ site.normal)
        self.give = 1.5 * self.friction * load / float(direction @ stiffness @ direction)
        self.states = [(0.0, found, 0.0, 0.0)]

    def ways(self, distance: float | None):
        """m; where equilibria are wanted."""
        if distance is not None:
            yield from (w for g in self.settings.give if (w := g * self.give) < distance - 1e-12)
            yield distance
            return
        way = 0.0
        for share in self.settings.give:
            way = share * self.give
            yield way
        while way < self.settings.farthest * self.radius + self.give:
            way += self.settings.step * self.radius
            yield way

    def path(self, distance: float | None) -> DragPath:
        """Raises EquilibriumError."""
        worst = 0.0
        for way in self.ways(distance):
            found = self.ladder.go_to(way)
            error = reaction_error(self.site, found, self.ladder.contact.pose)
            worst = max(worst, error)
            if error > self.ladder.settings.reaction_tolerance:
                raise EquilibriumError(f"action and reaction differ by {error:.1e}")
            _refuse(why_stray(self.site, self.ladder.tool, self.depth, found.u, self.ladder.contact.pose))
            self.states.append((way, found, self.ladder.dissipation, self.ladder.check.sliding))
            if distance is None and self.steady:
                break
        way, dissipation, sliding = (np.array([state[k] for state in self.states]) for k in (0, 2, 3))
        force = np.array([state[1].contact.force for state in self.states])
        energy = np.array([state[1].elastic.energy for state in self.states])
        resistance = -force @ self.direction
        work = float(np.sum(0.5 * (resistance[1:] + resistance[:-1]) * np.diff(way)))
        missing = work - (energy[-1] - energy[0]) - dissipation[-1]
        return DragPath(
            self.depth, self.direction, way, force, energy, dissipation, sliding,
            max(state[1].residual for state in self.states), worst,
            abs(missing) / max(abs(work), 1e-300), self.steady,
        )  # fmt: skip

    @property
    def steady(self) -> bool:
        """All slides, and the resistance changed little in the last step."""
        if len(self.states) < 3 or self.states[-1][0] < self.give:
            return False
        (way_0, found_0, _, _), (way_1, found_1, _, _) = self.states[-2:]
        change = abs((found_1.contact.force - found_0.contact.force) @ self.direction)
        reach = self.friction * float(found_1.contact.force @ self.site.normal)
        return change / (way_1 - way_0) * 0.1 * self.radius <= self.settings.steady * reach
