# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""One press: the normal ladder of a rigid tool, its reactions, energies, and the sticking contact's stiffness.

The tool is turned as the site says and its reference point goes from p(0) = c + rho n to p(d) = c + (rho - d) n.
Each recorded state is an equilibrium; f = force on the tool, W = stored energy.  Free checks, kept in the record:

    action and reaction:  |f_tool - f_supports| / |f_tool|, and moments  (the supports' side is computed on its own)
    work and energy:      dW/dd = f . n                             (checked over each ladder, see `work_mismatch`)

With a friction coefficient the same ladder runs with Coulomb's law at every point (coulomb.py), on a path of smaller
steps, because friction remembers; the record then holds what the law's own check found, and the work also pays for
dissipation: dW/dd + dD/dd = f . n.

Sticking: at each depth the points in contact are held to the tool, and the tool's translational stiffness
K = -df/dp is found from the linearised equilibrium.  Lateral ladders do the same with finite moves.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from palpate.fem_offline.clearance import why_not_placed, why_stray
from palpate.fem_offline.contact import Sticking, Unilateral
from palpate.fem_offline.coulomb import Coulomb, FrictionCheck
from palpate.fem_offline.equilibrium import Equilibrium, EquilibriumError, equilibrate
from palpate.fem_offline.site import Site
from palpate.fem_offline.sliding import equilibrate_sliding
from palpate.fem_offline.tool import Pose, Tool

__all__ = ["LateralLadder", "PressRecord", "PressSettings", "PressState", "SlidingRecord", "press"]


LOOSE = 3.0e-3
"""Residual at which multipliers are updated; a better one does not survive the update."""
STICKING_TOLERANCE = 1.0e-6
"""Of the linear solves for the sticking stiffness.  The stiffness is a small difference of large numbers (the
spring that holds the points is a thousand times stiffer than the tissue): 1e-2 was off by half."""


PATH = 1.0e-5
"""Residual of steps on the way with friction; they are remembered."""


@dataclass(frozen=True)
class PressSettings:
    """How a press is solved; part of every record's hash.

    Attributes:
        penalty: contact penalty over E, 1/m (8 per mm; see contact.py).
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


@dataclass(frozen=True)
class LateralLadder:
    """A sticking lateral move at one depth.

    Attributes:
        depth: m.
        deflection: (M, 3) m; tool translation from the pressed state, the zero state first.
        force_vector: (M, 3) N on the tool.
        energy: (M,) J.
    """

    depth: float
    deflection: np.ndarray
    force_vector: np.ndarray
    energy: np.ndarray


@dataclass(frozen=True)
class PressState:
    """What a lateral move can be chosen by.

    Attributes:
        normal: (3,) outward.  force: (3,) N on the tool.  sticking_stiffness: (3, 3) N/m.
    """

    normal: np.ndarray
    force: np.ndarray
    sticking_stiffness: np.ndarray


@dataclass(frozen=True)
class SlidingRecord:
    """What friction did in a press; rows as the press record's.

    Attributes:
        friction: coefficient.
        dissipation: (K,) J since the untouched state.
        sliding: (K,) share of the pressed area that slid in the last step.
        excess: (K,) largest |tau| - mu p over the largest mu p, from the states' tractions anew.
        turned: (K,) largest power that friction misses for not opposing sliding, over the largest mu p |slip|.
    """

    friction: float
    dissipation: np.ndarray
    sliding: np.ndarray
    excess: np.ndarray
    turned: np.ndarray


@dataclass(frozen=True)
class PressRecord:
    """What one press found.  K states, the untouched one first.

    Attributes:
        contact_point, normal: (3,) m, (3,).
        depth: (K,) m.  force_vector: (K, 3) N on the tool.  moment: (K, 3) N m about the reference point.
        energy: (K,) J stored in the tissue.  area: (K,) m2 of reference surface in contact.
        residual: (K,) |r| / |f|.  reaction_error: (K,) action against reaction, forces and moments.
        penetration: (K,) m; mean gap error where pressure acts.
        sticking_stiffness: (K, 3, 3) N/m; -df/dp with the contact stuck, at every second depth and the deepest;
            zero at the zero state, NaN elsewhere.
        lateral: sticking lateral ladders.
        work_mismatch: largest |W + dissipation - integral of f_n| over the ladder, fraction of the deepest W.
        converged: every depth asked for was reached.  reason: why not, else "".
        unknowns: free equations.  newton_steps: in all.  seconds: wall time.  fidelity: near_field or full.
        sliding: with friction; None without.
    """

    contact_point: np.ndarray
    normal: np.ndarray
    depth: np.ndarray
    force_vector: np.ndarray
    moment: np.ndarray
    energy: np.ndarray
    area: np.ndarray
    residual: np.ndarray
    reaction_error: np.ndarray
    penetration: np.ndarray
    sticking_stiffness: np.ndarray
    lateral: tuple[LateralLadder, ...]
    work_mismatch: float
    converged: bool
    reason: str
    unknowns: int
    newton_steps: int
    seconds: float
    fidelity: str
    sliding: SlidingRecord | None = None

    @property
    def force(self) -> np.ndarray:
        """(K,) N; normal force on the tool."""
        return self.force_vector @ self.normal


@dataclass
class _Ladder:
    """A tool on its way in: the last equilibria, for extrapolation; `size` (m) of the contact at the deepest."""

    site: Site
    tool: Tool
    settings: PressSettings
    contact: Unilateral
    size: float
    depth: list[float] = field(default_factory=lambda: [0.0])
    u: list[np.ndarray] = field(default_factory=list)
    pressure: list[np.ndarray] = field(default_factory=list)
    newton_steps: int = 0
    dissipation: float = 0.0
    check: FrictionCheck | None = None

    def __post_init__(self) -> None:
        self.u = [np.zeros_like(self.site.body.nodes)]
        self.pressure = [np.zeros(self.site.surface.point_shape)]
        if isinstance(self.contact, Coulomb):
            self.contact.pose = self.site.pose(self.tool, 0.0)
            self.contact.start(self.u[0])

    @property
    def force_floor(self) -> float:
        return 1e-4 * self.site.youngs_modulus * self.size**2

    def step_to(self, depth: float, recorded: bool) -> Equilibrium:
        """One equilibrium at `depth`, started by extrapolating the last two."""
        self.contact.pose = self.site.pose(self.tool, depth)
        start = self.u[-1]
        self.contact.multiplier = self.pressure[-1]
        if len(self.depth) > 2:
            ratio = (depth - self.depth[-1]) / (self.depth[-1] - self.depth[-2])
            start = self.u[-1] + ratio * (self.u[-1] - self.u[-2])
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
        self.depth.append(depth)
        self.u.append(found.u)
        self.pressure.append(pressure)
        self.depth, self.u, self.pressure = self.depth[-3:], self.u[-3:], self.pressure[-3:]
        return found

    def _remember(self, found: Equilibrium) -> np.ndarray:
        """End a step with friction; returns the pressures, (B, Q) Pa."""
        self.check = self.contact.check(found.u, found.contact)
        if self.check.failure():
            raise EquilibriumError(self.check.failure())
        self.contact.commit(found.u)
        self.dissipation += self.check.dissipation
        return self.contact.limit / self.contact.friction

    def _largest(self, depth: float) -> float:
        """m; longest step towards `depth`."""
        largest = self.settings.step * self.size
        if not isinstance(self.contact, Coulomb):
            return largest
        return min(largest, self.settings.growth * self.depth[-1] or depth / 8.0)

    def _solve(self, start: np.ndarray, tolerance: float) -> Equilibrium:
        solve = equilibrate_sliding if isinstance(self.contact, Coulomb) else equilibrate
        found = solve(self.site.body, self.contact, start, tolerance, self.force_floor)
        self.newton_steps += found.iterations
        return found

    def go_to(self, depth: float) -> Equilibrium:
        """Equilibrium at `depth` in steps of at most settings.step contact sizes, halved where they fail."""
        largest = np.inf
        halvings = 0
        while True:
            remaining = depth - self.depth[-1]
            count = int(np.ceil(remaining / min(largest, self._largest(depth)) - 1e-9))
            target = self.depth[-1] + remaining / max(count, 1)
            kept = (list(self.depth), list(self.u), list(self.pressure))
            try:
                found = self.step_to(target, count <= 1)
            except EquilibriumError:
                self.depth, self.u, self.pressure = kept
                halvings += 1
                if halvings > self.settings.halvings:
                    raise
                largest = 0.5 * min(largest, remaining / max(count, 1))
                continue
            if count <= 1:
                return found


def press(
    site: Site,
    tool: Tool,
    depths: np.ndarray,
    settings: PressSettings = PressSettings(),
    moves: Callable[[int, PressState], np.ndarray | None] = lambda index, state: None,
    progress: Callable[[float], None] = lambda depth: None,
    watch: Callable[[float, Equilibrium], None] = lambda depth, found: None,
    friction: float = 0.0,
) -> PressRecord:
    """Press `tool` into a site along -normal.

    Args:
        depths: (K - 1,) m, rising, positive.
        moves: of the index in `depths` and the state there, tool translations (M, 3) m tried one after the other
            with the contact stuck (each starts where the last one ended), or None.
        progress: called with each depth reached.
        watch: called with each recorded equilibrium, before any lateral move.
        friction: Coulomb's coefficient; lateral moves stick whatever it is.

    Returns:
        The record, as deep as it came; `converged` and `reason` say whether that was all.
    """
    begun = time.perf_counter()
    contact = _contact(site, tool, settings, friction)
    ladder = _Ladder(site, tool, settings, contact, site.contact_size(tool, float(depths[-1])))
    zero = np.zeros(3)
    rows: list[tuple] = [(0.0, zero, zero, 0.0, 0.0, 0.0, 0.0, 0.0, np.zeros((3, 3)))]
    slid = [(0.0, 0.0, 0.0, 0.0)]
    ladders: list[LateralLadder] = []
    reason = why_not_placed(site, tool, float(depths[-1]))
    for index, depth in enumerate(depths if not reason else []):
        if depth >= site.thickness:
            reason = (
                f"{depth * 1e3:.2f} mm is deeper than the tissue, {site.thickness * 1e3:.2f} mm thick here"
            )
            break
        try:
            found = ladder.go_to(float(depth))
            mismatch = _reaction_error(site, found, contact.pose)
            if mismatch > settings.reaction_tolerance:
                reason = f"action and reaction differ by {mismatch:.1e} at {depth * 1e3:.2f} mm"
                break
            reason = why_stray(site, tool, float(depth), found.u)
            if reason:
                break
            stuck = _sticking(site, found, contact, settings)
            wants_stiffness = index % 2 == 1 or index == len(depths) - 1
            stiffness = (
                _sticking_stiffness(site, found, stuck) if wants_stiffness else np.full((3, 3), np.nan)
            )
            touch = found.contact
            rows.append(
                (depth, touch.force, touch.moment, found.elastic.energy, touch.area, found.residual, mismatch,
                 touch.penetration, stiffness)
            )  # fmt: skip
            if ladder.check:
                check = ladder.check
                slid.append((ladder.dissipation, check.sliding, check.excess, check.turned))
            watch(float(depth), found)
            wanted = moves(index, PressState(site.normal, touch.force, stiffness))
            if wanted is not None:
                ladders.append(_lateral_ladder(site, found, stuck, float(depth), wanted, settings, ladder))
        except (
            EquilibriumError,
            ArithmeticError,
        ) as error:  # a linear solve of the stuck contact may fail too
            reason = f"stopped before {depth * 1e3:.2f} mm: {error}; less depth, or a finer mesh"
            break
        progress(float(depth))
    column = [np.array([row[k] for row in rows], float) for k in range(9)]
    return PressRecord(
        site.contact_point,
        site.normal,
        *column,
        tuple(ladders),
        _work_mismatch(
            column[0], column[1] @ site.normal, column[3] + (np.array(slid)[:, 0] if friction else 0.0)
        ),
        reason == "",
        reason,
        site.body.equation_count,
        ladder.newton_steps,
        time.perf_counter() - begun,
        site.fidelity,
        SlidingRecord(friction, *np.array(slid).T) if friction else None,
    )


def _contact(site: Site, tool: Tool, settings: PressSettings, friction: float) -> Unilateral:
    penalty = settings.penalty * site.youngs_modulus
    if not friction:
        return Unilateral(site.surface, tool, penalty)
    if not 0.0 < friction < np.inf:
        raise ValueError(f"friction is {friction}; it must be zero or a positive number")
    return Coulomb(
        site.surface,
        tool,
        penalty,
        friction=friction,
        tangential_penalty=settings.sticking_penalty * penalty,
    )


def _reaction_error(site: Site, found: Equilibrium, pose: Pose) -> float:
    """Force and moment on the tool against the supports', as a share of the force (times the body's size)."""
    force, moment = found.contact.force, found.contact.moment
    support = site.body.support_reaction(found.u, found.elastic)
    scale = max(float(np.linalg.norm(force)), 1e-300)
    outline = np.concatenate([site.patch.points, site.surroundings.far_faces.reshape(-1, 3)])
    arm = float(np.linalg.norm(outline - site.contact_point, axis=1).max())
    turned = moment + np.cross(pose.position, force) - support[3:]
    return float(max(np.linalg.norm(force - support[:3]) / scale, np.linalg.norm(turned) / (scale * arm)))


def _sticking(site: Site, found: Equilibrium, contact: Unilateral, settings: PressSettings) -> Sticking:
    return Sticking(
        site.surface,
        settings.sticking_penalty * contact.penalty,
        site.surface.points(found.u),
        found.contact.traction,
        contact.pose.position.copy(),
    )


def _sticking_stiffness(site: Site, found: Equilibrium, stuck: Sticking) -> np.ndarray:
    """K = sum_q w_q eps_s (1 - N du/dD), H du/dD = eps_s sum_q w_q N."""
    if not found.contact.area:
        return np.zeros((3, 3))
    body, surface = site.body, site.surface
    body.linearise(found.u, stuck.hessian(found.u, False), 0.0, stuck=True)
    body.renew()
    free = body.equation >= 0
    load = stuck.load_of_translation(len(found.u))
    stiffness = np.zeros((3, 3))
    for k in range(3):
        response = np.zeros(len(free))
        response[free] = body.solve(load[:, :, k].ravel()[free], STICKING_TOLERANCE)
        # transposed load gives sum_q w_q eps_s N du/dD for each direction at once
        stiffness[:, k] = -np.einsum("nij,ni->j", load, response.reshape(-1, 3))
        stiffness[k, k] += stuck.penalty * float(np.sum(surface.weight[stuck._acting]))
    return 0.5 * (stiffness + stiffness.T)


def _lateral_ladder(
    site: Site,
    found: Equilibrium,
    stuck: Sticking,
    depth: float,
    moves: np.ndarray,
    settings: PressSettings,
    ladder: _Ladder,
) -> LateralLadder:
    u = found.u
    forces, energies = [found.contact.force], [found.elastic.energy]
    for move in np.atleast_2d(moves):
        stuck.translation = np.asarray(move, float)
        state = equilibrate(site.body, stuck, u, 1e-4, ladder.force_floor)
        stuck.update(state.u)
        state = equilibrate(site.body, stuck, state.u, settings.tolerance, ladder.force_floor)
        ladder.newton_steps += state.iterations
        u = state.u
        forces.append(state.contact.force)
        energies.append(state.elastic.energy)
    deflection = np.concatenate([np.zeros((1, 3)), np.atleast_2d(moves)])
    return LateralLadder(depth, deflection, np.array(forces), np.array(energies))


def _work_mismatch(depth: np.ndarray, force: np.ndarray, energy: np.ndarray) -> float:
    """Largest |W - integral f dd| / W_end, with f ~ d^n between neighbours: (f2 d2 - f1 d1) / (n + 1)."""
    if len(depth) < 3 or not np.all(force[1:] > 0.0):
        return 0.0
    d, f = depth[1:], force[1:]
    n = np.diff(np.log(f)) / np.diff(np.log(d))
    # up to the first depth, n is that of the next step (1.5 for a ball, 1 for a punch, 2 for a cone)
    work = np.concatenate([[0.0], np.cumsum(np.diff(f * d) / (n + 1.0))]) + f[0] * d[0] / (n[0] + 1.0)
    return float(np.max(np.abs(energy[1:] - work)) / max(energy[-1], 1e-300))
